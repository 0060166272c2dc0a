//! Where a frame changes: tiles that are wholly within the disk or wholly off it are found and filled, what is left are
//! the pixels along its edges.
//!
//! A tile is bounded as a [`Patch`] (whose page derives the bound); where that decides nothing it is split, and only
//! the edges that were open over it are looked at again. In tiles so small that what is not linear in their pixels is
//! a small share of a pixel, each row of pixels is cut at the edges' lines: into pixels that are decided for certain,
//! and those that are asked one by one.

use rayon::prelude::*;

use super::RenderError;
use crate::isoradial::{Bundle, Isoradials, Line, Open, Patch, Uniform, Verdict};
use crate::render::mask::WHITE;
use crate::scene::View;

/// The side of the largest tiles, in pixels.
const TILE: usize = 64;

/// The side of the smallest tiles.
const SMALLEST: usize = 4;

/// A band of a frame's rows.
struct Band<'a> {
    /// Their pixels.
    pixels: &'a mut [u8],
    /// From one row to the next.
    stride: usize,
    /// The first row's place in the frame.
    first: usize,
}

/// A rectangle of a band's pixels.
#[derive(Debug, Clone, Copy)]
struct Tile {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// How a frame is filled.
pub(super) struct Filler<'a, P> {
    pub(super) view: &'a View,
    pub(super) curves: &'a Isoradials,
    /// How far from its centre a pixel looks to either side, in pixels: 0 for what its centre sees.
    pub(super) reach: f64,
    /// A tile is cut into rows where what is not linear of its edges is below this, in pixels: a compromise between
    /// tiles and pixels to be asked.
    pub(super) straight: f64,
    /// The value of the pixel (column, row) of the frame; the edges given are all that are open over it, and some
    /// more.
    pub(super) pixel: P,
}

/// Fills a frame, on all threads of the current rayon pool: row j begins at `j stride` of `pixels`.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
pub(super) fn fill_frame<P: Fn(usize, usize, Option<&Open>) -> u8 + Sync>(
    filler: &Filler<'_, P>,
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    let (width, height) = (filler.view.width() as usize, filler.view.height() as usize);
    let needed = stride.saturating_mul(height - 1).saturating_add(width);
    if stride < width || pixels.len() < needed {
        return Err(RenderError::Buffer {
            width,
            height,
            stride,
            bytes: pixels.len(),
        });
    }
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

/// Finds and fills the tiles that are all alike, and leaves the pixels along the disk's edges as they come: what of a
/// frame's time is spent on finding its edges. `smooth` as [`coverage`](super::coverage) does it, or as
/// [`mask`](super::mask) does.
///
/// # Errors
/// [`RenderError::Buffer`] for a buffer that the frame does not fit.
pub fn cull(
    view: &View,
    curves: &Isoradials,
    smooth: bool,
    pixels: &mut [u8],
) -> Result<(), RenderError> {
    let filler = Filler {
        view,
        curves,
        reach: if smooth { 0.5 } else { 0.0 },
        straight: if smooth {
            super::coverage::STRAIGHT_TILE
        } else {
            super::mask::STRAIGHT_TILE
        },
        pixel: |_: usize, _: usize, _: Option<&Open>| 0,
    };
    fill_frame(&filler, pixels, view.width() as usize)
}

impl<P: Fn(usize, usize, Option<&Open>) -> u8> Filler<'_, P> {
    /// Fills a tile of a band, all of whose pixels are black.
    fn fill(&self, band: &mut Band<'_>, tile: Tile, before: Option<&Open>) {
        let top = band.first + tile.top;
        let columns = (tile.left as f64, (tile.left + tile.width) as f64);
        let rows = (top as f64, (top + tile.height) as f64);
        let half = (0.5 * tile.width as f64, 0.5 * tile.height as f64);
        let Some(patch) = Patch::new(self.view, self.curves, columns, rows) else {
            return self.fill_bundle(band, tile);
        };
        match self.curves.patched(&patch, half, before) {
            Err(Uniform::Miss) => {}
            Err(Uniform::Hit) => band.whiten(tile),
            Ok(open) if is_straight(&open, half, self.straight) => self.cut(band, tile, &open),
            Ok(open) if tile.is_smallest() => self.ask(band, tile, Some(&open)),
            Ok(open) => self.split(band, tile, Some(&open)),
        }
    }

    /// Fills a tile whose rays are in both quarter turns, or all about the hole's direction.
    fn fill_bundle(&self, band: &mut Band<'_>, tile: Tile) {
        // With half a pixel more on each side, where pixels look to either side of their centres: what is on one side
        // of an edge there is so too for lines that take the edge's place.
        let (left, top) = (
            tile.left as f64 - self.reach,
            (band.first + tile.top) as f64 - self.reach,
        );
        let (wide, high) = (
            tile.width as f64 + 2.0 * self.reach,
            tile.height as f64 + 2.0 * self.reach,
        );
        let bundle = Bundle::new(self.view, (left, left + wide), (top, top + high));
        match bundle.map_or(Verdict::Mixed, |bundle| self.curves.verdict(&bundle)) {
            Verdict::Miss => {}
            Verdict::Hit => band.whiten(tile),
            Verdict::Mixed if tile.is_smallest() => self.ask(band, tile, None),
            Verdict::Mixed => self.split(band, tile, None),
        }
    }

    fn split(&self, band: &mut Band<'_>, tile: Tile, open: Option<&Open>) {
        // Halves, the first of them rounded up to a power of two.
        let half = |side: usize| side.next_power_of_two() / 2;
        let (width, height) = (half(tile.width).max(1), half(tile.height).max(1));
        for top in (tile.top..tile.top + tile.height).step_by(height) {
            for left in (tile.left..tile.left + tile.width).step_by(width) {
                let part = Tile {
                    left,
                    top,
                    width: width.min(tile.left + tile.width - left),
                    height: height.min(tile.top + tile.height - top),
                };
                self.fill(band, part, open);
            }
        }
    }

    /// Cuts each row of a tile at its open edges.
    fn cut(&self, band: &mut Band<'_>, tile: Tile, open: &Open) {
        let (half_width, half_height) = (0.5 * tile.width as f64, 0.5 * tile.height as f64);
        for j in 0..tile.height {
            let dy = j as f64 + 0.5 - half_height;
            let cuts = |line: &Line| Cut::new(line, dy, half_width, half_height, self.reach);
            let y = band.first + tile.top + j;
            let row = band.row(tile.top + j, tile.left, tile.width);
            let mut possible: [(usize, usize); 12] = [(0, 0); 12];
            for (possible, band) in possible.iter_mut().zip(open.bands()) {
                let (mut certain, mut perhaps) = ((0, tile.width), (0, tile.width));
                // Within the band is g ≥ 0 at its outer edge and g ≤ 0 at its inner one.
                if let Some(line) = &band.outer {
                    cuts(line).keep_positive(tile.width, &mut certain, &mut perhaps);
                }
                if let Some(line) = &band.inner {
                    cuts(&line.opposite()).keep_positive(tile.width, &mut certain, &mut perhaps);
                }
                if certain.0 < certain.1 {
                    row[certain.0..certain.1].fill(WHITE);
                }
                *possible = perhaps;
            }
            for &(from, to) in &possible[..open.bands().len()] {
                for (i, pixel) in row.iter_mut().enumerate().take(to).skip(from) {
                    if *pixel != WHITE {
                        *pixel = (self.pixel)(tile.left + i, y, Some(open));
                    }
                }
            }
        }
    }

    /// Asks every pixel of a tile.
    fn ask(&self, band: &mut Band<'_>, tile: Tile, open: Option<&Open>) {
        for j in 0..tile.height {
            let y = band.first + tile.top + j;
            let row = band.row(tile.top + j, tile.left, tile.width);
            for (i, pixel) in row.iter_mut().enumerate() {
                *pixel = (self.pixel)(tile.left + i, y, open);
            }
        }
    }
}

/// Whether every open edge is a straight line over its tile, to so many pixels.
pub(super) fn is_straight(open: &Open, half: (f64, f64), pixels: f64) -> bool {
    let straight = |line: &Line| {
        let bend = line.per_column.radius * half.0 + line.per_row.radius * half.1;
        // The gradient's larger part is its length, but for a factor of √2.
        let gradient = line.per_column.middle.abs().max(line.per_row.middle.abs());
        bend <= pixels * gradient
    };
    open.bands()
        .iter()
        .flat_map(|band| [&band.inner, &band.outer])
        .flatten()
        .all(straight)
}

impl Tile {
    fn is_smallest(self) -> bool {
        self.width.max(self.height) <= SMALLEST
    }
}

impl Band<'_> {
    fn row(&mut self, row: usize, left: usize, width: usize) -> &mut [u8] {
        &mut self.pixels[row * self.stride + left..][..width]
    }

    /// Makes the first `height` rows black.
    fn blacken(&mut self, height: usize, width: usize) {
        if self.stride == width {
            self.pixels.fill(0);
        } else {
            for row in 0..height {
                self.row(row, 0, width).fill(0);
            }
        }
    }

    fn whiten(&mut self, tile: Tile) {
        for row in tile.top..tile.top + tile.height {
            self.row(row, tile.left, tile.width).fill(WHITE);
        }
    }
}

/// Where in a row `|slope dx + value| ≤ doubt`.
#[derive(Debug, Clone, Copy)]
struct Cut {
    value: f64,
    slope: f64,
    doubt: f64,
    half: f64,
}

impl Cut {
    fn new(line: &Line, dy: f64, half_width: f64, half_height: f64, reach: f64) -> Self {
        Self {
            value: line.value.middle + line.per_row.middle * dy,
            slope: line.per_column.middle,
            doubt: line.value.radius
                + line.per_column.radius * half_width
                + line.per_row.radius * half_height
                + reach * (line.per_column.most() + line.per_row.most()),
            half: half_width,
        }
    }

    /// Keeps of two ranges of the row's pixels those that are certainly on the positive side, and those that may be.
    fn keep_positive(
        self,
        width: usize,
        certain: &mut (usize, usize),
        perhaps: &mut (usize, usize),
    ) {
        /// The pixel, as a real number, at which a bound is 0 is moved by rounding by far less than this.
        const ROUNDING: f64 = 1e-6;
        // g ≥ slope dx + value − doubt at dx = i + ½ − half.
        let (certainly, maybe) = (self.value - self.doubt, self.value + self.doubt);
        if self.slope == 0.0 {
            if certainly < 0.0 {
                *certain = (0, 0);
            }
            if maybe < 0.0 {
                *perhaps = (0, 0);
            }
            return;
        }
        let inverse = 1.0 / self.slope;
        let (at_certain, at_maybe) = (
            self.half - 0.5 - certainly * inverse,
            self.half - 0.5 - maybe * inverse,
        );
        let most = width as f64;
        // The number of pixels below a place: its ceiling.
        let below = |place: f64| {
            let place = place.max(0.0).min(most);
            let whole = place as usize;
            whole + usize::from(whole as f64 != place)
        };
        if self.slope > 0.0 {
            certain.0 = certain.0.max(below(at_certain + ROUNDING));
            perhaps.0 = perhaps.0.max(below(at_maybe - ROUNDING));
        } else {
            certain.1 = certain.1.min(below(at_certain - ROUNDING));
            perhaps.1 = perhaps.1.min(below(at_maybe + ROUNDING));
        }
    }
}
