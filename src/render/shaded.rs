//! Draws frames with light or data, in bands of rows.
//!
//! Each order has an outline of its own: where it lies in front. So every pixel is known to be covered wholly by one
//! order, or partly by one or several. What is covered wholly is painted from [patches](super::patch); each partly
//! covered pixel is a [mixture](super::mixture) of its orders.

use std::cell::{Cell, RefCell};

use super::banded::{BandScratch, BandedOutline};
use super::cells::{Cells, ONE};
use super::frame::{Threads, on_threads};
use super::ink::{Ink, Part};
use super::painter::{Painter, Partial};
use super::path::OutlinePath;
use super::projection::Projection;
use super::shader::Shader;
use super::tiles::{Run, TILE};
use crate::isoradial::Boundary;

/// A band is a row of tiles.
pub(super) const ROWS_OF_BAND: usize = TILE.1;

/// A share above this counts as the whole: areas are rounded.
const WHOLE: i64 = ONE - 8;

/// A smaller share counts as none. So what one order covers as a whole has no part of another.
const LEAST: i64 = 16;

/// The memory that frames with light or data are drawn with.
#[derive(Debug, Default)]
pub(super) struct ShadedWorkspace {
    outlines: Vec<(u32, BandedOutline)>,
    scratch: Vec<ShadedScratch>,
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
}

/// No order, in [`ShadedScratch::orders`].
const NONE: u8 = u8::MAX;

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
        (half, workspace): (&'a mut OutlinePath, &'a mut ShadedWorkspace),
        shader: &'a Shader<'a>,
        (smooth, threads): (bool, Threads),
    ) -> Self {
        Self {
            half,
            workspace,
            shader,
            smooth,
            threads,
        }
    }

    /// Paints the frame band by band. `bands` are the parts of its memory, each of [`ROWS_OF_BAND`] rows.
    pub(super) fn paint<'b, I: Ink<N>, const N: usize>(
        mut self,
        ink: &I,
        bands: impl Iterator<Item = I::Band<'b>> + Send,
    ) {
        let (shader, smooth) = (self.shader, self.smooth);
        let (view, curves) = (shader.view, shader.curves);
        let height = view.height() as usize;
        let rows = ROWS_OF_BAND;
        let count = self.threads.count();
        let is_meaningful = self.draw_outlines(rows);
        let workspace = self.workspace;
        let outlines = &workspace.outlines[..curves.orders().len()];
        let scratch = &mut workspace.scratch;
        scratch.resize_with(scratch.len().max(count), Default::default);
        on_threads(&mut scratch[..count], bands, |scratch, band, mut memory| {
            let top = band * rows;
            let rows = rows.min(height - top);
            let painter = Painter { shader, ink, top };
            if smooth && is_meaningful && !outlines.is_empty() {
                scratch.paint_smooth(outlines, band, rows, &painter, &mut memory);
            } else {
                let outlines = is_meaningful.then_some(outlines);
                scratch.find_orders(outlines, band, rows, &painter);
                painter.clear_but(rows, &[], &mut memory);
                for shown in curves.orders() {
                    scratch.paint_order(shown.number(), rows, &painter, &mut memory);
                }
            }
            ink.finish(&mut memory, shader, top);
        });
    }

    /// Draws the outline of each order. Returns whether they are more than rounding.
    fn draw_outlines(&mut self, rows: usize) -> bool {
        let (view, curves) = (self.shader.view, self.shader.curves);
        let projection = Projection::new(view, curves);
        let orders = curves.orders();
        let outlines = &mut self.workspace.outlines;
        outlines.resize_with(orders.len().max(outlines.len()), Default::default);
        let on_all_threads = self.threads.count() > 1;
        let mut is_meaningful = true;
        for ((order, outline), shown) in outlines.iter_mut().zip(orders) {
            *order = shown.number();
            let number = Some(*order);
            let weight = |boundary: &Boundary| {
                i32::from(boundary.above == number) - i32::from(boundary.below == number)
            };
            outline.trace(self.half, &projection, self.smooth, weight, on_all_threads);
            is_meaningful &= outline.is_meaningful(curves);
            let sees = |place| self.shader.front_at(place) == number;
            outline.sort(view, rows, sees);
        }
        is_meaningful
    }
}

/// Orders and their outlines.
type Outlines = [(u32, BandedOutline)];

impl ShadedScratch {
    /// Paints a band with smooth edges.
    fn paint_smooth<I: Ink<N>, const N: usize>(
        &mut self,
        outlines: &Outlines,
        band: usize,
        rows: usize,
        painter: &Painter<'_, I, N>,
        memory: &mut I::Band<'_>,
    ) {
        self.partial.clear();
        for (i, (order, outline)) in outlines.iter().enumerate() {
            self.runs.clear();
            outline.draw(band, &mut self.band);
            let (runs, partial) = (&mut self.runs, &mut self.partial);
            self.band.rows(|cells, row, left| {
                collect(cells, row, left, *order, runs, partial);
            });
            if i == 0 {
                painter.clear_but(rows, &[], memory);
            }
            painter.paint_runs(*order, rows, &self.runs, memory);
        }
        painter.paint_partial(&mut self.partial, &mut self.parts, memory);
    }

    /// Finds the order that the centre of each pixel of a band sees: from outlines, or by asking each.
    fn find_orders<I, const N: usize>(
        &mut self,
        outlines: Option<&Outlines>,
        band: usize,
        rows: usize,
        painter: &Painter<'_, I, N>,
    ) {
        let shader = painter.shader;
        let width = shader.view.width() as usize;
        let seen = |column: usize, row: usize| {
            let place = (column as f64 + 0.5, (painter.top + row) as f64 + 0.5);
            shader.front_at(place).map_or(NONE, |front| front as u8)
        };
        let orders = &mut self.orders;
        orders.clear();
        orders.resize(width * rows, NONE);
        let Some(outlines) = outlines else {
            for (i, order) in orders.iter_mut().enumerate() {
                *order = seen(i % width, i / width);
            }
            return;
        };
        for (order, outline) in outlines {
            outline.draw(band, &mut self.band);
            self.band.rows(|cells, row, left| {
                let orders = &mut orders[row * width..][..width];
                let orders = Cell::from_mut(orders).as_slice_of_cells();
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
            for &(column, row) in &self.band.doubtful {
                let (column, row) = (column as usize, row as usize);
                orders[row * width + column] = seen(column, row);
            }
        }
    }

    /// Paints the pixels whose centres see an order.
    fn paint_order<I: Ink<N>, const N: usize>(
        &mut self,
        order: u32,
        rows: usize,
        painter: &Painter<'_, I, N>,
        memory: &mut I::Band<'_>,
    ) {
        self.runs.clear();
        let width = painter.shader.view.width() as usize;
        for (row, orders) in self.orders.chunks_exact(width).enumerate() {
            runs_of(orders, order as u8, row, &mut self.runs);
        }
        painter.paint_runs(order, rows, &self.runs, memory);
    }
}

/// Collects a row's pixels of one order.
fn collect(
    cells: &mut Cells,
    row: usize,
    left: i64,
    order: u32,
    runs: &mut Vec<Run>,
    partial: &mut Vec<Partial>,
) {
    let (runs, partial) = (RefCell::new(runs), RefCell::new(partial));
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
                    part: Part {
                        order,
                        share: share as f32 / ONE as f32,
                    },
                });
            }
        }
    };
    cells.walk(row, left, add, |column, share| {
        add(column, column + 1, share);
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
