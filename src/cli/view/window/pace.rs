//! How coarse frames are drawn while the camera moves, so that they come at the display's rate.

use std::time::Duration;

/// The time that a frame may take: a sixtieth of a second.
const FRAME: Duration = Duration::from_nanos(16_666_667);

/// So many frames in a row must be too slow, or fast enough, before anything changes: one slow frame may be the
/// system's doing.
const PATIENCE: u32 = 3;

/// How a frame is drawn while the camera moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Coarseness {
    /// How many pixels of the window one pixel of the frame stands for, in each direction.
    pub(super) reduction: u32,
    /// Whether edges are smooth, if they are in the scene. In small pictures with light smooth pixels take longest:
    /// many of them hold a whole ring, whose light is averaged.
    pub(super) is_smooth: bool,
}

/// From the finest to the coarsest.
const LEVELS: [Coarseness; 5] = [
    Coarseness::FULL,
    Coarseness::hard(1),
    Coarseness::hard(2),
    Coarseness::hard(3),
    Coarseness::hard(4),
];

impl Coarseness {
    /// That of the picture at rest.
    pub(super) const FULL: Self = Self {
        reduction: 1,
        is_smooth: true,
    };

    const fn hard(reduction: u32) -> Self {
        Self {
            reduction,
            is_smooth: false,
        }
    }
}

/// Chooses how frames are drawn, by the time that they take.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Pace {
    level: usize,
    slow: u32,
    fast: u32,
}

impl Pace {
    /// How the next frame is drawn.
    pub(super) fn coarseness(&self) -> Coarseness {
        LEVELS[self.level]
    }

    /// Takes the time that a frame took, and chooses how the next is drawn. A larger one is drawn if it will take at
    /// most nine tenths of the time that it may, provided that its time goes with its pixels.
    pub(super) fn drawn(&mut self, time: Duration) {
        let coarser = self.level + 1;
        let finer = self.level.saturating_sub(1);
        let squared = |level: usize| f64::from(LEVELS[level].reduction * LEVELS[level].reduction);
        let growth = squared(self.level) / squared(finer);
        let is_slow = time > FRAME && coarser < LEVELS.len();
        let is_fast = growth > 1.0 && time.mul_f64(growth) < FRAME.mul_f64(0.9);
        // Twice too slow counts twice.
        let weight = if time > 2 * FRAME { 2 } else { 1 };
        self.slow = if is_slow { self.slow + weight } else { 0 };
        self.fast = if is_fast { self.fast + 1 } else { 0 };
        if self.slow >= PATIENCE {
            *self = Self::at(coarser);
        } else if self.fast >= PATIENCE {
            *self = Self::at(finer);
        }
    }

    /// Begins the next movement one level finer: what is looked at may be another thing by then.
    pub(super) fn rested(&mut self) {
        *self = Self::at(self.level.saturating_sub(1));
    }

    fn at(level: usize) -> Self {
        Self {
            level,
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws frames whose time goes with their pixels, and returns how they were drawn.
    fn frames(pace: &mut Pace, full: Duration, count: u32) -> Vec<Coarseness> {
        (0..count)
            .map(|_| {
                let coarseness = pace.coarseness();
                pace.drawn(full / (coarseness.reduction * coarseness.reduction));
                coarseness
            })
            .collect()
    }

    #[test]
    fn frames_are_coarser_only_where_they_are_slow() {
        let mut pace = Pace::default();
        let fine = frames(&mut pace, Duration::from_millis(16), 50);
        assert!(fine.iter().all(|&by| by == Coarseness::FULL));
        // At half the size each takes 10 ms.
        let slow = frames(&mut pace, Duration::from_millis(40), 50);
        let expected = [Coarseness::FULL, Coarseness::hard(1), Coarseness::hard(2)];
        assert_eq!([slow[1], slow[2], slow[4]], expected);
        assert_eq!(slow[49], Coarseness::hard(2));
        // At a third 11 ms, at half 25 ms.
        let slower = frames(&mut pace, Duration::from_millis(100), 50);
        assert_eq!(slower[49], Coarseness::hard(3));
        let hopeless = frames(&mut pace, Duration::from_secs(10), 50);
        assert_eq!(hopeless[49], Coarseness::hard(4));
        let fast = frames(&mut pace, Duration::from_millis(5), 50);
        assert_eq!(
            (fast[0], fast[49]),
            (Coarseness::hard(4), Coarseness::hard(1))
        );
    }

    #[test]
    fn smooth_edges_come_back_after_a_rest_and_go_if_they_are_slow_again() {
        let mut pace = Pace::default();
        for _ in 0..2 {
            assert_eq!(pace.coarseness(), Coarseness::FULL);
            pace.drawn(Duration::from_millis(60));
            pace.drawn(Duration::from_millis(60));
            for _ in 0..50 {
                assert_eq!(pace.coarseness(), Coarseness::hard(1));
                pace.drawn(Duration::from_millis(2));
            }
            pace.rested();
        }
    }

    #[test]
    fn a_single_slow_frame_changes_nothing() {
        let mut pace = Pace::default();
        for _ in 0..10 {
            pace.drawn(Duration::from_millis(100));
            pace.drawn(Duration::from_millis(5));
        }
        assert_eq!(pace.coarseness(), Coarseness::FULL);
    }
}
