//! From a place in the sky to the rays that leave towards it.

use super::{COEFFICIENTS, EscapeCurve};
use crate::isoradial::chebyshev::Chebyshev;

/// Coefficients of the polynomial that guesses a root; one step of Newton's makes it exact.
pub(super) const INVERSE_COEFFICIENTS: usize = 12;

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
    /// Fits the polynomials that guess roots.
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
                        let (value, slope) = horner(powers, t);
                        t = (t + (angle - value) / slope).clamp(-1.0, 1.0);
                    }
                    t
                })
                .collect();
            let powers = Chebyshev::powers(&chebyshev.coefficients(&values));
            self.inverses.push(core::array::from_fn(|i| powers[i]));
        }
    }

    /// Returns the ray that sweeps `angle` on its way out, at least 0.
    pub fn image(&self, angle: f64) -> Image {
        let octave = self.ends[1..].partition_point(|&end| end <= angle);
        let (x, rate) = if octave < self.octaves.len() {
            let (low, high) = (self.ends[octave], self.ends[octave + 1]);
            let place = 1.0 - 2.0 * (angle - low) / (high - low);
            let inverse = &self.inverses[octave];
            let guess = inverse.iter().rev().fold(0.0, |sum, c| sum * place + c);
            let (value, slope) = horner(&self.octaves[octave], guess);
            let m = 0.5 * ((guess + (angle - value) / slope).clamp(-1.0, 1.0) + 3.0);
            (libm::ldexp(m, -1 - octave as i32), -2.0 * m * slope)
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

/// The most steps that a root takes from its neighbour.
const NEWTON_STEPS: usize = 6;

/// Returns a polynomial and its derivative.
#[inline(always)]
fn horner(powers: &[f64; COEFFICIENTS], t: f64) -> (f64, f64) {
    let (mut value, mut slope) = (powers[COEFFICIENTS - 1], 0.0);
    for c in powers[..COEFFICIENTS - 1].iter().rev() {
        slope = slope * t + value;
        value = value * t + c;
    }
    (value, slope)
}
