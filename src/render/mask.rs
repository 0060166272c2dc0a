//! Frames with hard edges: white where a pixel's centre sees the disk, two comparisons a pixel and order, and those only
//! along the disk's edges.

use super::tiles::{Filler, fill_frame};
use super::{RenderError, blank, each_pixel};
use crate::isoradial::{Isoradials, Open};
use crate::scene::View;

/// What is not linear of the edges over a tile, in pixels, below which it is cut into rows: measured as the cheapest.
pub(super) const STRAIGHT_TILE: f64 = 1.2;

/// White: the disk.
pub const WHITE: u8 = 255;

/// The frame's pixels, row by row from the top, on all threads of the current rayon pool.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let mut pixels = blank(view)?;
    render_into(view, curves, &mut pixels, view.width() as usize)?;
    Ok(pixels)
}

/// The frame, drawn into a caller's buffer: row j begins at `j stride`, whatever lies between the rows' ends is left
/// as it is. Nothing is allocated.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
pub fn render_into(
    view: &View,
    curves: &Isoradials,
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    let filler = Filler {
        view,
        curves,
        reach: 0.0,
        straight: STRAIGHT_TILE,
        pixel: |column: usize, row: usize, _: Option<&Open>| value(view, curves, column, row),
    };
    fill_frame(&filler, pixels, stride)
}

/// The same pixels, each asked by itself.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render_every_pixel(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    each_pixel(view, |column, row| value(view, curves, column, row))
}

fn value(view: &View, curves: &Isoradials, column: usize, row: usize) -> u8 {
    if sees(view, curves, (column as f64 + 0.5, row as f64 + 0.5)) {
        WHITE
    } else {
        0
    }
}

/// Whether the disk is seen at a place of the picture, in pixels from its left and its top.
#[inline]
pub(super) fn sees(view: &View, curves: &Isoradials, (column, row): (f64, f64)) -> bool {
    let ray = view.ray_at(view.x_at(column), view.y_at(row));
    let s = ray.transverse();
    // Straight at the hole or away from it: no plane, no disk.
    s > 0.0 && curves.meets(ray.z, s, view.n_p().abs() * s, view.plane_slope() * ray.ta)
}
