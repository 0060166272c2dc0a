//! Light rays around a Schwarzschild hole: what happens to a ray, and at which angles.
//!
//! Units: the Schwarzschild radius is 1, `u = 1/r`, angles in radians. A ray moves in a plane, where
//! `d²u/dφ² = 3/2 u² − u`; its first integral is `e² = (du/dφ)² + u²(1 − u) = 1/b²`, b the impact parameter.
//!
//! One question is asked of a ray, [`Orbits::follow`]: which radii does it cross, in which order, at which
//! swept angles, and how does it end? It is answered by [`exact::Exact`] (elliptic integrals), by
//! [`integrate::Adaptive`] and [`integrate::FixedStep`] (the equation itself, stepped in φ), and by the
//! [table](crate::table).

pub mod carlson;
pub mod csv;
pub mod exact;
pub mod integrate;
pub mod invariants;
pub mod path;

/// The farthest start there is, as inverse radius: beyond r = 1e100 the squares of `u` leave the range of numbers.
pub const MIN_U: f64 = 1e-100;

/// A ray's state where it starts, in its own plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    u: f64,
    dudphi: f64,
}

impl Ray {
    /// A ray at inverse radius `u` (`1e-100 ≤ u < 1`, outside the horizon) with slope `dudphi` (any number, or ±∞
    /// for straight in and straight out).
    ///
    /// # Errors
    /// [`OrbitError::Outside`] where `u` is not within those bounds, [`OrbitError::NoSlope`] where `dudphi`
    /// is not a number.
    pub fn new(u: f64, dudphi: f64) -> Result<Self, OrbitError> {
        if !(MIN_U..1.0).contains(&u) {
            return Err(OrbitError::Outside { u });
        }
        if dudphi.is_nan() {
            return Err(OrbitError::NoSlope);
        }
        Ok(Self { u, dudphi })
    }

    /// Inverse radius `u = 1/r`, between 0 and 1.
    pub fn u(self) -> f64 {
        self.u
    }

    /// `du/dφ`, positive where the ray goes inward.
    pub fn dudphi(self) -> f64 {
        self.dudphi
    }
}

/// How a ray ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fate {
    /// It reaches the horizon, r = 1.
    Capture,
    /// It flies out to r = ∞.
    Escape,
}

/// Something that happens to a ray.
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

/// Why a ray could not be followed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum OrbitError {
    /// The ray does not start outside the horizon.
    #[error(
        "u0 = {u:?} is not allowed: a ray starts outside the horizon and within 1e100 radii of it, 1e-100 ≤ u0 < 1"
    )]
    Outside {
        /// The inverse radius given.
        u: f64,
    },
    /// The ray has no direction.
    #[error(
        "dudphi is not a number: give du/dφ, or inf / -inf for a ray straight at or away from the hole"
    )]
    NoSlope,
    /// A radius to be watched is no radius outside the horizon.
    #[error(
        "radius {radius:?} is not allowed: crossings are reported for radii above 1, the horizon, up to 1e100"
    )]
    Radius {
        /// The radius given.
        radius: f64,
    },
    /// A stepped solution did not end.
    #[error(
        "no end found within {steps} steps (reached φ = {angle:?}): the ray winds near the photon sphere; use a larger step limit or the exact method"
    )]
    StepLimit {
        /// The steps taken.
        steps: u64,
        /// The angle reached.
        angle: f64,
    },
}

/// A way to find out what happens to a ray.
pub trait Orbits: Sync {
    /// All events of `ray` in the order they happen: the crossings of each of `radii` (Schwarzschild radii, finite,
    /// above 1; a radius given twice counts once), then its end. The start itself is no crossing.
    ///
    /// # Errors
    /// [`OrbitError::Radius`] for a radius that cannot be watched, [`OrbitError::StepLimit`] where a stepped method gives up.
    fn follow(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError>;

    /// Where `ray` turns back: its periapsis outside the photon sphere, its apoapsis inside. `None` for a ray that
    /// does not, or has its turning point behind it or at its start.
    ///
    /// # Errors
    /// [`OrbitError::StepLimit`] where a stepped method gives up.
    fn turning_point(&self, ray: Ray) -> Result<Option<TurningPoint>, OrbitError>;

    /// The angle at which `ray` crosses `radius` for the first time, `None` where it never does: what
    /// [`follow`](Self::follow) says first, without finding out the rest.
    ///
    /// # Errors
    /// As `follow`'s.
    fn first_crossing(&self, ray: Ray, radius: f64) -> Result<Option<f64>, OrbitError>;
}

/// Where a ray turns back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint {
    /// Inverse radius, where du/dφ = 0.
    pub u: f64,
    /// The angle swept from the start, in radians.
    pub angle: f64,
}

/// The radii to watch, as inverse radii in ascending `u`, each once.
///
/// # Errors
/// [`OrbitError::Radius`] for a radius that is not finite and above 1.
pub(crate) fn inverse_radii(radii: &[f64]) -> Result<Vec<WatchedRadius>, OrbitError> {
    let mut watched = Vec::with_capacity(radii.len());
    for &radius in radii {
        watched.push(WatchedRadius::new(radius)?);
    }
    watched.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    watched.dedup_by(|a, b| a.radius == b.radius);
    Ok(watched)
}

/// A radius whose crossings are reported.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WatchedRadius {
    /// As given, in Schwarzschild radii.
    pub(crate) radius: f64,
    /// Its inverse.
    pub(crate) u: f64,
}

impl WatchedRadius {
    /// # Errors
    /// [`OrbitError::Radius`] for a radius that is not finite and above 1.
    pub(crate) fn new(radius: f64) -> Result<Self, OrbitError> {
        if !(radius > 1.0 && radius <= 1.0 / MIN_U) {
            return Err(OrbitError::Radius { radius });
        }
        Ok(Self {
            radius,
            u: 1.0 / radius,
        })
    }
}
