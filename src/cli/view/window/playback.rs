//! The animation's clock.

use std::time::{Duration, Instant};

use crate::scene::Animation;

/// Which frame of an animation is shown, and when the next one is due. It begins again at its end.
#[derive(Debug, Clone)]
pub(super) struct Playback {
    first: i64,
    frames: i64,
    /// The time of one frame.
    interval: Duration,
    frame: i64,
    /// Since when it plays, and from which frame on.
    begun: Option<(Instant, i64)>,
}

impl Playback {
    /// Stands at an animation's first frame.
    pub(super) fn new(animation: &Animation) -> Self {
        let rate = animation.rate();
        Self {
            first: animation.first(),
            frames: animation.frames().into(),
            interval: Duration::from_secs_f64(f64::from(rate.seconds) / f64::from(rate.frames)),
            frame: animation.first(),
            begun: None,
        }
    }

    /// Whether there is anything to play.
    pub(super) fn has_frames(&self) -> bool {
        self.frames > 1
    }

    /// The number of the frame that is shown.
    pub(super) fn frame(&self) -> i64 {
        self.frame
    }

    /// Where the frame is between the first and the last, 0 to 1.
    pub(super) fn share(&self) -> f64 {
        (self.frame - self.first) as f64 / (self.frames - 1).max(1) as f64
    }

    pub(super) fn is_playing(&self) -> bool {
        self.begun.is_some()
    }

    pub(super) fn stop(&mut self) {
        self.begun = None;
    }

    /// Plays or stops.
    pub(super) fn toggle(&mut self, now: Instant) {
        self.begun = match self.begun {
            None if self.has_frames() => Some((now, self.frame)),
            _ => None,
        };
    }

    /// Goes to the frame at a share of the way from the first to the last.
    pub(super) fn seek(&mut self, share: f64) {
        self.stop();
        let steps = (share.clamp(0.0, 1.0) * (self.frames - 1) as f64).round();
        self.frame = self.first + steps as i64;
    }

    /// Goes to a frame, or the one of the animation's that is nearest.
    pub(super) fn go_to(&mut self, frame: i64) {
        self.frame = frame.clamp(self.first, self.first + self.frames - 1);
    }

    /// Goes on to the frame that is due. Returns whether that is another one.
    pub(super) fn advance(&mut self, now: Instant) -> bool {
        let Some((begun, from)) = self.begun else {
            return false;
        };
        let passed = self.passed(now - begun);
        let frame = self.first + (from - self.first + passed).rem_euclid(self.frames);
        std::mem::replace(&mut self.frame, frame) != frame
    }

    /// When the next frame is due, if it plays.
    pub(super) fn next(&self, now: Instant) -> Option<Instant> {
        let (begun, _) = self.begun?;
        let passed = self.passed(now - begun) + 1;
        Some(begun + self.interval.mul_f64(passed as f64))
    }

    /// The number of frames in some time. A frame that was waited for has begun, however times are rounded.
    fn passed(&self, time: Duration) -> i64 {
        let rounding = Duration::from_micros(1);
        ((time + rounding).as_secs_f64() / self.interval.as_secs_f64()) as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_follow_the_clock_and_begin_again() {
        let animation = Animation::load("orbit").unwrap();
        let mut playback = Playback::new(&animation);
        let (first, count) = (animation.first(), i64::from(animation.frames()));
        let start = Instant::now();
        assert!(!playback.advance(start) && playback.next(start).is_none());
        playback.toggle(start);
        let mut now = start;
        for passed in 1..=count + 3 {
            now = playback.next(now).unwrap();
            assert!(playback.advance(now), "{passed}");
            assert_eq!(playback.frame(), first + passed % count);
        }
        let rate = animation.rate();
        let expected = (count + 3) as f64 * f64::from(rate.seconds) / f64::from(rate.frames);
        assert!(((now - start).as_secs_f64() - expected).abs() < 1e-5);
        // What was not drawn in time is left out.
        playback.go_to(first);
        playback.toggle(now);
        playback.toggle(now);
        playback.advance(now + Duration::from_secs(1));
        assert_eq!(
            playback.frame(),
            first + i64::from(rate.frames / rate.seconds)
        );
        playback.toggle(now);
        assert!(!playback.is_playing());
    }

    #[test]
    fn the_bar_leads_to_every_frame() {
        let mut playback = Playback::new(&Animation::load("orbit").unwrap());
        for (share, frame) in [(-1.0, 1), (0.0, 1), (0.5, 121), (1.0, 240), (2.0, 240)] {
            playback.seek(share);
            assert_eq!(playback.frame(), frame);
        }
        assert_eq!(playback.share(), 1.0);
        let still = Playback::new(&Animation::load("classic").unwrap());
        assert!(!still.has_frames() && still.share() == 0.0);
    }
}
