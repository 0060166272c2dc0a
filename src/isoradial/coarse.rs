//! The points of a curve on the coarsest nodes.
//!
//! Each node's guess comes from the nodes before it. From order 2 on the curve has the shape of the one an order
//! before: the guess is that curve's h at this node times the ratio of the two curves, continued as a line from the
//! last two nodes. Elsewhere it is the cubic through the last two nodes and their slopes, continued by one cell.

use super::node_angles::NodeAngles;
use super::quarter_turn::QuarterTurn;
use super::solve::{CurveGuess, CurvePoint, CurveSolver, SolveTolerance};
use crate::orbit::path::{Branch, FixedRadiiAngles};

/// The fewest cells of a quarter turn.
pub(super) const FEWEST_CELLS: usize = 8;

/// The points of a curve on the coarsest nodes.
pub(super) type CoarsePoints = [CurvePoint; FEWEST_CELLS + 1];

/// Solves for the points of a curve on the coarsest nodes, right to `tolerance`.
///
/// `before` is the same curve one order before, if its shape is alike. `start` is the last point of the quarter turn
/// before this one, if this one begins there.
pub(super) fn coarse_points<B: FixedRadiiAngles>(
    solver: &CurveSolver<B>,
    quarter: QuarterTurn,
    angles: &mut NodeAngles,
    before: Option<&CoarsePoints>,
    start: Option<CurvePoint>,
    tolerance: SolveTolerance,
) -> CoarsePoints {
    let phi = angles.nodes(FEWEST_CELLS);
    let mut points = [CurvePoint {
        h: f64::INFINITY,
        slope: f64::NAN,
        branch: Branch::Direct,
    }; FEWEST_CELLS + 1];
    for i in 0..=FEWEST_CELLS {
        let x = quarter.x_at(i as f64 / FEWEST_CELLS as f64);
        if quarter.has_pole_at(x) {
            continue;
        }
        let angle = quarter.start + phi[i];
        let cell = phi[i.max(1)] - phi[i.max(1) - 1];
        let guess = match (i, before, start) {
            (0, _, Some(start)) => CurveGuess {
                h: start.h,
                slope: start.slope,
                blur: 1.0 / cell,
                branch: start.branch,
            },
            (0, Some(before), None) => {
                let ratio = libm::exp(-core::f64::consts::PI);
                CurveGuess {
                    h: ratio * before[0].h,
                    slope: ratio * before[0].slope,
                    blur: f64::INFINITY,
                    branch: before[0].branch,
                }
            }
            (0, None, None) => CurveGuess {
                h: solver.first_guess(angle),
                slope: f64::NAN,
                blur: f64::INFINITY,
                branch: Branch::Direct,
            },
            (1.., Some(before), _) => {
                let ratio = |i: usize| points[i].h / before[i].h;
                let rise = if i == 1 {
                    0.0
                } else {
                    (ratio(i - 1) - ratio(i - 2)) / (phi[i - 1] - phi[i - 2])
                };
                let ratio = ratio(i - 1) + rise * cell;
                // If a line through two nodes is off by some error at the next node, its slope there is off by 3/2 of
                // that error a cell. For a constant it is 1. And h itself changes by h′ for each radian.
                CurveGuess {
                    h: ratio * before[i].h,
                    slope: ratio * before[i].slope + rise * before[i].h,
                    blur: 2.0 / cell + 1.0,
                    branch: points[i - 1].branch,
                }
            }
            (1.., None, _) => extrapolated(solver, quarter, i, &points),
        };
        let tolerance = SolveTolerance {
            phi: tolerance.phi * cell,
            ..tolerance
        };
        points[i] = solver.follow(angle, guess, tolerance);
    }
    points
}

/// Guesses node `i` from the cubic of the stored values through the two nodes before it and their slopes.
fn extrapolated<B: FixedRadiiAngles>(
    solver: &CurveSolver<B>,
    quarter: QuarterTurn,
    i: usize,
    points: &CoarsePoints,
) -> CurveGuess {
    let x = |i: usize| quarter.x_at(i as f64 / FEWEST_CELLS as f64);
    let stored = |i: usize| {
        let x = x(i);
        if quarter.has_pole_at(x) {
            let value = solver.at_pole();
            // The slope of flat space.
            return (value, -value - solver.critical);
        }
        quarter.stored_from_h(x, points[i].h, points[i].slope)
    };
    let width = x(1) - x(0);
    let (y1, s1) = stored(i - 1);
    let (y, s) = if i == 1 {
        (y1 + width * s1, s1)
    } else {
        let (y0, s0) = stored(i - 2);
        // Hermite's cubic in units of the width, continued by one cell.
        let (s0, s1) = (width * s0, width * s1);
        (
            5.0 * y0 - 4.0 * y1 + 2.0 * s0 + 4.0 * s1,
            (12.0 * (y0 - y1) + 5.0 * s0 + 8.0 * s1) / width,
        )
    };
    let (h, slope, _) = quarter.h_from_stored(x(i), (y, s, 0.0));
    // The error of the slope is unknown: the curve may bend in this cell.
    CurveGuess {
        h,
        slope,
        blur: f64::INFINITY,
        branch: points[i - 1].branch,
    }
}
