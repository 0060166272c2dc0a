//! Puts a ray's events together from swept angles, for every method that computes those.

use super::elliptic::turning_u;
use super::events::{Event, EventKind, Orbits, TurningPoint, WatchedRadius};
use super::invariants::{Family, Orbit, OrbitPoint};
use super::ray::{OrbitError, Ray};

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
}
