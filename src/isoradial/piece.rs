//! A quarter turn of both edges' curves, ready for frames.

use super::Edge;
use super::nodes::Nodes;
use super::runs::Runs;
use super::sight::Shown;
use crate::lanes::Real;
use crate::table::spline::{
    Cells, Jet, Scale, Stencil, bounds, cell_bounds, jet, thirds, value, value_and_slope,
};

/// A quarter turn of both curves, as splines in x of `h` (or `x h` where h has a pole).
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// The image's order.
    pub(super) order: u32,
    axis: Scale,
    /// Whether h has a pole at x = 0, and `x h` is kept.
    pole: bool,
    inner: Vec<f64>,
    outer: Vec<f64>,
    inner_thirds: Vec<f64>,
    outer_thirds: Vec<f64>,
    inner_runs: Runs,
    outer_runs: Runs,
    /// No ray of this piece meets the disk with `h` below this
    pub(super) lowest: f64,
    /// or above this.
    pub(super) highest: f64,
}

impl Piece {
    /// The piece between two curves drawn over the same x, on as many nodes as the finer one has.
    pub(super) fn new(order: u32, inner: &Nodes, outer: &Nodes) -> Self {
        let count = inner.count().max(outer.count());
        let finer = if inner.count() == count { inner } else { outer };
        let axis = Scale::new(finer.axis());
        let (inner_spline, outer_spline) = (inner.spline(count), outer.spline(count));
        let mut piece = Self {
            order,
            axis,
            pole: finer.quarter.pole,
            inner_thirds: thirds(&inner_spline, axis),
            outer_thirds: thirds(&outer_spline, axis),
            inner: inner_spline,
            outer: outer_spline,
            inner_runs: Runs::new(core::iter::empty()),
            outer_runs: Runs::new(core::iter::empty()),
            lowest: f64::INFINITY,
            highest: f64::NEG_INFINITY,
        };
        let runs = |edge| {
            Runs::new((0..count - 1).map(|cell| {
                if piece.pole {
                    piece.bounds_from_values(edge, (finer.x(cell), finer.x(cell + 1)))
                } else {
                    cell_bounds(piece.spline(edge), cell)
                }
            }))
        };
        let (inner, outer) = (runs(Edge::Inner), runs(Edge::Outer));
        piece.lowest = outer.over(0, count - 2).0;
        piece.highest = inner.over(0, count - 2).1;
        (piece.inner_runs, piece.outer_runs) = (inner, outer);
        piece
    }

    /// Bounds of h over an interval of x.
    pub(super) fn bounds(&self, edge: Edge, x: (f64, f64)) -> (f64, f64) {
        /// Of fewer cells than these the values at both ends tell more than the cells' bounds.
        const FEW: usize = 4;
        let (first, last) = self.axis.cells(x);
        if last - first < FEW {
            return self.bounds_from_values(edge, x);
        }
        let runs = match edge {
            Edge::Inner => &self.inner_runs,
            Edge::Outer => &self.outer_runs,
        };
        runs.over(first, last)
    }

    fn bounds_from_values(&self, edge: Edge, x: (f64, f64)) -> (f64, f64) {
        let values = bounds(self.spline(edge), self.axis, x);
        if !self.pole {
            return values;
        }
        // Both ways are right, and the narrower of the two depends on how near the pole is.
        let (low, high) = over(values, x);
        let (middle, radius) = self.within(edge, 0.5 * (x.0 + x.1), 0.5 * (x.1 - x.0));
        (low.max(middle - radius), high.min(middle + radius))
    }

    /// h = f/x within `reach` of x, by the mean value theorem: the quotient of two bounds forgets what f and x have in
    /// common.
    fn within(&self, edge: Edge, x: f64, reach: f64) -> (f64, f64) {
        let jet = self.jet(edge, &self.about(x, reach));
        let (h, least) = (jet.value / x, x - reach);
        if least <= 0.0 {
            return (h, f64::INFINITY);
        }
        // h′ = (f′ − h)/x = (x f′ − f)/x², and x f′ − f changes by x f″.
        let far = x + reach;
        let change = (x * jet.slope - jet.value).abs()
            + far * (jet.bend.abs() + jet.third[0].abs().max(jet.third[1].abs()) * reach) * reach;
        (
            h,
            change / (least * least) * reach + 16.0 * f64::EPSILON * h.abs(),
        )
    }

    /// Whether a ray with `z − κ_c s = excess` meets the disk at x.
    #[inline]
    pub(super) fn meets(&self, excess: f64, s: f64, x: f64) -> bool {
        let scaled = if self.pole { excess * x } else { excess };
        let stencil = self.axis.stencil(x);
        scaled >= s * value(&self.outer, &stencil) && scaled <= s * value(&self.inner, &stencil)
    }

    /// h of one edge at x.
    pub(super) fn height(&self, edge: Edge, x: f64) -> f64 {
        let stencil: Stencil = self.axis.stencil(x);
        let kept = value(self.spline(edge), &stencil);
        if self.pole { kept / x } else { kept }
    }

    /// The splines' cells about x, as far as `reach`.
    #[inline(always)]
    pub(super) fn about<T: Real>(&self, x: T, reach: T) -> Cells<T> {
        self.axis.about(x, reach)
    }

    /// One edge's spline about there.
    #[inline(always)]
    pub(super) fn jet<T: Real>(&self, edge: Edge, about: &Cells<T>) -> Jet<T> {
        let thirds = match edge {
            Edge::Inner => &self.inner_thirds,
            Edge::Outer => &self.outer_thirds,
        };
        jet(self.spline(edge), thirds, self.axis, about)
    }

    /// Value and slope of one edge's spline at x.
    #[inline(always)]
    pub(super) fn value_and_slope<T: Real>(&self, edge: Edge, x: T) -> [T; 2] {
        value_and_slope(self.spline(edge), self.axis, x)
    }

    /// Whether the spline is of `x h` in place of h, which has a pole at 0.
    pub(super) fn has_pole(&self) -> bool {
        self.pole
    }

    fn spline(&self, edge: Edge) -> &[f64] {
        match edge {
            Edge::Inner => &self.inner,
            Edge::Outer => &self.outer,
        }
    }

    /// How many nodes both curves have together.
    pub(super) fn nodes(&self) -> usize {
        // A spline has two coefficients more than nodes.
        self.inner.len() + self.outer.len() - 4
    }

    /// How many bytes a frame reads of it.
    pub(super) fn bytes(&self) -> usize {
        (2 * (self.inner.len() + self.outer.len()) - 6) * size_of::<f64>()
    }
}

/// The greatest distance between two curves drawn over the same x, in pixels.
pub(super) fn thickness(inner: &Nodes, outer: &Nodes, shown: &Shown) -> f64 {
    let count = inner.count().min(outer.count());
    // Nodes are doubled: those of the coarser curve are nodes of the finer one too.
    let (step_inner, step_outer) = (
        (inner.count() - 1) / (count - 1),
        (outer.count() - 1) / (count - 1),
    );
    (0..count).fold(0.0, |thickness: f64, i| {
        let (high, low) = (inner.height(i * step_inner), outer.height(i * step_outer));
        shown.apart(thickness, (low.min(high), low.max(high)))
    })
}

/// The quotients of an interval by one of numbers ≥ 0.
fn over(values: (f64, f64), x: (f64, f64)) -> (f64, f64) {
    let low = if values.0 >= 0.0 {
        values.0 / x.1
    } else {
        values.0 / x.0
    };
    let high = if values.1 >= 0.0 {
        values.1 / x.0
    } else {
        values.1 / x.1
    };
    // 0/0, where nothing is known.
    (
        if low.is_nan() { f64::NEG_INFINITY } else { low },
        if high.is_nan() { f64::INFINITY } else { high },
    )
}
