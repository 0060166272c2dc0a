//! Paints the pixels of a band: what one order covers wholly, and what is covered in part.

use core::f64::consts::{PI, TAU};

use super::ink::{Ink, Part, Quantities, Stretch};
use super::mixture::Mixture;
use super::patch::{Misfit, Patch};
use super::shader::Shader;
use super::tiles::{Rectangle, Run, TileRow, Tiled, paint_runs};

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
    pub(super) band: TileRow,
}

impl<I: Ink<N>, const N: usize> Painter<'_, I, N> {
    /// Clears the band.
    pub(super) fn clear(&self, memory: &mut I::Band<'_>) {
        for row in 0..self.band.rows {
            self.ink.clear(memory, row, (0, self.band.width));
        }
    }

    /// Clears what of the band is beyond the rim of a fisheye.
    pub(super) fn clear_beyond_the_rim(&self, memory: &mut I::Band<'_>) {
        for row in 0..self.band.rows {
            let (from, to) = self.band.seen_columns(self.shader.view, row);
            for columns in [(0, from), (to, self.band.width)] {
                if columns.0 < columns.1 {
                    self.ink.clear(memory, row, columns);
                }
            }
        }
    }

    /// Paints the pixels that one order covers wholly: runs, by rows.
    pub(super) fn paint_runs(&self, order: u32, runs: &[Run], memory: &mut I::Band<'_>) {
        let mut tiles = OrderTiles {
            painter: self,
            order,
            memory,
        };
        paint_runs(&mut tiles, self.band, runs);
    }

    /// Fits a patch to the pixels of a rectangle.
    fn fit(&self, order: u32, bounds: Rectangle, patch: &mut Patch<N>) -> Result<(), Misfit> {
        let (shader, ink) = (self.shader, self.ink);
        bounds.check_angle(shader.view)?;
        let corners = bounds.centres(self.band);
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
        let allowed = |size| ink.tolerance() * size;
        ink.fit()
            .fit(patch, corners, ink.quantities(), allowed, evaluate)
    }

    /// Paints the pixels that are covered in part. `parts` is memory; `beside` gives the light of a pixel, by row and
    /// column, where the disk does not cover it.
    pub(super) fn paint_partial(
        &self,
        partial: &mut [Partial],
        parts: &mut Vec<Part>,
        beside: impl Fn(usize, usize) -> [f32; 3],
        memory: &mut I::Band<'_>,
    ) {
        partial.sort_unstable_by_key(|partial| (partial.row, partial.column, partial.part.order));
        for pixel in partial.chunk_by(|a, b| (a.row, a.column) == (b.row, b.column)) {
            parts.clear();
            parts.extend(pixel.iter().map(|partial| partial.part));
            let (row, column) = (pixel[0].row as usize, pixel[0].column as usize);
            let mixture = Mixture::new(self.shader, self.band.centre(column, row));
            let beside = beside(row, column);
            self.ink
                .put_mixture(memory, (row, column), parts, &mixture, beside);
        }
    }
}

/// What one order covers, tile by tile.
struct OrderTiles<'p, 'a, 'b, 'm, I: Ink<N>, const N: usize> {
    painter: &'p Painter<'a, I, N>,
    order: u32,
    memory: &'m mut I::Band<'b>,
}

impl<I: Ink<N>, const N: usize> Tiled<N> for OrderTiles<'_, '_, '_, '_, I, N> {
    fn needs_patch(&self) -> bool {
        self.painter.ink.quantities() > 0
    }

    fn fit(&mut self, bounds: Rectangle, patch: &mut Patch<N>) -> Result<(), Misfit> {
        self.painter.fit(self.order, bounds, patch)
    }

    fn put_patch(&mut self, bounds: Rectangle, runs: &[Run], patch: &Patch<N>) {
        let Painter { shader, ink, band } = *self.painter;
        for (row, (from, to)) in bounds.clip(runs) {
            let stretch = Stretch {
                order: self.order,
                row,
                from,
                to,
                place: band.centre(from, row),
            };
            ink.put_stretch(self.memory, shader, stretch, patch);
        }
    }

    fn put_pixel(&mut self, row: usize, column: usize) {
        let Painter { shader, ink, band } = *self.painter;
        let place = band.centre(column, row);
        ink.put_pixel(self.memory, shader, self.order, (row, column), place);
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
