//! How much of a pixel the hole's shadow covers.

use core::f64::consts::FRAC_1_SQRT_2;

use super::section::Section;
use crate::scene::{PixelRay, View};

/// An edge is taken as straight within a pixel where it bends as a circle of so many pixels or a larger one: what that
/// leaves out is a chord³/12 over the radius, at most 0.004 of the pixel.
const STRAIGHT: f64 = 64.0;

/// Lines across a pixel along which a bent edge is found.
const LINES: u32 = 16;

/// Returns the share of a pixel's square that the shadow covers, the pixel's centre at a place in pixels from the
/// picture's left and its top. `critical` is κ of the critical ray.
///
/// The shadow is where `f = z − κ_c s` is positive: a cone about the hole's direction, or, where `κ_c` is negative, all
/// but a cone about the direction away from it.
pub(super) fn share(view: &View, critical: f64, (x, y): (f64, f64)) -> f64 {
    let side = view.pixel_side();
    let point = (view.x_at(x), view.y_at(y));
    let ray = view.ray_at(point.0, point.1);
    let s = ray.transverse();
    let f = ray.z - critical * s;
    let is_shadow = f64::from(u8::from(f > 0.0));
    let [across, down] = view.changes_at(point.0, point.1).map(|change| {
        let s = (ray.ta * change.ta + ray.tb * change.tb) / s;
        change.z - critical * s
    });
    let radius = 1.0 / ((1.0 + critical * critical).sqrt() * side);
    if radius < STRAIGHT {
        // The slopes of z and s are at most 1.
        let most = (1.0 + critical.abs()) * side * FRAC_1_SQRT_2;
        return if f.abs() > most {
            is_shadow
        } else {
            bent_share(view, critical, (x, y), across.abs() < down.abs())
        };
    }
    let slope = (across * across + down * down).sqrt();
    let distance = -f / slope;
    if distance.abs() < 1.0 {
        1.0 - Section::new((across / slope, down / slope), (1.0, 1.0)).share_below(distance)
    } else {
        is_shadow
    }
}

/// Returns whether the shadow covers a place.
pub(super) fn covers(view: &View, critical: f64, (x, y): (f64, f64)) -> bool {
    let ray = view.ray_at(view.x_at(x), view.y_at(y));
    ray.z >= critical * ray.transverse()
}

/// Returns the share of a pixel as the mean over lines across the edge, upright or level ones, on each of which it is
/// exact but for what bends the lines themselves.
fn bent_share(view: &View, critical: f64, (x, y): (f64, f64), upright: bool) -> f64 {
    let square = critical * critical;
    let product = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] - square * (a[1] * b[1] + a[2] * b[2]);
    let mut sum = 0.0;
    for line in 0..LINES {
        let offset = (f64::from(line) + 0.5) / f64::from(LINES) - 0.5;
        let (x, y) = if upright {
            (x + offset, y)
        } else {
            (x, y + offset)
        };
        let (x, y) = (view.x_at(x), view.y_at(y));
        let parts = |PixelRay { z, ta, tb }| [z, ta, tb];
        let at = parts(view.ray_at(x, y));
        let along = parts(view.changes_at(x, y)[usize::from(upright)]);
        let z = at[0];
        // The edge of the cone is where z² − κ² s² is 0, and z has the sign of κ.
        let (a, b, c) = (product(along, along), product(at, along), product(at, at));
        let root = -(b + (b * b - a * c).sqrt().copysign(b));
        let mut ends = [-0.5, root / a, c / root, -z / along[0], 0.5];
        for end in &mut ends {
            *end = if end.abs() < 0.5 {
                *end
            } else {
                0.5_f64.copysign(*end)
            };
        }
        ends.sort_unstable_by(f64::total_cmp);
        for pair in ends.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let z = z + middle * along[0];
            let is_cone =
                (z > 0.0) == (critical >= 0.0) && c + middle * (2.0 * b + middle * a) > 0.0;
            sum += if is_cone { pair[1] - pair[0] } else { 0.0 };
        }
    }
    let cone = sum / f64::from(LINES);
    if critical < 0.0 { 1.0 - cone } else { cone }
}
