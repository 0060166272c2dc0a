//! One curve over one quarter turn, on as many nodes as its pixels need.
//!
//! # Derivation
//! Between the nodes runs a cubic spline. Its error in a cell of width δ is largest in the middle, `δ⁴|f⁗|/384`, except
//! where cells are few or near the curve's end. So the error is measured as follows:
//!
//! * The true curve is computed in the middle of each cell.
//! * These points and the nodes give a spline on half the cells. It is 16 times as accurate, so it serves as the truth
//!   in the quarters of the cells.
//!
//! The nodes are doubled until the largest difference, in pixels, is small enough. In 10,000 random scenes the error
//! was nowhere more than 1.1 times that difference, on the fewest nodes once 1.8 times. [`BETWEEN`] and
//! [`BETWEEN_FEWEST`] times are promised.
//!
//! The spline also provides the guess of the true curve in the middle of a cell, with its slope. Mostly one swept angle
//! is then enough to solve for the point (see `solve.rs`), because the point need not be closer than [`NODE_SHARE`]
//! asks.
//!
//! The true curve is only as good as the method's angles. An error δφ of an angle moves it by `|∂ψ/∂φ| δφ`, at most
//! [`CurveNodes::sensitivity`] times δφ in pixels.
//!
//! Cells in which the curve is outside the picture are not measured.

use super::coarse::{CoarsePoints, FEWEST_CELLS};
use super::edge::EdgeError;
use super::node_angles::NodeAngles;
use super::pixel_metric::PixelMetric;
use super::quarter_turn::QuarterTurn;
use super::solve::{CurveGuess, CurvePoint, CurveSolver, SolveTolerance};
use crate::orbit::path::{Branch, FixedRadiiAngles};
use crate::table::spline::{self, NodeAxis, coefficients, on_half_cells};

/// The promised error over the largest measured one: the error may be larger between the places measured.
const BETWEEN: f64 = 1.25;

/// The same for the fewest cells, where a curve may bend within one of them.
const BETWEEN_FEWEST: f64 = 2.0;

/// Errors below this share of the allowed error are not told apart.
const FLOOR: f64 = 1.0 / 16.0;

/// From this number of cells on, doubling the nodes of a resolved curve reduces its error to far less than a half.
const SETTLED_CELLS: usize = 128;

/// The most cells of a quarter turn. A disk out to r = 1e6 bends its curve within 1e-3 of φ = π, which takes thousands.
const MOST_CELLS: usize = 1 << 14;

/// The allowed error of a node, as a share of the curve's. Four times as much is promised, 1/128 of the curve's: for
/// the node, for the spline between two nodes (at most twice a node's error), and for the truth it is compared with.
pub(super) const NODE_SHARE: f64 = 1.0 / 512.0;

/// One curve over one quarter turn, on equidistant nodes.
#[derive(Debug, Clone)]
pub(super) struct CurveNodes {
    /// h, or `x h` in the quarter turn with the pole.
    values: Vec<f64>,
    /// The coefficients of the spline through them.
    spline: Vec<f64>,
    pub(super) quarter: QuarterTurn,
    /// The branch on which rays meet the radius at the curve's beginning.
    branch: Branch,
    /// The bound of the interpolation error, in pixels.
    interpolation: f64,
}

impl CurveNodes {
    /// Creates the nodes from their points.
    pub(super) fn new<B: FixedRadiiAngles>(
        solver: &CurveSolver<B>,
        quarter: QuarterTurn,
        points: &CoarsePoints,
    ) -> Self {
        let value = |(i, point): (usize, &CurvePoint)| {
            let x = quarter.x_at(i as f64 / FEWEST_CELLS as f64);
            if quarter.has_pole_at(x) {
                solver.at_pole()
            } else {
                point.h / quarter.h_over_stored(x)
            }
        };
        let mut values = Vec::with_capacity(2 * FEWEST_CELLS + 1);
        values.extend(points.iter().enumerate().map(value));
        Self {
            spline: Vec::new(),
            values,
            quarter,
            branch: points[1].branch,
            interpolation: f64::INFINITY,
        }
    }

    /// Doubles the nodes until the curve is right to `allowed` pixels in every visible cell, or as right as the
    /// method's angles are.
    pub(super) fn refine<B: FixedRadiiAngles>(
        self,
        solver: &CurveSolver<B>,
        angles: &mut NodeAngles,
        metric: &PixelMetric,
        allowed: f64,
        angle_error: f64,
    ) -> Self {
        let mut nodes = self;
        nodes.spline = coefficients(&nodes.values);
        let solved = NODE_SHARE * allowed;
        let tolerance = SolveTolerance {
            psi: solved / metric.max_per_radian(),
            phi: 0.0,
        };
        let mut noise = None;
        loop {
            let (finer, mut error) =
                nodes.refined(solver, angles, metric, tolerance, FLOOR * allowed);
            // See BETWEEN and NODE_SHARE.
            let is_coarsest = nodes.cells() <= FEWEST_CELLS;
            let between = if is_coarsest { BETWEEN_FEWEST } else { BETWEEN };
            let promised = |error: f64| between * error + 4.0 * solved;
            let mut suffices = |error: f64| {
                let settled = nodes.cells() >= SETTLED_CELLS
                    && error > 0.5 * nodes.interpolation
                    && error <= 100.0 * allowed;
                error <= allowed
                    || settled
                    || finer.cells() >= MOST_CELLS
                    // More nodes do not reduce the errors of the angles and of the arithmetic.
                    || error <= 2.0 * *noise.get_or_insert_with(|| {
                        let none = EdgeError::default();
                        let error = finer.error(none, angles, metric, angle_error);
                        error.angles + error.rounding
                    })
            };
            // The quarters are measured only if the middles suffice.
            let mut done = suffices(promised(error));
            if done {
                error = finer.error_of_coarser(&nodes.spline, metric, error);
                done = suffices(promised(error));
            }
            if done {
                nodes.interpolation = promised(error);
                return nodes;
            }
            nodes = Self {
                interpolation: promised(error),
                ..finer
            };
        }
    }

    /// Returns the number of nodes.
    pub(super) fn count(&self) -> usize {
        self.values.len()
    }

    fn cells(&self) -> usize {
        self.values.len() - 1
    }

    /// Returns x at node i.
    pub(super) fn x(&self, i: usize) -> f64 {
        self.quarter.x_at(i as f64 / self.cells() as f64)
    }

    /// Returns `h = κ − κ_c` at node i, infinite at a pole.
    pub(super) fn height(&self, i: usize) -> f64 {
        if self.quarter.pole {
            self.values[i] / self.x(i)
        } else {
            self.values[i]
        }
    }

    pub(super) fn axis(&self) -> NodeAxis {
        NodeAxis {
            start: self.quarter.x.0,
            end: self.quarter.x.1,
            nodes: self.values.len() as u32,
        }
    }

    /// Returns the coefficients of the curve's spline on `count` nodes: its own number, or doublings of it.
    pub(super) fn spline(&self, count: usize) -> Vec<f64> {
        let mut spline = self.spline.clone();
        while spline.len() < count + 2 {
            spline = on_half_cells(&spline);
        }
        spline
    }

    /// Raises the error of the curves before to what this one may be off by in the picture, where `angle_error` is the
    /// error of the method's angles.
    pub(super) fn error(
        &self,
        before: EdgeError,
        angles: &mut NodeAngles,
        metric: &PixelMetric,
        angle_error: f64,
    ) -> EdgeError {
        let most = (before.angles / angle_error).max(0.0);
        EdgeError {
            interpolation: self.interpolation.max(before.interpolation),
            angles: self.sensitivity(most, angles, metric) * angle_error,
            rounding: self.rounding(before.rounding, metric),
        }
    }

    /// Returns the greater of `most` and the visible curve's `|∂ψ/∂φ|` from node to node, in pixels per radian.
    pub(super) fn sensitivity(
        &self,
        most: f64,
        angles: &mut NodeAngles,
        metric: &PixelMetric,
    ) -> f64 {
        let phi = angles.nodes(self.cells());
        let mut before = self.height(0);
        (1..self.count()).fold(most, |most, i| {
            let (ends, turn) = ((before, self.height(i)), phi[i] - phi[i - 1]);
            before = ends.1;
            let least = most * turn;
            let moved = metric.max_visible_distance(least, ends.0, ends.1, ends);
            if moved > least { moved / turn } else { most }
        })
    }

    /// Returns the greater of `most` and the effect of rounding, in pixels. A pixel's own `z/s` and `κ_c` are off by a
    /// few ε each, and `dψ = dκ/(1 + κ²)`.
    fn rounding(&self, most: f64, metric: &PixelMetric) -> f64 {
        const ROUNDINGS: f64 = 4.0 * f64::EPSILON;
        let critical = metric.critical;
        let mut before = self.height(0);
        (1..self.count()).fold(most, |most, i| {
            let ends = (before, self.height(i));
            before = ends.1;
            let kappa = critical + ends.0.min(ends.1);
            let (size, per_radian) = (kappa.abs() + critical.abs(), 1.0 + kappa * kappa);
            if ROUNDINGS * size * metric.max_per_radian() <= most * per_radian
                || !metric.shows(ends)
            {
                return most;
            }
            let rounding = ROUNDINGS * size / per_radian;
            // Towards the hole and away from it κ is infinite, and ψ exact.
            if rounding.is_finite() {
                most.max(rounding * metric.per_radian(kappa))
            } else {
                most
            }
        })
    }

    /// Doubles the cells. Returns the finer curve, and the greater of `floor` and the error of this one on the new
    /// nodes, in pixels.
    fn refined<B: FixedRadiiAngles>(
        &self,
        solver: &CurveSolver<B>,
        angles: &mut NodeAngles,
        metric: &PixelMetric,
        tolerance: SolveTolerance,
        floor: f64,
    ) -> (Self, f64) {
        let (quarter, cells) = (self.quarter, self.cells());
        let per_unit = self.axis().scale();
        let phi = angles.nodes(2 * cells);
        let mut values = Vec::with_capacity(2 * cells + 1);
        let mut branch = self.branch;
        let mut error = floor;
        for i in 0..cells {
            values.push(self.values[i]);
            let x = quarter.x_at((i as f64 + 0.5) / cells as f64);
            let (value, slope, bend) = spline::in_the_middle(&self.spline, i);
            let (h, slope, bend) =
                quarter.h_from_stored(x, (value, slope * per_unit, bend * per_unit * per_unit));
            let k = 2 * i + 1;
            // The spline's error vanishes at the nodes, so it rises and falls within half a cell. The curve bends as
            // much as the spline.
            let blur = 4.0 / (phi[k + 1] - phi[k - 1]) + 0.5 * (bend / slope).abs();
            let guess = CurveGuess {
                h,
                slope,
                blur,
                branch,
            };
            let point = solver.follow(quarter.start + phi[k], guess, tolerance);
            let truth = point.h;
            branch = point.branch;
            values.push(truth / quarter.h_over_stored(x));
            error =
                metric.max_visible_distance(error, h, truth, (self.height(i), self.height(i + 1)));
        }
        values.push(self.values[cells]);
        let finer = Self {
            spline: coefficients(&values),
            values,
            ..*self
        };
        (finer, error)
    }

    /// Returns the greater of `error` and the distance between this curve and its spline on half as many cells, in the
    /// middle of each of its cells, in pixels.
    fn error_of_coarser(&self, coarser: &[f64], metric: &PixelMetric, mut error: f64) -> f64 {
        let mut before = self.height(0);
        for i in 0..self.cells() {
            let coarse = spline::in_a_quarter(coarser, i);
            let (fine, _, _) = spline::in_the_middle(&self.spline, i);
            let ends = (before, self.height(i + 1));
            before = ends.1;
            let x = self.quarter.x_at((i as f64 + 0.5) / self.cells() as f64);
            let factor = self.quarter.h_over_stored(x);
            error = metric.max_visible_distance(error, coarse * factor, fine * factor, ends);
        }
        error
    }
}
