//! Polynomials through Chebyshev's nodes, −1 to 1.
//!
//! Source: Trefethen, *Approximation Theory and Approximation Practice* (2013), chapters 2 to 4.

use core::f64::consts::PI;

/// The nodes `cos(πi/n)` of degree n, ends included.
#[derive(Debug)]
pub(crate) struct Chebyshev {
    /// `cos(πi/n)` for i from 0 to 2n − 1.
    cosines: Vec<f64>,
}

impl Chebyshev {
    /// The nodes of a degree of at least 1.
    pub(crate) fn new(degree: usize) -> Self {
        let cosine = |i: usize| {
            // The middle is 0, and the nodes are alike on both sides of it.
            if 2 * i == degree || 2 * i == 3 * degree {
                0.0
            } else {
                libm::cos(PI * i as f64 / degree as f64)
            }
        };
        Self {
            cosines: (0..2 * degree).map(cosine).collect(),
        }
    }

    fn degree(&self) -> usize {
        self.cosines.len() / 2
    }

    /// The nodes, from 1 down to −1.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = f64> {
        self.cosines[..=self.degree()].iter().copied()
    }

    /// The coefficients of `T_0` to `T_n` of the polynomial through values on the nodes (a discrete cosine transform).
    pub(crate) fn coefficients(&self, values: &[f64]) -> Vec<f64> {
        let n = self.degree();
        let half = |i: usize| if i == 0 || i == n { 0.5 } else { 1.0 };
        (0..=n)
            .map(|k| {
                let sum: f64 = (0..=n)
                    .map(|i| half(i) * values[i] * self.cosines[i * k % (2 * n)])
                    .sum();
                sum * half(k) * 2.0 / n as f64
            })
            .collect()
    }

    /// The coefficients of the powers of a sum of `T_k`, the lowest first.
    pub(crate) fn powers(coefficients: &[f64]) -> Vec<f64> {
        let n = coefficients.len();
        let mut powers = vec![0.0; n];
        let (mut before, mut this) = (vec![0.0; n], vec![0.0; n]);
        before[0] = 1.0;
        if n > 1 {
            this[1] = 1.0;
        }
        for c in coefficients {
            for (power, t) in powers.iter_mut().zip(&before) {
                *power += c * t;
            }
            // T_{k+2} = 2x T_{k+1} − T_k
            let next: Vec<f64> = (0..n)
                .map(|i| if i > 0 { 2.0 * this[i - 1] } else { 0.0 } - before[i])
                .collect();
            before = core::mem::replace(&mut this, next);
        }
        powers
    }

    /// The sum of `c_k T_k` at x (Clenshaw 1955, *Math. Tables Aids Comput.* 9, 118).
    pub(crate) fn sum(coefficients: &[f64], x: f64) -> f64 {
        let (mut first, mut second) = (0.0, 0.0);
        for c in coefficients[1..].iter().rev() {
            (first, second) = (2.0 * x * first - second + c, first);
        }
        x * first - second + coefficients[0]
    }
}
