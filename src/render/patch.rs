//! Smooth quantities over a rectangle of the picture, as polynomials.
//!
//! What pixels show of one order changes smoothly from pixel to pixel. So it is evaluated at some nodes of a rectangle,
//! and polynomials give the rest. Whether they do is told by the last coefficients: those of an analytic function fall
//! by about the same factor each, so that what is left out is smaller than the last one.

use super::ink::MOST_QUANTITIES;
use crate::isoradial::Chebyshev;

/// Numbers at the nodes of a rectangle, row by row; or the factors of products of powers, by the power of y.
type Square<const N: usize> = [[f64; N]; N];

/// Fits polynomials of degree `N − 1` in each coordinate. N is odd.
#[derive(Debug)]
pub(super) struct PatchFit<const N: usize> {
    /// Places of the nodes, from 1 to −1.
    nodes: [f64; N],
    /// The powers of the polynomial through values at the nodes: for each node, its factor in each power.
    powers: Square<N>,
    /// The factors of the last two coefficients of Chebyshev's polynomials.
    last: [[f64; N]; 2],
}

/// Polynomials of several quantities over a rectangle.
#[derive(Debug)]
pub(super) struct Patch<const N: usize> {
    centre: (f64, f64),
    per_pixel: (f64, f64),
    values: [Square<N>; MOST_QUANTITIES],
    coefficients: [Square<N>; MOST_QUANTITIES],
    steepness: f64,
}

/// A side of a rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Y,
}

/// Why a fit is not good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Misfit {
    /// Some node has no value.
    NoValue,
    /// Along this axis the rectangle has to be cut into so many parts.
    TooLong(Axis, usize),
}

/// A rectangle is cut into no more parts at once.
const MOST_PARTS: usize = 8;

impl<const N: usize> PatchFit<N> {
    pub(super) fn new() -> Self {
        let chebyshev = Chebyshev::new(N - 1);
        let mut fit = Self {
            nodes: [0.0; N],
            powers: [[0.0; N]; N],
            last: [[0.0; N]; 2],
        };
        for (node, place) in chebyshev.nodes().enumerate() {
            let mut unit = [0.0; N];
            unit[node] = 1.0;
            let coefficients = chebyshev.coefficients(&unit);
            fit.nodes[node] = place;
            fit.last[0][node] = coefficients[N - 1];
            fit.last[1][node] = coefficients[N - 2];
            fit.powers[node].copy_from_slice(&Chebyshev::powers(&coefficients));
        }
        fit
    }

    /// Fits `quantities` quantities between two corners of a rectangle. `evaluate` gives them at a place; it returns
    /// `false` where it cannot.
    ///
    /// # Errors
    /// A [`Misfit`] unless each quantity is right to about what is `allowed` at its greatest size.
    pub(super) fn fit(
        &self,
        patch: &mut Patch<N>,
        (from, to): ((f64, f64), (f64, f64)),
        quantities: usize,
        allowed: impl Fn(f64) -> f64,
        mut evaluate: impl FnMut((f64, f64), &mut [f64; MOST_QUANTITIES]) -> bool,
    ) -> Result<(), Misfit> {
        let half = |from: f64, to: f64| (0.5 * (to - from)).max(0.5);
        let (half_x, half_y) = (half(from.0, to.0), half(from.1, to.1));
        patch.centre = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        patch.per_pixel = (1.0 / half_x, 1.0 / half_y);
        // The middle row first: where it is too long no other is needed.
        for i in 0..N {
            let j = (i + N / 2) % N;
            let y = patch.centre.1 + half_y * self.nodes[j];
            let mut at = [0.0; MOST_QUANTITIES];
            for (i, node) in self.nodes.iter().enumerate() {
                if !evaluate((patch.centre.0 + half_x * node, y), &mut at) {
                    return Err(Misfit::NoValue);
                }
                for (values, value) in patch.values[..quantities].iter_mut().zip(at) {
                    values[j][i] = value;
                }
            }
            if i == 0 {
                let rows = patch.values[..quantities].iter().map(|values| values[j]);
                let off = rows.fold(0.0, |off: f64, row| {
                    let size = row
                        .iter()
                        .fold(0.0, |size: f64, value| size.max(value.abs()));
                    worst(off, share(self.left(&row), allowed(size)))
                });
                is_within(off, 0.0, N)?;
            }
        }
        let (mut off_x, mut off_y) = (0.0, 0.0);
        for values in &patch.values[..quantities] {
            let size = values.as_flattened().iter();
            let allowed = allowed(size.fold(0.0, |size: f64, value| size.max(value.abs())));
            let (mut left_x, mut left_y) = (0.0, 0.0);
            for k in 0..N {
                left_x = worst(left_x, self.left(&values[k]));
                left_y = worst(left_y, self.left(&values.map(|row| row[k])));
            }
            off_x = worst(off_x, share(left_x, allowed));
            off_y = worst(off_y, share(left_y, allowed));
        }
        is_within(off_x, off_y, N)?;
        patch.steepness = patch.measured_steepness(&self.nodes, quantities - 1);
        for (values, coefficients) in patch.values[..quantities]
            .iter()
            .zip(&mut patch.coefficients)
        {
            let along_x = values.map(|row| combined(&self.powers, row.iter()));
            *coefficients = [[0.0; N]; N];
            for (factors, along_x) in self.powers.iter().zip(&along_x) {
                for (coefficients, factor) in coefficients.iter_mut().zip(factors) {
                    for (c, x) in coefficients.iter_mut().zip(along_x) {
                        *c += factor * x;
                    }
                }
            }
        }
        Ok(())
    }

    /// What a polynomial through values at the nodes leaves out, about.
    #[inline]
    fn left(&self, values: &[f64; N]) -> f64 {
        let sum = |factors: &[f64; N]| -> f64 {
            let terms = factors
                .iter()
                .zip(values)
                .map(|(factor, value)| factor * value);
            terms.sum::<f64>().abs()
        };
        worst(sum(&self.last[0]), 0.25 * sum(&self.last[1]))
    }
}

/// The sum of rows, each times its factor.
#[inline]
fn combined<'a, const N: usize>(
    rows: &Square<N>,
    factors: impl Iterator<Item = &'a f64>,
) -> [f64; N] {
    let mut sum = [0.0; N];
    for (row, factor) in rows.iter().zip(factors) {
        for (sum, value) in sum.iter_mut().zip(row) {
            *sum += factor * value;
        }
    }
    sum
}

/// The larger of two numbers; NaN is the largest.
#[inline]
fn worst(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// What is left as a multiple of what is allowed. Nothing is nothing.
#[inline]
fn share(left: f64, allowed: f64) -> f64 {
    if left == 0.0 { 0.0 } else { left / allowed }
}

/// Checks how far off a fit is along each axis, as a multiple of what is allowed.
///
/// The last coefficient falls with the length to the power of the degree. That tells how many parts are enough.
fn is_within(off_x: f64, off_y: f64, count: usize) -> Result<(), Misfit> {
    let (axis, off) = if off_x >= off_y {
        (Axis::X, off_x)
    } else {
        (Axis::Y, off_y)
    };
    if off <= 1.0 {
        return Ok(());
    }
    let degree = (count - 1) as u32;
    let is_enough = |parts: &usize| (parts.pow(degree) as f64) >= off;
    let parts = (2..MOST_PARTS).find(is_enough).unwrap_or(MOST_PARTS);
    Err(Misfit::TooLong(axis, parts))
}

impl<const N: usize> Patch<N> {
    pub(super) fn new() -> Self {
        Self {
            centre: (0.0, 0.0),
            per_pixel: (1.0, 1.0),
            values: [[[0.0; N]; N]; MOST_QUANTITIES],
            coefficients: [[[0.0; N]; N]; MOST_QUANTITIES],
            steepness: 0.0,
        }
    }

    /// Returns about how much the last quantity changes from a pixel to the next, at most.
    pub(super) fn steepness(&self) -> f64 {
        self.steepness
    }

    fn measured_steepness(&self, nodes: &[f64; N], quantity: usize) -> f64 {
        let values = &self.values[quantity];
        let (mut across, mut down) = (0.0, 0.0);
        for (i, pair) in nodes.windows(2).enumerate() {
            let apart = 1.0 / (pair[0] - pair[1]);
            for (row, (a, b)) in values.iter().zip(values[i].iter().zip(&values[i + 1])) {
                across = f64::max(across, (row[i] - row[i + 1]).abs() * apart);
                down = f64::max(down, (a - b).abs() * apart);
            }
        }
        f64::max(across * self.per_pixel.0, down * self.per_pixel.1)
    }

    /// Returns a quantity's value in the middle.
    pub(super) fn middle(&self, quantity: usize) -> f64 {
        self.coefficients[quantity][0][0]
    }

    /// Returns a quantity along the row of pixels' centres at `y`.
    #[inline]
    pub(super) fn row(&self, quantity: usize, y: f64) -> RowPolynomial<N> {
        let t = (y - self.centre.1) * self.per_pixel.1;
        let mut powers = [0.0; N];
        for row in self.coefficients[quantity].iter().rev() {
            for (power, c) in powers.iter_mut().zip(row) {
                *power = *power * t + c;
            }
        }
        RowPolynomial {
            powers,
            centre: self.centre.0,
            per_pixel: self.per_pixel.0,
        }
    }
}

/// A polynomial along a row of pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowPolynomial<const N: usize> {
    powers: [f64; N],
    centre: f64,
    per_pixel: f64,
}

/// How many pixels are computed side by side.
const LANES: usize = 16;

impl<const N: usize> RowPolynomial<N> {
    /// Returns the polynomial less a constant: near that constant single precision is then as fine as its change.
    #[inline]
    pub(super) fn less(mut self, constant: f64) -> Self {
        self.powers[0] -= constant;
        self
    }

    /// Computes the quantity at x and at the places that follow, a pixel apart.
    ///
    /// What is computed in single precision is the difference from the value in the patch's middle. So the sum is as
    /// good as a float can be, but for half a unit in its last place.
    #[inline(never)]
    pub(super) fn fill(&self, x: f64, values: &mut [f32]) {
        let middle = self.powers[0] as f32;
        let mut powers = [0.0; N];
        for (single, power) in powers.iter_mut().zip(self.powers) {
            *single = power as f32;
        }
        powers[0] = (self.powers[0] - f64::from(middle)) as f32;
        let mut steps = [0.0; LANES];
        for (i, step) in steps.iter_mut().enumerate() {
            *step = i as f32 * self.per_pixel as f32;
        }
        let lanes = |i: usize| {
            let x = x + (i * LANES) as f64;
            let start = ((x - self.centre) * self.per_pixel) as f32;
            let mut sums = [powers[N - 1]; LANES];
            for c in powers[..N - 1].iter().rev() {
                for (sum, step) in sums.iter_mut().zip(&steps) {
                    *sum = *sum * (start + step) + c;
                }
            }
            for sum in &mut sums {
                *sum += middle;
            }
            sums
        };
        let (whole, rest) = values.as_chunks_mut::<LANES>();
        let count = whole.len();
        for (i, values) in whole.iter_mut().enumerate() {
            *values = lanes(i);
        }
        if !rest.is_empty() {
            rest.copy_from_slice(&lanes(count)[..rest.len()]);
        }
    }
}
