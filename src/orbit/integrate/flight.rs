//! What both integrators share: the equation, the start of a flight, and what is asked of it.

use super::crossings::{CrossingSearch, EventLog, MonotonePiece};
use super::root;
use crate::orbit::events::{Event, EventKind, TurningPoint, WatchedRadius};
use crate::orbit::ray::{OrbitError, Ray, STRAIGHT, straight_u_at};

/// The number of steps after which a stepped solution gives up, unless told otherwise. A ray one unit in the last place
/// from critical winds some 40 radians, which even steps of 0.001 cover in less than half as many.
pub(super) const DEFAULT_MAX_STEPS: u64 = 100_000;

/// A point of the phase plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct State {
    /// Inverse radius.
    pub(super) u: f64,
    /// du/dφ.
    pub(super) w: f64,
}

/// Computes `d²u/dφ² = 3/2 u² − u` as `3/2 u (u − 2/3)`. 2/3 is taken in two parts, the second of which is the rounding
/// error of the first. The result is right to a few units in its own last place on both sides of the photon sphere, so
/// that even a ray that starts at its rounded radius is repelled.
#[inline]
pub(super) fn acceleration(u: f64) -> f64 {
    const HIGH: f64 = 2.0 / 3.0;
    const LOW: f64 = f64::EPSILON / 6.0;
    1.5 * u * ((u - HIGH) - LOW)
}

/// Returns whether a and b have opposite signs. Zero has none.
pub(super) fn opposite(a: f64, b: f64) -> bool {
    (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)
}

/// A ray's flight before its first step.
pub(super) enum Departure<'a, L> {
    /// The path is straight, and all its crossings are found.
    Done(CrossingSearch<'a, L>),
    /// The state to step from, and the crossings to look for.
    Bound(State, CrossingSearch<'a, L>),
}

/// Prepares a flight. Rays that are straight lines in (φ, u) are finished here, among them those with infinite du/dφ,
/// whose angles are all 0.
pub(super) fn depart<L: EventLog>(ray: Ray, watched: &[WatchedRadius], log: L) -> Departure<'_, L> {
    let start = State {
        u: ray.u(),
        w: ray.dudphi(),
    };
    if start.w.abs() >= STRAIGHT {
        let inward = start.w > 0.0;
        let mut crossings = CrossingSearch::new(watched, log, start.u);
        let piece = MonotonePiece {
            from: start.u,
            to: if inward { 1.0 } else { 0.0 },
            inward,
            turns: false,
        };
        crossings.pass(piece, |u| (u - start.u).abs() / start.w.abs());
        return Departure::Done(crossings);
    }
    Departure::Bound(start, CrossingSearch::new(watched, log, start.u))
}

/// A step taken.
pub(super) struct Step {
    pub(super) from: State,
    pub(super) to: State,
    /// Its length in φ.
    pub(super) h: f64,
    /// The angle swept at `from`.
    pub(super) angle: f64,
}

impl Step {
    /// Reports the events on the step, which is cut at its turning point. Returns whether the flight ends on it.
    ///
    /// `at(x)` returns `u − origin`, du/dφ and d²u/dφ² at the angle x from the step's start.
    pub(super) fn pass<L: EventLog>(
        &self,
        crossings: &mut CrossingSearch<'_, L>,
        origin: f64,
        at: impl Fn(f64) -> [f64; 3],
    ) -> bool {
        let Self { from, to, h, angle } = *self;
        let pass = |crossings: &mut CrossingSearch<'_, L>, piece: MonotonePiece, first, last| {
            let mut reached = first;
            crossings.pass(piece, |u| {
                let level = u - origin;
                reached = root::bracketed(reached, last, piece.inward, |x| {
                    let [offset, slope, _] = at(x);
                    (offset - level, slope)
                });
                angle + reached
            })
        };
        let inward = from.w > 0.0 || (from.w == 0.0 && to.u > from.u);
        let whole = MonotonePiece {
            from: from.u,
            to: to.u,
            inward,
            turns: to.w == 0.0,
        };
        if !opposite(from.w, to.w) {
            if whole.turns {
                crossings.turn(to.u, angle + h);
            }
            return pass(crossings, whole, 0.0, h);
        }
        let turn = root::bracketed(0.0, h, !inward, |x| {
            let [_, slope, curvature] = at(x);
            (slope, curvature)
        });
        let turning = origin + at(turn)[0];
        crossings.turn(turning, angle + turn);
        let towards = MonotonePiece {
            to: turning,
            turns: true,
            ..whole
        };
        let back = MonotonePiece {
            from: turning,
            inward: !inward,
            turns: false,
            ..whole
        };
        pass(crossings, towards, 0.0, turn) || pass(crossings, back, turn, h)
    }
}

/// A method that steps along a ray until its end, or until `log` wants no further event.
pub(super) trait Flight {
    /// Follows `ray` past `watched` (by ascending u), and puts its events into `log`.
    ///
    /// # Errors
    /// [`OrbitError::StepLimit`]
    fn fly<'a, L: EventLog>(
        &self,
        ray: Ray,
        watched: &'a [WatchedRadius],
        log: L,
    ) -> Result<CrossingSearch<'a, L>, OrbitError>;

    /// Implements [`Orbits::follow`](crate::orbit::Orbits::follow)
    fn all_events(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError> {
        let watched = WatchedRadius::sorted(radii)?;
        // Each radius is crossed at most twice.
        let log = Vec::with_capacity(2 * watched.len() + 1);
        self.fly(ray, &watched, log).map(CrossingSearch::into_log)
    }

    /// Implements [`Orbits::first_crossing`](crate::orbit::Orbits::first_crossing)
    fn first_event(&self, ray: Ray, radius: f64) -> Result<Option<f64>, OrbitError> {
        let watched = [WatchedRadius::new(radius)?];
        let first = self.fly(ray, &watched, None)?.into_log();
        Ok(first.and_then(|event: Event| match event.kind {
            EventKind::Inbound | EventKind::Outbound => Some(event.angle),
            EventKind::End(_) => None,
        }))
    }

    /// Returns the state after `angle`, which is above 0; `None` where the ray has ended by then.
    ///
    /// # Errors
    /// [`OrbitError::StepLimit`]
    fn fly_for(&self, start: State, angle: f64) -> Result<Option<State>, OrbitError>;

    /// Implements [`Orbits::u_at_angle`](crate::orbit::Orbits::u_at_angle)
    fn u_after(&self, ray: Ray, angle: f64) -> Result<Option<f64>, OrbitError> {
        let (u, w) = (ray.u(), ray.dudphi());
        if angle == 0.0 {
            Ok(Some(u))
        } else if angle.is_nan() || angle < 0.0 {
            Ok(None)
        } else if w.abs() >= STRAIGHT {
            Ok(straight_u_at(u, w, angle))
        } else {
            let state = self.fly_for(State { u, w }, angle)?;
            Ok(state.map(|state| state.u))
        }
    }

    /// Implements [`Orbits::turning_point`](crate::orbit::Orbits::turning_point)
    fn turn(&self, ray: Ray) -> Result<Option<TurningPoint>, OrbitError> {
        let flight = self.fly(ray, &[], None)?;
        Ok(flight.turning_point())
    }
}
