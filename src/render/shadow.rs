//! How much of a pixel the hole's shadow covers.

use super::section::Section;
use crate::scene::{Affine, View};

/// Returns the share of a pixel's square that the shadow covers, the pixel's centre at a place in pixels from the
/// picture's left and its top. `critical` is κ of the critical ray.
///
/// The shadow is where `f = z − κ_c s` is positive. Its edge is taken as straight within the pixel.
pub(super) fn share(view: &View, critical: f64, (x, y): (f64, f64)) -> f64 {
    let ray = view.ray_at(view.x_at(x), view.y_at(y));
    let s = ray.transverse();
    let f = ray.z - critical * s;
    let change = |part: fn(Affine) -> f64| {
        let s = (ray.ta * part(view.ta()) + ray.tb * part(view.tb())) / s;
        (part(view.z()) - critical * s) * view.pixel_side()
    };
    let (x, y) = (change(|a| a.per_x), change(|a| -a.per_y));
    let slope = (x * x + y * y).sqrt();
    let distance = -f / slope;
    if distance.abs() < 1.0 {
        1.0 - Section::new((x / slope, y / slope), (1.0, 1.0)).share_below(distance)
    } else {
        f64::from(u8::from(f > 0.0))
    }
}
