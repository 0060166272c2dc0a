//! As many nodes of a curve as its pixels need.

use super::solve::Target;
use super::{Quarter, Sight};
use crate::orbit::path::SweptAngles;
use crate::table::spline::{Axis, Scale, coefficients, value};

/// Fewest cells of a piece: a quarter turn in eight.
const FEWEST_CELLS: usize = 8;

/// Cells from which on a doubling brings down the error of a curve that is resolved by far more than a half.
const SETTLED_CELLS: usize = 128;

/// Most cells of a piece. A disk to r = 1e6 bends its curve within 1e-3 of φ = π, which takes some thousands.
const MOST_CELLS: usize = 1 << 14;

/// One curve over one quarter turn, on equidistant nodes.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// h, or `x h` in the piece with the pole.
    pub(super) values: Vec<f64>,
    quarter: Quarter,
    critical: f64,
    /// The largest error in the middle of a cell, in pixels.
    pub(super) error: f64,
}

impl Nodes {
    /// The curve of `target`, its nodes doubled until the error in the middle of every cell is a tenth of the
    /// tolerance: the middles may miss the largest error, and the angles have one of their own. Once doubling no
    /// longer helps, only the latter is left, and the curve is as good as it gets.
    pub(super) fn draw(
        target: &Target,
        quarter: Quarter,
        sight: &Sight,
        angles: &impl SweptAngles,
    ) -> Self {
        let mut nodes = Self::coarsest(target, quarter, angles);
        loop {
            let (finer, error) = nodes.refined(target, sight, angles);
            let settled = nodes.cells() >= SETTLED_CELLS
                && error > 0.5 * nodes.error
                && error <= 100.0 * sight.tolerance;
            if error <= 0.1 * sight.tolerance || settled || finer.cells() >= MOST_CELLS {
                nodes.error = error;
                return nodes;
            }
            nodes = Self { error, ..finer };
        }
    }

    fn cells(&self) -> usize {
        self.values.len() - 1
    }

    fn x(&self, i: usize) -> f64 {
        i as f64 / self.cells() as f64
    }

    /// `κ` at node i; infinite at a pole.
    pub(super) fn kappa(&self, i: usize) -> f64 {
        let h = if self.quarter.pole {
            self.values[i] / self.x(i)
        } else {
            self.values[i]
        };
        self.critical + h
    }

    pub(super) fn axis(&self) -> Scale {
        Scale::new(Axis {
            start: 0.0,
            end: 1.0,
            nodes: self.values.len() as u32,
        })
    }

    pub(super) fn coefficients(&self) -> Vec<f64> {
        coefficients(&self.values)
    }

    /// The same curve on `count` nodes, a doubling or more of its own; its spline does for what lies between.
    pub(super) fn with_count(self, count: usize) -> Self {
        if count == self.values.len() {
            return self;
        }
        let (spline, axis) = (self.coefficients(), self.axis());
        let values = (0..count)
            .map(|i| value(&spline, &axis.stencil(i as f64 / (count - 1) as f64)))
            .collect();
        Self { values, ..self }
    }

    /// What is kept at x, from a guess of it.
    fn solve(
        target: &Target,
        quarter: Quarter,
        x: f64,
        guess: f64,
        angles: &impl SweptAngles,
    ) -> f64 {
        if quarter.pole && x == 0.0 {
            // φ → 0: w φ → u_d − u0, and x ~ φ.
            return (target.u_disk - target.u0) / target.slope_scale;
        }
        let factor = if quarter.pole { x } else { 1.0 };
        factor * target.solve(quarter.angle(x), guess / factor, angles)
    }

    fn coarsest(target: &Target, quarter: Quarter, angles: &impl SweptAngles) -> Self {
        let mut values: Vec<f64> = Vec::with_capacity(FEWEST_CELLS + 1);
        for i in 0..=FEWEST_CELLS {
            let x = i as f64 / FEWEST_CELLS as f64;
            // Flat space to begin with, where u = u0 cos φ + w sin φ; then the last value.
            let guess = values.last().copied().unwrap_or_else(|| {
                let angle = quarter.angle(x);
                let flat = (target.u_disk / target.u0 - libm::cos(angle))
                    / libm::sin(angle).abs().max(0.1);
                if quarter.start > 2.0 {
                    -target.critical.abs() * libm::exp(-angle)
                } else {
                    flat - target.critical
                }
            });
            values.push(Self::solve(target, quarter, x, guess, angles));
        }
        Self {
            values,
            quarter,
            critical: target.critical,
            error: f64::INFINITY,
        }
    }

    /// Twice the cells, and how far the present curve was off on the new nodes, in pixels.
    fn refined(&self, target: &Target, sight: &Sight, angles: &impl SweptAngles) -> (Self, f64) {
        let (spline, axis) = (self.coefficients(), self.axis());
        let mut values = Vec::with_capacity(2 * self.cells() + 1);
        let mut error: f64 = 0.0;
        for i in 0..self.cells() {
            values.push(self.values[i]);
            let x = (i as f64 + 0.5) / self.cells() as f64;
            let guess = value(&spline, &axis.stencil(x));
            let truth = Self::solve(target, self.quarter, x, guess, angles);
            values.push(truth);
            let factor = if self.quarter.pole { 1.0 / x } else { 1.0 };
            let kappa = self.critical + truth * factor;
            // dψ = dκ/(1 + κ²) for κ = cot ψ.
            error = error
                .max((guess - truth).abs() * factor / (1.0 + kappa * kappa) / sight.pixel_angle);
        }
        values.push(self.values[self.cells()]);
        (Self { values, ..*self }, error)
    }
}
