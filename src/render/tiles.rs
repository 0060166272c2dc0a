//! Where a frame changes: tiles that are wholly within the disk or wholly off it are found and filled, what is left are
//! the pixels along its edges.
//!
//! A tile is bounded as a [`Patch`] (whose page derives the bound); where that decides nothing it is split, and only
//! the edges that were open over it are looked at again. In tiles so small that what is not linear in their pixels is
//! a small share of a pixel, each row of pixels is cut at the edges' lines: into pixels that are decided for certain,
//! and those that are asked one by one.

use core::marker::PhantomData;

use rayon::prelude::*;

use super::RenderError;
use super::coverage::Shares;
use super::leaf::Leaf;
use super::mask::{Hard, WHITE};
use crate::isoradial::{Bundle, Isoradials, Open, OpenEdges, Picture, Uniform, Verdict};
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
    /// The edges that are open over the tile at hand.
    edges: OpenEdges,
}

/// A rectangle of a band's pixels.
#[derive(Debug, Clone, Copy)]
struct Tile {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// What a frame's pixels are.
pub(super) trait Pixels: Sync {
    /// How far from its centre a pixel looks to either side, in pixels: 0 for what its centre sees.
    const REACH: f64;

    /// A tile is drawn from its edges' quadratics where what is not quadratic of them is below this, in pixels: a
    /// compromise between tiles and pixels to be asked.
    const DOUBT: f64;

    /// The value of the pixel (column, row). `open` are edges among which are all that are open over it.
    fn value(&self, column: usize, row: usize, open: Option<Open>) -> u8;

    /// The value of a pixel of a leaf, along its edges.
    fn value_along(&self, column: usize, row: usize, leaf: &OpenEdges) -> u8;
}

/// How a frame is filled.
struct Filler<'a, P> {
    view: &'a View,
    curves: &'a Isoradials,
    picture: Picture<'a>,
    pixels: P,
}

/// Fills a frame, on all threads of the current rayon pool: row j begins at `j stride` of `pixels`.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
pub(super) fn fill_frame<P: Pixels>(
    view: &View,
    curves: &Isoradials,
    pixels_are: P,
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
    let filler = Filler {
        view,
        curves,
        picture: Picture::new(view, curves),
        pixels: pixels_are,
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
                edges: OpenEdges::none(),
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

impl<P: Pixels> Filler<'_, P> {
    /// Fills a tile of a band, all of whose pixels are black.
    fn fill(&self, band: &mut Band<'_>, tile: Tile, before: Option<Open>) {
        let top = band.first + tile.top;
        let columns = (tile.left as f64, (tile.left + tile.width) as f64);
        let rows = (top as f64, (top + tile.height) as f64);
        let Some(patch) = self.picture.patch(columns, rows) else {
            return self.fill_bundle(band, tile);
        };
        match self.curves.patched(&patch, before, &mut band.edges) {
            Err(Uniform::Miss) => {}
            Err(Uniform::Hit) => band.whiten(tile),
            Ok(open) => {
                if let Some(leaf) = Leaf::new(&patch, &band.edges, P::REACH, P::DOUBT) {
                    self.draw(band, tile, &leaf);
                } else if tile.is_smallest() {
                    self.ask(band, tile, Some(open));
                } else {
                    self.split(band, tile, Some(open));
                }
            }
        }
    }

    /// Fills a tile whose rays are in both quarter turns, or all about the hole's direction.
    fn fill_bundle(&self, band: &mut Band<'_>, tile: Tile) {
        // With half a pixel more on each side, where pixels look to either side of their centres: what is on one side
        // of an edge there is so too for lines that take the edge's place.
        let (left, top) = (
            tile.left as f64 - P::REACH,
            (band.first + tile.top) as f64 - P::REACH,
        );
        let (wide, high) = (
            tile.width as f64 + 2.0 * P::REACH,
            tile.height as f64 + 2.0 * P::REACH,
        );
        let bundle = Bundle::new(self.view, (left, left + wide), (top, top + high));
        match bundle.map_or(Verdict::Mixed, |bundle| self.curves.verdict(&bundle)) {
            Verdict::Miss => {}
            Verdict::Hit => band.whiten(tile),
            Verdict::Mixed if tile.is_smallest() => self.ask(band, tile, None),
            Verdict::Mixed => self.split(band, tile, None),
        }
    }

    fn split(&self, band: &mut Band<'_>, tile: Tile, open: Option<Open>) {
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

    /// Draws a tile from its edges' quadratics, and asks the pixels along them.
    fn draw(&self, band: &mut Band<'_>, tile: Tile, leaf: &Leaf) {
        for j in 0..tile.height {
            let y = band.first + tile.top + j;
            let first = (tile.top + j) * band.stride + tile.left;
            let row = &mut band.pixels[first..first + tile.width];
            leaf.draw_row(j, row, |i| {
                self.pixels.value_along(tile.left + i, y, &band.edges)
            });
        }
    }

    /// Asks every pixel of a tile.
    fn ask(&self, band: &mut Band<'_>, tile: Tile, open: Option<Open>) {
        for j in 0..tile.height {
            let y = band.first + tile.top + j;
            let row = band.row(tile.top + j, tile.left, tile.width);
            for (i, pixel) in row.iter_mut().enumerate() {
                *pixel = self.pixels.value(tile.left + i, y, open);
            }
        }
    }
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
    let stride = view.width() as usize;
    if smooth {
        fill_frame(
            view,
            curves,
            Unasked::<Shares<'_>>(PhantomData),
            pixels,
            stride,
        )
    } else {
        fill_frame(
            view,
            curves,
            Unasked::<Hard<'_>>(PhantomData),
            pixels,
            stride,
        )
    }
}

/// Pixels that are black along the edges, of tiles as another kind of pixels has them.
struct Unasked<P>(PhantomData<P>);

impl<P: Pixels> Pixels for Unasked<P> {
    const REACH: f64 = P::REACH;
    const DOUBT: f64 = P::DOUBT;

    fn value(&self, _: usize, _: usize, _: Option<Open>) -> u8 {
        0
    }

    fn value_along(&self, _: usize, _: usize, _: &OpenEdges) -> u8 {
        0
    }
}
