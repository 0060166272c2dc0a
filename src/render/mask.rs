//! Frames with hard edges: white where a pixel's centre sees the disk, else black.

pub use super::WHITE;
use super::centre::fill_every_pixel;
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
    render_into(view, curves, &mut pixels, view.region().width as usize)?;
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

/// Returns the same pixels, evaluated one by one, without the outline: the truth that [`render`] is tested against.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render_every_pixel(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let mut pixels = blank(view)?;
    fill_every_pixel(view, curves, &mut pixels, view.region().width as usize);
    Ok(pixels)
}
