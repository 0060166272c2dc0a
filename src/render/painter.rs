//! Paints the pixels of a band: what one order covers wholly, and what is covered in part.

use super::ink::{Ink, MOST_QUANTITIES, Part};
use super::mixture::Mixture;
use super::patch::{Patch, PatchFit};
use super::shader::Shader;

/// Columns and rows of a tile: what a patch covers at most. Bands are whole rows of tiles.
pub(super) const TILE: (usize, usize) = (128, 32);

/// Pixels of a row of the band that one order covers wholly.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) row: u32,
    pub(super) from: u32,
    pub(super) to: u32,
}

/// A pixel of the band that an order covers in part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Partial {
    pub(super) row: u32,
    pub(super) column: u32,
    pub(super) part: Part,
}

/// Paints a band.
pub(super) struct Painter<'a, I> {
    pub(super) shader: &'a Shader<'a>,
    pub(super) ink: &'a I,
    pub(super) fit: &'a PatchFit,
    pub(super) smooth: bool,
    /// The band's first row in the picture.
    pub(super) top: usize,
}

/// A rectangle of pixels of a band.
#[derive(Debug, Clone, Copy)]
struct Rectangle {
    columns: (usize, usize),
    rows: (usize, usize),
}

impl Rectangle {
    /// The parts of runs within it: rows, and the columns of each.
    fn clip(self, runs: &[Run]) -> impl Iterator<Item = (usize, (usize, usize))> {
        runs.iter().filter_map(move |run| {
            let row = run.row as usize;
            let from = (run.from as usize).max(self.columns.0);
            let to = (run.to as usize).min(self.columns.1);
            let is_within = from < to && row >= self.rows.0 && row < self.rows.1;
            is_within.then_some((row, (from, to)))
        })
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

    /// Its halves, across its longer side.
    fn halves(self) -> [Self; 2] {
        let halves =
            |(from, to): (usize, usize)| [(from, from.midpoint(to)), (from.midpoint(to), to)];
        if self.columns.1 - self.columns.0 >= self.rows.1 - self.rows.0 {
            halves(self.columns).map(|columns| Self { columns, ..self })
        } else {
            halves(self.rows).map(|rows| Self { rows, ..self })
        }
    }
}

impl<I: Ink> Painter<'_, I> {
    /// y of the centres of a row of the band.
    fn y(&self, row: usize) -> f64 {
        (self.top + row) as f64 + 0.5
    }

    /// Paints the pixels that one order covers wholly: runs of `rows` rows, by rows.
    pub(super) fn paint_runs(
        &self,
        order: u32,
        rows: usize,
        runs: &[Run],
        patch: &mut Patch,
        memory: &mut I::Band<'_>,
    ) {
        let width = self.shader.view.width() as usize;
        let mut rest = runs;
        for first in (0..rows).step_by(TILE.1) {
            let last = (first + TILE.1).min(rows);
            let (runs, after) =
                rest.split_at(rest.partition_point(|run| (run.row as usize) < last));
            rest = after;
            if runs.is_empty() {
                continue;
            }
            for column in (0..width).step_by(TILE.0) {
                let tile = Rectangle {
                    columns: (column, (column + TILE.0).min(width)),
                    rows: (first, last),
                };
                self.paint_tile(order, runs, tile, patch, memory);
            }
        }
    }

    /// Paints the runs within a rectangle: from a patch, or from patches of its halves, or pixel by pixel.
    fn paint_tile(
        &self,
        order: u32,
        runs: &[Run],
        tile: Rectangle,
        patch: &mut Patch,
        memory: &mut I::Band<'_>,
    ) {
        let (count, bounds) = tile.shrunk(runs);
        if count == 0 {
            return;
        }
        let needs_patch = self.ink.quantities() > 0;
        if needs_patch && count <= self.fit.nodes() {
            self.paint_pixels(order, runs, bounds, memory);
        } else if !needs_patch || self.fits(order, bounds, patch) {
            for (row, columns) in bounds.clip(runs) {
                let y = self.y(row);
                self.ink
                    .put_row(memory, self.shader, order, row, columns, patch, y);
            }
        } else {
            for half in bounds.halves() {
                self.paint_tile(order, runs, half, patch, memory);
            }
        }
    }

    /// Fits a patch to the pixels of a rectangle. Returns whether it is as good as the ink asks.
    fn fits(&self, order: u32, bounds: Rectangle, patch: &mut Patch) -> bool {
        let (shader, ink) = (self.shader, self.ink);
        let centre = |column: usize, row: usize| (column as f64 + 0.5, self.y(row));
        let corners = (
            centre(bounds.columns.0, bounds.rows.0),
            centre(bounds.columns.1 - 1, bounds.rows.1 - 1),
        );
        let mut first = None;
        let evaluate = |place, values: &mut [f64]| {
            let ray = shader.ray(place);
            let Some(u) = shader.u(order, &ray) else {
                return false;
            };
            ink.evaluate(shader, order, u, &ray, values);
            let first = *first.get_or_insert_with(|| ink.angle(values));
            ink.unwrap(values, first);
            true
        };
        self.fit
            .fit(patch, corners, ink.quantities(), ink.tolerance(), evaluate)
    }

    /// Paints the runs within a rectangle pixel by pixel.
    fn paint_pixels(&self, order: u32, runs: &[Run], bounds: Rectangle, memory: &mut I::Band<'_>) {
        let (shader, ink) = (self.shader, self.ink);
        let mut values = [0.0; MOST_QUANTITIES];
        for (row, (from, to)) in bounds.clip(runs) {
            for column in from..to {
                let place = (column as f64 + 0.5, self.y(row));
                if self.smooth && ink.averages() {
                    let mixture = Mixture::new(shader, place);
                    let whole = [Part { order, share: 1.0 }];
                    ink.put_mixture(memory, shader, row, column, &whole, &mixture);
                    continue;
                }
                let ray = shader.ray(place);
                let u = shader.u_on_disk(order, &ray);
                ink.evaluate(shader, order, u, &ray, &mut values);
                ink.put(memory, shader, order, (row, column), &ray, &values);
            }
        }
    }

    /// Paints the pixels that are covered in part. `parts` is memory.
    pub(super) fn paint_partial(
        &self,
        partial: &mut [Partial],
        parts: &mut Vec<Part>,
        memory: &mut I::Band<'_>,
    ) {
        partial.sort_unstable_by_key(|partial| (partial.row, partial.column, partial.part.order));
        for pixel in partial.chunk_by(|a, b| (a.row, a.column) == (b.row, b.column)) {
            parts.clear();
            parts.extend(pixel.iter().map(|partial| partial.part));
            let (row, column) = (pixel[0].row as usize, pixel[0].column as usize);
            let mixture = Mixture::new(self.shader, (column as f64 + 0.5, self.y(row)));
            self.ink
                .put_mixture(memory, self.shader, row, column, parts, &mixture);
        }
    }
}
