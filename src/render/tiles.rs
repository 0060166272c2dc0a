//! The tiles of a band: rectangles of pixels whose quantities are polynomials, and their parts where these do not do.
//!
//! Tiles are those of the whole picture, whichever part of it is drawn: a polynomial depends on all the pixels of its
//! tile that it is for. So a part of a picture is drawn as the tiles that it touches, and has the whole picture's
//! pixels.

use super::patch::{Axis, Misfit, Patch};
use crate::scene::{Projection, Region, View};

/// Columns and rows of a tile: what a patch covers at most. Bands are whole rows of tiles.
pub(super) const TILE: (usize, usize) = (128, 32);

/// The widest angle of a patch in a picture that is not flat, in radians.
const WIDEST: f64 = 0.8;

/// A band: a row of tiles that the drawn part of a picture touches, cut at the picture's sides.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileRow {
    /// Its number among them, from the top.
    pub(super) number: usize,
    /// The place of its first pixel in the picture.
    pub(super) left: usize,
    pub(super) top: usize,
    /// Its columns and rows.
    pub(super) width: usize,
    pub(super) rows: usize,
}

impl TileRow {
    /// The number-th row of tiles of a view.
    pub(super) fn new(view: &View, number: usize) -> Self {
        let tiles = tiles_of(view);
        let above = number * TILE.1;
        Self {
            number,
            left: tiles.left as usize,
            top: tiles.top as usize + above,
            width: tiles.width as usize,
            rows: TILE.1.min((tiles.height as usize).saturating_sub(above)),
        }
    }

    /// How many rows of tiles a view has.
    pub(super) fn count(view: &View) -> usize {
        (tiles_of(view).height as usize).div_ceil(TILE.1)
    }

    /// The pixels of it that are drawn.
    pub(super) fn shown(self, view: &View) -> Rectangle {
        let part = view.region();
        let within = |first: u32, count: u32, begin: usize, length: usize| {
            let (first, last) = (first as usize, (first + count) as usize);
            let end = (begin + length).min(last);
            (first.saturating_sub(begin), end - begin)
        };
        Rectangle {
            columns: within(part.left, part.width, self.left, self.width),
            rows: within(part.top, part.height, self.top, self.rows),
        }
    }

    /// The columns of it that show something in a row of it: none beyond the rim of a fisheye.
    pub(super) fn seen_columns(self, view: &View, row: usize) -> (usize, usize) {
        let (from, to) = view.shown_columns((self.top + row) as u32);
        let within = |column: u32| (column as usize).clamp(self.left, self.left + self.width);
        (within(from) - self.left, within(to) - self.left)
    }

    /// The place of a pixel's centre, in pixels from the picture's left and its top.
    pub(super) fn centre(self, column: usize, row: usize) -> (f64, f64) {
        (
            (self.left + column) as f64 + 0.5,
            (self.top + row) as f64 + 0.5,
        )
    }
}

/// Returns the drawn part of a picture, widened to whole tiles as far as the picture goes.
pub(super) fn tiles_of(view: &View) -> Region {
    let part = view.region();
    let widened = |first: u32, count: u32, tile: usize, all: u32| {
        let tile = tile as u32;
        let begin = first / tile * tile;
        (
            begin,
            (first + count).next_multiple_of(tile).min(all) - begin,
        )
    };
    let (left, width) = widened(part.left, part.width, TILE.0, view.width());
    let (top, height) = widened(part.top, part.height, TILE.1, view.height());
    Region {
        left,
        top,
        width,
        height,
    }
}

/// Pixels of a row of a band, side by side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) row: u32,
    pub(super) from: u32,
    pub(super) to: u32,
}

/// A rectangle of pixels of a band.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rectangle {
    /// The first one, and the one after the last.
    pub(super) columns: (usize, usize),
    pub(super) rows: (usize, usize),
}

/// What is painted tile by tile, from patches with N nodes a side.
pub(super) trait Tiled<const N: usize> {
    /// Whether patches are needed at all.
    fn needs_patch(&self) -> bool {
        true
    }

    /// Whether nothing is to be painted in a rectangle, as far as that is told at once.
    fn is_empty(&self, bounds: Rectangle) -> bool {
        let _ = bounds;
        false
    }

    /// Fits a patch to the pixels of a rectangle.
    ///
    /// # Errors
    /// A [`Misfit`]: the rectangle has to be cut.
    fn fit(&mut self, bounds: Rectangle, patch: &mut Patch<N>) -> Result<(), Misfit>;

    /// Paints the runs within a rectangle from its patch.
    fn put_patch(&mut self, bounds: Rectangle, runs: &[Run], patch: &Patch<N>);

    /// Paints one pixel.
    fn put_pixel(&mut self, row: usize, column: usize);
}

/// Paints runs of a band, sorted by rows.
pub(super) fn paint_runs<const N: usize>(
    painter: &mut impl Tiled<N>,
    TileRow { width, rows, .. }: TileRow,
    runs: &[Run],
) {
    let mut patch = Patch::new();
    let mut rest = runs;
    for first in (0..rows).step_by(TILE.1) {
        let last = (first + TILE.1).min(rows);
        let (runs, after) = rest.split_at(rest.partition_point(|run| (run.row as usize) < last));
        rest = after;
        if runs.is_empty() {
            continue;
        }
        for column in (0..width).step_by(TILE.0) {
            let tile = Rectangle {
                columns: (column, (column + TILE.0).min(width)),
                rows: (first, last),
            };
            paint_tile(painter, tile, runs, &mut patch);
        }
    }
}

/// Paints the runs within a rectangle: from a patch, or from patches of its parts, or pixel by pixel.
fn paint_tile<const N: usize>(
    painter: &mut impl Tiled<N>,
    tile: Rectangle,
    runs: &[Run],
    patch: &mut Patch<N>,
) {
    let (count, bounds) = tile.shrunk(runs);
    if count == 0 || painter.is_empty(bounds) {
        return;
    }
    let needs_patch = painter.needs_patch();
    if needs_patch && count <= N * N {
        for (row, (from, to)) in bounds.clip(runs) {
            for column in from..to {
                painter.put_pixel(row, column);
            }
        }
        return;
    }
    let fit = if needs_patch {
        painter.fit(bounds, patch)
    } else {
        Ok(())
    };
    let (axis, parts) = match fit {
        Ok(()) => return painter.put_patch(bounds, runs, patch),
        Err(Misfit::TooLong(axis, parts)) => (axis, parts),
        Err(Misfit::NoValue) => (bounds.longer(), 2),
    };
    for part in bounds.parts(axis, parts) {
        paint_tile(painter, part, runs, patch);
    }
}

impl Rectangle {
    /// The parts of runs within it: rows, and the columns of each.
    pub(super) fn clip(self, runs: &[Run]) -> impl Iterator<Item = (usize, (usize, usize))> {
        runs.iter().filter_map(move |run| {
            let row = run.row as usize;
            let from = (run.from as usize).max(self.columns.0);
            let to = (run.to as usize).min(self.columns.1);
            let is_within = from < to && row >= self.rows.0 && row < self.rows.1;
            is_within.then_some((row, (from, to)))
        })
    }

    /// The centres of its first and its last pixel, in a band.
    pub(super) fn centres(self, band: TileRow) -> ((f64, f64), (f64, f64)) {
        (
            band.centre(self.columns.0, self.rows.0),
            band.centre(self.columns.1 - 1, self.rows.1 - 1),
        )
    }

    /// The number of pixels of runs within it, and the rectangle about them.
    fn shrunk(self, runs: &[Run]) -> (usize, Self) {
        let mut count = 0;
        let mut bounds = Self {
            columns: (usize::MAX, 0),
            rows: (usize::MAX, 0),
        };
        for (row, (from, to)) in self.clip(runs) {
            count += to - from;
            bounds.columns = (bounds.columns.0.min(from), bounds.columns.1.max(to));
            bounds.rows = (bounds.rows.0.min(row), bounds.rows.1.max(row + 1));
        }
        (count, bounds)
    }

    /// Its parts, cut along an axis into at most so many: at least two, where it is more than a pixel.
    fn parts(self, axis: Axis, count: usize) -> impl Iterator<Item = Self> {
        let (columns, rows) = (self.columns.1 - self.columns.0, self.rows.1 - self.rows.0);
        let axis = match axis {
            Axis::X if columns > 1 => Axis::X,
            Axis::Y if rows > 1 => Axis::Y,
            _ if columns > rows => Axis::X,
            _ => Axis::Y,
        };
        let (first, length) = match axis {
            Axis::X => (self.columns.0, columns),
            Axis::Y => (self.rows.0, rows),
        };
        let count = count.min(length);
        (0..count).map(move |i| {
            let part = (first + i * length / count, first + (i + 1) * length / count);
            match axis {
                Axis::X => Self {
                    columns: part,
                    ..self
                },
                Axis::Y => Self { rows: part, ..self },
            }
        })
    }

    /// Checks that it is no wider angle than polynomials are trusted with: over a large part of a turn the last
    /// coefficients of a periodic function may be small by chance. Flat pictures have no such tiles.
    ///
    /// # Errors
    /// A [`Misfit`]: the rectangle has to be cut.
    pub(super) fn check_angle(self, view: &View) -> Result<(), Misfit> {
        if view.lens().projection() == Projection::Perspective {
            return Ok(());
        }
        let axis = self.longer();
        let (first, last) = match axis {
            Axis::X => self.columns,
            Axis::Y => self.rows,
        };
        let angle = (last - first) as f64 * view.pixel_side();
        if angle > WIDEST && last - first > 1 {
            return Err(Misfit::TooLong(axis, (angle / WIDEST).ceil() as usize));
        }
        Ok(())
    }

    /// The axis along which it is longer.
    fn longer(self) -> Axis {
        if self.columns.1 - self.columns.0 >= self.rows.1 - self.rows.0 {
            Axis::X
        } else {
            Axis::Y
        }
    }
}
