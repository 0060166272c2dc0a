//! A ray's events, put together from swept angles. Written once for every method that knows those.

use super::elliptic::turning_u;
use super::events::{Event, EventKind, Orbits, TurningPoint, WatchedRadius};
use super::invariants::{Family, Orbit, OrbitPoint};
use super::ray::{OrbitError, Ray};

/// A method that knows the angle a ray sweeps between two points of its orbit.
pub trait SweptAngles: Sync {
    /// The angle swept from `from` to `to` on a stretch without a turning point, `∫ du/|du/dφ|` between them; ≥ 0.
    fn direct(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64;

    /// The angle swept from `from` over the orbit's turning point (periapsis or apoapsis) to `to`. Only for orbits
    /// that have one.
    fn around(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64;

    /// The largest error of an angle, in radians, beside what rounding the ray's own two numbers does to it.
    fn error(&self) -> f64;

    /// The angle from the start of `orbit` to its end.
    fn to_end(&self, orbit: &Orbit) -> f64 {
        if turns(orbit) {
            self.around(orbit, orbit.start, orbit.end())
        } else {
            self.direct(orbit, orbit.start, orbit.end())
        }
    }

    /// The angles at which the orbit crosses inverse radius `u`: inbound, outbound. The start is no crossing.
    fn crossings(&self, orbit: &Orbit, u: f64) -> Crossings {
        Anywhere(self).crossings(orbit, orbit.point_at(u))
    }

    /// The same angles, for one orbit after the other, of orbits that start at inverse radius `from`, to `to`: where
    /// a method knows what depends on the two alone, it is found once.
    fn between(&self, from: f64, to: f64) -> impl FixedRadiiAngles {
        let _ = (from, to);
        Anywhere(self)
    }

    /// The first of [`Self::crossings`].
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

/// A method's swept angles from the start of orbits, which is at one radius, to their points at another.
pub trait FixedRadiiAngles {
    /// [`SweptAngles::direct`] from the start.
    fn direct(&self, orbit: &Orbit, to: OrbitPoint) -> f64;

    /// [`SweptAngles::around`] from the start.
    fn around(&self, orbit: &Orbit, to: OrbitPoint) -> f64;

    /// The angles at which the orbit is at a point of its own, if it has it, inbound and outbound.
    fn crossings(&self, orbit: &Orbit, point: Option<OrbitPoint>) -> Crossings {
        let Some(point) = point else {
            return Crossings::default();
        };
        let first = ahead(orbit, point.u).then(|| self.direct(orbit, point));
        // What lies on the way to the turning point is crossed again after it, and so is all that lies behind the
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

/// FixedRadiiAngles any two radii, of a method that knows nothing of them beforehand.
struct Anywhere<'a, A: ?Sized>(&'a A);

impl<A: SweptAngles + ?Sized> FixedRadiiAngles for Anywhere<'_, A> {
    #[inline]
    fn direct(&self, orbit: &Orbit, to: OrbitPoint) -> f64 {
        self.0.direct(orbit, orbit.start, to)
    }

    #[inline]
    fn around(&self, orbit: &Orbit, to: OrbitPoint) -> f64 {
        self.0.around(orbit, orbit.start, to)
    }
}

/// The two ways from an orbit's start to a radius.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Branch {
    /// Straight there.
    Direct,
    /// Over the turning point.
    Around,
}

impl Branch {
    /// The other one.
    pub(crate) fn other(self) -> Self {
        match self {
            Self::Direct => Self::Around,
            Self::Around => Self::Direct,
        }
    }
}

/// Whether the orbit leaves its start towards inverse radius `u`.
pub(crate) fn ahead(orbit: &Orbit, u: f64) -> bool {
    if orbit.inward {
        u > orbit.start.u
    } else {
        u < orbit.start.u
    }
}

/// Whether the orbit's turning point is still ahead of its start.
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
        // Watched radii come in ascending u: the order of inbound crossings, the reverse of outbound ones. A trapped
        // ray goes out first and in afterwards, every other ray in first.
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
        // There and back to the start is twice the way there, and needs no point where du/dφ is 0 but for rounding.
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
