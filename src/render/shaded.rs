//! Draws frames with light or data, in bands of rows.
//!
//! Each order has an outline of its own: where it lies in front. So every pixel is known to be covered wholly by one
//! order, or partly by one or several. What is covered wholly is painted from [patches](super::patch); each partly
//! covered pixel is a [mixture](super::mixture) of its orders.

use super::banded::{BandScratch, BandedOutline};
use super::cells::ONE;
use super::frame::{Threads, on_threads};
use super::ink::{Ink, Part};
use super::mixture::Mixture;
use super::patch::{Patch, PatchFit};
use super::path::OutlinePath;
use super::projection::Projection;
use super::shader::Shader;
use crate::isoradial::Boundary;

/// Columns and rows of a tile: what a patch covers at most. Bands are whole rows of tiles.
const TILE: (usize, usize) = (128, 32);

/// Memory for the cells of a band, in bytes: what the nearer caches hold.
const BAND: usize = 1 << 20;

/// A share above this counts as the whole: areas are rounded.
const WHOLE: i64 = ONE - 8;

/// A smaller share counts as none. So what one order covers as a whole has no part of another.
const LEAST: i64 = 16;

/// A rectangle with fewer pixels than this is not worth a patch, as a multiple of its nodes.
const WORTH: usize = 1;

/// The memory that frames with light or data are drawn with.
#[derive(Debug, Default)]
pub(super) struct ShadedWorkspace {
    outlines: Vec<(u32, BandedOutline)>,
    scratch: Vec<ShadedScratch>,
    /// The fit of patches, and its degree.
    fit: Option<(usize, PatchFit)>,
}

/// What a thread draws a band with.
#[derive(Debug, Default)]
struct ShadedScratch {
    band: BandScratch,
    runs: Vec<Run>,
    partial: Vec<Partial>,
    parts: Vec<Part>,
    /// For hard edges: the order of each pixel of the band.
    orders: Vec<u8>,
    patch: Patch,
}

/// Pixels of a row of the band that one order covers wholly.
#[derive(Debug, Clone, Copy)]
struct Run {
    row: u32,
    from: u32,
    to: u32,
}

/// A pixel of the band that an order covers in part.
#[derive(Debug, Clone, Copy)]
struct Partial {
    row: u32,
    column: u32,
    order: u32,
    share: f32,
}

/// No order, in [`ShadedScratch::orders`].
const NONE: u8 = u8::MAX;

/// A rectangle of pixels of a band.
#[derive(Debug, Clone, Copy)]
struct Rectangle {
    columns: (usize, usize),
    rows: (usize, usize),
}

/// A frame that is being painted.
struct Painter<'a, I> {
    shader: &'a Shader<'a>,
    ink: &'a I,
    fit: &'a PatchFit,
    smooth: bool,
}

/// The rows of a band, whole tiles.
pub(super) fn rows_of_band(width: usize) -> usize {
    (BAND / (size_of::<i64>() * width)).max(TILE.1) / TILE.1 * TILE.1
}

/// A frame with light or data, and the memory that it is drawn with.
pub(super) struct ShadedFrame<'a> {
    half: &'a mut OutlinePath,
    workspace: &'a mut ShadedWorkspace,
    shader: &'a Shader<'a>,
    smooth: bool,
    threads: Threads,
}

impl<'a> ShadedFrame<'a> {
    /// A frame with smooth edges or hard ones, on some threads.
    pub(super) fn new(
        memory: (&'a mut OutlinePath, &'a mut ShadedWorkspace),
        shader: &'a Shader<'a>,
        (smooth, threads): (bool, Threads),
    ) -> Self {
        Self {
            half: memory.0,
            workspace: memory.1,
            shader,
            smooth,
            threads,
        }
    }

    /// Paints the frame band by band. `bands` are the parts of its memory, each of [`rows_of_band`] rows.
    pub(super) fn paint<'b, I: Ink>(self, ink: &I, bands: impl Iterator<Item = I::Band<'b>> + Send)
    where
        I::Band<'b>: Send,
    {
        let Self {
            half,
            workspace,
            shader,
            smooth,
            threads,
        } = self;
        let (view, curves) = (shader.view, shader.curves);
        let (width, height) = (view.width() as usize, view.height() as usize);
        let rows = rows_of_band(width);
        let projection = Projection::new(view, curves);
        let count = threads.count();
        let orders = curves.orders();
        workspace
            .outlines
            .resize_with(orders.len().max(workspace.outlines.len()), Default::default);
        let mut is_meaningful = true;
        for ((order, outline), shown) in workspace.outlines.iter_mut().zip(orders) {
            *order = shown.number();
            let number = Some(*order);
            let weight = |boundary: &Boundary| {
                i32::from(boundary.above == number) - i32::from(boundary.below == number)
            };
            outline.draw(half, &projection, smooth, weight, count > 1);
            outline.sort(height, rows);
            is_meaningful &= outline.is_meaningful(curves);
        }
        let outlines = &workspace.outlines[..orders.len()];
        let fit = match &workspace.fit {
            Some((degree, fit)) if *degree == ink.degree() => fit,
            _ => {
                &workspace
                    .fit
                    .insert((ink.degree(), PatchFit::new(ink.degree())))
                    .1
            }
        };
        let painter = Painter {
            shader,
            ink,
            fit,
            smooth,
        };
        let drawn: Vec<_> = outlines
            .iter()
            .map(|(order, outline)| {
                let sees = |place| shader.front_at(place) == Some(*order);
                (*order, outline.drawn(view, curves, smooth, rows, sees))
            })
            .collect();
        workspace
            .scratch
            .resize_with(workspace.scratch.len().max(count), Default::default);
        on_threads(
            &mut workspace.scratch[..count],
            bands,
            |scratch, band, mut memory| {
                let top = band * rows;
                let rows_here = rows.min(height - top);
                ink.clear(&mut memory);
                if smooth && is_meaningful {
                    scratch.partial.clear();
                    for (order, outline) in &drawn {
                        scratch.runs.clear();
                        outline.draw(band, &mut scratch.band);
                        let (runs, partial) = (&mut scratch.runs, &mut scratch.partial);
                        outline.rows(&mut scratch.band, |cells, row, left| {
                            collect(cells, row, left, *order, runs, partial);
                        });
                        painter.paint_runs(*order, top, rows_here, width, scratch, &mut memory);
                    }
                    painter.paint_partial(top, scratch, &mut memory);
                } else {
                    let orders = &mut scratch.orders;
                    orders.clear();
                    orders.resize(width * rows_here, NONE);
                    if is_meaningful {
                        for (order, outline) in &drawn {
                            outline.draw(band, &mut scratch.band);
                            outline.rows(&mut scratch.band, |cells, row, left| {
                                let orders = &mut orders[row * width..][..width];
                                let orders = core::cell::Cell::from_mut(orders).as_slice_of_cells();
                                let fill = |from: usize, to: usize, share: i64| {
                                    if share > 0 {
                                        for pixel in &orders[from..to] {
                                            pixel.set(*order as u8);
                                        }
                                    }
                                };
                                cells.walk(row, left, fill, |column, share| {
                                    fill(column, column + 1, share);
                                });
                            });
                            for &(column, row) in &scratch.band.doubtful {
                                let place =
                                    (f64::from(column) + 0.5, (top + row as usize) as f64 + 0.5);
                                let front = shader.front_at(place);
                                orders[row as usize * width + column as usize] =
                                    front.map_or(NONE, |front| front as u8);
                            }
                        }
                    } else {
                        for (i, order) in orders.iter_mut().enumerate() {
                            let place = ((i % width) as f64 + 0.5, (top + i / width) as f64 + 0.5);
                            *order = shader.front_at(place).map_or(NONE, |front| front as u8);
                        }
                    }
                    for shown in curves.orders() {
                        scratch.runs.clear();
                        for (row, orders) in scratch.orders.chunks_exact(width).enumerate() {
                            runs_of(orders, shown.number() as u8, row, &mut scratch.runs);
                        }
                        painter.paint_runs(
                            shown.number(),
                            top,
                            rows_here,
                            width,
                            scratch,
                            &mut memory,
                        );
                    }
                }
                ink.finish(&mut memory, shader, top, smooth);
            },
        );
    }
}

/// Collects a row's pixels of one order.
fn collect(
    cells: &mut super::cells::Cells,
    row: usize,
    left: i64,
    order: u32,
    runs: &mut Vec<Run>,
    partial: &mut Vec<Partial>,
) {
    let (runs, partial) = (
        core::cell::RefCell::new(runs),
        core::cell::RefCell::new(partial),
    );
    let add = |from: usize, to: usize, share: i64| {
        if share >= WHOLE {
            let mut runs = runs.borrow_mut();
            match runs.last_mut() {
                Some(last) if last.row as usize == row && last.to as usize == from => {
                    last.to = to as u32;
                }
                _ => runs.push(Run {
                    row: row as u32,
                    from: from as u32,
                    to: to as u32,
                }),
            }
        } else if share >= LEAST {
            for column in from..to {
                partial.borrow_mut().push(Partial {
                    row: row as u32,
                    column: column as u32,
                    order,
                    share: share as f32 / ONE as f32,
                });
            }
        }
    };
    cells.walk(row, left, add, |column, share| {
        add(column, column + 1, share)
    });
}

/// Collects the runs of one order in a row.
fn runs_of(orders: &[u8], order: u8, row: usize, runs: &mut Vec<Run>) {
    let mut column = 0;
    while let Some(from) = orders[column..].iter().position(|&o| o == order) {
        let from = column + from;
        let length = orders[from..].iter().position(|&o| o != order);
        let to = length.map_or(orders.len(), |length| from + length);
        runs.push(Run {
            row: row as u32,
            from: from as u32,
            to: to as u32,
        });
        column = to;
    }
}

impl<I: Ink> Painter<'_, I> {
    /// Paints the pixels that one order covers wholly.
    fn paint_runs(
        &self,
        order: u32,
        top: usize,
        rows: usize,
        width: usize,
        scratch: &mut ShadedScratch,
        memory: &mut I::Band<'_>,
    ) {
        let mut rest = &scratch.runs[..];
        for first in (0..rows).step_by(TILE.1) {
            let last = (first + TILE.1).min(rows);
            let here = rest.partition_point(|run| (run.row as usize) < last);
            let (runs, after) = rest.split_at(here);
            rest = after;
            if runs.is_empty() {
                continue;
            }
            for column in (0..width).step_by(TILE.0) {
                let tile = Rectangle {
                    columns: (column, (column + TILE.0).min(width)),
                    rows: (first, last),
                };
                self.paint_tile(order, top, runs, tile, &mut scratch.patch, memory);
            }
        }
    }

    /// Paints the runs within a rectangle.
    fn paint_tile(
        &self,
        order: u32,
        top: usize,
        runs: &[Run],
        tile: Rectangle,
        patch: &mut Patch,
        memory: &mut I::Band<'_>,
    ) {
        let clipped = runs.iter().filter_map(|run| {
            let row = run.row as usize;
            let from = (run.from as usize).max(tile.columns.0);
            let to = (run.to as usize).min(tile.columns.1);
            (from < to && row >= tile.rows.0 && row < tile.rows.1).then_some((row, from, to))
        });
        let mut count = 0;
        let mut bounds = Rectangle {
            columns: (usize::MAX, 0),
            rows: (usize::MAX, 0),
        };
        for (row, from, to) in clipped.clone() {
            count += to - from;
            bounds.columns = (bounds.columns.0.min(from), bounds.columns.1.max(to));
            bounds.rows = (bounds.rows.0.min(row), bounds.rows.1.max(row + 1));
        }
        if count == 0 {
            return;
        }
        let shader = self.shader;
        if self.ink.quantities() == 0 {
            for (row, from, to) in clipped {
                let y = (top + row) as f64 + 0.5;
                self.ink
                    .put_row(memory, shader, order, row, (from, to), patch, y);
            }
            return;
        }
        if count > WORTH * self.fit.nodes() {
            let centre =
                |column: usize, row: usize| (column as f64 + 0.5, (top + row) as f64 + 0.5);
            let corners = (
                centre(bounds.columns.0, bounds.rows.0),
                centre(bounds.columns.1 - 1, bounds.rows.1 - 1),
            );
            let mut first = None;
            let fits = self.fit.fit(
                patch,
                corners,
                self.ink.quantities(),
                self.ink.tolerance(),
                |place, values| {
                    let ray = shader.ray(place);
                    let Some(u) = shader.u(order, &ray) else {
                        return false;
                    };
                    self.ink.evaluate(shader, order, u, &ray, values);
                    self.ink
                        .unwrap(values, first.get_or_insert_with(|| self.ink.kept(values)));
                    true
                },
            );
            if fits {
                for (row, from, to) in clipped {
                    self.ink.put_row(
                        memory,
                        shader,
                        order,
                        row,
                        (from, to),
                        patch,
                        (top + row) as f64 + 0.5,
                    );
                }
                return;
            }
            // The longer side is halved.
            let (wide, high) = (
                bounds.columns.1 - bounds.columns.0,
                bounds.rows.1 - bounds.rows.0,
            );
            let halves = if wide >= high {
                let middle = bounds.columns.0 + wide / 2;
                [
                    Rectangle {
                        columns: (bounds.columns.0, middle),
                        ..bounds
                    },
                    Rectangle {
                        columns: (middle, bounds.columns.1),
                        ..bounds
                    },
                ]
            } else {
                let middle = bounds.rows.0 + high / 2;
                [
                    Rectangle {
                        rows: (bounds.rows.0, middle),
                        ..bounds
                    },
                    Rectangle {
                        rows: (middle, bounds.rows.1),
                        ..bounds
                    },
                ]
            };
            for half in halves {
                self.paint_tile(order, top, runs, half, patch, memory);
            }
            return;
        }
        let mut values = [0.0; 8];
        for (row, from, to) in clipped {
            for column in from..to {
                if self.smooth && self.ink.averages() {
                    let place = (column as f64 + 0.5, (top + row) as f64 + 0.5);
                    let mixture = Mixture::new(shader, place);
                    let whole = Part { order, share: 1.0 };
                    self.ink
                        .put_mixture(memory, shader, row, column, &[whole], &mixture);
                    continue;
                }
                let ray = shader.ray((column as f64 + 0.5, (top + row) as f64 + 0.5));
                let u = shader.u_on_disk(order, &ray);
                self.ink.evaluate(shader, order, u, &ray, &mut values);
                self.ink
                    .put(memory, shader, order, (row, column), &ray, &values);
            }
        }
    }

    /// Paints the pixels that are covered in part.
    fn paint_partial(&self, top: usize, scratch: &mut ShadedScratch, memory: &mut I::Band<'_>) {
        let partial = &mut scratch.partial;
        partial.sort_unstable_by_key(|partial| (partial.row, partial.column, partial.order));
        let parts = &mut scratch.parts;
        for pixel in partial.chunk_by(|a, b| (a.row, a.column) == (b.row, b.column)) {
            parts.clear();
            parts.extend(pixel.iter().map(|part| Part {
                order: part.order,
                share: part.share,
            }));
            let (row, column) = (pixel[0].row as usize, pixel[0].column as usize);
            let place = (column as f64 + 0.5, (top + row) as f64 + 0.5);
            let mixture = Mixture::new(self.shader, place);
            self.ink
                .put_mixture(memory, self.shader, row, column, parts, &mixture);
        }
    }
}
