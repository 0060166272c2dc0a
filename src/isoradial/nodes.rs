//! As many nodes of a curve as its pixels need.
//!
//! # Derivation
//! Between the nodes runs a cubic spline, whose error is largest in the middle of a cell, `δ⁴|f⁗|/384` for cells of
//! the width δ, except where they are few or the curve's end is near. So the truth is computed in the middles, and
//! with it the spline of twice the nodes, sixteen times as right, which is the truth for the quarters: the largest
//! difference, in pixels, is what the nodes are doubled for until it is small enough. The error was nowhere over
//! [`BETWEEN`] times as large (1.2, in 3,000 random scenes): that is what is promised.
//!
//! The truth is itself only as good as the angles it is found from; an error δφ of an angle moves the curve by
//! `|∂ψ/∂φ| δφ`, [`Nodes::sensitivity`] times δφ pixels at most.
//!
//! Cells in which the curve is nowhere in the picture need nothing.

use super::sight::{Sight, angle, between};
use super::solve::Target;
use super::{EdgeError, Quarter};
use crate::orbit::path::SweptAngles;
use crate::table::spline::{Axis, Scale, coefficients, on_half_cells, value};

/// Fewest cells of a piece: a quarter turn in eight.
const FEWEST_CELLS: usize = 8;

/// What the error may be between the places it is looked at, over the largest that is seen there.
const BETWEEN: f64 = 1.25;

/// Cells from which on a doubling brings down the error of a curve that is resolved by far more than a half.
const SETTLED_CELLS: usize = 128;

/// Most cells of a piece. A disk to r = 1e6 bends its curve within 1e-3 of φ = π, which takes some thousands.
const MOST_CELLS: usize = 1 << 14;

/// One curve over one quarter turn, on equidistant nodes.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// h, or `x h` in the piece with the pole.
    values: Vec<f64>,
    pub(super) quarter: Quarter,
    /// The largest interpolation error, in pixels.
    interpolation: f64,
}

impl Nodes {
    /// The curve of `target`, its nodes doubled until it is right to `allowed` pixels in every cell that the picture
    /// shows, or as right as the angles are. With ∞ allowed, on the fewest nodes, whose error is not looked at.
    pub(super) fn draw(
        target: &Target,
        quarter: Quarter,
        sight: &Sight,
        allowed: f64,
        angles: &impl SweptAngles,
    ) -> Self {
        let mut nodes = Self::coarsest(target, quarter, angles);
        if allowed.is_infinite() {
            return nodes;
        }
        loop {
            let (finer, error) = nodes.refined(target, sight, angles);
            // Nodes and middles are off by as much as the angles and the arithmetic, which no node mends.
            let noise = finer.noise(sight, angles.error());
            let settled = nodes.cells() >= SETTLED_CELLS
                && error > 0.5 * nodes.interpolation
                && error <= 100.0 * allowed;
            if error <= allowed.max(2.0 * noise) || settled || finer.cells() >= MOST_CELLS {
                nodes.interpolation = error;
                return nodes;
            }
            nodes = Self {
                interpolation: error,
                ..finer
            };
        }
    }

    /// How many nodes there are.
    pub(super) fn count(&self) -> usize {
        self.values.len()
    }

    fn cells(&self) -> usize {
        self.values.len() - 1
    }

    /// x at node i.
    pub(super) fn x(&self, i: usize) -> f64 {
        self.quarter.x_at(i as f64 / self.cells() as f64)
    }

    /// `h = κ − κ_c` at node i; infinite at a pole.
    pub(super) fn height(&self, i: usize) -> f64 {
        self.values[i] * self.quarter.over_kept(self.x(i))
    }

    pub(super) fn axis(&self) -> Axis {
        Axis {
            start: self.quarter.x.0,
            end: self.quarter.x.1,
            nodes: self.values.len() as u32,
        }
    }

    /// The curve's spline, written on `count` nodes: its own, or doublings of them.
    pub(super) fn spline(&self, count: usize) -> Vec<f64> {
        let mut spline = coefficients(&self.values);
        while spline.len() < count + 2 {
            spline = on_half_cells(&spline);
        }
        spline
    }

    /// What the curve may be off by where the picture shows it, in pixels, from angles with an error of
    /// `angle_error`.
    pub(super) fn error(&self, sight: &Sight, angle_error: f64) -> EdgeError {
        EdgeError {
            interpolation: self.interpolation,
            angles: self.sensitivity(sight) * angle_error,
            rounding: self.rounding(sight),
        }
    }

    fn noise(&self, sight: &Sight, angle_error: f64) -> f64 {
        self.sensitivity(sight) * angle_error + self.rounding(sight)
    }

    /// `|∂ψ/∂φ|` where the picture shows the curve, at most, in pixels per radian of φ: from node to node.
    pub(super) fn sensitivity(&self, sight: &Sight) -> f64 {
        let visible = Visible::new(sight);
        (1..self.count()).fold(0.0, |most: f64, i| {
            let (before, after) = (self.height(i - 1), self.height(i));
            let turn = self.quarter.angle(self.x(i)) - self.quarter.angle(self.x(i - 1));
            most.max(visible.pixels(before, after, (before, after)) / turn)
        })
    }

    /// What the rounding of a pixel's own `z/s` and of `κ_c` amounts to, some ε of each, `dψ = dκ/(1 + κ²)`.
    fn rounding(&self, sight: &Sight) -> f64 {
        const ROUNDINGS: f64 = 4.0 * f64::EPSILON;
        let (visible, critical) = (Visible::new(sight), sight.critical());
        (1..self.count()).fold(0.0, |most: f64, i| {
            let ends = (self.height(i - 1), self.height(i));
            if !visible.reaches(ends) {
                return most;
            }
            let h = ends.0.min(ends.1);
            let kappa = critical + h;
            let rounding = ROUNDINGS * (kappa.abs() + critical.abs()) / (1.0 + kappa * kappa);
            // Infinite towards the hole or away from it, where ψ is exact.
            if rounding.is_finite() {
                most.max(rounding * sight.pixels_per_radian(angle(kappa)))
            } else {
                most
            }
        })
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
        let factor = quarter.over_kept(x);
        target.solve(quarter.angle(x), guess * factor, angles) / factor
    }

    fn coarsest(target: &Target, quarter: Quarter, angles: &impl SweptAngles) -> Self {
        let mut values: Vec<f64> = Vec::with_capacity(FEWEST_CELLS + 1);
        for i in 0..=FEWEST_CELLS {
            let x = quarter.x_at(i as f64 / FEWEST_CELLS as f64);
            let guess = values
                .last()
                .copied()
                .unwrap_or_else(|| target.first_guess(quarter.angle(x)) / quarter.over_kept(x));
            values.push(Self::solve(target, quarter, x, guess, angles));
        }
        Self {
            values,
            quarter,
            interpolation: f64::INFINITY,
        }
    }

    /// Twice the cells, and how far the present curve was off on the new nodes, in pixels.
    fn refined(&self, target: &Target, sight: &Sight, angles: &impl SweptAngles) -> (Self, f64) {
        let (spline, axis) = (coefficients(&self.values), Scale::new(self.axis()));
        let visible = Visible::new(sight);
        let mut values = Vec::with_capacity(2 * self.cells() + 1);
        let mut error: f64 = 0.0;
        for i in 0..self.cells() {
            values.push(self.values[i]);
            let x = self.quarter.x_at((i as f64 + 0.5) / self.cells() as f64);
            let guess = value(&spline, &axis.stencil(x));
            let truth = Self::solve(target, self.quarter, x, guess, angles);
            values.push(truth);
            let factor = self.quarter.over_kept(x);
            let ends = (self.height(i), self.height(i + 1));
            error = error.max(visible.pixels(guess * factor, truth * factor, ends));
        }
        values.push(self.values[self.cells()]);
        let finer = Self { values, ..*self };
        let error = BETWEEN * error.max(self.off_quarters(&finer, sight));
        (finer, error)
    }

    /// How far the present curve is off a finer one at a quarter and at three quarters of every cell.
    fn off_quarters(&self, finer: &Self, sight: &Sight) -> f64 {
        let (coarse, coarse_axis) = (coefficients(&self.values), Scale::new(self.axis()));
        let (fine, fine_axis) = (coefficients(&finer.values), Scale::new(finer.axis()));
        let visible = Visible::new(sight);
        let mut error: f64 = 0.0;
        for i in 0..finer.cells() {
            let x = self.quarter.x_at((i as f64 + 0.5) / finer.cells() as f64);
            let factor = self.quarter.over_kept(x);
            let guess = value(&coarse, &coarse_axis.stencil(x)) * factor;
            let better = value(&fine, &fine_axis.stencil(x)) * factor;
            let ends = (finer.height(i), finer.height(i + 1));
            error = error.max(visible.pixels(guess, better, ends));
        }
        error
    }
}

/// What the picture shows of a curve.
struct Visible<'a> {
    sight: &'a Sight,
    heights: (f64, f64),
}

impl<'a> Visible<'a> {
    fn new(sight: &'a Sight) -> Self {
        Self {
            sight,
            heights: sight.heights(),
        }
    }

    /// Whether the picture shows any ray of an interval of h.
    fn reaches(&self, h: (f64, f64)) -> bool {
        h.0.min(h.1) <= self.heights.1 && h.0.max(h.1) >= self.heights.0
    }

    /// The distance of two rays in pixels, 0 where the cell they lie in, from one of its ends to the other and as far
    /// beyond as the two are apart, is not in the picture.
    fn pixels(&self, a: f64, b: f64, ends: (f64, f64)) -> f64 {
        let apart = (a - b).abs();
        let low = ends.0.min(ends.1).min(a).min(b) - apart;
        let high = ends.0.max(ends.1).max(a).max(b) + apart;
        if !self.reaches((low, high)) {
            return 0.0;
        }
        let critical = self.sight.critical();
        // The farthest from the hole's direction that the picture shows of it, where pixels are smallest.
        let farthest = angle(critical + low.max(self.heights.0));
        self.sight.pixels_per_radian(farthest) * between(a.min(b), a.max(b), critical)
    }
}
