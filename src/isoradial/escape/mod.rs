//! The escape curve: the direction in which each ray of one camera leaves the hole behind.
//!
//! A ray that is not captured sweeps the angle Φ on its way from the camera to infinity, and leaves in the direction
//! `p̂ cos Φ + t̂ sin Φ`. At one camera radius Φ is a function of the angle ψ between the ray and the hole's direction
//! alone. It falls strictly, from +∞ at the critical ray, `ψ = ψ_c`, to 0 straight away from the hole, ψ = π.
//!
//! # The axis
//! Let `δ = ψ − ψ_c` be a ray's distance from the critical ray. The axis is `x = tan(δ/2)/tan(δ_max/2)`, with
//! `δ_max = π − ψ_c`, which takes no trigonometry:
//!
//! ```text
//! sin δ ~ s cos ψ_c − z sin ψ_c,   cos δ ~ s sin ψ_c + z cos ψ_c,   tan(δ/2) = sin δ/(1 + cos δ)
//! ```
//!
//! About the critical ray Φ is `−A ln x` and an analytic function, with A = 1 at x = 0 (Darwin 1959, *Proc. R. Soc. A*
//! 249, 180; [`charts`](crate::table::charts)). Φ has no other singularity near the axis: the mirrored critical rays
//! `ψ = −ψ_c` and `2π − ψ_c` lie on either side. So each octave of x is as
//! far from the singularity as it is long, and one degree of polynomials does for all, whatever the camera's radius.
//! Below the last octave only the logarithm is left: `Φ = Φ_last + ln(x_last/x)`.
//!
//! # Footprint
//! A small circle of radius ε about a ray is seen as an ellipse in the sky. Its semi-axes are `ε |dΦ/dψ|` in the ray's
//! plane and `ε |sin Φ/sin ψ|` across it. A point of the sky is magnified by the inverse of their product.

mod inverse;

use inverse::INVERSE_COEFFICIENTS;
pub use inverse::Image;

use super::chebyshev::Chebyshev;
use super::curve_spec::critical_kappa;
use crate::orbit::invariants::Orbit;
use crate::orbit::path::SweptAngles;
use crate::orbit::{OrbitError, Orbits, Ray};

/// Coefficients of an octave's polynomial. Chebyshev's fall by 5.8 each, so that what is left out is below
/// [`EscapeCurve::INTERPOLATION_ERROR`].
const COEFFICIENTS: usize = 13;

/// The octaves of x down to a distance from the critical ray of 2⁻⁴⁶ of the smallest angle that matters.
const OCTAVES: usize = 46;

/// The escape curve of one camera radius.
#[derive(Debug, Clone)]
pub struct EscapeCurve {
    /// Sine and cosine of `ψ_c`.
    sine: f64,
    cosine: f64,
    /// κ of the critical ray, `cot ψ_c`.
    critical: f64,
    /// `tan(δ_max/2)`
    longest: f64,
    /// Octaves of x, from `[½, 1]` down: the powers of `t = 2m − 3`, m from 1 to 2 across the octave.
    octaves: Vec<[f64; COEFFICIENTS]>,
    /// Φ at the start of each octave, from `x = 1` down, and at the end of the last.
    ends: Vec<f64>,
    /// For each octave, the powers of t as a function of Φ, −1 to 1 across the octave.
    inverses: Vec<[f64; INVERSE_COEFFICIENTS]>,
    /// For each share of a radian of Φ, the octave that it begins in; the last share ends with the last octave.
    shares: Vec<u32>,
}

/// A ray that escapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Escape {
    /// The angle swept, Φ.
    pub angle: f64,
    /// `−dΦ/dψ`, above 0: how fast the angle swept falls with the angle from the hole's direction.
    pub rate: f64,
}

impl EscapeCurve {
    /// How far an angle may be off between nodes, in radians, on top of the error of the method's angles.
    pub const INTERPOLATION_ERROR: f64 = 1e-10;

    /// Computes the curve of a camera at inverse radius `u0` from a method's swept angles. `slope_scale` is
    /// `u0 √(1 − u0)`.
    pub fn new(u0: f64, slope_scale: f64, angles: &impl SweptAngles) -> Self {
        let to_end = |orbit: &Orbit| Ok::<_, core::convert::Infallible>(angles.to_end(orbit));
        let Ok(curve) = Self::from_ends(u0, slope_scale, to_end);
        curve
    }

    /// Computes the curve by following rays.
    ///
    /// # Errors
    /// The method's error for a ray that it cannot follow.
    pub fn from_orbits(
        u0: f64,
        slope_scale: f64,
        orbits: &impl Orbits,
    ) -> Result<Self, OrbitError> {
        Self::from_ends(u0, slope_scale, |orbit| {
            let events = orbits.follow(Ray::new(u0, orbit.start_slope())?, &[])?;
            Ok(events.last().map_or(0.0, |end| end.angle))
        })
    }

    /// `to_end` gives the angle that an orbit sweeps to its end.
    fn from_ends<E>(
        u0: f64,
        slope_scale: f64,
        mut to_end: impl FnMut(&Orbit) -> Result<f64, E>,
    ) -> Result<Self, E> {
        let critical = critical_kappa(u0, slope_scale);
        let sine = 1.0 / (1.0 + critical * critical).sqrt();
        let cosine = critical * sine;
        let longest = if cosine > 0.0 {
            (1.0 + cosine) / sine
        } else {
            sine / (1.0 - cosine)
        };
        let mut curve = Self {
            sine,
            cosine,
            critical,
            longest,
            octaves: Vec::new(),
            ends: vec![0.0],
            inverses: Vec::new(),
            shares: Vec::new(),
        };
        // Far away, angles matter down to a share of the hole's size, `ψ_c = 2/longest`.
        let far = 2.0 * libm::log2(longest.max(1.0));
        let chebyshev = Chebyshev::new(COEFFICIENTS - 1);
        for octave in 0..OCTAVES + far as usize {
            let scale = libm::ldexp(0.5, -(octave as i32));
            let mut values = [0.0; COEFFICIENTS];
            for (value, node) in values.iter_mut().zip(chebyshev.nodes()) {
                let x = scale * (1.5 + 0.5 * node);
                if x < 1.0 {
                    let orbit = curve.orbit(x, u0, slope_scale);
                    *value = to_end(&orbit)?;
                }
            }
            let powers = Chebyshev::powers(&chebyshev.coefficients(&values));
            curve.octaves.push(core::array::from_fn(|i| powers[i]));
            curve.ends.push(values[COEFFICIENTS - 1]);
        }
        curve.invert();
        Ok(curve)
    }

    /// Returns the orbit at x, below 1. Its `Δ = (w − w_c)(w + w_c)` comes from `κ_c − κ = sin δ/(sin ψ sin ψ_c)`, so
    /// that it keeps its digits about the critical ray.
    fn orbit(&self, x: f64, u0: f64, slope_scale: f64) -> Orbit {
        let half = x * self.longest;
        let [cosine, sine] = self.direction(x);
        let below = 2.0 * half / ((1.0 + half * half) * sine * self.sine);
        let (excess, critical) = (-slope_scale * below, slope_scale * self.critical);
        let delta = excess * (2.0 * critical + excess);
        Orbit::with_delta(u0, slope_scale * cosine / sine, delta)
    }

    /// Returns cos ψ and sin ψ at x: `tan(ψ/2) = (tan(ψ_c/2) + tan(δ/2))/(1 − x)`.
    fn direction(&self, x: f64) -> [f64; 2] {
        let (near, beyond) = (1.0 / self.longest + x * self.longest, 1.0 - x);
        let length = near * near + beyond * beyond;
        [
            (beyond - near) * (beyond + near) / length,
            2.0 * near * beyond / length,
        ]
    }

    /// Returns the number of bytes that a frame reads.
    pub fn bytes(&self) -> usize {
        size_of_val(self.octaves.as_slice())
    }

    /// Returns the number of octaves of the distance to the critical ray that have a polynomial.
    pub fn octaves(&self) -> usize {
        self.octaves.len()
    }

    /// Returns the number of nodes.
    pub fn nodes(&self) -> usize {
        self.octaves.len() * COEFFICIENTS
    }

    /// Returns κ of the critical ray.
    pub fn critical(&self) -> f64 {
        self.critical
    }

    /// Returns `tan(δ/2)` of a ray with inward part z and transverse length s; 0 or less where it is captured.
    #[inline]
    fn half_tangent(&self, z: f64, s: f64) -> f64 {
        let length = (z * z + s * s).sqrt();
        let sine = self.sine * (self.critical * s - z);
        let cosine = self.sine * s + self.cosine * z;
        if cosine > 0.0 {
            sine / (length + cosine)
        } else {
            (length - cosine) / sine
        }
    }

    /// Returns how the ray with inward part `z` and transverse length `s` escapes; `None` where it is captured.
    ///
    /// The angle is off by at most the error of the method's angles and [`Self::INTERPOLATION_ERROR`].
    #[inline]
    pub fn at(&self, z: f64, s: f64) -> Option<Escape> {
        let half = self.half_tangent(z, s);
        (half > 0.0).then(|| self.at_half_tangent(half))
    }

    /// Returns the same at `tan(δ/2)`, above 0.
    #[inline]
    fn at_half_tangent(&self, half: f64) -> Escape {
        let x = (half / self.longest).min(1.0);
        // dδ is this times the change of ln x.
        let per_octave = 2.0 * half / (1.0 + half * half);
        let (octave, m) = octave_of(x);
        let Some(powers) = self.octaves.get(octave) else {
            let last = self.octaves.len();
            let x_last = libm::ldexp(1.0, -(last as i32));
            return Escape {
                angle: self.ends[last] + libm::log(x_last / x),
                rate: 1.0 / per_octave,
            };
        };
        let (value, slope) = value_and_slope(powers, 2.0 * m - 3.0);
        Escape {
            angle: value.max(0.0),
            // dt = 2 m d(ln x)
            rate: -2.0 * m * slope / per_octave,
        }
    }
}

/// Returns a polynomial of even degree and its derivative. Its even and its odd powers are summed side by side.
#[inline(always)]
fn value_and_slope<const N: usize>(powers: &[f64; N], t: f64) -> (f64, f64) {
    let square = t * t;
    let pairs = powers[..N - 1].as_chunks::<2>().0;
    let last = powers[N - 1];
    // Of even + t odd, and of their derivatives to t².
    let (mut even, mut odd) = (last, 0.0);
    let (mut even_slope, mut odd_slope) = (0.0, 0.0);
    for [c, d] in pairs.iter().rev() {
        even_slope = even_slope * square + even;
        odd_slope = odd_slope * square + odd;
        even = even * square + c;
        odd = odd * square + d;
    }
    (even + t * odd, odd + 2.0 * t * (even_slope + t * odd_slope))
}

/// Returns the octave of x in (0, 1], and the place across it, 1 to 2.
#[inline]
fn octave_of(x: f64) -> (usize, f64) {
    const MANTISSA: u64 = (1 << 52) - 1;
    const ONE: u64 = 1023 << 52;
    if x >= 1.0 {
        return (0, 2.0);
    }
    let bits = x.to_bits();
    let octave = 1022 - (bits >> 52) as usize;
    (octave, f64::from_bits(bits & MANTISSA | ONE))
}

#[cfg(test)]
mod tests;
