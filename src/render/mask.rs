//! Frames with hard edges: white where a pixel's centre sees the disk, else black.

pub use rayon::prelude::*;

pub use super::WHITE;
use super::error::{RenderError, blank};
use super::frame::{Threads, Workspace};
use crate::isoradial::Isoradials;
use crate::scene::View;

/// Returns the frame's pixels, row by row from the top, drawn on all threads of the current rayon pool.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let mut pixels = blank(view)?;
    render_into(view, curves, &mut pixels, view.width() as usize)?;
    Ok(pixels)
}

/// Draws the frame into a caller's buffer, on all threads of the current rayon pool: row j begins at `j stride`.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
pub fn render_into(
    view: &View,
    curves: &Isoradials,
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    Workspace::default().draw(view, curves, false, Threads::All, pixels, stride)
}

/// Returns the same pixels, each asked by itself: without the outline.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render_every_pixel(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let mut pixels = blank(view)?;
    fill_every_pixel(view, curves, &mut pixels, view.width() as usize);
    Ok(pixels)
}

/// Fills a buffer that the frame fits, each pixel asked by itself.
pub(super) fn fill_every_pixel(view: &View, curves: &Isoradials, pixels: &mut [u8], stride: usize) {
    let width = view.width() as usize;
    let rows = pixels.par_chunks_mut(stride).enumerate();
    rows.for_each(|(row, pixels)| {
        for (column, pixel) in pixels[..width].iter_mut().enumerate() {
            let sees = sees(view, curves, (column as f64 + 0.5, row as f64 + 0.5));
            *pixel = if sees { WHITE } else { 0 };
        }
    });
}

/// Whether the disk is seen at a place of the picture, in pixels from its left and its top.
#[inline]
pub(super) fn sees(view: &View, curves: &Isoradials, (column, row): (f64, f64)) -> bool {
    let ray = view.ray_at(view.x_at(column), view.y_at(row));
    let s = ray.transverse();
    // A ray straight at the hole or away from it has no plane and meets no disk.
    s > 0.0 && curves.meets(ray.z, s, view.n_p().abs() * s, view.plane_slope() * ray.ta)
}
