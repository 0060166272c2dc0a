//! Measures a table's error: its swept angles against the exact method's, off the grid's nodes.

use rayon::prelude::*;

use super::charts::{CRITICAL_B, TRAPPED_U, WEAK_V};
use super::lookup::Lookup;
use super::spec::Spec;
use super::spline::NodeAxis;
use crate::orbit::Ray;
use crate::orbit::exact::Exact;
use crate::orbit::invariants::Orbit;
use crate::orbit::path::SweptAngles;

/// A measured error, and on how many angles it was measured.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeasuredError {
    /// The largest difference of a swept angle, in radians.
    pub error: f64,
    /// How many angles were compared.
    pub angles: u64,
}

/// How many rays are followed for each cell of an orbit axis.
const RAYS: u32 = 128;

/// The orbits of one `e`, and the places on them from which rays start.
#[derive(Debug, Clone, Copy)]
struct OrbitRow {
    e: f64,
    /// The least and the greatest inverse radius.
    places: (f64, f64),
}

/// Measures the largest error of `lookup`, a table made from `spec`. In each chart and for the middle of each cell of
/// its orbit axis, 128 rays are followed to their ends and to one radius each; their starts and radii are spread evenly
/// over the chart's places.
///
/// Both methods are given the same orbits, so that the interpolation alone is compared. The result does not depend on
/// the number of threads.
pub fn measure(spec: &Spec, lookup: &Lookup<'_>) -> MeasuredError {
    let middles =
        |axis: NodeAxis| (1..axis.nodes).map(move |i| 0.5 * (axis.node(i - 1) + axis.node(i)));
    let from_t = |t: f64| (1.0 - t) * (1.0 + t) / CRITICAL_B;
    let mut rows: Vec<OrbitRow> = Vec::new();
    rows.extend(middles(spec.critical_axes().orbit).map(|e| OrbitRow {
        e,
        places: (0.0, 1.0),
    }));
    rows.extend(
        middles(spec.weak_axes().orbit)
            .map(from_t)
            .map(|e| OrbitRow {
                e,
                places: (0.0, WEAK_V * e),
            }),
    );
    rows.extend(
        middles(spec.trapped_axes().orbit)
            .map(from_t)
            .map(|e| OrbitRow {
                e,
                places: (apoapsis(e), 1.0),
            }),
    );
    rows.extend(middles(spec.radial_axes().orbit).map(|b2| OrbitRow {
        e: 1.0 / b2.sqrt(),
        places: (0.0, 1.0),
    }));
    rows.par_iter()
        .map(|&row| along_orbit(row, lookup))
        .reduce(MeasuredError::default, |a, b| MeasuredError {
            error: a.error.max(b.error),
            angles: a.angles + b.angles,
        })
}

/// Returns a little less than the apoapsis' inverse radius u3: `1 − u3 = e²/u3²`, and u3 is at least [`TRAPPED_U`].
fn apoapsis(e: f64) -> f64 {
    (1.0 - e * e / (TRAPPED_U * TRAPPED_U)).max(TRAPPED_U)
}

/// Measures the rays of one `e`. Their starts and radii come from the additive sequence of the plastic number's powers,
/// which fills the square evenly (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
fn along_orbit(row: OrbitRow, lookup: &Lookup<'_>) -> MeasuredError {
    let OrbitRow {
        e,
        places: (least, greatest),
    } = row;
    let mut worst = MeasuredError::default();
    for k in 0..RAYS {
        let fraction = |step: f64| {
            let x = 0.5 + f64::from(k) * step;
            x - x.floor()
        };
        let (p, q) = (
            fraction(0.754_877_666_246_692_7),
            fraction(0.569_840_290_998_053_2),
        );
        // A quarter of the starts and of the radii crowd towards each end, where the splines' errors are largest and
        // most cameras are.
        let place = |x: f64, which: u32| {
            let x = match which % 4 {
                0 => x * x * x,
                1 => 1.0 - x * x * x,
                _ => x,
            };
            least + (greatest - least) * x
        };
        let (u0, u) = (place(p, k), place(q, k / 4));
        let slope2 = e * e - u0 * u0 * (1.0 - u0);
        if slope2 < 0.0 {
            continue;
        }
        for sign in [1.0, -1.0] {
            let Ok(ray) = Ray::new(u0, sign * slope2.sqrt()) else {
                continue;
            };
            let orbit = Orbit::new(ray);
            let mut compare = |found: Option<f64>, truth: Option<f64>| {
                if let (Some(found), Some(truth)) = (found, truth) {
                    worst.error = worst.error.max((found - truth).abs());
                    worst.angles += 1;
                }
            };
            compare(Some(lookup.to_end(&orbit)), Some(Exact.to_end(&orbit)));
            // At the start's own radius the error of one place counts twice: the most that it can add up to.
            for u in [u, u0] {
                let (table, exact) = (lookup.crossings(&orbit, u), Exact.crossings(&orbit, u));
                compare(table.inbound, exact.inbound);
                compare(table.outbound, exact.outbound);
            }
        }
    }
    worst
}
