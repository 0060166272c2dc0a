//! How coarse frames are drawn while the camera moves, so that they come at the display's rate.

use std::time::Duration;

/// The time that a frame may take: a sixtieth of a second.
const FRAME: Duration = Duration::from_nanos(16_666_667);

/// The most pixels of the window that one pixel of a frame stands for, in each direction.
const COARSEST: u32 = 4;

/// So many frames in a row must be too slow, or fast enough, before anything changes: one slow frame may be the
/// system's doing.
const PATIENCE: u32 = 3;

/// How coarse frames are drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pace {
    reduction: u32,
    slow: u32,
    fast: u32,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            reduction: 1,
            slow: 0,
            fast: 0,
        }
    }
}

impl Pace {
    /// How many pixels of the window one pixel of a frame stands for, in each direction.
    pub(super) fn reduction(&self) -> u32 {
        self.reduction
    }

    /// Takes the time that a frame of this reduction took, and chooses that of the next. A finer one is taken where the
    /// frame would take at most nine tenths of the time that it may take, if its time goes with its pixels.
    pub(super) fn drawn(&mut self, time: Duration) {
        let reduction = self.reduction;
        let finer = reduction.saturating_sub(1).max(1);
        let growth = f64::from(reduction * reduction) / f64::from(finer * finer);
        let is_slow = time > FRAME && reduction < COARSEST;
        let is_fast = reduction > 1 && time.mul_f64(growth) < FRAME.mul_f64(0.9);
        self.slow = if is_slow { self.slow + 1 } else { 0 };
        self.fast = if is_fast { self.fast + 1 } else { 0 };
        if self.slow >= PATIENCE {
            *self = Self {
                reduction: reduction + 1,
                ..Self::default()
            };
        } else if self.fast >= PATIENCE {
            *self = Self {
                reduction: finer,
                ..Self::default()
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws frames that take `full` at full size, and returns the reductions.
    fn frames(pace: &mut Pace, full: Duration, count: u32) -> Vec<u32> {
        (0..count)
            .map(|_| {
                let reduction = pace.reduction();
                pace.drawn(full / (reduction * reduction));
                reduction
            })
            .collect()
    }

    #[test]
    fn frames_are_coarser_only_where_they_are_slow() {
        let mut pace = Pace::default();
        assert!(
            frames(&mut pace, Duration::from_millis(16), 50)
                .iter()
                .all(|&by| by == 1)
        );
        // At half the size each takes 10 ms.
        let slow = frames(&mut pace, Duration::from_millis(40), 50);
        assert_eq!((slow[2], slow[3], slow[49]), (1, 2, 2));
        // At a third 11 ms, at half 25 ms.
        let slower = frames(&mut pace, Duration::from_millis(100), 50);
        assert_eq!((slower[2], slower[3], slower[49]), (2, 3, 3));
        let hopeless = frames(&mut pace, Duration::from_secs(10), 50);
        assert_eq!(hopeless[49], COARSEST);
        let fast = frames(&mut pace, Duration::from_millis(5), 50);
        assert_eq!((fast[0], fast[49]), (COARSEST, 1));
    }

    #[test]
    fn a_single_slow_frame_changes_nothing() {
        let mut pace = Pace::default();
        for _ in 0..10 {
            pace.drawn(Duration::from_millis(100));
            pace.drawn(Duration::from_millis(5));
        }
        assert_eq!(pace.reduction(), 1);
    }
}
