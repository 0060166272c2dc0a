//! Finds which frames share curves: neighbours of one camera radius.
//!
//! Spans are found within blocks of frames. Blocks begin at fixed frame numbers, whichever frames are drawn. So a frame
//! always gets the same curves, and finding the span of one frame among millions takes only the time of its block.

use std::sync::OnceLock;

use crate::isoradial::{CurveSpec, Isoradials, RadiusMap};
use crate::render::sky::SkyAtRadius;
use crate::scene::{Animation, View};

/// The number of frames in a block.
const BLOCK: i64 = 256;

/// The greatest ratio of the pixel sizes in a span. Smaller pixels need finer curves. Up to this ratio, sharing the
/// finer ones is cheaper than building both.
const MAX_PIXEL_RATIO: f64 = 2.0;

/// A block of frames and its spans.
#[derive(Debug)]
pub(super) struct Block {
    first: i64,
    spans: Vec<Span>,
}

/// Successive frames with the same curves.
#[derive(Debug)]
pub(super) struct Span {
    first: i64,
    last: i64,
    /// What the curves are built for: the union over the frames.
    pub(super) spec: CurveSpec,
    /// The curves, built when a frame first needs them.
    pub(super) curves: OnceLock<Isoradials>,
    /// Their map, built when a frame with light or data first needs it.
    pub(super) map: OnceLock<RadiusMap>,
    /// The sky at their radius, computed when a frame that shows it first needs it.
    pub(super) sky: OnceLock<SkyAtRadius>,
}

impl Block {
    /// Finds the spans of the block that a frame is in. Blocks are counted from the animation's first frame. Invalid
    /// frames are in no span.
    pub(super) fn new(animation: &Animation, frame: i64) -> Self {
        let first = frame - (frame - animation.first()).rem_euclid(BLOCK);
        let last = (first + BLOCK - 1).min(animation.last());
        let mut spans: Vec<Span> = Vec::new();
        // The pixel size of the span's first frame. Comparing with it, not with the last frame, bounds a slow zoom too.
        let mut pixel = 0.0;
        for number in first..=last {
            let Ok(scene) = animation.frame(number) else {
                continue;
            };
            let spec = CurveSpec::new(&scene, &View::new(&scene), scene.tolerance());
            if let Some(span) = spans.last_mut()
                && span.last + 1 == number
                && (pixel / MAX_PIXEL_RATIO..=pixel * MAX_PIXEL_RATIO).contains(&spec.pixel)
                && let Some(both) = span.spec.union(&spec)
            {
                span.last = number;
                span.spec = both;
            } else {
                pixel = spec.pixel;
                spans.push(Span {
                    first: number,
                    last: number,
                    spec,
                    curves: OnceLock::new(),
                    map: OnceLock::new(),
                    sky: OnceLock::new(),
                });
            }
        }
        Self { first, spans }
    }

    /// Returns whether a frame is in this block.
    pub(super) fn has(&self, frame: i64) -> bool {
        (self.first..self.first + BLOCK).contains(&frame)
    }

    /// Returns the span that a frame is in.
    pub(super) fn span(&self, frame: i64) -> Option<&Span> {
        let after = self.spans.partition_point(|span| span.first <= frame);
        let span = self.spans.get(after.checked_sub(1)?)?;
        (frame <= span.last).then_some(span)
    }
}

impl Span {
    /// Returns whether the span has more than one frame.
    pub(super) fn is_shared(&self) -> bool {
        self.first < self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spans(animation: &Animation) -> Vec<(i64, i64)> {
        let mut spans = Vec::new();
        let mut next = animation.first();
        while next <= animation.last() {
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
        let zoom = "[camera]\nposition = [20, 0, 5]\nfov = 64\n[disk]\ninner = 3\nouter = 12\n\
            [image]\nwidth = 64\nheight = 36\n[animation]\nframes = 100\ninterpolation = \"linear\"\n\
            [[animation.keyframe]]\nframe = 1\nfov = 64\n[[animation.keyframe]]\nframe = 100\nfov = 4\n";
        let spans = spans(&Animation::from_toml(zoom).unwrap());
        assert!((4..=6).contains(&spans.len()), "{spans:?}");
    }
}
