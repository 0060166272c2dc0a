//! Cubic splines on uniform axes: the table's interpolation.
//!
//! A function's values on N nodes become N + 2 B-spline coefficients; between the nodes the value is the sum of four
//! neighbouring coefficients (sixteen in two dimensions) times the weights of [`Scale::stencil`]. The error is
//! `h⁴ max|f⁗| / 384` an axis, nine times less than that of a cubic through four nodes, for the same work.
//! Source: de Boor, *A Practical Guide to Splines* (1978), chapters IV and IX.

use core::ops::{Mul, Sub};

use serde::{Deserialize, Serialize};
use wide::f64x2;

use crate::lanes::{Real, rounded};

/// A uniform axis whose ends lie exactly on its first and its last node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct NodeAxis {
    /// The first node.
    pub(crate) start: f64,
    /// The last node.
    pub(crate) end: f64,
    /// How many nodes; at least [`NodeAxis::FEWEST`].
    pub(crate) nodes: u32,
}

/// Four neighbouring coefficients and their weights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stencil {
    first: usize,
    weights: [f64; 4],
}

/// The stencils of two places on one axis, their weights side by side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StencilPair {
    first: [usize; 2],
    weights: [f64x2; 4],
}

impl NodeAxis {
    /// The fewest nodes of an axis: the end conditions use the outermost six.
    pub(crate) const FEWEST: u32 = 6;

    /// Returns node `i`; the first and the last are exactly the ends.
    pub(crate) fn node(self, i: u32) -> f64 {
        if i + 1 == self.nodes {
            return self.end;
        }
        self.start + (self.end - self.start) * (f64::from(i) / f64::from(self.nodes - 1))
    }

    /// Returns how many coefficients the axis has.
    pub(crate) fn coefficients(self) -> usize {
        self.nodes as usize + 2
    }

    /// Returns the number of cells in a unit of the axis.
    pub(crate) fn scale(self) -> f64 {
        f64::from(self.nodes - 1) / (self.end - self.start)
    }
}

/// An axis ready for lookups.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    start: f64,
    per_unit: f64,
    last_cell: i32,
}

impl Scale {
    pub(crate) fn new(axis: NodeAxis) -> Self {
        Self {
            start: axis.start,
            per_unit: axis.scale(),
            last_cell: axis.nodes.cast_signed() - 2,
        }
    }

    /// Returns where the four coefficients about `x` are, and the uniform cubic B-spline's weights. Beyond the axis'
    /// ends its outermost cubics continue.
    #[inline(always)]
    pub(crate) fn stencil(self, x: f64) -> Stencil {
        let t = (x - self.start) * self.per_unit;
        let cell = self.cell(t);
        let f = t - f64::from(cell);
        Stencil {
            first: cell as usize,
            weights: weights(f),
        }
    }

    /// Returns the stencils of two places, by the same operations side by side.
    #[inline(always)]
    pub(crate) fn stencils(self, x: f64x2) -> StencilPair {
        let t = (x - self.start) * self.per_unit;
        let [t0, t1] = t.to_array();
        let (cell0, cell1) = (self.cell(t0), self.cell(t1));
        let f = t - f64x2::new([f64::from(cell0), f64::from(cell1)]);
        StencilPair {
            first: [cell0 as usize, cell1 as usize],
            weights: weights(f),
        }
    }

    /// Returns the cell of `x`, within the axis, and the share of it that lies before x.
    #[inline(always)]
    pub(super) fn cell_and_share(self, x: f64) -> (usize, f64) {
        let t = (x - self.start) * self.per_unit;
        let cell = self.cell(t);
        (cell as usize, t - f64::from(cell))
    }

    /// Returns the cells of two places.
    pub(crate) fn cells(self, x: (f64, f64)) -> (usize, usize) {
        (self.cell_and_share(x.0).0, self.cell_and_share(x.1).0)
    }

    /// A place in units of cells from the first node on.
    #[inline(always)]
    fn in_cells<T: Real>(self, x: T) -> T {
        (x - self.start) * self.per_unit
    }

    /// The cells of such places, within the axis, and how much of them lies before.
    #[inline(always)]
    fn cells_and_shares<T: Real>(self, t: T) -> (T::Indices, T) {
        let (cells, before) = (t - 0.5).rounded(self.last_cell);
        (cells, t - before)
    }

    /// Returns the cell, within the axis, of a place `t` cells from the first node.
    #[inline(always)]
    fn cell(self, t: f64) -> u32 {
        // Rounding t − ½ gives the cell. A node belongs to either of its cells, whose cubics agree there. For a t that
        // is NaN or beyond the integers the index is arbitrary, but within the axis.
        rounded(t - 0.5, self.last_cell)
    }
}

/// Returns six times the uniform cubic B-spline's weights at the share f of a cell, for one place or for several side
/// by side.
#[inline(always)]
fn weights<T>(f: T) -> [T; 4]
where
    T: Copy + Mul<Output = T>,
    f64: Mul<T, Output = T> + Sub<T, Output = T>,
{
    let g = 1.0 - f;
    let (f2, g2) = (f * f, g * g);
    [
        g2 * g,
        4.0 - f2 * (6.0 - 3.0 * f),
        4.0 - g2 * (6.0 - 3.0 * g),
        f2 * f,
    ]
}

/// Returns the value of a spline of one variable at `stencil`.
#[inline(always)]
pub(crate) fn value(coefficients: &[f64], stencil: &Stencil) -> f64 {
    let c = &coefficients[stencil.first..stencil.first + 4];
    let w = stencil.weights;
    (w[0] * c[0] + w[1] * c[1]) + (w[2] * c[2] + w[3] * c[3])
}

/// Bounds of a spline of one variable between two places, t cells apart: its values there, and `max|s″| t²/8` beyond
/// them (the error of the chord). s″ is piecewise linear between the coefficients' second differences.
pub(crate) fn bounds(coefficients: &[f64], axis: Scale, x: (f64, f64)) -> (f64, f64) {
    let (first, last) = (axis.stencil(x.0), axis.stencil(x.1));
    let ends = (value(coefficients, &first), value(coefficients, &last));
    let within = &coefficients[first.first..last.first + 4];
    let bend = within.windows(3).fold(0.0, |bend: f64, c| {
        bend.max((c[0] - 2.0 * c[1] + c[2]).abs())
    });
    let t = (x.1 - x.0) * axis.per_unit;
    // Each value has some roundings of terms as large as the coefficients, whose weights' sum is 6.
    let size = within.iter().fold(0.0, |size: f64, c| size.max(c.abs()));
    let margin = 6.0 * (bend * t * t / 8.0 + 16.0 * f64::EPSILON * size);
    (ends.0.min(ends.1) - margin, ends.0.max(ends.1) + margin)
}

/// Bounds of a spline of one variable within a cell, as [`bounds`] has them.
#[inline]
pub(crate) fn cell_bounds(coefficients: &[f64], cell: usize) -> (f64, f64) {
    let c = &coefficients[cell..cell + 4];
    let ends = (c[0] + 4.0 * c[1] + c[2], c[1] + 4.0 * c[2] + c[3]);
    let bend = (c[0] - 2.0 * c[1] + c[2])
        .abs()
        .max((c[1] - 2.0 * c[2] + c[3]).abs());
    let size = (c[0].abs().max(c[1].abs())).max(c[2].abs().max(c[3].abs()));
    let margin = 6.0 * (bend / 8.0 + 16.0 * f64::EPSILON * size);
    (ends.0.min(ends.1) - margin, ends.0.max(ends.1) + margin)
}

/// A spline about one place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jet<T = f64> {
    pub(crate) value: T,
    pub(crate) slope: T,
    /// The second derivative.
    pub(crate) bend: T,
    /// The least and the greatest third derivative near by.
    pub(crate) third: [T; 2],
}

/// A spline's value and slope at x.
#[inline(always)]
pub(crate) fn value_and_slope<T: Real>(coefficients: &[f64], axis: Scale, x: T) -> [T; 2] {
    let (cell, share) = axis.cells_and_shares(axis.in_cells(x));
    within_cell(axis, share, x.neighbours(coefficients, cell))
}

/// A spline's value and slope at a share of a cell, between the four coefficients about it.
#[inline(always)]
fn within_cell<T: Real>(axis: Scale, f: T, [c0, c1, c2, c3]: [T; 4]) -> [T; 2] {
    let g = -(f - 1.0);
    let (f2, g2) = (f * f, g * g);
    let (near, far) = (
        -(f2 * -(f * 3.0 - 6.0) - 4.0),
        -(g2 * -(g * 3.0 - 6.0) - 4.0),
    );
    let value = (g2 * g * c0 + near * c1) + (far * c2 + f2 * f * c3);
    let slope = (f2 * c3 - g2 * c0) + (g * -(g * 3.0 - 4.0) * c2 - f * -(f * 3.0 - 4.0) * c1);
    [value, slope * (3.0 * axis.per_unit)]
}

/// The cells of an axis about a place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cells<T: Real> {
    /// Its own.
    cell: T::Indices,
    /// How much of it lies before the place.
    share: T,
    /// The first and the last one near by.
    first: T::Indices,
    last: T::Indices,
}

impl Scale {
    /// The cells about x, as far as `reach`.
    #[inline(always)]
    pub(crate) fn about<T: Real>(self, x: T, reach: T) -> Cells<T> {
        let (t, reach) = (self.in_cells(x), reach * self.per_unit);
        let (cell, share) = self.cells_and_shares(t);
        let (first, _) = self.cells_and_shares(t - reach);
        let (last, _) = self.cells_and_shares(t + reach);
        Cells {
            cell,
            share,
            first,
            last,
        }
    }
}

/// A spline about a place. Its third derivative is constant in each cell, of those that `thirds` is the list of.
#[inline(always)]
pub(crate) fn jet<T: Real>(
    coefficients: &[f64],
    thirds: &[f64],
    axis: Scale,
    about: &Cells<T>,
) -> Jet<T> {
    let share = about.share;
    let c = share.neighbours(coefficients, about.cell);
    let [value, slope] = within_cell(axis, share, c);
    let [c0, c1, c2, c3] = c;
    let (first, second) = (c0 - c1 * 2.0 + c2, c1 - c2 * 2.0 + c3);
    let bend = (-(share - 1.0) * first + share * second) * (6.0 * axis.per_unit * axis.per_unit);
    Jet {
        value,
        slope,
        bend,
        third: share.range_of(thirds, about.first, about.last),
    }
}

/// A spline's third derivatives, cell by cell: from the coefficients' third differences.
pub(crate) fn thirds(coefficients: &[f64], axis: Scale) -> Vec<f64> {
    let scale = 6.0 * axis.per_unit * axis.per_unit * axis.per_unit;
    let third = |c: &[f64]| scale * ((c[3] - c[0]) - 3.0 * (c[2] - c[1]));
    coefficients.windows(4).map(third).collect()
}

/// Returns the values of a spline of two variables at two places. The coefficients are stored row by row, `width` in
/// each; `rows` is the place along the slow axis, `columns` are the two places along the fast one.
#[inline(always)]
pub(crate) fn values_2d(
    coefficients: &[f64],
    width: usize,
    rows: &Stencil,
    columns: &StencilPair,
) -> f64x2 {
    let [r0, r1, r2, r3] = rows.weights;
    let weights = [
        f64x2::splat(r0),
        f64x2::splat(r1),
        f64x2::splat(r2),
        f64x2::splat(r3),
    ];
    let row = rows.first * width;
    let [low0, high0] = across_rows(coefficients, row + columns.first[0], width, weights);
    let [low1, high1] = across_rows(coefficients, row + columns.first[1], width, weights);
    let w = columns.weights;
    (w[0] * f64x2::new([low0[0], low1[0]]) + w[1] * f64x2::new([low0[1], low1[1]]))
        + (w[2] * f64x2::new([high0[0], high1[0]]) + w[3] * f64x2::new([high0[1], high1[1]]))
}

/// Returns the weighted sums over four rows of the four columns from `first` on, as two pairs.
#[inline(always)]
fn across_rows(
    coefficients: &[f64],
    first: usize,
    width: usize,
    weights: [f64x2; 4],
) -> [[f64; 2]; 2] {
    let a = &coefficients[first..first + 4];
    let b = &coefficients[first + width..first + width + 4];
    let c = &coefficients[first + 2 * width..first + 2 * width + 4];
    let d = &coefficients[first + 3 * width..first + 3 * width + 4];
    let [wa, wb, wc, wd] = weights;
    let low = (wa * f64x2::new([a[0], a[1]]) + wb * f64x2::new([b[0], b[1]]))
        + (wc * f64x2::new([c[0], c[1]]) + wd * f64x2::new([d[0], d[1]]));
    let high = (wa * f64x2::new([a[2], a[3]]) + wb * f64x2::new([b[2], b[3]]))
        + (wc * f64x2::new([c[2], c[3]]) + wd * f64x2::new([d[2], d[3]]));
    [low.to_array(), high.to_array()]
}

/// A spline's value, slope and second derivative in the middle of a cell, for cells as wide as one.
#[inline]
pub(crate) fn in_the_middle(coefficients: &[f64], cell: usize) -> (f64, f64, f64) {
    let c = &coefficients[cell..cell + 4];
    let (outer, inner) = (c[0] + c[3], c[1] + c[2]);
    (
        0.125 * outer + 2.875 * inner,
        0.75 * (c[3] - c[0]) + 3.75 * (c[2] - c[1]),
        3.0 * (outer - inner),
    )
}

/// A spline's value in the middle of a half of a cell; the halves are counted through.
#[inline]
pub(crate) fn in_a_quarter(coefficients: &[f64], half: usize) -> f64 {
    let c = &coefficients[half / 2..half / 2 + 4];
    let [near, first, second, far] = weights(0.25);
    if half.is_multiple_of(2) {
        (near * c[0] + first * c[1]) + (second * c[2] + far * c[3])
    } else {
        (far * c[0] + second * c[1]) + (first * c[2] + near * c[3])
    }
}

/// Computes the coefficients of the spline through `values`, one value for each node: `values.len() + 2` coefficients,
/// each over 6. (The weights of [`Scale::stencil`] are six times the B-spline's, which saves each lookup the division.)
///
/// At the nodes `f_i = c_i + δ²c_i/6`: a tridiagonal system, diagonally dominant, solved by elimination. At the ends
/// the inverse series `c = f − δ²f/6 + δ⁴f/36 − …` gives the coefficient of the second node, with δ⁴f continued
/// linearly from the next two nodes: its error is of order h⁶, as that of the inner coefficients. (The usual "not a
/// knot" condition drops the third term; its error at the ends was measured to be 4 to 11 times as large.)
pub(crate) fn coefficients(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let at_second = |f: [f64; 6]| {
        let second = |i: usize| f[i - 1] - 2.0 * f[i] + f[i + 1];
        let fourth = |i: usize| second(i - 1) - 2.0 * second(i) + second(i + 1);
        f[1] - second(1) / 6.0 + (2.0 * fourth(2) - fourth(3)) / 36.0
    };
    // c[i + 1] is the coefficient centred on node i.
    let mut c = vec![0.0; n + 2];
    c[2] = at_second(core::array::from_fn(|i| values[i]));
    c[n - 1] = at_second(core::array::from_fn(|i| values[n - 1 - i]));
    let pivot = |i: usize| PIVOTS[(i - 2).min(PIVOTS.len() - 1)];
    for i in 2..n - 2 {
        // Row i: c_{i−1} + 4c_i + c_{i+1} = 6f_i. This eliminates the term below the diagonal.
        let right = if i == n - 3 { c[n - 1] } else { 0.0 };
        c[i + 1] = (6.0 * values[i] - c[i] - right) * pivot(i);
    }
    for i in (2..n - 3).rev() {
        c[i + 1] -= pivot(i) * c[i + 2];
    }
    c[1] = 6.0 * values[1] - 4.0 * c[2] - c[3];
    c[0] = 6.0 * values[0] - 4.0 * c[1] - c[2];
    c[n] = 6.0 * values[n - 2] - 4.0 * c[n - 1] - c[n - 2];
    c[n + 1] = 6.0 * values[n - 1] - 4.0 * c[n] - c[n - 1];
    for c in &mut c {
        *c /= 6.0;
    }
    c
}

/// The elimination's pivots, each `1/(4 − the one before)`. Each is 14 times closer to `2 − √3` than the one before;
/// the last one is equal to it.
const PIVOTS: [f64; 16] = {
    let mut pivots = [0.25; 16];
    let mut i = 1;
    while i < pivots.len() {
        pivots[i] = 1.0 / (4.0 - pivots[i - 1]);
        i += 1;
    }
    pivots
};

/// The same spline on cells half as wide: every other node new, and its value the same everywhere.
///
/// The uniform cubic B-spline's two-scale relation, its five coefficients 1, 4, 6, 4, 1 over 8 (Lane & Riesenfeld
/// 1980, *IEEE Trans. Pattern Anal. Mach. Intell.* 2, 35).
pub(crate) fn on_half_cells(coefficients: &[f64]) -> Vec<f64> {
    let cells = coefficients.len() - 3;
    // The first coefficient of both is centred one node before the first; i counts those of the wide cells.
    (0..2 * cells + 3)
        .map(|j| {
            let i = j / 2;
            if j % 2 == 0 {
                0.5 * (coefficients[i] + coefficients[i + 1])
            } else {
                (coefficients[i] + 6.0 * coefficients[i + 1] + coefficients[i + 2]) / 8.0
            }
        })
        .collect()
}

/// Computes the coefficients of the two-dimensional spline through `values` (rows of `columns` nodes), first along each
/// row, then along each column.
pub(crate) fn coefficients_2d(values: &[f64], columns: usize) -> Vec<f64> {
    let along_rows: Vec<Vec<f64>> = values.chunks_exact(columns).map(coefficients).collect();
    let width = columns + 2;
    let mut result = vec![0.0; (along_rows.len() + 2) * width];
    for j in 0..width {
        let column: Vec<f64> = along_rows.iter().map(|row| row[j]).collect();
        for (i, c) in coefficients(&column).into_iter().enumerate() {
            result[i * width + j] = c;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is its own spline, up to the ends and beyond them.
    #[test]
    fn cubics_are_reproduced() {
        let cubic = |x: f64| 0.3 - 1.2 * x + 0.7 * x * x - 2.1 * x * x * x;
        for nodes in [6, 7, 8, 20] {
            let axis = NodeAxis {
                start: -1.0,
                end: 2.0,
                nodes,
            };
            let values: Vec<f64> = (0..nodes).map(|i| cubic(axis.node(i))).collect();
            let c = coefficients(&values);
            for k in -1..32 {
                let x = -1.0 + f64::from(k) * 0.1;
                let got = value(&c, &Scale::new(axis).stencil(x));
                assert!(
                    (got - cubic(x)).abs() < 1e-12,
                    "{nodes} nodes at {x}: {got}"
                );
            }
        }
    }

    #[test]
    fn jets_are_the_splines_derivatives() {
        let axis = Scale::new(NodeAxis {
            start: -1.0,
            end: 2.0,
            nodes: 9,
        });
        let values: Vec<f64> = (0..9).map(|i| libm::sin(f64::from(i * i))).collect();
        let c = coefficients(&values);
        let at = |x: f64| value(&c, &axis.stencil(x));
        for k in 2..58 {
            let x = -1.0 + f64::from(k) * 0.05 + 0.01;
            let jet = jet(&c, &thirds(&c, axis), axis, &axis.about(x, 0.071));
            assert_eq!(jet.value, at(x));
            let (before, after) = (at(x - 1e-4), at(x + 1e-4));
            assert!(
                (jet.slope - (after - before) / 2e-4).abs() < 1e-5,
                "{jet:?} at {x}"
            );
            for j in -7..=7 {
                let y = x + f64::from(j) * 0.0099;
                let second = (at(y - 1e-3) - 2.0 * at(y) + at(y + 1e-3)) / 1e-6;
                // A difference quotient of values that are right to ε.
                let (low, high) = ((y - x) * jet.third[0], (y - x) * jet.third[1]);
                assert!(
                    second - jet.bend >= low.min(high) - 1e-6
                        && second - jet.bend <= low.max(high) + 1e-6,
                    "{second} at {y}: {jet:?}"
                );
            }
        }
    }

    #[test]
    fn half_cells_change_no_value() {
        let axis = |nodes| NodeAxis {
            start: -1.0,
            end: 2.0,
            nodes,
        };
        let values: Vec<f64> = (0..9).map(|i| libm::sin(f64::from(i * i))).collect();
        let wide = coefficients(&values);
        let narrow = on_half_cells(&wide);
        assert_eq!(narrow.len(), 17 + 2);
        for k in -2..=32 {
            let x = -1.0 + f64::from(k) * 0.1;
            let (a, b) = (
                value(&wide, &Scale::new(axis(9)).stencil(x)),
                value(&narrow, &Scale::new(axis(17)).stencil(x)),
            );
            assert!(
                (a - b).abs() < 1e-14 || !(-1.0..=2.0).contains(&x),
                "{a} and {b} at {x}"
            );
        }
    }

    /// The error falls with the fourth power of the node distance.
    #[test]
    fn fourth_order() {
        let f = |x: f64, y: f64| libm::exp(x) * libm::sin(3.0 * y);
        let error = |nodes: u32| {
            let axis = NodeAxis {
                start: 0.0,
                end: 1.0,
                nodes,
            };
            let values: Vec<f64> = (0..nodes * nodes)
                .map(|k| f(axis.node(k % nodes), axis.node(k / nodes)))
                .collect();
            let c = coefficients_2d(&values, nodes as usize);
            let mut worst: f64 = 0.0;
            for k in 0..400 {
                let (x, y) = (f64::from(k % 20) / 19.3, f64::from(k / 20) / 19.7);
                let scale = Scale::new(axis);
                let places = f64x2::new([x, 0.3]);
                let got = values_2d(
                    &c,
                    axis.coefficients(),
                    &scale.stencil(y),
                    &scale.stencils(places),
                );
                let [got, other] = got.to_array();
                worst = worst.max((other - f(0.3, y)).abs());
                worst = worst.max((got - f(x, y)).abs());
            }
            worst
        };
        let ratio = error(20) / error(39);
        assert!(
            (12.0..24.0).contains(&ratio),
            "halving the distance changed the error by {ratio}, not 16"
        );
    }
}
