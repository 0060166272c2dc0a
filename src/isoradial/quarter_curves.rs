//! The curves of both edges over one quarter turn, ready for frames.

use super::edge::Edge;
use super::nodes::CurveNodes;
use crate::table::spline::{Scale, cell_bounds, greatest_bend, value, value_and_slope};

/// The curves of both edges over one quarter turn: splines in x of h, or of `x h` where h has a pole.
#[derive(Debug, Clone)]
pub(crate) struct QuarterCurves {
    /// The image's order.
    pub(super) order: u32,
    axis: Scale,
    /// Whether h has a pole at x = 0, so that the splines are of `x h`.
    pole: bool,
    inner: Vec<f64>,
    outer: Vec<f64>,
    /// A lower and an upper bound of h between the two curves.
    pub(super) h_range: (f64, f64),
}

impl QuarterCurves {
    /// Puts two curves over the same x on as many nodes as the finer one has.
    pub(super) fn new(order: u32, inner: &CurveNodes, outer: &CurveNodes) -> Self {
        let count = inner.count().max(outer.count());
        let finer = if inner.count() == count { inner } else { outer };
        let mut curves = Self {
            order,
            axis: Scale::new(finer.axis()),
            pole: finer.quarter.pole,
            inner: inner.spline(count),
            outer: outer.spline(count),
            h_range: (f64::INFINITY, f64::NEG_INFINITY),
        };
        for cell in 0..count - 1 {
            let x = (finer.x(cell), finer.x(cell + 1));
            let (low, _) = curves.bounds(Edge::Outer, cell, x);
            let (_, high) = curves.bounds(Edge::Inner, cell, x);
            curves.h_range = (curves.h_range.0.min(low), curves.h_range.1.max(high));
        }
        curves
    }

    /// Bounds h over a cell between two x.
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

    /// Returns whether a ray with `z − κ_c s = excess` meets the disk at x.
    #[inline]
    pub(super) fn meets(&self, excess: f64, s: f64, x: f64) -> bool {
        // At x = 0 the ray leaves the plane where the camera is, and meets it again as the next order.
        if self.pole && x == 0.0 {
            return false;
        }
        let scaled = if self.pole { excess * x } else { excess };
        let stencil = self.axis.stencil(x);
        scaled >= s * value(&self.outer, &stencil) && scaled <= s * value(&self.inner, &stencil)
    }

    /// Returns h of one edge at x.
    pub(super) fn height(&self, edge: Edge, x: f64) -> f64 {
        let stored = value(self.spline(edge), &self.axis.stencil(x));
        if self.pole { stored / x } else { stored }
    }

    /// Returns the value and the slope of one edge's spline at x.
    #[inline]
    pub(crate) fn value_and_slope(&self, edge: Edge, x: f64) -> [f64; 2] {
        value_and_slope(self.spline(edge), self.axis, x)
    }

    /// Returns the greatest size of the second derivative of one edge's spline between two x.
    pub(crate) fn bend(&self, edge: Edge, x: (f64, f64)) -> f64 {
        greatest_bend(self.spline(edge), self.axis, x)
    }

    /// Returns whether the splines are of `x h`, because h has a pole at x = 0.
    pub(crate) fn has_pole(&self) -> bool {
        self.pole
    }

    /// Returns the least and the greatest x.
    pub(super) fn range(&self) -> (f64, f64) {
        self.axis.range()
    }

    fn spline(&self, edge: Edge) -> &[f64] {
        match edge {
            Edge::Inner => &self.inner,
            Edge::Outer => &self.outer,
        }
    }

    /// Returns the number of nodes of both curves together.
    pub(super) fn nodes(&self) -> usize {
        // A spline has two coefficients more than nodes.
        self.inner.len() + self.outer.len() - 4
    }

    /// Returns the number of bytes that a frame reads of them.
    pub(super) fn bytes(&self) -> usize {
        (self.inner.len() + self.outer.len()) * size_of::<f64>()
    }
}
