//! What a place of the picture sees, from the curves alone.

use rayon::prelude::*;

use super::frame::MaskSample;
use crate::isoradial::Isoradials;
use crate::scene::{Region, View};

/// Fills a buffer that the frame fits, evaluating each pixel by itself.
pub(super) fn fill_every_pixel<T: MaskSample>(
    view: &View,
    curves: &Isoradials,
    pixels: &mut [T],
    stride: usize,
) {
    let Region {
        left, top, width, ..
    } = view.region();
    let rows = pixels.par_chunks_mut(stride).enumerate();
    rows.for_each(|(row, pixels)| {
        for (column, pixel) in pixels[..width as usize].iter_mut().enumerate() {
            let place = (
                (left as usize + column) as f64 + 0.5,
                (top as usize + row) as f64 + 0.5,
            );
            let seen = front(view, curves, place);
            *pixel = if seen.is_some() {
                T::WHITE
            } else {
                T::default()
            };
        }
    });
}

/// Returns the order in front at a place of the picture, in pixels from its left and its top.
#[inline]
pub(super) fn front(view: &View, curves: &Isoradials, (column, row): (f64, f64)) -> Option<u32> {
    if !view.shows((column, row)) {
        return None;
    }
    let ray = view.ray_at(view.x_at(column), view.y_at(row));
    let s = ray.transverse();
    // A ray straight at the hole or away from it has no plane and meets no disk.
    if s > 0.0 {
        curves.front(ray.z, s, view.n_p().abs() * s, view.plane_slope() * ray.ta)
    } else {
        None
    }
}

/// Returns the share of what a pixel has within a fisheye's rim of which `sees` holds. The pixel's upper left corner is
/// at a place, and its centre within the rim.
///
/// Where a few places agree they stand for all. That is so but where an edge passes straight behind the camera.
pub(super) fn share_within_rim(
    view: &View,
    (column, row): (f64, f64),
    sees: impl Fn((f64, f64)) -> bool,
) -> f64 {
    let counted = |side: u32| {
        let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
        let places = (0..side * side).map(|i| (column + offset(i % side), row + offset(i / side)));
        let within = places.filter(|place| view.shows(*place));
        within.fold((0_u32, 0_u32), |(seen, all), place| {
            (seen + u32::from(sees(place)), all + 1)
        })
    };
    let few = counted(3);
    let (seen, all) = if few.0 == 0 || few.0 == few.1 {
        few
    } else {
        counted(16)
    };
    f64::from(seen) / f64::from(all)
}
