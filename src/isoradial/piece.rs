//! A quarter turn of both edges' curves, ready for frames.

use super::Edge;
use super::nodes::Nodes;
use super::sight::Shown;
use crate::table::spline::{Scale, Stencil, bounds, cell_bounds, jet, value};

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
        let mut piece = Self {
            order,
            axis: Scale::new(finer.axis()),
            pole: finer.quarter.pole,
            inner: inner.spline(count),
            outer: outer.spline(count),
            lowest: outer.heights().fold(f64::INFINITY, f64::min),
            highest: inner.heights().fold(f64::NEG_INFINITY, f64::max),
        };
        let mut before = finer.x(0);
        for cell in 0..count - 1 {
            let x = (before, finer.x(cell + 1));
            before = x.1;
            let (mut lowest, mut highest) = (
                cell_bounds(&piece.outer, cell).0,
                cell_bounds(&piece.inner, cell).1,
            );
            if piece.pole {
                // Only what goes beyond the nodes needs its narrower bounds.
                (lowest, highest) = (over((lowest, lowest), x).0, over((highest, highest), x).1);
                if lowest < piece.lowest {
                    lowest = piece.bounds(Edge::Outer, x).0;
                }
                if highest > piece.highest {
                    highest = piece.bounds(Edge::Inner, x).1;
                }
            }
            piece.lowest = piece.lowest.min(lowest);
            piece.highest = piece.highest.max(highest);
        }
        piece
    }

    /// Bounds of h over an interval of x.
    pub(super) fn bounds(&self, edge: Edge, x: (f64, f64)) -> (f64, f64) {
        let values = bounds(self.spline(edge), self.axis, x);
        if !self.pole {
            return values;
        }
        // Both ways are right, and the narrower of the two depends on how near the pole is.
        let (low, high) = over(values, x);
        let (h, _) = self.height_and_slope(edge, 0.5 * (x.0 + x.1), 0.5 * (x.1 - x.0));
        let radius = h.radius + 16.0 * f64::EPSILON * h.middle.abs();
        (low.max(h.middle - radius), high.min(h.middle + radius))
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

    /// Value and slope of one edge's spline at x, and the largest size of its second derivative within `reach`.
    #[inline]
    pub(super) fn jet(&self, edge: Edge, x: f64, reach: f64) -> (f64, f64, f64) {
        jet(self.spline(edge), self.axis, x, reach)
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
        (self.inner.len() + self.outer.len()) * size_of::<f64>()
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
