//! Light rays around a Schwarzschild black hole: what happens to a ray, and at which angles.
//!
//! Units: the Schwarzschild radius is 1, `u = 1/r`, angles are in radians. A ray moves in a plane, where
//! `d²u/dφ² = 3/2 u² − u`; its first integral is `e² = (du/dφ)² + u²(1 − u) = 1/b²`, b the impact parameter.
//!
//! [`Orbits::follow`] answers which radii a ray crosses, in which order and at which swept angles, and how it ends;
//! [`Orbits::u_at_angle`] answers where it is at a given angle, [`arc_points`] lays points along its path.
//! Three methods implement it: [`exact::Exact`] (elliptic integrals), [`integrate::Adaptive`] and
//! [`integrate::FixedStep`] (the equation itself, stepped in φ), and the [table](crate::table).

mod arc_points;
pub mod carlson;
mod elliptic;
mod events;
pub mod exact;
pub mod integrate;
pub mod invariants;
pub mod path;
mod ray;
mod taylor;

pub use arc_points::{ArcPoint, arc_points};
#[cfg(feature = "chart")]
pub(crate) use elliptic::turning_u;
pub(crate) use elliptic::{RealRoots, without_turning_point};
pub use events::{Event, EventKind, Fate, Orbits, TurningPoint};
pub use ray::{MIN_U, OrbitError, Ray};
