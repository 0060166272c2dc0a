//! How far the disk's edges move in the picture when the orbit angles change.

use super::builder::{MAX_ORDERS, curve_builder};
use super::curve_spec::CurveSpec;
use super::pixel_metric::PixelMetric;
use super::solve::SolveTolerance;
use crate::orbit::path::SweptAngles;

/// The allowed error of a node where curves are only measured, as a share of the distance of two nodes.
const NODE_TOLERANCE: f64 = 1e-4;

/// Returns the greatest `|∂ψ/∂φ|` of the curves of `spec`, in pixels per radian: how far an edge moves when every angle
/// changes. It is computed on the coarsest nodes. Without a disk it is 0.
///
/// The curves of an order are about e^−π as steep as those of the order before. So the search ends at the first order
/// whose curves would not exceed the maximum found so far, even where the picture does not show them.
pub fn sensitivity(spec: &CurveSpec, angles: &impl SweptAngles) -> f64 {
    let Some(u_edges) = spec.u_edges else {
        return 0.0;
    };
    let metric = PixelMetric::new(spec);
    let tolerance = SolveTolerance {
        psi: 0.0,
        phi: NODE_TOLERANCE,
    };
    let mut builder = curve_builder(spec, u_edges, &metric, angles);
    let mut most: f64 = 0.0;
    for number in 0..MAX_ORDERS {
        let curves = builder.coarse(number, tolerance);
        if number > 0 && curves.thickness(&metric) < spec.tolerance {
            break;
        }
        most = most.max(builder.sensitivity(&curves));
        if number > 0 && builder.max_slope() * metric.max_per_radian() <= most {
            break;
        }
    }
    most
}
