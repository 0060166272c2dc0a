//! Paints the pixels of a band: what one order covers wholly, and what is covered in part.

use core::f64::consts::{PI, TAU};

use super::ink::{Ink, Part, Quantities, Stretch};
use super::mixture::Mixture;
use super::patch::{Axis, Misfit, Patch};
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
pub(super) struct Painter<'a, I, const N: usize> {
    pub(super) shader: &'a Shader<'a>,
    pub(super) ink: &'a I,
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

    /// The axis along which it is longer.
    fn longer(self) -> Axis {
        if self.columns.1 - self.columns.0 >= self.rows.1 - self.rows.0 {
            Axis::X
        } else {
            Axis::Y
        }
    }
}

impl<I: Ink<N>, const N: usize> Painter<'_, I, N> {
    /// y of the centres of a row of the band.
    fn y(&self, row: usize) -> f64 {
        (self.top + row) as f64 + 0.5
    }

    /// Clears `rows` rows but for runs.
    pub(super) fn clear_but(&self, rows: usize, runs: &[Run], memory: &mut I::Band<'_>) {
        let width = self.shader.view.width() as usize;
        let mut runs = runs.iter().peekable();
        for row in 0..rows {
            let mut from = 0;
            while let Some(run) = runs.next_if(|run| run.row as usize == row) {
                self.ink.clear(memory, row, (from, run.from as usize));
                from = run.to as usize;
            }
            self.ink.clear(memory, row, (from, width));
        }
    }

    /// Paints the pixels that one order covers wholly: runs of `rows` rows, by rows.
    pub(super) fn paint_runs(
        &self,
        order: u32,
        rows: usize,
        runs: &[Run],
        memory: &mut I::Band<'_>,
    ) {
        let width = self.shader.view.width() as usize;
        let mut patch = Patch::new();
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
                self.paint_tile(order, runs, tile, &mut patch, memory);
            }
        }
    }

    /// Paints the runs within a rectangle: from a patch, or from patches of its parts, or pixel by pixel.
    fn paint_tile(
        &self,
        order: u32,
        runs: &[Run],
        tile: Rectangle,
        patch: &mut Patch<N>,
        memory: &mut I::Band<'_>,
    ) {
        let (count, bounds) = tile.shrunk(runs);
        if count == 0 {
            return;
        }
        let needs_patch = self.ink.quantities() > 0;
        if needs_patch && count <= N * N {
            for (row, (from, to)) in bounds.clip(runs) {
                for column in from..to {
                    let place = (column as f64 + 0.5, self.y(row));
                    let (shader, pixel) = (self.shader, (row, column));
                    self.ink.put_pixel(memory, shader, order, pixel, place);
                }
            }
            return;
        }
        let fit = if needs_patch {
            self.fit(order, bounds, patch)
        } else {
            Ok(())
        };
        let (axis, parts) = match fit {
            Ok(()) => {
                for (row, (from, to)) in bounds.clip(runs) {
                    let stretch = Stretch {
                        order,
                        row,
                        from,
                        to,
                        y: self.y(row),
                    };
                    self.ink.put_stretch(memory, self.shader, stretch, patch);
                }
                return;
            }
            Err(Misfit::TooLong(axis, parts)) => (axis, parts),
            Err(Misfit::NoValue) => (bounds.longer(), 2),
        };
        for part in bounds.parts(axis, parts) {
            self.paint_tile(order, runs, part, patch, memory);
        }
    }

    /// Fits a patch to the pixels of a rectangle.
    fn fit(&self, order: u32, bounds: Rectangle, patch: &mut Patch<N>) -> Result<(), Misfit> {
        let (shader, ink) = (self.shader, self.ink);
        let centre = |column: usize, row: usize| (column as f64 + 0.5, self.y(row));
        let corners = (
            centre(bounds.columns.0, bounds.rows.0),
            centre(bounds.columns.1 - 1, bounds.rows.1 - 1),
        );
        let angle = ink.angle();
        let mut first = None;
        let evaluate = |place, values: &mut Quantities| {
            let ray = shader.ray(place);
            let Some(u) = shader.u(order, &ray) else {
                return false;
            };
            ink.evaluate(shader, order, u, &ray, values);
            if let Some(angle) = angle {
                let first = *first.get_or_insert(values[angle]);
                values[angle] = continued(values[angle], first);
            }
            true
        };
        let (quantities, tolerance) = (ink.quantities(), ink.tolerance());
        self.ink
            .fit()
            .fit(patch, corners, quantities, tolerance, evaluate)
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
            self.ink.put_mixture(memory, (row, column), parts, &mixture);
        }
    }
}

/// An angle, a turn more or less, within half a turn of another one.
fn continued(angle: f64, other: f64) -> f64 {
    let turn = angle - other;
    if turn > PI {
        angle - TAU
    } else if turn < -PI {
        angle + TAU
    } else {
        angle
    }
}
