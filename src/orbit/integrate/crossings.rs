//! Which watched radii a piece of a path passes, in order.

use crate::orbit::events::{Event, EventKind, Fate, TurningPoint, WatchedRadius};

/// A piece of a path along which u only rises or only falls.
#[derive(Debug, Clone, Copy)]
pub(super) struct MonotonePiece {
    /// u where it begins. What happened there was reported with the piece before.
    pub(super) from: f64,
    /// u where it ends.
    pub(super) to: f64,
    /// Whether u rises. Told apart from `from` and `to`, which may be equal or, at a turning point, rounded.
    pub(super) inward: bool,
    /// Whether the ray turns back at its end: a radius just touched there is not crossed.
    pub(super) turns: bool,
}

/// What is kept of a flight's events.
pub(super) trait EventLog {
    /// Takes the next event, and tells whether another is wanted.
    fn take(&mut self, event: Event) -> bool;
}

/// All of them.
impl EventLog for Vec<Event> {
    fn take(&mut self, event: Event) -> bool {
        self.push(event);
        true
    }
}

/// The first.
impl EventLog for Option<Event> {
    fn take(&mut self, event: Event) -> bool {
        *self = Some(event);
        false
    }
}

/// The events of a flight so far, and the radii it may cross next.
#[derive(Debug)]
pub(super) struct CrossingSearch<'a, L> {
    /// By ascending u.
    watched: &'a [WatchedRadius],
    log: L,
    turning_point: Option<TurningPoint>,
    /// Nearest level of u (a watched radius, infinity or the horizon) at or below the present u.
    below: f64,
    /// Nearest level at or above the present u.
    above: f64,
}

impl<'a, L: EventLog> CrossingSearch<'a, L> {
    /// A flight that begins at `u`, watched at `watched` (by ascending u).
    pub(super) fn new(watched: &'a [WatchedRadius], log: L, u: f64) -> Self {
        let mut crossings = Self {
            watched,
            log,
            turning_point: None,
            below: 0.0,
            above: 1.0,
        };
        crossings.settle(u);
        crossings
    }

    /// Whether nothing is met on the way from the present u straight to `u`: the question asked at every step.
    #[inline]
    pub(super) fn clear_until(&self, u: f64) -> bool {
        // From a watched radius itself the answer is always no, since both bounds are that radius: the way back
        // through it must not be missed.
        self.below < u && u < self.above
    }

    /// Reports what is met along a piece, `angle_at(u)` being the swept angle at which the piece reaches u; it is
    /// asked in the order the ray meets them. Returns whether the flight ends on it, or has been followed as far as is
    /// wanted.
    pub(super) fn pass(
        &mut self,
        piece: MonotonePiece,
        mut angle_at: impl FnMut(f64) -> f64,
    ) -> bool {
        let MonotonePiece {
            from,
            to,
            inward,
            turns,
        } = piece;
        let index = |level: f64, inclusive: bool| {
            self.watched
                .partition_point(|watched| watched.u < level || (inclusive && watched.u == level))
        };
        // Inward (from, to], outward [to, from): each level belongs to one of two pieces that meet there.
        let range = if inward {
            index(from, true)..index(to, !turns)
        } else {
            index(to, turns)..index(from, false)
        };
        let passed = self.watched.get(range).unwrap_or_default();
        let kind = if inward {
            EventKind::Inbound
        } else {
            EventKind::Outbound
        };
        let mut report = |level: &WatchedRadius| {
            self.log.take(Event {
                kind,
                radius: level.radius,
                angle: angle_at(level.u),
            })
        };
        let wanted = if inward {
            passed.iter().all(&mut report)
        } else {
            passed.iter().rev().all(&mut report)
        };
        if !wanted {
            return true;
        }
        let end = if inward && to >= 1.0 {
            Some((Fate::Capture, 1.0, 1.0))
        } else if !inward && to <= 0.0 {
            Some((Fate::Escape, f64::INFINITY, 0.0))
        } else {
            None
        };
        if let Some((fate, radius, u)) = end {
            self.log.take(Event {
                kind: EventKind::End(fate),
                radius,
                angle: angle_at(u),
            });
            return true;
        }
        self.settle(to);
        false
    }

    /// Finds the levels next to `u`.
    fn settle(&mut self, u: f64) {
        let at_or_below = self.watched.partition_point(|watched| watched.u <= u);
        let below = self.watched.partition_point(|watched| watched.u < u);
        self.below = at_or_below
            .checked_sub(1)
            .and_then(|i| self.watched.get(i))
            .map_or(0.0, |level| level.u);
        self.above = self.watched.get(below).map_or(1.0, |level| level.u);
    }

    /// Reports that the flight turned back.
    pub(super) fn turn(&mut self, u: f64, angle: f64) {
        self.turning_point.get_or_insert(TurningPoint { u, angle });
    }

    /// Where the flight turned back.
    pub(super) fn turning_point(&self) -> Option<TurningPoint> {
        self.turning_point
    }

    /// What was reported.
    pub(super) fn into_log(self) -> L {
        self.log
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radii_met(pieces: &[(f64, f64, bool)]) -> Vec<f64> {
        let watched = WatchedRadius::sorted(&[2.0, 4.0, 8.0]).unwrap();
        let mut crossings = CrossingSearch::new(&watched, Vec::new(), pieces[0].0);
        for &(from, to, turns) in pieces {
            crossings.pass(
                MonotonePiece {
                    from,
                    to,
                    inward: to > from,
                    turns,
                },
                |u| u,
            );
        }
        crossings
            .into_log()
            .iter()
            .map(|event| event.radius)
            .collect()
    }

    #[test]
    fn a_level_where_two_pieces_meet_is_crossed_once() {
        assert_eq!(
            radii_met(&[(0.1, 0.25, false), (0.25, 0.3, false)]),
            [8.0, 4.0]
        );
        assert_eq!(
            radii_met(&[(0.3, 0.25, false), (0.25, 0.1, false)]),
            [4.0, 8.0]
        );
    }

    #[test]
    fn a_level_touched_at_a_turning_point_is_not_crossed() {
        assert_eq!(
            radii_met(&[(0.2, 0.25, true), (0.25, 0.2, false)]),
            [] as [f64; 0]
        );
        assert_eq!(
            radii_met(&[(0.2, 0.26, true), (0.26, 0.2, false)]),
            [4.0, 4.0]
        );
    }

    #[test]
    fn nothing_is_clear_from_a_level_itself() {
        let watched = WatchedRadius::sorted(&[4.0]).unwrap();
        let mut crossings = CrossingSearch::new(&watched, Vec::new(), 0.25);
        assert!(!crossings.clear_until(0.3) && !crossings.clear_until(0.2));
        crossings.pass(
            MonotonePiece {
                from: 0.25,
                to: 0.3,
                inward: true,
                turns: false,
            },
            |u| u,
        );
        assert!(
            crossings.clear_until(0.26)
                && !crossings.clear_until(0.25)
                && !crossings.clear_until(1.0)
        );
    }
}
