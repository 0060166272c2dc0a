//! Which frames share curves: neighbours of one camera radius.
//!
//! The spans are found within blocks of frames that begin at the same numbers whichever frames are drawn, so that a frame's
//! curves are the same wherever it is drawn, and a frame among millions is found in the time of one block.

use std::sync::OnceLock;

use crate::isoradial::{Isoradials, Sight};
use crate::scene::{Animation, View};

/// How many frames are looked at together.
const BLOCK: u32 = 256;

/// Curves for one picture are finer than for another where its pixels are smaller. Up to this ratio, sharing them is cheaper than
/// drawing both.
const ALIKE: f64 = 2.0;

/// The spans of one block.
#[derive(Debug)]
pub(super) struct Block {
    number: u32,
    spans: Vec<Span>,
}

/// Frames with the same curves.
#[derive(Debug)]
pub(super) struct Span {
    first: u32,
    last: u32,
    /// What the curves are drawn for: all that these frames show.
    pub(super) sight: Sight,
    /// The curves, once a frame has needed them.
    pub(super) curves: OnceLock<Isoradials>,
}

impl Block {
    /// The number of the block that a frame is in.
    fn of(frame: u32) -> u32 {
        frame.saturating_sub(1) / BLOCK
    }

    /// The block that a frame is in. Frames that cannot be are in no span.
    pub(super) fn new(animation: &Animation, frame: u32) -> Self {
        let number = Self::of(frame);
        let first = number * BLOCK + 1;
        let last = first.saturating_add(BLOCK - 1).min(animation.frames());
        let mut spans: Vec<Span> = Vec::new();
        // The pixel of a span's first frame: to drift from there is no way to become unlike.
        let mut pixel = 0.0;
        for number in first..=last {
            let Ok(scene) = animation.frame(number) else {
                continue;
            };
            let sight = Sight::new(&scene, &View::new(&scene), scene.tolerance());
            if let Some(span) = spans.last_mut()
                && span.last + 1 == number
                && (pixel / ALIKE..=pixel * ALIKE).contains(&sight.pixel)
                && let Some(both) = span.sight.and(&sight)
            {
                span.last = number;
                span.sight = both;
            } else {
                pixel = sight.pixel;
                spans.push(Span {
                    first: number,
                    last: number,
                    sight,
                    curves: OnceLock::new(),
                });
            }
        }
        Self { number, spans }
    }

    /// Whether a frame is in this block.
    pub(super) fn has(&self, frame: u32) -> bool {
        self.number == Self::of(frame)
    }

    /// The span that a frame is in.
    pub(super) fn span(&self, frame: u32) -> Option<&Span> {
        let after = self.spans.partition_point(|span| span.first <= frame);
        let span = self.spans.get(after.checked_sub(1)?)?;
        (frame <= span.last).then_some(span)
    }
}

impl Span {
    /// Whether it is of more than one frame.
    pub(super) fn is_shared(&self) -> bool {
        self.first < self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spans(animation: &Animation) -> Vec<(u32, u32)> {
        let mut spans = Vec::new();
        let mut next = 1;
        while next <= animation.frames() {
            let block = Block::new(animation, next);
            let span = block.span(next).unwrap();
            assert!(block.has(next) && span.first == next);
            spans.push((span.first, span.last));
            next = span.last + 1;
        }
        spans
    }

    #[test]
    fn an_orbit_is_one_span_and_an_approach_one_a_frame() {
        assert_eq!(spans(&Animation::load("orbit").unwrap()), [(1, 240)]);
        assert_eq!(spans(&Animation::load("classic").unwrap()), [(1, 1)]);
        let approach = spans(&Animation::load("approach").unwrap());
        assert_eq!(approach.len(), 240);
    }

    #[test]
    fn spans_end_at_the_same_frames_wherever_one_begins_to_look() {
        let long = crate::scene::builtins()
            .iter()
            .find(|builtin| builtin.name() == "orbit")
            .unwrap();
        let long =
            Animation::from_toml(&long.toml().replace("frames = 240", "frames = 1000")).unwrap();
        assert_eq!(
            spans(&long),
            [(1, 256), (257, 512), (513, 768), (769, 1000)]
        );
        let block = Block::new(&long, 700);
        let span = block.span(700).unwrap();
        assert_eq!((span.first, span.last), (513, 768));
        assert!(block.span(512).is_none() && block.span(769).is_none() && !block.has(769));
    }

    #[test]
    fn a_lens_that_grows_long_gets_curves_of_its_own() {
        let zoom = "[camera]\nposition = [20, 0, 5]\nfov = 64\n[disk]\ninner = 3\nouter = 12\n[image]\nwidth = 64\nheight = 36\n\
            [animation]\nframes = 100\ninterpolation = \"linear\"\n\
            [[animation.keyframe]]\nframe = 1\nfov = 64\n[[animation.keyframe]]\nframe = 100\nfov = 4\n";
        let spans = spans(&Animation::from_toml(zoom).unwrap());
        assert!((4..=6).contains(&spans.len()), "{spans:?}");
    }
}
