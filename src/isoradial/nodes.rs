//! As many nodes of a curve as its pixels need.
//!
//! # Derivation
//! Between the nodes runs a cubic spline, whose error is largest in the middle of a cell, `δ⁴|f⁗|/384` for cells of
//! the width δ, except where they are few or the curve's end is near. So the truth is computed in the middles, and
//! with it the spline of twice the nodes, sixteen times as right, which is the truth for the quarters: the largest
//! difference, in pixels, is what the nodes are doubled for until it is small enough. The error was nowhere over
//! [`BETWEEN`] times as large (1.2, in 3,000 random scenes): that is what is promised.
//!
//! A guess of the truth in a cell's middle, its slope included, is the spline's own: one swept angle is enough for most
//! of them (see `solve.rs`), which is solved for no more closely than [`SOLVED`] asks.
//!
//! The truth is itself only as good as the angles it is found from; an error δφ of an angle moves the curve by
//! `|∂ψ/∂φ| δφ`, [`Nodes::sensitivity`] times δφ pixels at most.
//!
//! Cells in which the curve is nowhere in the picture need nothing.

use super::sight::Shown;
use super::solve::{Closeness, Found, Guess, Target};
use super::turns::Turns;
use super::{EdgeError, Quarter};
use crate::orbit::path::{Branch, FixedRadiiAngles};
use crate::table::spline::{self, NodeAxis, coefficients, on_half_cells};

/// Fewest cells of a piece: a quarter turn in eight.
const FEWEST_CELLS: usize = 8;

/// What the error may be between the places it is looked at, over the largest that is seen there.
const BETWEEN: f64 = 1.25;

/// Errors below this share of what they may be are not told from it.
const FLOOR: f64 = 1.0 / 16.0;

/// Cells from which on a doubling brings down the error of a curve that is resolved by far more than a half.
const SETTLED_CELLS: usize = 128;

/// Most cells of a piece. A disk to r = 1e6 bends its curve within 1e-3 of φ = π, which takes some thousands.
const MOST_CELLS: usize = 1 << 14;

/// What a node may be off by, over what the curve may. Four times as much is promised for it, 1/128 of the curve's: for
/// the node, for the spline between two that are off (at most twice as much), and for the truth it is compared with.
pub(super) const SOLVED: f64 = 1.0 / 512.0;

/// What a node may be off by where a curve is only looked at, over the distance of two nodes.
pub(super) const LOOKED_AT: f64 = 1e-4;

/// One curve over one quarter turn, on equidistant nodes.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// h, or `x h` in the piece with the pole.
    values: Vec<f64>,
    /// The coefficients of the spline through them.
    spline: Vec<f64>,
    pub(super) quarter: Quarter,
    /// The way that rays take to the radius at the curve's beginning.
    branch: Branch,
    /// The largest interpolation error, in pixels.
    interpolation: f64,
}

/// The points of a curve on the coarsest nodes.
pub(super) type Coarsest = [Found; FEWEST_CELLS + 1];

/// The points on the coarsest nodes of the curve of `target`, right to `closeness`; `before` is the same curve an order
/// before, `end` the point at the end of the quarter turn before this one, if it ends where this one begins.
///
/// The guesses: the next node lies where the cubic through the last two and their slopes goes on, or, from the second
/// order on, where the one before it was, times as much as at the last node.
pub(super) fn coarsest<B: FixedRadiiAngles>(
    target: &Target<B>,
    quarter: Quarter,
    turns: &mut Turns,
    before: Option<&Coarsest>,
    end: Option<Found>,
    closeness: Closeness,
) -> Coarsest {
    let turned = turns.nodes(FEWEST_CELLS);
    let mut found = [Found {
        h: f64::INFINITY,
        slope: f64::NAN,
        branch: Branch::Direct,
    }; FEWEST_CELLS + 1];
    for i in 0..=FEWEST_CELLS {
        let x = quarter.x_at(i as f64 / FEWEST_CELLS as f64);
        if quarter.pole && x == 0.0 {
            continue;
        }
        let cell = if i == 0 {
            turned[1] - turned[0]
        } else {
            turned[i] - turned[i - 1]
        };
        let guess = match (i, before, end) {
            (0, _, Some(end)) => Some(Guess {
                h: end.h,
                slope: end.slope,
                blur: 1.0 / cell,
                branch: end.branch,
            }),
            (0, Some(before), None) => {
                let ratio = libm::exp(-core::f64::consts::PI);
                Some(Guess {
                    h: ratio * before[0].h,
                    slope: ratio * before[0].slope,
                    blur: f64::INFINITY,
                    branch: before[0].branch,
                })
            }
            (0, None, None) => None,
            (1.., Some(before), _) => {
                let ratio = |i: usize| found[i].h / before[i].h;
                let rise = if i == 1 {
                    0.0
                } else {
                    (ratio(i - 1) - ratio(i - 2)) / (turned[i - 1] - turned[i - 2])
                };
                let ratio = ratio(i - 1) + rise * cell;
                // A line through two nodes that is off at the next by some amount is off there in its slope by 3/2 of
                // that a cell, a constant by 1; and h bends by h′ for each radian.
                Some(Guess {
                    h: ratio * before[i].h,
                    slope: ratio * before[i].slope + rise * before[i].h,
                    blur: 2.0 / cell + 1.0,
                    branch: found[i - 1].branch,
                })
            }
            (1.., None, _) => Some(extrapolated(target, quarter, i, &found)),
        };
        let angle = quarter.start + turned[i];
        let guess = guess.unwrap_or_else(|| Guess {
            h: target.first_guess(angle),
            slope: f64::NAN,
            blur: f64::INFINITY,
            branch: Branch::Direct,
        });
        let closeness = Closeness {
            phi: closeness.phi * cell,
            ..closeness
        };
        found[i] = target.follow(angle, guess, closeness);
    }
    found
}

/// A guess of node `i`: of what is kept, the cubic through the two nodes before and their slopes.
fn extrapolated<B: FixedRadiiAngles>(
    target: &Target<B>,
    quarter: Quarter,
    i: usize,
    found: &Coarsest,
) -> Guess {
    let x = |i: usize| quarter.x_at(i as f64 / FEWEST_CELLS as f64);
    let kept = |i: usize| {
        let x = x(i);
        if quarter.pole && x == 0.0 {
            let value = target.at_pole();
            // As in flat space.
            return (value, -value - target.critical);
        }
        quarter.kept(x, found[i])
    };
    let width = x(1) - x(0);
    let (y1, s1) = kept(i - 1);
    let (y, s) = if i == 1 {
        (y1 + width * s1, s1)
    } else {
        let (y0, s0) = kept(i - 2);
        // In units of the width, at twice it from the first: Hermite's cubic.
        let (s0, s1) = (width * s0, width * s1);
        (
            5.0 * y0 - 4.0 * y1 + 2.0 * s0 + 4.0 * s1,
            (12.0 * (y0 - y1) + 5.0 * s0 + 8.0 * s1) / width,
        )
    };
    let (h, slope, _) = quarter.along(x(i), (y, s, 0.0));
    // The curve may have turned since.
    Guess {
        h,
        slope,
        blur: f64::INFINITY,
        branch: found[i - 1].branch,
    }
}

impl Nodes {
    /// The nodes of `found`.
    pub(super) fn new<B: FixedRadiiAngles>(
        target: &Target<B>,
        quarter: Quarter,
        found: &Coarsest,
    ) -> Self {
        let value = |(i, found): (usize, &Found)| {
            let x = quarter.x_at(i as f64 / FEWEST_CELLS as f64);
            if quarter.pole && x == 0.0 {
                target.at_pole()
            } else {
                found.h / quarter.over_kept(x)
            }
        };
        let mut values = Vec::with_capacity(2 * FEWEST_CELLS + 1);
        values.extend(found.iter().enumerate().map(value));
        Self {
            spline: Vec::new(),
            values,
            quarter,
            branch: found[1].branch,
            interpolation: f64::INFINITY,
        }
    }

    /// The curve of `target`, its nodes doubled until it is right to `allowed` pixels in every cell that the picture
    /// shows, or as right as the angles are.
    pub(super) fn refine<B: FixedRadiiAngles>(
        self,
        target: &Target<B>,
        turns: &mut Turns,
        shown: &Shown,
        allowed: f64,
        angle_error: f64,
    ) -> Self {
        let mut nodes = self;
        nodes.spline = coefficients(&nodes.values);
        let solved = SOLVED * allowed;
        let closeness = Closeness {
            psi: solved / shown.most_per_radian(),
            phi: 0.0,
        };
        let mut noise = None;
        loop {
            let (finer, mut error) =
                nodes.refined(target, turns, shown, closeness, FLOOR * allowed);
            // See there.
            let promised = |error: f64| BETWEEN * error + 4.0 * solved;
            let mut suffices = |error: f64| {
                let settled = nodes.cells() >= SETTLED_CELLS
                    && error > 0.5 * nodes.interpolation
                    && error <= 100.0 * allowed;
                error <= allowed
                    || settled
                    || finer.cells() >= MOST_CELLS
                    // Nodes and middles are off by as much as the angles and the arithmetic, which no node mends.
                    || error <= 2.0 * *noise.get_or_insert_with(|| {
                        let none = EdgeError::default();
                        let error = finer.error(none, turns, shown, angle_error);
                        error.angles + error.rounding
                    })
            };
            // The quarters are looked at only where the middles are right.
            let mut done = suffices(promised(error));
            if done {
                error = finer.off(&nodes.spline, shown, error);
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

    /// The curve's spline, written on `count` nodes: its own, or doublings of them.
    pub(super) fn spline(&self, count: usize) -> Vec<f64> {
        let mut spline = self.spline.clone();
        while spline.len() < count + 2 {
            spline = on_half_cells(&spline);
        }
        spline
    }

    /// What the curve, or those before it, may be off by where the picture shows it, in pixels, from angles with an
    /// error of `angle_error`.
    pub(super) fn error(
        &self,
        before: EdgeError,
        turns: &mut Turns,
        shown: &Shown,
        angle_error: f64,
    ) -> EdgeError {
        let most = (before.angles / angle_error).max(0.0);
        EdgeError {
            interpolation: self.interpolation.max(before.interpolation),
            angles: self.sensitivity(most, turns, shown) * angle_error,
            rounding: self.rounding(before.rounding, shown),
        }
    }

    /// `|∂ψ/∂φ|` where the picture shows the curve, in pixels per radian of φ, from node to node, if more than `most`.
    pub(super) fn sensitivity(&self, most: f64, turns: &mut Turns, shown: &Shown) -> f64 {
        let turned = turns.nodes(self.cells());
        let mut before = self.height(0);
        (1..self.count()).fold(most, |most, i| {
            let (ends, turn) = ((before, self.height(i)), turned[i] - turned[i - 1]);
            before = ends.1;
            let least = most * turn;
            let moved = shown.farthest(least, ends.0, ends.1, ends);
            if moved > least { moved / turn } else { most }
        })
    }

    /// What the rounding of a pixel's own `z/s` and of `κ_c` amounts to, some ε of each, `dψ = dκ/(1 + κ²)`, if more
    /// than `most`.
    fn rounding(&self, most: f64, shown: &Shown) -> f64 {
        const ROUNDINGS: f64 = 4.0 * f64::EPSILON;
        let critical = shown.critical;
        let mut before = self.height(0);
        (1..self.count()).fold(most, |most, i| {
            let ends = (before, self.height(i));
            before = ends.1;
            let kappa = critical + ends.0.min(ends.1);
            let (size, per_radian) = (kappa.abs() + critical.abs(), 1.0 + kappa * kappa);
            if ROUNDINGS * size * shown.most_per_radian() <= most * per_radian
                || !shown.reaches(ends)
            {
                return most;
            }
            let rounding = ROUNDINGS * size / per_radian;
            // Infinite towards the hole or away from it, where ψ is exact.
            if rounding.is_finite() {
                most.max(rounding * shown.per_radian(kappa))
            } else {
                most
            }
        })
    }

    /// Twice the cells, and how far the present curve was off on the new nodes, in pixels, if more than `floor`.
    fn refined<B: FixedRadiiAngles>(
        &self,
        target: &Target<B>,
        turns: &mut Turns,
        shown: &Shown,
        closeness: Closeness,
        floor: f64,
    ) -> (Self, f64) {
        let (quarter, cells) = (self.quarter, self.cells());
        let per_unit = self.axis().scale();
        let turned = turns.nodes(2 * cells);
        let mut values = Vec::with_capacity(2 * cells + 1);
        let mut branch = self.branch;
        let mut error = floor;
        for i in 0..cells {
            values.push(self.values[i]);
            let x = quarter.x_at((i as f64 + 0.5) / cells as f64);
            let (value, slope, bend) = spline::in_the_middle(&self.spline, i);
            let (h, slope, bend) =
                quarter.along(x, (value, slope * per_unit, bend * per_unit * per_unit));
            let k = 2 * i + 1;
            // An error that vanishes at the nodes rises and falls within half a cell; the curve bends as the spline
            // does.
            let blur = 4.0 / (turned[k + 1] - turned[k - 1]) + 0.5 * (bend / slope).abs();
            let guess = Guess {
                h,
                slope,
                blur,
                branch,
            };
            let found = target.follow(quarter.start + turned[k], guess, closeness);
            let truth = found.h;
            branch = found.branch;
            values.push(truth / quarter.over_kept(x));
            error = shown.farthest(error, h, truth, (self.height(i), self.height(i + 1)));
        }
        values.push(self.values[cells]);
        let finer = Self {
            spline: coefficients(&values),
            values,
            ..*self
        };
        (finer, error)
    }

    /// How far a spline on half as many cells is off this curve in the middle of each cell, in pixels, if more than
    /// `error`.
    fn off(&self, coarser: &[f64], shown: &Shown, mut error: f64) -> f64 {
        let mut before = self.height(0);
        for i in 0..self.cells() {
            let coarse = spline::in_a_quarter(coarser, i);
            let (fine, _, _) = spline::in_the_middle(&self.spline, i);
            let ends = (before, self.height(i + 1));
            before = ends.1;
            let factor = if self.quarter.pole {
                self.quarter
                    .over_kept(self.quarter.x_at((i as f64 + 0.5) / self.cells() as f64))
            } else {
                1.0
            };
            error = shown.farthest(error, coarse * factor, fine * factor, ends);
        }
        error
    }
}
