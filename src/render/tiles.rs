//! Where a frame changes: tiles that are wholly within the disk or wholly off it are found and filled, what is left are
//! the pixels along its edges.
//!
//! Tiles are looked at four by four (see [`Group`]). One whose edges are not yet cubics is split, and only the
//! edges that were open over it are looked at again.

use rayon::prelude::*;

use super::RenderError;
use super::blocks::{Asked, Canvas};
use super::coverage::Shares;
use super::group::{Group, TILES, Tiles, border};
use super::mask::{Hard, WHITE};
use crate::isoradial::{Bundle, Isoradials, Open, Picture, Verdict};
use crate::lanes::{Level, level};
use crate::scene::View;

/// The side of the largest tiles, in pixels.
pub(super) const TILE: usize = 64;

/// How a frame's pixels look at their edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kind {
    /// How far from its centre a pixel looks to either side, in pixels: 0 for what its centre sees.
    pub(super) reach: f64,
    /// A tile is drawn where what of its edges is not cubic is below this, in pixels: a compromise between tiles and
    /// pixels to be asked.
    pub(super) doubt: f64,
    /// How far an edge may be off its tangent over a pixel of such a tile, in pixels.
    pub(super) bend: f64,
    /// How far about a tile its edges are looked for, in pixels.
    pub(super) margin: f64,
    /// The side of the smallest tiles, in pixels.
    pub(super) smallest: usize,
}

/// What a frame's pixels are.
pub(super) trait Pixels: Sync {
    /// How they look at their edges.
    const KIND: Kind;

    /// The value of the pixel (column, row). `open` are edges among which are all that are open over it.
    fn value(&self, column: usize, row: usize, open: Option<Open>) -> u8;

    /// Draws the pixels of a tile that are to be asked, along its edges; `corner` is the tile's in the picture.
    fn draw_along(
        &self,
        level: Level,
        group: (&Group, usize),
        corner: (usize, usize),
        asked: &Asked,
        canvas: &mut Canvas<'_>,
    );
}

/// How a frame is filled.
struct Filler<'a, P> {
    level: Level,
    picture: Picture<'a>,
    pixels: P,
}

/// A band of a frame's rows.
struct Band<'a> {
    /// Their pixels.
    pixels: &'a mut [u8],
    /// From one row to the next.
    stride: usize,
    /// The first row's place in the frame.
    first: usize,
    /// How many columns and rows.
    size: (usize, usize),
    /// The tiles at hand.
    group: Group,
    /// The pixels to be asked of one of them.
    asked: Asked,
}

/// A square of a band's pixels; of that, what is within the band.
#[derive(Debug, Clone, Copy, Default)]
struct Tile {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// Who fills a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Threads {
    /// All threads of the current rayon pool.
    All,
    /// This one.
    This,
}

/// Fills a frame: row j begins at `j stride` of `pixels`.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
pub(super) fn fill_frame<P: Pixels>(
    view: &View,
    curves: &Isoradials,
    kind: P,
    threads: Threads,
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
        level: level(),
        picture: Picture::new(view, curves),
        pixels: kind,
    };
    let band = |(index, pixels)| {
        let first = index * TILE;
        let mut band = Band {
            pixels,
            stride,
            first,
            size: (width, TILE.min(height - first)),
            group: Group::new(),
            asked: Asked::new(),
        };
        band.blacken();
        for left in (0..width).step_by(TILES * TILE) {
            let corners = [0, 1, 2, 3].map(|i| (left + i * TILE, 0));
            filler.fill(&mut band, corners, TILE, None);
        }
    };
    let (pixels, rows) = (&mut pixels[..needed], stride * TILE);
    match threads {
        Threads::All => {
            // A few bands have most of the edges: each may be taken by whoever has nothing to do.
            let bands = pixels.par_chunks_mut(rows).enumerate().with_max_len(1);
            bands.for_each(band);
        }
        Threads::This => pixels.chunks_mut(rows).enumerate().for_each(band),
    }
    Ok(())
}

impl<P: Pixels> Filler<'_, P> {
    /// Fills four tiles of a band, all of whose pixels are black, from their corners on.
    fn fill(
        &self,
        band: &mut Band<'_>,
        corners: [(usize, usize); TILES],
        side: usize,
        before: Option<Open>,
    ) {
        let half = 0.5 * side as f64;
        let tiles = corners.map(|corner| band.tile(corner, side));
        let mut active = 0;
        for (i, tile) in tiles.iter().enumerate() {
            active |= u32::from(tile.width > 0 && tile.height > 0) << i;
        }
        let four = Tiles {
            columns: corners.map(|(left, _)| left as f64 + half),
            rows: corners.map(|(_, top)| (band.first + top) as f64 + half),
            half: [half + P::KIND.margin; 2],
            active,
            before,
        };
        band.group.look(self.level, &self.picture, &four, P::KIND);
        let group = &band.group;
        let (hit, miss, unknown) = (group.hit, group.miss, group.unknown);
        let (both, cubic) = (group.both, group.cubic);
        let mut split = [None; TILES];
        for (i, tile) in tiles.into_iter().enumerate() {
            let is = |mask: u32| mask & (1 << i) != 0;
            if !is(active) || is(miss) {
            } else if is(hit) {
                band.whiten(tile);
            } else if is(unknown) {
                split[i] = self.fill_bundle(band, tile).then_some(None);
            } else if is(cubic) {
                self.draw(band, tile, (four.columns[i], four.rows[i]), half, i);
            } else if is(both) {
                split[i] = Some(None);
            } else {
                split[i] = Some(Some(band.group.open(i)));
            }
        }
        for (tile, open) in tiles.into_iter().zip(split) {
            if let Some(open) = open {
                if side <= P::KIND.smallest {
                    self.ask(band, tile, open);
                } else {
                    self.split(band, tile, side, open);
                }
            }
        }
    }

    /// Fills a tile of which nothing is known if it is all alike. Whether it may not be.
    fn fill_bundle(&self, band: &mut Band<'_>, tile: Tile) -> bool {
        // With half a pixel more on each side, where pixels look to either side of their centres: what is on one side
        // of an edge there is so too for lines that take the edge's place.
        let reach = P::KIND.reach;
        let (left, top) = (
            tile.left as f64 - reach,
            (band.first + tile.top) as f64 - reach,
        );
        let (wide, high) = (
            tile.width as f64 + 2.0 * reach,
            tile.height as f64 + 2.0 * reach,
        );
        let bundle = Bundle::new(self.picture.view(), (left, left + wide), (top, top + high));
        let curves = self.picture.curves();
        let verdict = bundle.map_or(Verdict::Mixed, |bundle| curves.verdict(&bundle));
        if verdict == Verdict::Hit {
            band.whiten(tile);
        }
        verdict == Verdict::Mixed
    }

    fn split(&self, band: &mut Band<'_>, tile: Tile, side: usize, open: Option<Open>) {
        let half = side / 2;
        let corners = [(0, 0), (half, 0), (0, half), (half, half)]
            .map(|(right, down)| (tile.left + right, tile.top + down));
        self.fill(band, corners, half, open);
    }

    /// Draws a tile whose edges are cubics, and asks the pixels along them.
    fn draw(&self, band: &mut Band<'_>, tile: Tile, centre: (f64, f64), half: f64, index: usize) {
        let first = tile.top * band.stride + tile.left;
        let mut canvas = Canvas {
            pixels: &mut band.pixels[first..],
            stride: band.stride,
            size: (tile.width, tile.height),
        };
        let (group, corner) = (&band.group, (tile.left, band.first + tile.top));
        let line = group
            .is_in_both(index)
            .then(|| self.picture.border_about(centre));
        let border = line.map(|line| border(&line, [half; 2], P::KIND.reach));
        let drawing = group.drawing(index, half, border);
        drawing.draw(self.level, &mut canvas, &mut band.asked);
        self.pixels
            .draw_along(self.level, (group, index), corner, &band.asked, &mut canvas);
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

impl Band<'_> {
    /// What of a tile is in the band.
    fn tile(&self, (left, top): (usize, usize), side: usize) -> Tile {
        Tile {
            left,
            top,
            width: side.min(self.size.0.saturating_sub(left)),
            height: side.min(self.size.1.saturating_sub(top)),
        }
    }

    fn row(&mut self, row: usize, left: usize, width: usize) -> &mut [u8] {
        &mut self.pixels[row * self.stride + left..][..width]
    }

    fn blacken(&mut self) {
        if self.stride == self.size.0 {
            self.pixels.fill(0);
        } else {
            for row in 0..self.size.1 {
                self.row(row, 0, self.size.0).fill(0);
            }
        }
    }

    fn whiten(&mut self, tile: Tile) {
        // A tile's rows are short: as many pixels as it mostly has are stored sooner than a function is called.
        match tile.width {
            64 => self.whiten_rows::<64>(tile),
            32 => self.whiten_rows::<32>(tile),
            16 => self.whiten_rows::<16>(tile),
            8 => self.whiten_rows::<8>(tile),
            _ => {
                for row in tile.top..tile.top + tile.height {
                    self.row(row, tile.left, tile.width).fill(WHITE);
                }
            }
        }
    }

    fn whiten_rows<const WIDTH: usize>(&mut self, tile: Tile) {
        for row in tile.top..tile.top + tile.height {
            if let Some(row) = self.row(row, tile.left, WIDTH).first_chunk_mut() {
                *row = [WHITE; WIDTH];
            }
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
        fill_frame(view, curves, Unasked::<true>, Threads::All, pixels, stride)
    } else {
        fill_frame(view, curves, Unasked::<false>, Threads::All, pixels, stride)
    }
}

/// Pixels that are black along the edges, of tiles as smooth or as hard ones have them.
struct Unasked<const SMOOTH: bool>;

impl<const SMOOTH: bool> Pixels for Unasked<SMOOTH> {
    const KIND: Kind = if SMOOTH { Shares::KIND } else { Hard::KIND };

    fn value(&self, _: usize, _: usize, _: Option<Open>) -> u8 {
        0
    }

    fn draw_along(
        &self,
        _: Level,
        _: (&Group, usize),
        _: (usize, usize),
        _: &Asked,
        _: &mut Canvas<'_>,
    ) {
    }
}
