//! Smooth quantities over a rectangle of the picture, as polynomials.
//!
//! What pixels show of one order changes smoothly from pixel to pixel. So it is evaluated at some nodes of a rectangle,
//! and polynomials give the rest. Whether they do is told by the last coefficients: those of an analytic function fall
//! by about the same factor each, so that what is left out is smaller than the last one.

use super::ink::MOST_QUANTITIES;
use crate::isoradial::Chebyshev;

/// Fits polynomials of one degree in each coordinate.
#[derive(Debug)]
pub(super) struct PatchFit {
    count: usize,
    /// Places of the nodes, from 1 to −1.
    nodes: Vec<f64>,
    /// Row by row: the powers of the polynomial through values at the nodes.
    powers: Vec<f64>,
    /// The last two coefficients of Chebyshev's polynomials.
    last: [Vec<f64>; 2],
}

/// Polynomials of several quantities over a rectangle.
#[derive(Debug, Default)]
pub(super) struct Patch {
    centre: (f64, f64),
    per_pixel: (f64, f64),
    count: usize,
    /// For each quantity, for each power of y, the lowest first, the powers of x.
    coefficients: Vec<f64>,
    values: Vec<f64>,
    along_x: Vec<f64>,
    /// How far each node is from the one before, of the half width.
    nodes_apart: Vec<f64>,
    steepness: f64,
}

/// The most powers of a patch in x.
pub(super) const MOST_POWERS: usize = 10;

impl PatchFit {
    pub(super) fn new(degree: usize) -> Self {
        let count = degree + 1;
        let chebyshev = Chebyshev::new(degree);
        let mut powers = vec![0.0; count * count];
        let mut last = [vec![0.0; count], vec![0.0; count]];
        for node in 0..count {
            let mut unit = vec![0.0; count];
            unit[node] = 1.0;
            let coefficients = chebyshev.coefficients(&unit);
            last[0][node] = coefficients[degree];
            last[1][node] = coefficients[degree - 1];
            for (power, value) in Chebyshev::powers(&coefficients).into_iter().enumerate() {
                powers[power * count + node] = value;
            }
        }
        Self {
            count,
            nodes: chebyshev.nodes().collect(),
            powers,
            last,
        }
    }

    /// How many nodes a patch has.
    pub(super) fn nodes(&self) -> usize {
        self.count * self.count
    }

    /// Fits `quantities` quantities between two corners of a rectangle. `evaluate` gives them at a place; it returns
    /// `false` where it cannot. Each is right to about `tolerance` times its greatest size. Returns whether it is so.
    pub(super) fn fit(
        &self,
        patch: &mut Patch,
        (from, to): ((f64, f64), (f64, f64)),
        quantities: usize,
        tolerance: f64,
        mut evaluate: impl FnMut((f64, f64), &mut [f64]) -> bool,
    ) -> bool {
        let count = self.count;
        let half = |from: f64, to: f64| (0.5 * (to - from)).max(0.5);
        let (half_x, half_y) = (half(from.0, to.0), half(from.1, to.1));
        patch.centre = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        patch.per_pixel = (1.0 / half_x, 1.0 / half_y);
        patch.count = count;
        patch.values.clear();
        patch.values.resize(quantities * count * count, 0.0);
        let mut at = [0.0; MOST_QUANTITIES];
        for (j, y) in self.nodes.iter().enumerate() {
            for (i, x) in self.nodes.iter().enumerate() {
                let place = (patch.centre.0 + half_x * x, patch.centre.1 + half_y * y);
                if !evaluate(place, &mut at[..quantities]) {
                    return false;
                }
                for (q, value) in at[..quantities].iter().enumerate() {
                    patch.values[(q * count + j) * count + i] = *value;
                }
            }
        }
        patch.nodes_apart.clear();
        let apart = self.nodes.windows(2).map(|nodes| nodes[0] - nodes[1]);
        patch
            .nodes_apart
            .extend(core::iter::once(f64::INFINITY).chain(apart));
        patch.steepness = patch.measured_steepness();
        patch.coefficients.clear();
        patch.along_x.resize(count * count, 0.0);
        for values in patch.values.chunks_exact(count * count) {
            let size = values
                .iter()
                .fold(0.0, |size: f64, value| size.max(value.abs()));
            let allowed = tolerance * size;
            for k in 0..count {
                let mut left = 0.0;
                for (last, share) in self.last.iter().zip([1.0, 0.25]) {
                    let (mut along_x, mut along_y) = (0.0, 0.0);
                    for (i, factor) in last.iter().enumerate() {
                        along_x += factor * values[k * count + i];
                        along_y += factor * values[i * count + k];
                    }
                    left = f64::max(left, share * along_x.abs().max(along_y.abs()));
                }
                if left > allowed || left.is_nan() {
                    return false;
                }
            }
            for j in 0..count {
                for power in 0..count {
                    let row = &self.powers[power * count..][..count];
                    let values = &values[j * count..][..count];
                    patch.along_x[j * count + power] = row
                        .iter()
                        .zip(values)
                        .map(|(factor, value)| factor * value)
                        .sum();
                }
            }
            for power_y in 0..count {
                let factors = &self.powers[power_y * count..][..count];
                for power_x in 0..count {
                    let sum = (0..count).map(|j| factors[j] * patch.along_x[j * count + power_x]);
                    patch.coefficients.push(sum.sum());
                }
            }
        }
        true
    }
}

/// A polynomial along a row of pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowPolynomial {
    powers: [f64; MOST_POWERS],
    count: usize,
    centre: f64,
    per_pixel: f64,
}

impl Patch {
    /// Returns about how much the last quantity changes from a pixel to the next, at most.
    pub(super) fn steepness(&self) -> f64 {
        self.steepness
    }

    fn measured_steepness(&self) -> f64 {
        let count = self.count;
        let values = &self.values[self.values.len() - count * count..];
        let most = |pairs: &mut dyn Iterator<Item = (usize, usize, usize)>, per_pixel: f64| {
            pairs.fold(0.0, |most: f64, (a, b, i)| {
                let apart = self.nodes_apart[i] / per_pixel;
                most.max((values[a] - values[b]).abs() / apart)
            })
        };
        let rows = (0..count).flat_map(|j| (1..count).map(move |i| (j, i)));
        let across = most(
            &mut rows
                .clone()
                .map(|(j, i)| (j * count + i, j * count + i - 1, i)),
            self.per_pixel.0,
        );
        let down = most(
            &mut rows.map(|(j, i)| (i * count + j, (i - 1) * count + j, i)),
            self.per_pixel.1,
        );
        across.max(down)
    }

    /// Returns a quantity along the row of pixels' centres at `y`.
    #[inline]
    pub(super) fn row(&self, quantity: usize, y: f64) -> RowPolynomial {
        let (count, t) = (self.count, (y - self.centre.1) * self.per_pixel.1);
        let mut powers = [0.0; MOST_POWERS];
        let rows = &self.coefficients[quantity * count * count..][..count * count];
        for row in rows.chunks_exact(count).rev() {
            for (power, c) in powers.iter_mut().zip(row) {
                *power = *power * t + c;
            }
        }
        RowPolynomial {
            powers,
            count,
            centre: self.centre.0,
            per_pixel: self.per_pixel.0,
        }
    }
}

/// How many pixels are computed side by side.
const LANES: usize = 16;

impl RowPolynomial {
    /// The quantity at x.
    #[inline]
    pub(super) fn at(&self, x: f64) -> f64 {
        let t = (x - self.centre) * self.per_pixel;
        let powers = self.powers[..self.count].iter().rev();
        powers.fold(0.0, |sum, c| sum * t + c)
    }

    /// Calls `each` with the quantity at the centres of some pixels of a row at a time, with the first one's column.
    ///
    /// What is computed in single precision is the difference from the value in the patch's middle. So the sum is as
    /// good as a float can be, but for half a unit in its last place.
    #[inline(always)]
    pub(super) fn for_lanes(&self, from: usize, to: usize, mut each: impl FnMut(usize, &[f32])) {
        let middle = self.powers[0] as f32;
        let mut powers = self.powers.map(|power| power as f32);
        powers[0] = (self.powers[0] - f64::from(middle)) as f32;
        let powers = &powers[..self.count];
        let step = self.per_pixel as f32;
        let mut column = from;
        while column < to {
            let start = ((column as f64 + 0.5 - self.centre) * self.per_pixel) as f32;
            let mut sums = [0.0_f32; LANES];
            let t: [f32; LANES] = core::array::from_fn(|i| start + i as f32 * step);
            for c in powers.iter().rev() {
                for (sum, t) in sums.iter_mut().zip(&t) {
                    *sum = *sum * t + c;
                }
            }
            let values = sums.map(|sum| middle + sum);
            let count = LANES.min(to - column);
            each(column, &values[..count]);
            column += count;
        }
    }
}
