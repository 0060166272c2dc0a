//! A frame from isoradial curves: two comparisons a pixel and order, and those only along the disk's edges.

use rayon::prelude::*;

use super::{RenderError, blank};
use crate::isoradial::{Bundle, Isoradials, Sight, Verdict};
use crate::scene::{Affine, Scene, View};

/// White: the disk.
pub const WHITE: u8 = 255;

/// What an edge may be off by, in pixels, where nothing else is asked for.
pub const TOLERANCE: f64 = 1e-3;

/// What the curves of `scene` are to be drawn for.
pub fn sight(scene: &Scene, view: &View) -> Sight {
    // A pixel spans the least angle where the picture plane is farthest from its centre: cos² there.
    let (x, y) = (view.x_at(0.0), view.y_at(0.0));
    let pitch = (view.y_at(0.0) - view.y_at(1.0)).abs();
    Sight {
        u0: view.u0(),
        slope_scale: view.slope_scale(),
        u_inner: 1.0 / scene.disk().inner,
        u_outer: 1.0 / scene.disk().outer,
        pixel_angle: pitch / (1.0 + x * x + y * y),
        tolerance: TOLERANCE,
    }
}

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
    /// `|n·p̂|`.
    n_p: f64,
    /// `D = n_a t_a`: with n or its opposite for the disk's normal the plane is the same; of the two the one away
    /// from the camera has N ≥ 0.
    n_a: f64,
}

impl<'a> Frame<'a> {
    fn new(view: &'a View, curves: &'a Isoradials) -> Self {
        let n_a = if view.n_p() > 0.0 {
            -view.n_a()
        } else {
            view.n_a()
        };
        Self {
            view,
            curves,
            n_p: view.n_p().abs(),
            n_a,
        }
    }

    /// Fills a tile of side `side` or less; `rows` are those of its band, which begins at row `first_row` of the
    /// frame.
    fn fill(&self, rows: &mut [u8], first_row: usize, tile: Tile, side: usize) {
        let verdict = self
            .bundle(first_row, tile)
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

    /// Bounds of a tile's rays, from the ray at its centre and the circle about it that the tile lies in; none where
    /// the tile may hold the ray straight at the hole or straight away from it.
    fn bundle(&self, first_row: usize, tile: Tile) -> Option<Bundle> {
        let (z, ta, tb) = (self.view.z(), self.view.ta(), self.view.tb());
        let (left, top) = (
            self.view.x_at(tile.left as f64),
            self.view.y_at((first_row + tile.top) as f64),
        );
        let right = self.view.x_at((tile.left + tile.width) as f64);
        let bottom = self.view.y_at((first_row + tile.top + tile.height) as f64);
        let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
        let (half_x, half_y) = (0.5 * (right - left), 0.5 * (top - bottom));
        let reach = |affine: Affine| (affine.per_x * half_x).abs() + (affine.per_y * half_y).abs();
        let (z_centre, ta_centre, tb_centre) = (z.at(x, y), ta.at(x, y), tb.at(x, y));
        let s = (ta_centre * ta_centre + tb_centre * tb_centre).sqrt();
        let (reach_a, reach_b) = (reach(ta), reach(tb));
        let radius = (reach_a * reach_a + reach_b * reach_b).sqrt();
        let (s_least, s_most) = (s - radius, s + radius);
        if s_least <= 0.0 {
            return None;
        }
        let (z_least, z_most) = (z_centre - reach(z), z_centre + reach(z));
        let kappa = (
            z_least / if z_least < 0.0 { s_least } else { s_most },
            z_most / if z_most < 0.0 { s_most } else { s_least },
        );
        // The gradient of t_a/s is |t_b|/s² ≤ 1/s.
        let (cosine, spread) = (ta_centre / s, radius / s_least);
        let (least, most) = ((cosine - spread).max(-1.0), (cosine + spread).min(1.0));
        let over_n = |d: f64| {
            if self.n_p > 0.0 {
                d / self.n_p
            } else {
                f64::INFINITY.copysign(d)
            }
        };
        let ends = (over_n(self.n_a * least), over_n(self.n_a * most));
        let cotangent = if self.n_a < 0.0 {
            (ends.1, ends.0)
        } else {
            ends
        };
        Some(Bundle { kappa, cotangent })
    }
}
