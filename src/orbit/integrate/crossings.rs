//! Finds the watched radii that a piece of a path passes, in order.

use crate::orbit::events::{Event, EventKind, Fate, TurningPoint, WatchedRadius};

/// A piece of a path along which u only rises or only falls.
#[derive(Debug, Clone, Copy)]
pub(super) struct MonotonePiece {
    /// u where it begins. Events there were reported with the piece before.
    pub(super) from: f64,
    /// u where it ends.
    pub(super) to: f64,
    /// Whether u rises. (`from` and `to` may be equal or, at a turning point, rounded.)
    pub(super) inward: bool,
    /// Whether the ray turns back at its end. A radius that it only touches there is not crossed.
    pub(super) turns: bool,
}

/// Keeps a flight's events.
pub(super) trait EventLog {
    /// Takes the next event, and returns whether another is wanted.
    fn take(&mut self, event: Event) -> bool;
}

/// Keeps all of them.
impl EventLog for Vec<Event> {
    fn take(&mut self, event: Event) -> bool {
        self.push(event);
        true
    }
}

/// Keeps the first.
impl EventLog for Option<Event> {
    fn take(&mut self, event: Event) -> bool {
        *self = Some(event);
        false
    }
}

/// The events of a flight so far, and the radii it may cross next.
#[derive(Debug)]
pub(super) struct CrossingSearch<'a, L> {
    /// The radii, by ascending u.
    watched: &'a [WatchedRadius],
    log: L,
    turning_point: Option<TurningPoint>,
    /// The nearest level of u (a watched radius, infinity or the horizon) at or below the present u.
    below: f64,
    /// The nearest level at or above the present u.
    above: f64,
}

impl<'a, L: EventLog> CrossingSearch<'a, L> {
    /// Begins a flight at `u` that reports the crossings of `watched` (by ascending u).
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

    /// Returns whether no level lies between the present u and `u`. Called at every step.
    #[inline]
    pub(super) fn clear_until(&self, u: f64) -> bool {
        // At a watched radius both bounds are that radius and the answer is no, so that the way back through it is not
        // missed.
        self.below < u && u < self.above
    }

    /// Reports the events along a piece. `angle_at(u)` returns the swept angle at which the piece reaches u; it is
    /// called in the order in which the ray meets the radii. Returns whether the flight ends on the piece, or no
    /// further event is wanted.
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
        // Inward (from, to], outward [to, from): of two pieces that meet at a level, one contains it.
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

    /// Records where the flight turned back.
    pub(super) fn turn(&mut self, u: f64, angle: f64) {
        self.turning_point.get_or_insert(TurningPoint { u, angle });
    }

    /// Returns where the flight turned back.
    pub(super) fn turning_point(&self) -> Option<TurningPoint> {
        self.turning_point
    }

    /// Returns the events.
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
