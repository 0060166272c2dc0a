//! Frames with hard edges: white where a pixel's centre sees the disk, two comparisons a pixel and order, and those only
//! along the disk's edges.

use super::blocks::{Asked, Canvas};
use super::group::Group;
use super::tiles::{Kind, Pixels, Threads, fill_frame};
use super::{RenderError, blank, each_pixel};
use crate::isoradial::{Isoradials, Open};
use crate::lanes::Level;
use crate::scene::View;

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

/// The frame, on all threads of the current rayon pool, drawn into a caller's buffer: row j begins at `j stride`, whatever lies between the rows' ends is left
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
    render_on(view, curves, Threads::All, pixels, stride)
}

/// The same, on some threads.
pub(super) fn render_on(
    view: &View,
    curves: &Isoradials,
    threads: Threads,
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    let kind = Hard { view, curves };
    fill_frame(view, curves, kind, threads, pixels, stride)
}

/// The same pixels, each asked by itself.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render_every_pixel(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let pixels = Hard { view, curves };
    each_pixel(view, |column, row| pixels.value(column, row, None))
}

/// Pixels that are what their centres see.
pub(super) struct Hard<'a> {
    view: &'a View,
    curves: &'a Isoradials,
}

impl Pixels for Hard<'_> {
    const KIND: Kind = Kind {
        reach: 0.0,
        // Measured as the cheapest.
        doubt: 0.1,
        bend: f64::INFINITY,
        margin: 0.0,
        smallest: 4,
    };

    fn value(&self, column: usize, row: usize, _: Option<Open>) -> u8 {
        let centre = (column as f64 + 0.5, row as f64 + 0.5);
        if sees(self.view, self.curves, centre) {
            WHITE
        } else {
            0
        }
    }

    fn draw_along(
        &self,
        _: Level,
        _: (&Group, usize),
        (left, top): (usize, usize),
        asked: &Asked,
        canvas: &mut Canvas<'_>,
    ) {
        for &(i, j) in asked.pixels() {
            let (i, j) = (usize::from(i), usize::from(j));
            canvas.pixels[j * canvas.stride + i] = self.value(left + i, top + j, None);
        }
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
