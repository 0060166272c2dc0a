//! Builds the curves of one order after the other.

use super::coarse::{CoarsePoints, coarse_points};
use super::curve_spec::CurveSpec;
use super::edge::EdgeError;
use super::node_angles::NodeAngles;
use super::nodes::CurveNodes;
use super::pixel_metric::PixelMetric;
use super::quarter_curves::QuarterCurves;
use super::quarter_turn::QuarterTurn;
use super::solve::{CurvePoint, CurveSolver, SolveTolerance, curve_solver};
use crate::orbit::path::{FixedRadiiAngles, SweptAngles};

/// The most orders that are built. The next one is e^{−12π} as thick as the first, below the rounding of a ray.
pub(super) const MAX_ORDERS: u32 = 12;

/// Builds the curves of one order after the other, from order 0 on.
pub(super) struct CurveBuilder<'a, B> {
    metric: &'a PixelMetric,
    /// The error of the method's angles.
    angle_error: f64,
    /// For the inner and the outer edge.
    solvers: [CurveSolver<B>; 2],
    /// The quarter turns that the picture shows.
    turns: Vec<VisibleTurn>,
}

/// The part of a quarter turn that the picture shows, the same in every order.
struct VisibleTurn {
    index: usize,
    angles: NodeAngles,
    /// The coarsest nodes of the inner and the outer edge in the order before.
    before: Option<[CoarsePoints; 2]>,
}

/// Creates a builder for the curves of `spec` and of a disk with the inverse radii `u_edges`, the inner edge's first.
pub(super) fn curve_builder<'a, A: SweptAngles>(
    spec: &CurveSpec,
    u_edges: [f64; 2],
    metric: &'a PixelMetric,
    angles: &'a A,
) -> CurveBuilder<'a, impl FixedRadiiAngles> {
    let turns = spec.window.quarters().into_iter().enumerate();
    CurveBuilder {
        metric,
        angle_error: angles.error(),
        solvers: u_edges.map(|u_disk| curve_solver(spec, u_disk, angles)),
        turns: turns
            .filter_map(|(index, x)| {
                Some(VisibleTurn {
                    index,
                    angles: NodeAngles::new(x?),
                    before: None,
                })
            })
            .collect(),
    }
}

impl<B: FixedRadiiAngles> CurveBuilder<'_, B> {
    /// Builds the curves of order `number` on the coarsest nodes. Orders have to be asked for one after the other.
    pub(super) fn coarse(&mut self, number: u32, tolerance: SolveTolerance) -> OrderCurves {
        let mut joint: Option<[CurvePoint; 2]> = None;
        let mut curves = Vec::with_capacity(self.turns.len());
        for turn in &mut self.turns {
            let quarter = QuarterTurn::new(number, turn.index, turn.angles.x());
            // The curves of order 0 begin at the camera, so that those of order 1 have another shape.
            let before = turn.before.as_ref().filter(|_| number > 1);
            let points = [0, 1].map(|edge| {
                let before = before.map(|both| &both[edge]);
                let start = joint.map(|both| both[edge]).filter(|_| quarter.x.0 == 0.0);
                let solver = &self.solvers[edge];
                coarse_points(solver, quarter, &mut turn.angles, before, start, tolerance)
            });
            joint = (quarter.x.1 == 1.0).then(|| points.map(|points| points[points.len() - 1]));
            curves.push(
                [0, 1].map(|edge| CurveNodes::new(&self.solvers[edge], quarter, &points[edge])),
            );
            turn.before = Some(points);
        }
        OrderCurves(curves)
    }

    /// Doubles the nodes of the curves until their error is at most `allowed` pixels.
    pub(super) fn refine(&mut self, coarse: OrderCurves, allowed: f64) -> OrderCurves {
        let [inner_solver, outer_solver] = &self.solvers;
        let pairs = coarse.0.into_iter().zip(&mut self.turns);
        let refined = pairs.map(|([inner, outer], turn)| {
            let mut refine = |nodes: CurveNodes, solver| {
                nodes.refine(
                    solver,
                    &mut turn.angles,
                    self.metric,
                    allowed,
                    self.angle_error,
                )
            };
            [refine(inner, inner_solver), refine(outer, outer_solver)]
        });
        OrderCurves(refined.collect())
    }

    /// Returns the greatest `|∂ψ/∂φ|` of the visible parts of the curves, in pixels per radian.
    pub(super) fn sensitivity(&mut self, curves: &OrderCurves) -> f64 {
        let mut most: f64 = 0.0;
        for (pair, turn) in curves.0.iter().zip(&mut self.turns) {
            for nodes in pair {
                most = nodes.sensitivity(most, &mut turn.angles, self.metric);
            }
        }
        most
    }

    /// Raises an error to what the curves may be off by.
    pub(super) fn error(&mut self, mut error: EdgeError, curves: &OrderCurves) -> EdgeError {
        for (pair, turn) in curves.0.iter().zip(&mut self.turns) {
            for nodes in pair {
                error = nodes.error(error, &mut turn.angles, self.metric, self.angle_error);
            }
        }
        error
    }

    /// Returns the greatest `|∂ψ/∂φ|` of the last order's curves at the coarsest nodes, in the picture or not; infinite
    /// if a slope is not known.
    pub(super) fn max_slope(&self) -> f64 {
        let pairs = self.turns.iter().flat_map(|turn| &turn.before);
        pairs.flatten().flatten().fold(0.0, |most: f64, point| {
            let kappa = self.metric.critical + point.h;
            let slope = point.slope.abs() / (1.0 + kappa * kappa);
            most.max(if slope.is_nan() { f64::INFINITY } else { slope })
        })
    }
}

/// The curves of one order: the inner and the outer edge's of each quarter turn that the picture shows.
pub(super) struct OrderCurves(Vec<[CurveNodes; 2]>);

impl OrderCurves {
    /// Returns the greatest distance between the two edges at their nodes, in pixels.
    pub(super) fn thickness(&self, metric: &PixelMetric) -> f64 {
        self.0.iter().fold(0.0, |most: f64, [inner, outer]| {
            most.max(thickness(inner, outer, metric))
        })
    }

    /// Returns the curves of the quarter turns in which the picture shows any ray that meets the disk, with the quarter
    /// turn's index.
    pub(super) fn visible(
        &self,
        number: u32,
        spec: &CurveSpec,
    ) -> impl Iterator<Item = (usize, QuarterCurves)> {
        let (low, high) = spec.h_range();
        let curves = self.0.iter().map(move |[inner, outer]| {
            let curves = QuarterCurves::new(number, inner, outer);
            (inner.quarter.index, curves)
        });
        curves.filter(move |(_, curves)| curves.h_range.0 <= high && curves.h_range.1 >= low)
    }
}

/// Returns the greatest distance between two curves over the same x, in pixels.
fn thickness(inner: &CurveNodes, outer: &CurveNodes, metric: &PixelMetric) -> f64 {
    let count = inner.count().min(outer.count());
    // Nodes are doubled, so those of the coarser curve are nodes of the finer one too.
    let (step_inner, step_outer) = (
        (inner.count() - 1) / (count - 1),
        (outer.count() - 1) / (count - 1),
    );
    (0..count).fold(0.0, |thickness: f64, i| {
        let (high, low) = (inner.height(i * step_inner), outer.height(i * step_outer));
        metric.max_distance(thickness, (low.min(high), low.max(high)))
    })
}
