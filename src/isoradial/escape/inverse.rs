//! From a place in the sky to the rays that leave towards it.

use super::{EscapeCurve, value_and_slope};
use crate::isoradial::chebyshev::Chebyshev;

/// Coefficients of an octave's inverse polynomial.
pub(super) const INVERSE_COEFFICIENTS: usize = 15;

/// A ray that sweeps a given angle: an image of what lies there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    /// cos ψ, its inward part; ψ is the angle from the hole's direction.
    pub cosine: f64,
    /// sin ψ, its transverse part.
    pub sine: f64,
    /// `−dΦ/dψ`, above 0.
    pub rate: f64,
}

impl Image {
    /// Returns by how much a point of the sky is magnified at the swept angle whose sine is `sine`,
    /// `|sin ψ dψ/(sin Φ dΦ)|`. It is infinite straight before and behind the hole.
    pub fn magnification(&self, sine: f64) -> f64 {
        self.sine / (sine.abs() * self.rate)
    }
}

impl EscapeCurve {
    /// Fits the inverse polynomials.
    pub(super) fn invert(&mut self) {
        let chebyshev = Chebyshev::new(INVERSE_COEFFICIENTS - 1);
        for (octave, powers) in self.octaves.iter().enumerate() {
            let (low, high) = (self.ends[octave], self.ends[octave + 1]);
            let mut t = 1.0;
            let values: Vec<f64> = chebyshev
                .nodes()
                .map(|node| {
                    // Newton's method from the node before; Φ is convex and falls with t.
                    let angle = low + (high - low) * 0.5 * (1.0 - node);
                    for _ in 0..NEWTON_STEPS {
                        let (value, slope) = value_and_slope(powers, t);
                        t = (t + (angle - value) / slope).clamp(-1.0, 1.0);
                    }
                    t
                })
                .collect();
            let powers = Chebyshev::powers(&chebyshev.coefficients(&values));
            self.inverses.push(core::array::from_fn(|i| powers[i]));
        }
        let shares = (self.ends[self.octaves.len()] * SHARES_PER_RADIAN) as usize + 2;
        let octave = |share: usize| self.octave_from(0, share as f64 / SHARES_PER_RADIAN);
        self.shares = (0..shares).map(|share| octave(share) as u32).collect();
    }

    /// Returns the octave in which rays sweep `angle`, at least `first`.
    #[inline]
    fn octave_from(&self, first: usize, angle: f64) -> usize {
        first + self.ends[first + 1..].partition_point(|&end| end <= angle)
    }

    /// Returns the octave in which rays sweep `angle`.
    #[inline]
    fn octave_of_angle(&self, angle: f64) -> usize {
        let share = (angle * SHARES_PER_RADIAN) as usize;
        let Some(&[first, last]) = self
            .shares
            .get(share..share + 2)
            .and_then(<[u32]>::first_chunk)
        else {
            return self.octaves.len();
        };
        let (first, last) = (first as usize, last as usize);
        first + self.ends[first + 1..=last].partition_point(|&end| end <= angle)
    }

    /// Returns the ray that sweeps `angle` on its way out, at least 0. It sweeps that up to 1e-9 radians.
    pub fn image(&self, angle: f64) -> Image {
        let octave = self.octave_of_angle(angle);
        let (x, rate) = if octave < self.octaves.len() {
            let (low, high) = (self.ends[octave], self.ends[octave + 1]);
            let place = 1.0 - 2.0 * (angle - low) / (high - low);
            let (t, slope) = value_and_slope(&self.inverses[octave], place);
            let m = 0.5 * (t.clamp(-1.0, 1.0) + 3.0);
            // dΦ is half of high − low for each unit of the place.
            let rate = m * (high - low) / slope;
            (m * power_of_half(octave + 1), rate)
        } else {
            let x = libm::exp(self.ends[octave] - angle);
            (libm::ldexp(x, -(octave as i32)), 1.0)
        };
        let half = x * self.longest;
        let [cosine, sine] = self.direction(x);
        Image {
            cosine,
            sine,
            rate: rate * (1.0 + half * half) / (2.0 * half),
        }
    }
}

/// The angle swept is cut into this many parts a radian, to find its octave.
const SHARES_PER_RADIAN: f64 = 8.0;

/// Returns 2⁻ⁿ, for n below 1000.
#[inline(always)]
fn power_of_half(n: usize) -> f64 {
    f64::from_bits((1023 - n as u64) << 52)
}

/// The most steps that a root takes from its neighbour.
const NEWTON_STEPS: usize = 6;
