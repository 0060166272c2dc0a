//! A frame from isoradial curves: two comparisons a pixel and order, and those only along the disk's edges.

use rayon::prelude::*;

use super::{RenderError, blank};
use crate::isoradial::{Bundle, Isoradials, Verdict};
use crate::scene::View;

/// White: the disk.
pub const WHITE: u8 = 255;

/// The side of the largest tiles, in pixels; [`SPLIT`]² of the next smaller ones fill each.
const TILE: usize = 64;

/// Into how many tiles a tile is split along each side.
const SPLIT: usize = 4;

/// The side of the smallest tiles: below it each pixel is asked by itself.
const SMALLEST: usize = 4;

/// The frame's pixels, row by row from the top, on all threads of the current rayon pool.
///
/// Tiles whose rays all meet the same are filled at once; the others are split, down to single pixels along the
/// disk's edges.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let frame = Frame::new(view, curves);
    let width = view.width() as usize;
    let mut pixels = blank(view)?;
    pixels
        .par_chunks_mut(width * TILE)
        .enumerate()
        .for_each(|(band, rows)| {
            let height = rows.len() / width;
            for left in (0..width).step_by(TILE) {
                let tile = Tile {
                    left,
                    top: 0,
                    width: TILE.min(width - left),
                    height,
                };
                frame.fill(rows, band * TILE, tile, TILE);
            }
        });
    Ok(pixels)
}

/// The same pixels, each asked by itself.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render_every_pixel(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let frame = Frame::new(view, curves);
    let width = view.width() as usize;
    let mut pixels = blank(view)?;
    pixels
        .par_chunks_exact_mut(width)
        .enumerate()
        .for_each(|(j, row)| {
            frame.fill_pixels(
                row,
                j,
                Tile {
                    left: 0,
                    top: 0,
                    width,
                    height: 1,
                },
            );
        });
    Ok(pixels)
}

/// A rectangle of pixels; `top` counts from the first row of its band.
#[derive(Debug, Clone, Copy)]
struct Tile {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// What all pixels of a frame share.
struct Frame<'a> {
    view: &'a View,
    curves: &'a Isoradials,
    /// N over s.
    n_p: f64,
    /// D over `t_a`.
    n_a: f64,
}

impl<'a> Frame<'a> {
    fn new(view: &'a View, curves: &'a Isoradials) -> Self {
        Self {
            view,
            curves,
            n_p: view.n_p().abs(),
            n_a: view.plane_slope(),
        }
    }

    /// Fills a tile of side `side` or less; `rows` are those of its band, which begins at row `first_row` of the
    /// frame.
    fn fill(&self, rows: &mut [u8], first_row: usize, tile: Tile, side: usize) {
        let (left, top) = (tile.left as f64, (first_row + tile.top) as f64);
        let columns = (left, left + tile.width as f64);
        let rows_of_tile = (top, top + tile.height as f64);
        let verdict = Bundle::new(self.view, columns, rows_of_tile)
            .map_or(Verdict::Mixed, |bundle| self.curves.verdict(&bundle));
        let width = self.view.width() as usize;
        match verdict {
            // The pixels are black to begin with.
            Verdict::Miss => {}
            Verdict::Hit => {
                for row in rows
                    .chunks_exact_mut(width)
                    .skip(tile.top)
                    .take(tile.height)
                {
                    row[tile.left..tile.left + tile.width].fill(WHITE);
                }
            }
            Verdict::Mixed if side <= SMALLEST => self.fill_pixels(rows, first_row, tile),
            Verdict::Mixed => {
                let side = side / SPLIT;
                for top in (tile.top..tile.top + tile.height).step_by(side) {
                    for left in (tile.left..tile.left + tile.width).step_by(side) {
                        let width = side.min(tile.left + tile.width - left);
                        let height = side.min(tile.top + tile.height - top);
                        self.fill(
                            rows,
                            first_row,
                            Tile {
                                left,
                                top,
                                width,
                                height,
                            },
                            side,
                        );
                    }
                }
            }
        }
    }

    fn fill_pixels(&self, rows: &mut [u8], first_row: usize, tile: Tile) {
        let (z, ta, tb) = (self.view.z(), self.view.ta(), self.view.tb());
        let width = self.view.width() as usize;
        for (j, row) in rows
            .chunks_exact_mut(width)
            .enumerate()
            .skip(tile.top)
            .take(tile.height)
        {
            let y = self.view.y_at((first_row + j) as f64 + 0.5);
            for (i, pixel) in row.iter_mut().enumerate().skip(tile.left).take(tile.width) {
                let x = self.view.x_at(i as f64 + 0.5);
                let (z, ta, tb) = (z.at(x, y), ta.at(x, y), tb.at(x, y));
                let s = (ta * ta + tb * tb).sqrt();
                // Straight at the hole or away from it: no plane, no disk.
                if s > 0.0 && self.curves.meets(z, s, self.n_p * s, self.n_a * ta) {
                    *pixel = WHITE;
                }
            }
        }
    }
}
