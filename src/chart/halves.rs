//! The exact method against itself: one integral, and the same in two parts.

use crate::orbit::exact::Exact;
use crate::orbit::invariants::{Orbit, OrbitPoint};
use crate::orbit::path::SweptAngles;
use crate::orbit::turning_u;

/// The exact angle from the start of `orbit` to `to`, straight or over the turning point, as the sum of two parts. They
/// meet half way (in u) to where the ray goes first: `to`, or the turning point.
pub(super) fn in_two_parts(orbit: &Orbit, to: OrbitPoint, over_turning_point: bool) -> f64 {
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
    // Where there is no room for a middle, the whole is all there is.
    match orbit.point_at(0.5 * (start.u + first)) {
        Some(middle) => Exact.direct(orbit, start, middle) + rest(middle),
        None => rest(start),
    }
}
