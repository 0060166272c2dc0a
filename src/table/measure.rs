//! How wrong a table is: its swept angles against the exact method's, off the grid.

use rayon::prelude::*;

use super::charts::{CRITICAL_B, LOWER_E2};
use super::lookup::Lookup;
use super::spec::Spec;
use super::spline::Axis;
use crate::orbit::Ray;
use crate::orbit::exact::Exact;
use crate::orbit::invariants::Orbit;
use crate::orbit::path::SweptAngles;

/// An error, and how many angles it was measured on.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Measured {
    /// The largest difference of a swept angle, in radians.
    pub error: f64,
    /// How many angles were compared.
    pub angles: u64,
}

/// Rays per cell of an orbit axis.
const RAYS: u32 = 48;

/// The largest error of `lookup` (a table made after `spec`): for the middle of every cell of every orbit axis, some
/// rays spread evenly over the starts that such an orbit has, each followed to its end and to a radius of its own.
///
/// Both methods are given the same orbit, so that what is compared is the interpolation alone. The result depends on nothing else, thread
/// count included.
pub fn measure(spec: &Spec, lookup: &Lookup<'_>) -> Measured {
    let middles =
        |axis: Axis| (1..axis.nodes).map(move |i| 0.5 * (axis.node(i - 1) + axis.node(i)));
    let from_t = |t: f64| (1.0 - t) * (1.0 + t) / CRITICAL_B;
    let mut slopes: Vec<f64> = Vec::new();
    slopes.extend(middles(spec.critical_axes().orbit));
    slopes.extend(middles(spec.weak_axes().orbit).map(from_t));
    slopes.extend(middles(spec.trapped_axes().orbit).map(from_t));
    slopes.extend(middles(spec.radial_axes().orbit).map(|b2: f64| 1.0 / b2.sqrt()));
    // The borders themselves, where errors are largest.
    slopes.extend([LOWER_E2 * 0.999_999, LOWER_E2 * 1.000_001].map(f64::sqrt));
    slopes
        .par_iter()
        .map(|&e| along_orbit(e, lookup))
        .reduce(Measured::default, |a, b| Measured {
            error: a.error.max(b.error),
            angles: a.angles + b.angles,
        })
}

/// The rays of one `e`: starts and radii from the additive sequence of the plastic number's powers, which fills the square evenly
/// (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
fn along_orbit(e: f64, lookup: &Lookup<'_>) -> Measured {
    let mut worst = Measured::default();
    for k in 0..RAYS {
        let fraction = |step: f64| {
            let x = 0.5 + f64::from(k) * step;
            x - x.floor()
        };
        let (p, q) = (
            fraction(0.754_877_666_246_692_7),
            fraction(0.569_840_290_998_053_2),
        );
        // Half of the starts crowd towards infinity, where cameras stand.
        let u0 = if k % 2 == 0 { p } else { p * p * p * e };
        let slope2 = e * e - u0 * u0 * (1.0 - u0);
        if slope2 < 0.0 {
            continue;
        }
        for sign in [1.0, -1.0] {
            let Ok(ray) = Ray::new(u0, sign * slope2.sqrt()) else {
                continue;
            };
            let orbit = Orbit::new(ray);
            let (table, exact) = (lookup.crossings(&orbit, q), Exact.crossings(&orbit, q));
            let pairs = [
                (Some(lookup.to_end(&orbit)), Some(Exact.to_end(&orbit))),
                (table.inbound, exact.inbound),
                (table.outbound, exact.outbound),
            ];
            for (found, truth) in pairs {
                if let (Some(found), Some(truth)) = (found, truth) {
                    worst.error = worst.error.max((found - truth).abs());
                    worst.angles += 1;
                }
            }
        }
    }
    worst
}
