//! A quarter turn of both edges' curves, ready for frames.

use super::Edge;
use super::nodes::Nodes;
use super::sight::Shown;
use crate::table::spline::{Scale, Stencil, cell_bounds, greatest_bend, value, value_and_slope};

/// A quarter turn of both curves, as splines in x of `h` (or `x h` where h has a pole).
#[derive(Debug, Clone)]
pub(crate) struct Piece {
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
            lowest: f64::INFINITY,
            highest: f64::NEG_INFINITY,
        };
        for cell in 0..count - 1 {
            let x = (finer.x(cell), finer.x(cell + 1));
            piece.lowest = piece.lowest.min(piece.bounds(Edge::Outer, cell, x).0);
            piece.highest = piece.highest.max(piece.bounds(Edge::Inner, cell, x).1);
        }
        piece
    }

    /// Bounds of h over a cell, whose ends are at x.
    fn bounds(&self, edge: Edge, cell: usize, x: (f64, f64)) -> (f64, f64) {
        let (low, high) = cell_bounds(self.spline(edge), cell);
        if !self.pole {
            return (low, high);
        }
        let quotients = [low / x.0, low / x.1, high / x.0, high / x.1];
        if quotients.iter().any(|quotient| quotient.is_nan()) {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let least = quotients.into_iter().fold(f64::INFINITY, f64::min);
        let greatest = quotients.into_iter().fold(f64::NEG_INFINITY, f64::max);
        (least, greatest)
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

    /// Value and slope of one edge's spline at x.
    #[inline]
    pub(crate) fn value_and_slope(&self, edge: Edge, x: f64) -> [f64; 2] {
        value_and_slope(self.spline(edge), self.axis, x)
    }

    /// The greatest size of the second derivative of one edge's spline between two x.
    pub(crate) fn bend(&self, edge: Edge, x: (f64, f64)) -> f64 {
        greatest_bend(self.spline(edge), self.axis, x)
    }

    /// Whether the spline is of `x h` in place of h, which has a pole at 0.
    pub(crate) fn has_pole(&self) -> bool {
        self.pole
    }

    /// The least and the greatest x.
    pub(super) fn range(&self) -> (f64, f64) {
        self.axis.range()
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
