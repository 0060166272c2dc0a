//! Puts a ray's events together from swept angles, for every method that computes those.

use super::elliptic::turning_u;
use super::events::{Event, EventKind, Fate, Orbits, TurningPoint, WatchedRadius};
use super::invariants::{Family, Orbit, OrbitPoint};
use super::ray::{OrbitError, Ray, STRAIGHT, straight_u_at, within_flight};
use super::taylor::{LONGEST_STEP, PhasePoint};

/// A method that computes the angle a ray sweeps between two points of its orbit. Every such method implements
/// [`Orbits`].
pub trait SweptAngles: Sync {
    /// Returns the angle swept from `from` to `to` on a stretch without a turning point, `∫ du/|du/dφ|` ≥ 0.
    fn direct(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64;

    /// Returns the angle swept from `from` over the orbit's turning point (periapsis or apoapsis) to `to`. Only for
    /// orbits that have a turning point.
    fn around(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64;

    /// Returns the largest error of an angle, in radians, without the effect of rounding the ray's two numbers.
    fn error(&self) -> f64;

    /// Returns the angle from the start of `orbit` to its end.
    fn to_end(&self, orbit: &Orbit) -> f64 {
        if turns(orbit) {
            self.around(orbit, orbit.start, orbit.end())
        } else {
            self.direct(orbit, orbit.start, orbit.end())
        }
    }

    /// Returns the angles at which the orbit crosses inverse radius `u`. The start is not a crossing.
    fn crossings(&self, orbit: &Orbit, u: f64) -> Crossings {
        PlainAngles(self).crossings(orbit, orbit.point_at(u))
    }

    /// Returns the angles of orbits that all start at inverse radius `from`, to inverse radius `to`. A method may
    /// compute here what depends on the two radii alone.
    fn between(&self, from: f64, to: f64) -> impl FixedRadiiAngles {
        let _ = (from, to);
        PlainAngles(self)
    }

    /// Returns the first of [`Self::crossings`].
    #[inline]
    fn first_crossing_at(&self, orbit: &Orbit, u: f64) -> Option<f64> {
        let point = orbit.point_at(u)?;
        if ahead(orbit, u) {
            Some(self.direct(orbit, orbit.start, point))
        } else {
            turns(orbit).then(|| self.around(orbit, orbit.start, point))
        }
    }
}

/// A method's swept angles from the start of orbits at one fixed radius to their points at another.
pub trait FixedRadiiAngles {
    /// Returns [`SweptAngles::direct`] from the start.
    fn direct(&self, orbit: &Orbit, to: OrbitPoint) -> f64;

    /// Returns [`SweptAngles::around`] from the start.
    fn around(&self, orbit: &Orbit, to: OrbitPoint) -> f64;

    /// Returns the angles at which the orbit is at `point`, which is the orbit's point at the second radius; none
    /// where the orbit does not reach that radius.
    fn crossings(&self, orbit: &Orbit, point: Option<OrbitPoint>) -> Crossings {
        let Some(point) = point else {
            return Crossings::default();
        };
        let first = ahead(orbit, point.u).then(|| self.direct(orbit, point));
        // After its turning point the orbit crosses every radius that lay on the way there, and every one behind the
        // start.
        let second = turns(orbit).then(|| self.around(orbit, point));
        if orbit.inward {
            Crossings {
                inbound: first,
                outbound: second,
            }
        } else {
            Crossings {
                inbound: second,
                outbound: first,
            }
        }
    }
}

/// The angles of a method that computes nothing beforehand.
struct PlainAngles<'a, A: ?Sized>(&'a A);

impl<A: SweptAngles + ?Sized> FixedRadiiAngles for PlainAngles<'_, A> {
    #[inline]
    fn direct(&self, orbit: &Orbit, to: OrbitPoint) -> f64 {
        self.0.direct(orbit, orbit.start, to)
    }

    #[inline]
    fn around(&self, orbit: &Orbit, to: OrbitPoint) -> f64 {
        self.0.around(orbit, orbit.start, to)
    }
}

/// Which of an orbit's two stretches from its start to a radius is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Branch {
    /// Before the turning point.
    Direct,
    /// Over the turning point.
    Around,
}

impl Branch {
    /// Returns the other one.
    pub(crate) fn other(self) -> Self {
        match self {
            Self::Direct => Self::Around,
            Self::Around => Self::Direct,
        }
    }
}

/// Returns whether the orbit leaves its start towards inverse radius `u`.
pub(crate) fn ahead(orbit: &Orbit, u: f64) -> bool {
    if orbit.inward {
        u > orbit.start.u
    } else {
        u < orbit.start.u
    }
}

/// Returns whether the orbit's turning point is ahead of its start.
pub(crate) fn turns(orbit: &Orbit) -> bool {
    match orbit.family {
        Family::Monotone => false,
        Family::Scattered => orbit.inward,
        Family::Trapped => !orbit.inward,
    }
}

/// The angles at which a ray crosses one radius.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Crossings {
    /// Towards the hole.
    pub inbound: Option<f64>,
    /// Away from the hole.
    pub outbound: Option<f64>,
}

/// The most anchors that [`point_at_angle`] takes. Two are enough but for rays that wind within rounding of the photon
/// sphere, where any anchor gives u to a few units in the last place.
const MOST_ANCHORS: u32 = 8;

/// Returns the inverse radius at which `orbit` is after `angle` radians, and on which branch; `None` where it has ended
/// by then, or where `angle` is not a number of 0 or more.
///
/// An *anchor* is a point of the orbit whose swept angle is known. From an anchor within a quarter of a radian the
/// orbit equation leads to `angle` in a few Taylor steps, which have no singularity at the turning point. Such a guess
/// needs one swept angle, and two where its branch is wrong; without a guess the equation itself makes one, stepped
/// from the start.
///
/// The error is that of the anchor's swept angle times |du/dφ|, and the rounding of the steps.
pub(crate) fn point_at_angle<A: SweptAngles + ?Sized>(
    angles: &A,
    orbit: &Orbit,
    angle: f64,
    guess: Option<(f64, Branch)>,
) -> Option<(f64, Branch)> {
    if angle == 0.0 {
        return Some((orbit.start.u, Branch::Direct));
    }
    if angle.is_nan() || angle < 0.0 {
        return None;
    }
    if orbit.start.slope >= STRAIGHT {
        let w = orbit.start_slope();
        return straight_u_at(orbit.start.u, w, angle).map(|u| (u, Branch::Direct));
    }
    let mut anchor = match guess {
        Some((u, branch)) if within_flight(u) => {
            let guessed = Anchor::at(angles, orbit, u, branch);
            if turns(orbit) && (angle - guessed.angle).abs() > LONGEST_STEP {
                let other = Anchor::at(angles, orbit, u, branch.other());
                guessed.nearer(other, angle)
            } else {
                guessed
            }
        }
        _ => Anchor::start(orbit),
    };
    let mut best = None;
    for _ in 0..MOST_ANCHORS {
        let left = angle - anchor.angle;
        let Some(point) = anchor.point.advanced(left, orbit.delta) else {
            anchor = Anchor::end(angles, orbit);
            if angle < anchor.angle {
                continue;
            }
            return None;
        };
        // The sign of du/dφ tells the branch.
        let returning = turns(orbit) && (point.w < 0.0) == orbit.inward;
        let branch = if returning {
            Branch::Around
        } else {
            Branch::Direct
        };
        best = Some((point.u, branch));
        if left.abs() <= LONGEST_STEP {
            break;
        }
        anchor = Anchor::at(angles, orbit, point.u, branch);
    }
    best
}

/// A point of an orbit whose swept angle from the start is known.
struct Anchor {
    point: PhasePoint,
    angle: f64,
}

impl Anchor {
    fn start(orbit: &Orbit) -> Self {
        Self {
            point: PhasePoint::new(orbit.start.u, orbit.start_slope()),
            angle: 0.0,
        }
    }

    fn end<A: SweptAngles + ?Sized>(angles: &A, orbit: &Orbit) -> Self {
        let OrbitPoint { u, slope } = orbit.end();
        let w = if orbit.fate() == Fate::Capture {
            slope
        } else {
            -slope
        };
        Self {
            point: PhasePoint::new(u, w),
            angle: angles.to_end(orbit),
        }
    }

    /// Returns the one of two anchors that is nearer to an angle.
    fn nearer(self, other: Self, angle: f64) -> Self {
        if (angle - other.angle).abs() < (angle - self.angle).abs() {
            other
        } else {
            self
        }
    }

    /// Returns the turning point, or the start of an orbit without one.
    fn turning<A: SweptAngles + ?Sized>(angles: &A, orbit: &Orbit) -> Self {
        if !turns(orbit) {
            return Self::start(orbit);
        }
        Self {
            point: PhasePoint::turning(orbit),
            angle: 0.5 * angles.around(orbit, orbit.start, orbit.start),
        }
    }

    /// Returns the point at inverse radius `u` on a branch, or the turning point where the orbit does not reach u.
    #[inline]
    fn at<A: SweptAngles + ?Sized>(angles: &A, orbit: &Orbit, u: f64, branch: Branch) -> Self {
        let Some(point) = orbit.point_at(u) else {
            return Self::turning(angles, orbit);
        };
        let around = turns(orbit) && branch == Branch::Around;
        let angle = if around {
            angles.around(orbit, orbit.start, point)
        } else {
            angles.direct(orbit, orbit.start, point)
        };
        let behind_start = !around && !ahead(orbit, u);
        let w = if orbit.inward == around {
            -point.slope
        } else {
            point.slope
        };
        Self {
            point: PhasePoint::new(u, w),
            angle: if behind_start { -angle } else { angle },
        }
    }
}

impl<T: SweptAngles> Orbits for T {
    fn follow(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError> {
        let watched = WatchedRadius::sorted(radii)?;
        let orbit = Orbit::new(ray);
        let mut inbound = Vec::with_capacity(watched.len());
        let mut outbound = Vec::with_capacity(watched.len());
        for &WatchedRadius { radius, u } in &watched {
            let crossings = self.crossings(&orbit, u);
            let event = |kind| {
                move |angle| Event {
                    kind,
                    radius,
                    angle,
                }
            };
            inbound.extend(crossings.inbound.map(event(EventKind::Inbound)));
            outbound.extend(crossings.outbound.map(event(EventKind::Outbound)));
        }
        // Watched radii come in ascending u: in the order of inbound crossings, in the reverse order of outbound ones.
        // A trapped ray goes out first, every other ray in first.
        outbound.reverse();
        let (mut events, rest) = match orbit.family {
            Family::Trapped => (outbound, inbound),
            Family::Monotone | Family::Scattered => (inbound, outbound),
        };
        events.extend(rest);
        events.push(Event {
            kind: EventKind::End(orbit.fate()),
            radius: 1.0 / orbit.end().u,
            angle: self.to_end(&orbit),
        });
        Ok(events)
    }

    fn turning_point(&self, ray: Ray) -> Result<Option<TurningPoint>, OrbitError> {
        let orbit = Orbit::new(ray);
        // Half of the angle there and back: no point is needed whose du/dφ is 0 only up to rounding.
        Ok(turns(&orbit).then(|| TurningPoint {
            u: turning_u(&orbit),
            angle: 0.5 * self.around(&orbit, orbit.start, orbit.start),
        }))
    }

    fn first_crossing(&self, ray: Ray, radius: f64) -> Result<Option<f64>, OrbitError> {
        let WatchedRadius { u, .. } = WatchedRadius::new(radius)?;
        Ok(self.first_crossing_at(&Orbit::new(ray), u))
    }

    fn u_at_angle(&self, ray: Ray, angle: f64) -> Result<Option<f64>, OrbitError> {
        Ok(point_at_angle(self, &Orbit::new(ray), angle, None).map(|(u, _)| u))
    }
}

#[cfg(test)]
mod tests;
