//! The constants of motion of a ray: e², its difference from the critical value, and the family of rays.

use super::events::Fate;
use super::ray::Ray;

/// The photon sphere's inverse radius, around which critical rays wind for ever.
pub const PHOTON_SPHERE_U: f64 = 2.0 / 3.0;

/// `e² = 1/b²` of the critical ray, b = 3√3/2: that of the phase plane's saddle, (u, du/dφ) = (2/3, 0).
pub const CRITICAL_E2: f64 = 4.0 / 27.0;

/// The three families of rays, by `e²` and the side of the photon sphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// `e² > 4/27`: no turning point; falls in where `du/dφ > 0`, flies out where `du/dφ < 0`.
    Monotone,
    /// `e² < 4/27`, outside the photon sphere: turns at a periapsis and escapes.
    Scattered,
    /// `e² < 4/27`, inside the photon sphere: turns at an apoapsis and is captured.
    Trapped,
}

/// A ray with its constants of motion.
#[derive(Debug, Clone, Copy)]
pub struct Orbit {
    /// Where the ray starts.
    pub start: OrbitPoint,
    /// Whether it starts towards the hole. A ray that starts at its turning point counts as having passed it.
    pub inward: bool,
    /// `e² = (du/dφ)² + u²(1 − u) = 1/b²`.
    pub e2: f64,
    /// `Δ = e² − 4/27`, to a few units in its own last place wherever the start's two numbers determine it as well.
    pub delta: f64,
    /// The family of rays that it belongs to.
    pub family: Family,
}

/// A point of an orbit.
#[derive(Debug, Clone, Copy)]
pub struct OrbitPoint {
    /// Inverse radius.
    pub u: f64,
    /// `|du/dφ|`.
    pub slope: f64,
}

impl Orbit {
    /// Computes the constants of motion of `ray`.
    pub fn new(ray: Ray) -> Self {
        let (u, w) = (ray.u(), ray.dudphi());
        Self::with_delta(u, w, distance_from_critical(u, w.abs()))
    }

    /// Returns the orbit that starts at inverse radius `u` with slope `w`, for a caller who knows its
    /// `Δ = w² + u²(1 − u) − 4/27` better than the two numbers determine it.
    #[inline(always)]
    pub(crate) fn with_delta(u: f64, w: f64, delta: f64) -> Self {
        let slope = w.abs();
        let family = if delta > 0.0 {
            Family::Monotone
        } else if three_u_minus_two(u) < 0.0 {
            Family::Scattered
        } else {
            Family::Trapped
        };
        Self {
            start: OrbitPoint { u, slope },
            inward: w > 0.0 || (slope == 0.0 && family == Family::Trapped),
            e2: slope * slope + u * u * (1.0 - u),
            delta,
            family,
        }
    }

    /// Returns du/dφ at the start.
    #[inline]
    pub(crate) fn start_slope(&self) -> f64 {
        if self.inward {
            self.start.slope
        } else {
            -self.start.slope
        }
    }

    /// Returns how the ray ends.
    #[inline]
    pub fn fate(&self) -> Fate {
        match self.family {
            Family::Monotone if self.inward => Fate::Capture,
            Family::Trapped => Fate::Capture,
            Family::Monotone | Family::Scattered => Fate::Escape,
        }
    }

    /// Returns the orbit's point at inverse radius `u`, if the orbit reaches it before or after its turning point. A
    /// radius that the orbit only touches is not reached.
    #[inline]
    pub fn point_at(&self, u: f64) -> Option<OrbitPoint> {
        RadialLeg::new(self.start.u, u).end(self)
    }

    /// Returns the orbit's end, r = ∞ or the horizon. There `|du/dφ| = e`.
    pub fn end(&self) -> OrbitPoint {
        let u = match self.fate() {
            Fate::Capture => 1.0,
            Fate::Escape => 0.0,
        };
        OrbitPoint {
            u,
            slope: self.e2.sqrt(),
        }
    }
}

/// What orbits between two inverse radii have in common.
///
/// `u̇² = u̇0² + (u0 − u)(u0 + u − u0² − u0 u − u²)`: a sum of the start's slope and a difference that is exact for
/// neighbouring radii. About the photon sphere the second factor vanishes too. With `x = u − 2/3` it is
/// `−(x0 + x + x0² + x0 x + x²)`, which keeps its digits there.
#[derive(Debug, Clone, Copy)]
pub struct RadialLeg {
    /// The second inverse radius.
    u: f64,
    /// Whether it is inside the photon sphere.
    inside: bool,
    /// The change of `u̇²` between the two.
    gain: f64,
    /// `u̇²` of the critical ray at the second.
    critical: f64,
}

impl RadialLeg {
    /// Prepares the leg from inverse radius `u0` to `u`.
    #[inline]
    pub fn new(u0: f64, u: f64) -> Self {
        let factor = if u0 + u > 1.0 {
            let (x0, x) = (three_u_minus_two(u0) / 3.0, three_u_minus_two(u) / 3.0);
            -(x0 + x + x0 * x0 + x0 * x + x * x)
        } else {
            u0 + u - u0 * u0 - u0 * u - u * u
        };
        let s = critical_slope(u);
        Self {
            u,
            inside: three_u_minus_two(u) > 0.0,
            gain: (u0 - u) * factor,
            critical: s * s,
        }
    }

    /// Returns the point at the second inverse radius of `orbit`, which must start at the first; `None` where it does
    /// not reach the second (see [`Orbit::point_at`]).
    #[inline(always)]
    pub fn end(&self, orbit: &Orbit) -> Option<OrbitPoint> {
        let slope2 = orbit.start.slope * orbit.start.slope;
        // Where u̇² is small against the start's (nearer to the photon sphere) the difference from the start's has few
        // digits left, and s² + Δ has all of them.
        let squared = if self.critical + orbit.delta.abs() < slope2 {
            self.critical + orbit.delta
        } else {
            slope2 + self.gain
        };
        let same_side = match orbit.family {
            Family::Monotone => true,
            Family::Scattered => !self.inside,
            Family::Trapped => self.inside,
        };
        (same_side && squared > 0.0).then(|| OrbitPoint {
            u: self.u,
            slope: squared.sqrt(),
        })
    }
}

/// Returns `3u − 2`. For u ≥ ½ it is rounded once, since both summands of `(2u − 1) + (u − 1)` are exact; below,
/// nothing cancels. It is never zero, since 2/3 is not a floating-point number.
#[inline]
pub(crate) fn three_u_minus_two(u: f64) -> f64 {
    (2.0 * u - 1.0) + (u - 1.0)
}

/// Returns `s = |u − 2/3| √(u + 1/3)`, the slope `|du/dφ|` of the critical ray at u, since `s² = 4/27 − u²(1 − u)`.
pub(crate) fn critical_slope(u: f64) -> f64 {
    three_u_minus_two(u).abs() * ((3.0 * u + 1.0) / 27.0).sqrt()
}

/// Computes `Δ = e² − 4/27 = (|u̇| − s)(|u̇| + s)`.
///
/// A few units in the last place from critical the first factor has no digit left. There Δ is computed as `(27u̇² − (3u
/// − 2)²(3u + 1))/27` in double-double arithmetic. Its error of 2⁻¹⁰⁰ times 27u̇² leaves the sign, and with it the
/// ray's fate, right.
fn distance_from_critical(u: f64, slope: f64) -> f64 {
    let s = critical_slope(u);
    let difference = slope - s;
    if slope.is_infinite() {
        return f64::INFINITY;
    }
    // s has at most 3 roundings. Relative to a thousandth of s they are 1e3 times as large, and angles, which grow as
    // ln |Δ|, are right to some 1e-13 whatever their condition.
    if difference.abs() > 1e-3 * s {
        return difference * (slope + s);
    }
    let x = if u >= 0.5 {
        Double::sum(2.0 * u - 1.0, u - 1.0)
    } else {
        Double::product(3.0, u).add(-2.0)
    };
    let y = Double::product(3.0, u).add(1.0);
    let squared = Double::product(slope, slope);
    let critical = x.mul(x).mul(y);
    squared
        .mul(Double {
            high: 27.0,
            low: 0.0,
        })
        .sub(critical)
        / 27.0
}

/// An unevaluated sum of two doubles, |low| ≤ ulp(high)/2.
#[derive(Clone, Copy)]
struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// Returns a + b exactly (Knuth 1969).
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self {
            high,
            low: (a - (high - part)) + (b - part),
        }
    }

    /// Returns a·b exactly (Dekker 1971), by splitting, without a fused multiply-add.
    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        let ((ah, al), (bh, bl)) = (split(a), split(b));
        Self {
            high,
            low: ((ah * bh - high) + ah * bl + al * bh) + al * bl,
        }
    }

    fn add(self, b: f64) -> Self {
        let s = Self::sum(self.high, b);
        Self::sum(s.high, s.low + self.low)
    }

    fn mul(self, other: Self) -> Self {
        let p = Self::product(self.high, other.high);
        Self::sum(
            p.high,
            p.low + (self.high * other.low + self.low * other.high),
        )
    }

    /// Returns the difference, rounded to one double.
    fn sub(self, other: Self) -> f64 {
        let d = Self::sum(self.high, -other.high);
        d.high + (d.low + (self.low - other.low))
    }
}

/// Splits a into its upper 26 bits and the rest (Veltkamp 1968).
fn split(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a;
    let high = c - (c - a);
    (high, a - high)
}
