//! The flux's root, fast.

use std::sync::LazyLock;

use crate::light::flux;
use crate::table::spline::{self, NodeAxis, Scale};

/// `√(F/F_max)/u^{3/2}` as a spline of √u, in which it is analytic.
#[derive(Debug)]
pub(super) struct FluxSpline {
    coefficients: Vec<f64>,
    axis: Scale,
}

/// Nodes from far away to [`INNERMOST_U`]: the spline is right to some 1e-9.
const NODES: u32 = 400;

/// Maps of a camera radius go beyond the innermost stable orbit, to about this inverse radius.
const INNERMOST_U: f64 = 0.6;

/// The same for all disks.
static SHARED: LazyLock<FluxSpline> = LazyLock::new(FluxSpline::new);

impl FluxSpline {
    fn new() -> Self {
        let axis = NodeAxis {
            start: 1e-4,
            end: INNERMOST_U.sqrt(),
            nodes: NODES,
        };
        let nodes: Vec<f64> = (0..NODES)
            .map(|i| {
                let v = axis.node(i);
                flux::signed_root(v * v) / (v * v * v)
            })
            .collect();
        Self {
            coefficients: spline::coefficients(&nodes),
            axis: Scale::new(axis),
        }
    }

    /// The spline, computed at its first use.
    pub(super) fn shared() -> &'static Self {
        &SHARED
    }

    /// Returns [`flux::signed_root`] at u.
    #[inline(always)]
    pub(super) fn signed_root(&self, u: f64) -> f64 {
        let v = u.sqrt();
        u * v * spline::value(&self.coefficients, &self.axis.stencil(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_root_of_the_flux() {
        let spline = FluxSpline::shared();
        for i in 0..4000 {
            let u = 1e-9 * libm::pow(0.333 / 1e-9, f64::from(i) / 4000.0);
            let (found, exact) = (spline.signed_root(u), flux::signed_root(u));
            assert!(
                (found - exact).abs() <= 1e-9 * libm::pow(3.0 * u, 1.5),
                "{u}: {found} {exact}"
            );
        }
    }
}
