//! What can happen to a ray, and the question that every method answers.

use super::ray::{MIN_U, OrbitError, Ray};

/// How a ray ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fate {
    /// It reaches the horizon, r = 1.
    Capture,
    /// It flies out to r = ∞.
    Escape,
}

/// What happens to a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventKind {
    /// It crosses a radius towards the hole.
    Inbound,
    /// It crosses a radius away from the hole.
    Outbound,
    /// It ends.
    End(Fate),
}

/// One thing that happens to a ray, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// What happens.
    pub kind: EventKind,
    /// The radius crossed, in Schwarzschild radii; 1 at capture, infinite at escape.
    pub radius: f64,
    /// The angle swept from the start, in radians.
    pub angle: f64,
}

/// Where a ray turns back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint {
    /// Inverse radius, where du/dφ = 0.
    pub u: f64,
    /// The angle swept from the start, in radians.
    pub angle: f64,
}

/// A method that computes what happens to a ray.
pub trait Orbits: Sync {
    /// Returns all events of `ray` in the order in which they happen: the crossings of each of `radii` (Schwarzschild
    /// radii, finite, above 1; a radius given twice counts once), then its end. The start itself is not a crossing.
    ///
    /// # Errors
    /// [`OrbitError::Radius`] for a radius that is not allowed, [`OrbitError::StepLimit`] where a stepped method gives
    /// up.
    fn follow(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError>;

    /// Returns where `ray` turns back: its periapsis outside the photon sphere, its apoapsis inside. `None` for a ray
    /// without a turning point, or with its turning point behind it or at its start.
    ///
    /// # Errors
    /// [`OrbitError::StepLimit`] where a stepped method gives up.
    fn turning_point(&self, ray: Ray) -> Result<Option<TurningPoint>, OrbitError>;

    /// Returns the angle at which `ray` crosses `radius` for the first time, `None` where it never does. The first
    /// event of [`follow`](Self::follow), without the cost of the others.
    ///
    /// # Errors
    /// Those of `follow`.
    fn first_crossing(&self, ray: Ray, radius: f64) -> Result<Option<f64>, OrbitError>;

    /// Returns the inverse radius of `ray` after it has swept `angle` radians from its start; `None` where it has ended
    /// by then, or where `angle` is not a number of 0 or more.
    ///
    /// # Errors
    /// [`OrbitError::StepLimit`] where a stepped method gives up.
    fn u_at_angle(&self, ray: Ray, angle: f64) -> Result<Option<f64>, OrbitError>;
}

/// A radius whose crossings are reported.
#[derive(Debug, Clone, Copy)]
pub(super) struct WatchedRadius {
    /// As given, in Schwarzschild radii.
    pub(super) radius: f64,
    /// Its inverse.
    pub(super) u: f64,
}

impl WatchedRadius {
    /// # Errors
    /// [`OrbitError::Radius`] for a radius that is not above 1, or is beyond 1e100.
    pub(super) fn new(radius: f64) -> Result<Self, OrbitError> {
        if !(radius > 1.0 && radius <= 1.0 / MIN_U) {
            return Err(OrbitError::Radius { radius });
        }
        Ok(Self {
            radius,
            u: 1.0 / radius,
        })
    }

    /// Returns the radii in ascending `u`, each once.
    ///
    /// # Errors
    /// [`OrbitError::Radius`] for a radius that is not above 1, or is beyond 1e100.
    pub(super) fn sorted(radii: &[f64]) -> Result<Vec<Self>, OrbitError> {
        let watched: Result<Vec<_>, _> = radii.iter().map(|&radius| Self::new(radius)).collect();
        let mut watched = watched?;
        watched.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        watched.dedup_by(|a, b| a.radius == b.radius);
        Ok(watched)
    }
}
