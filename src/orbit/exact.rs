//! The exact method.

use super::elliptic::{RealRoots, without_turning_point};
use super::invariants::{Family, Orbit, OrbitPoint};
use super::path::SweptAngles;

/// The exact method: elliptic integrals, exact up to rounding, for every ray.
#[derive(Debug, Clone, Copy, Default)]
pub struct Exact;

impl SweptAngles for Exact {
    /// A few units in the last place of an angle of some radians.
    fn error(&self) -> f64 {
        16.0 * f64::EPSILON
    }

    fn direct(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64 {
        match orbit.family {
            Family::Monotone => without_turning_point(orbit.e2, orbit.delta, from.u, to.u),
            Family::Scattered => {
                let roots = RealRoots::new(orbit.e2, orbit.delta);
                (roots.to_periapsis(from) - roots.to_periapsis(to)).abs()
            }
            Family::Trapped => {
                let roots = RealRoots::new(orbit.e2, orbit.delta);
                (roots.to_apoapsis(from) - roots.to_apoapsis(to)).abs()
            }
        }
    }

    fn around(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64 {
        let roots = RealRoots::new(orbit.e2, orbit.delta);
        match orbit.family {
            Family::Trapped => roots.to_apoapsis(from) + roots.to_apoapsis(to),
            Family::Scattered | Family::Monotone => {
                roots.to_periapsis(from) + roots.to_periapsis(to)
            }
        }
    }
}
