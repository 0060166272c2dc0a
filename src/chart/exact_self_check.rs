//! The exact method's own error: one elliptic integral against the sum of two over the same range.

use crate::orbit::exact::Exact;
use crate::orbit::invariants::{Orbit, OrbitPoint};
use crate::orbit::path::SweptAngles;
use crate::orbit::turning_u;

/// Computes the exact angle from the start of `orbit` to `to` as a sum of two integrals. The path to `to` is direct, or
/// leads over the turning point. The two integrals meet halfway, in u = 1/r, to where the ray goes first: `to` or the
/// turning point.
pub(super) fn angle_in_two_parts(orbit: &Orbit, to: OrbitPoint, over_turning_point: bool) -> f64 {
    let start = orbit.start;
    let first = if over_turning_point {
        turning_u(orbit)
    } else {
        to.u
    };
    let rest = |from: OrbitPoint| {
        if over_turning_point {
            Exact.around(orbit, from, to)
        } else {
            Exact.direct(orbit, from, to)
        }
    };
    // Without a double between the two ends, one integral covers the whole range.
    match orbit.point_at(0.5 * (start.u + first)) {
        Some(middle) => Exact.direct(orbit, start, middle) + rest(middle),
        None => rest(start),
    }
}
