//! A frame from isoradial curves: two comparisons a pixel and order, and those only along the disk's edges.

use rayon::prelude::*;

use super::tiles::{Band, Filler, TILE, Tile};
use super::{RenderError, blank};
use crate::isoradial::Isoradials;
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

/// The frame, drawn into a caller's buffer: row j begins at `j stride`, whatever lies between the rows' ends is left
/// as it is. Nothing is allocated.
///
/// Tiles whose rays all meet the same are filled at once; the others are split, down to single pixels along the
/// disk's edges.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
pub fn render_into(
    view: &View,
    curves: &Isoradials,
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    let (width, height) = (view.width() as usize, view.height() as usize);
    let needed = stride.saturating_mul(height - 1).saturating_add(width);
    if stride < width || pixels.len() < needed {
        return Err(RenderError::Buffer {
            width,
            height,
            stride,
            bytes: pixels.len(),
        });
    }
    let sample = Sample::new(view, curves);
    let filler = Filler {
        view,
        curves,
        reach: 0.0,
        pixel: |column: usize, row: usize| sample.at(column, row),
    };
    pixels[..needed]
        .par_chunks_mut(stride * TILE)
        .enumerate()
        .for_each(|(index, pixels)| {
            let first = index * TILE;
            let height = TILE.min(height - first);
            let mut band = Band {
                pixels,
                stride,
                first,
            };
            band.blacken(height, width);
            for left in (0..width).step_by(TILE) {
                let tile = Tile {
                    left,
                    top: 0,
                    width: TILE.min(width - left),
                    height,
                };
                filler.fill(&mut band, tile, None);
            }
        });
    Ok(())
}

/// The same pixels, each asked by itself.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render_every_pixel(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let sample = Sample::new(view, curves);
    let width = view.width() as usize;
    let mut pixels = blank(view)?;
    pixels
        .par_chunks_exact_mut(width)
        .enumerate()
        .for_each(|(row, pixels)| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                *pixel = sample.at(column, row);
            }
        });
    Ok(pixels)
}

/// What the centres of pixels see.
struct Sample<'a> {
    view: &'a View,
    curves: &'a Isoradials,
    /// N over s.
    n_p: f64,
    /// D over `t_a`.
    n_a: f64,
}

impl<'a> Sample<'a> {
    fn new(view: &'a View, curves: &'a Isoradials) -> Self {
        Self {
            view,
            curves,
            n_p: view.n_p().abs(),
            n_a: view.plane_slope(),
        }
    }

    /// The value of a pixel.
    #[inline]
    fn at(&self, column: usize, row: usize) -> u8 {
        let x = self.view.x_at(column as f64 + 0.5);
        let y = self.view.y_at(row as f64 + 0.5);
        let ray = self.view.ray_at(x, y);
        let s = ray.transverse();
        // Straight at the hole or away from it: no plane, no disk.
        if s > 0.0 && self.curves.meets(ray.z, s, self.n_p * s, self.n_a * ray.ta) {
            WHITE
        } else {
            0
        }
    }
}
