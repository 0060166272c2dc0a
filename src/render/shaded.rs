//! Draws frames with light or data, in bands of rows.
//!
//! Each order has an outline of its own: where it lies in front. So every pixel is known to be covered wholly by one
//! order, or partly by one or several. What is covered wholly is painted from [patches](super::patch); each partly
//! covered pixel is a [mixture](super::mixture) of its orders.

use std::cell::{Cell, RefCell};

use super::banded::{BandScratch, BandedOutline};
use super::cells::{Cells, ONE};
use super::centre::share_within_rim;
use super::edge_map::EdgeMap;
use super::frame::{Threads, on_threads};
use super::ink::{Ink, Part};
use super::painter::{Painter, Partial};
use super::path::OutlinePath;
use super::runs::{complement, keep, runs_of, without};
use super::shader::Shader;
use super::sky::{FrameSky, StarImages};
use super::tiles::{Run, TILE, TileRow, tiles_of};
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
    stars: StarImages,
}

/// What a thread draws a band with.
#[derive(Debug, Default)]
struct ShadedScratch {
    band: BandScratch,
    runs: Vec<Run>,
    partial: Vec<Partial>,
    /// Those across a fisheye's rim.
    rim: Vec<Partial>,
    parts: Vec<Part>,
    /// For hard edges: the order of each pixel of the band.
    orders: Vec<u8>,
    /// Pixels that the disk covers wholly, and those that it does not.
    covered: Vec<Run>,
    free: Vec<Run>,
    /// Pixels whose centres see the sky, for data of it.
    centres: Vec<Run>,
    /// The sky's light, and whether all of it is 0.
    light: Vec<[f32; 3]>,
    is_dark: bool,
}

/// No order, in [`ShadedScratch::orders`].
const NONE: u8 = u8::MAX;

/// A frame with light or data, and the memory that it is drawn with.
pub(super) struct ShadedFrame<'a> {
    half: &'a mut OutlinePath,
    workspace: &'a mut ShadedWorkspace,
    shader: &'a Shader<'a>,
    sky: Option<&'a FrameSky<'a>>,
    smooth: bool,
    threads: Threads,
}

impl<'a> ShadedFrame<'a> {
    /// A frame with smooth edges or hard ones, on some threads.
    pub(super) fn new(
        (half, workspace): (&'a mut OutlinePath, &'a mut ShadedWorkspace),
        (shader, sky): (&'a Shader<'a>, Option<&'a FrameSky<'a>>),
        (smooth, threads): (bool, Threads),
    ) -> Self {
        Self {
            half,
            workspace,
            shader,
            sky,
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
        let rows = ROWS_OF_BAND;
        let count = self.threads.count();
        let is_meaningful = self.draw_outlines(rows);
        let workspace = self.workspace;
        let outlines = &workspace.outlines[..curves.orders().len()];
        let sky = self.sky;
        let stars = &mut workspace.stars;
        if let Some(sky) = sky {
            sky.find_stars(stars, rows, self.threads);
        }
        let stars = &*stars;
        let scratch = &mut workspace.scratch;
        scratch.resize_with(scratch.len().max(count), Default::default);
        on_threads(&mut scratch[..count], bands, |scratch, band, mut memory| {
            let band = TileRow::new(view, band);
            let painter = Painter { shader, ink, band };
            let sky = sky.map(|sky| BandSky { sky, stars });
            if smooth && is_meaningful && !outlines.is_empty() {
                scratch.paint_smooth(outlines, &painter, sky.as_ref(), &mut memory);
            } else {
                let outlines = is_meaningful.then_some(outlines);
                scratch.find_orders(outlines, &painter);
                painter.clear(&mut memory);
                scratch.paint_stars(&painter, sky.as_ref(), &mut memory);
                scratch.free.clear();
                for (row, orders) in scratch.orders.chunks_exact(band.width).enumerate() {
                    runs_of(orders, NONE, row, &mut scratch.free);
                }
                keep(&mut scratch.free, |row| band.seen_columns(view, row));
                for shown in curves.orders() {
                    scratch.paint_order(shown.number(), &painter, &mut memory);
                }
                if let Some(sky) = &sky {
                    scratch.paint_sky(&painter, sky, &mut memory);
                    ink.put_directions(&mut memory, &sky.sky.shader, band, &scratch.free);
                }
            }
            scratch.darken(&painter, sky.as_ref());
            ink.finish(&mut memory, shader, band);
            painter.clear_beyond_the_rim(&mut memory);
            ink.hand_over(&mut memory);
        });
    }

    /// Draws the outline of each order. Returns whether they are more than rounding.
    fn draw_outlines(&mut self, rows: usize) -> bool {
        let (view, curves) = (self.shader.view, self.shader.curves);
        let map = EdgeMap::new(view, curves);
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
            outline.trace(self.half, &map, self.smooth, weight, on_all_threads);
            is_meaningful &= outline.is_meaningful(curves);
            let sees = |place| self.shader.front_at(place) == number;
            outline.sort(view, tiles_of(view), rows, sees);
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
        painter: &Painter<'_, I, N>,
        sky: Option<&BandSky<'_>>,
        memory: &mut I::Band<'_>,
    ) {
        let band = painter.band;
        self.partial.clear();
        self.covered.clear();
        painter.clear(memory);
        self.paint_stars(painter, sky, memory);
        for (order, outline) in outlines {
            self.runs.clear();
            outline.draw(band.number, &mut self.band);
            let (runs, partial) = (&mut self.runs, &mut self.partial);
            self.band.rows(|cells, row, left| {
                collect(cells, row, left, *order, runs, partial);
            });
            let view = painter.shader.view;
            keep(runs, |row| band.inner_columns(view, row));
            add_rim(painter, *order, runs, &mut self.rim);
            painter.paint_runs(*order, &self.runs, memory);
            if sky.is_some() {
                self.covered.extend_from_slice(&self.runs);
            }
        }
        if let Some(sky) = sky {
            self.covered.sort_unstable_by_key(|run| (run.row, run.from));
            let size = (band.width as u32, band.rows as u32);
            complement(&self.covered, size, &mut self.free);
            let view = painter.shader.view;
            keep(&mut self.free, |row| band.seen_columns(view, row));
            self.paint_sky(painter, sky, memory);
        }
        let view = painter.shader.view;
        self.partial.retain(|pixel| {
            let (from, to) = band.inner_columns(view, pixel.row as usize);
            (from..to).contains(&(pixel.column as usize))
        });
        self.partial.append(&mut self.rim);
        let beside = |row: usize, column: usize| {
            let light = self.light.get(row * band.width + column);
            let sky = sky.filter(|sky| sky.sky.shines());
            sky.and(light).copied().unwrap_or_default()
        };
        painter.paint_partial(&mut self.partial, &mut self.parts, beside, memory);
        if let Some(sky) = sky
            && painter.ink.needs_directions()
        {
            self.find_centres(painter);
            painter
                .ink
                .put_directions(memory, &sky.sky.shader, band, &self.centres);
        }
    }

    /// Paints the stars of a sky that nothing fills: before the disk, which hides them.
    fn paint_stars<I: Ink<N>, const N: usize>(
        &mut self,
        painter: &Painter<'_, I, N>,
        sky: Option<&BandSky<'_>>,
        memory: &mut I::Band<'_>,
    ) {
        let Some(sky) = sky.filter(|sky| sky.sky.has_stars() && !sky.sky.is_filled()) else {
            return;
        };
        let (view, band) = (painter.shader.view, painter.band);
        let pixels = band.width * band.rows;
        if !self.is_dark || self.light.len() != pixels {
            self.light.clear();
            self.light.resize(pixels, [0.0; 3]);
            self.is_dark = true;
        }
        let light = &mut self.light;
        sky.stars.add(view, band, light);
        sky.stars.pixels(band, |row, column| {
            let pixel = row * band.width + column;
            painter
                .ink
                .put_light(memory, row, column, &light[pixel..=pixel]);
        });
    }

    /// Takes the stars out of the light again: most of it is dark all the time.
    fn darken<I, const N: usize>(
        &mut self,
        painter: &Painter<'_, I, N>,
        sky: Option<&BandSky<'_>>,
    ) {
        if let Some(sky) = sky.filter(|_| self.is_dark) {
            let (light, band) = (&mut self.light, painter.band);
            sky.stars.pixels(band, |row, column| {
                light[row * band.width + column] = [0.0; 3];
            });
        }
    }

    /// Paints what fills the sky, and stars before it, beside what the disk covers wholly.
    fn paint_sky<I: Ink<N>, const N: usize>(
        &mut self,
        painter: &Painter<'_, I, N>,
        sky: &BandSky<'_>,
        memory: &mut I::Band<'_>,
    ) {
        if !sky.sky.is_filled() {
            return;
        }
        let (view, band) = (painter.shader.view, painter.band);
        self.is_dark = false;
        self.light.clear();
        self.light.resize(band.width * band.rows, [0.0; 3]);
        sky.sky.paint(band, &self.free, &mut self.light);
        if sky.sky.has_stars() {
            sky.stars.add(view, band, &mut self.light);
        }
        for run in &self.free {
            let (row, from, to) = (run.row as usize, run.from as usize, run.to as usize);
            let light = &self.light[row * band.width..][from..to];
            painter.ink.put_light(memory, row, from, light);
        }
    }

    /// Finds the pixels whose centres do not see the disk.
    fn find_centres<I, const N: usize>(&mut self, painter: &Painter<'_, I, N>) {
        self.covered.clear();
        for pixel in &self.partial {
            let place = painter
                .band
                .centre(pixel.column as usize, pixel.row as usize);
            if painter.shader.front_at(place).is_some() {
                self.covered.push(Run {
                    row: pixel.row,
                    from: pixel.column,
                    to: pixel.column + 1,
                });
            }
        }
        self.covered.sort_unstable_by_key(|run| (run.row, run.from));
        without(&self.free, &self.covered, &mut self.centres);
    }

    /// Finds the order that the centre of each pixel of a band sees: from outlines, or by asking each.
    fn find_orders<I, const N: usize>(
        &mut self,
        outlines: Option<&Outlines>,
        painter: &Painter<'_, I, N>,
    ) {
        let (shader, band) = (painter.shader, painter.band);
        let width = band.width;
        let seen = |column: usize, row: usize| {
            let place = band.centre(column, row);
            shader.front_at(place).map_or(NONE, |front| front as u8)
        };
        let orders = &mut self.orders;
        orders.clear();
        orders.resize(width * band.rows, NONE);
        let Some(outlines) = outlines else {
            for (i, order) in orders.iter_mut().enumerate() {
                *order = seen(i % width, i / width);
            }
            return;
        };
        for (order, outline) in outlines {
            outline.draw(band.number, &mut self.band);
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
        for (row, orders) in orders.chunks_exact_mut(width).enumerate() {
            let (from, to) = painter.band.seen_columns(shader.view, row);
            orders[..from].fill(NONE);
            orders[to..].fill(NONE);
        }
    }

    /// Paints the pixels whose centres see an order.
    fn paint_order<I: Ink<N>, const N: usize>(
        &mut self,
        order: u32,
        painter: &Painter<'_, I, N>,
        memory: &mut I::Band<'_>,
    ) {
        self.runs.clear();
        let width = painter.band.width;
        for (row, orders) in self.orders.chunks_exact(width).enumerate() {
            runs_of(orders, order as u8, row, &mut self.runs);
        }
        painter.paint_runs(order, &self.runs, memory);
    }
}

/// The sky of a band.
struct BandSky<'a> {
    sky: &'a FrameSky<'a>,
    stars: &'a StarImages,
}

/// Adds the pixels across a fisheye's rim that an order covers wholly or in part, where no area counts.
fn add_rim<I, const N: usize>(
    painter: &Painter<'_, I, N>,
    order: u32,
    runs: &mut Vec<Run>,
    partial: &mut Vec<Partial>,
) {
    let (shader, band, count) = (painter.shader, painter.band, runs.len());
    for row in 0..band.rows {
        let seen = band.seen_columns(shader.view, row);
        let inner = band.inner_columns(shader.view, row);
        for column in (seen.0..inner.0).chain(inner.1..seen.1) {
            let corner = ((band.left + column) as f64, (band.top + row) as f64);
            let sees = |place| shader.front_at(place) == Some(order);
            let share = share_within_rim(shader.view, corner, sees);
            let (row, column) = (row as u32, column as u32);
            if share == 1.0 {
                runs.push(Run {
                    row,
                    from: column,
                    to: column + 1,
                });
            } else if share > 0.0 {
                let share = share as f32;
                partial.push(Partial {
                    row,
                    column,
                    part: Part { order, share },
                });
            }
        }
    }
    if runs.len() > count {
        runs.sort_unstable_by_key(|run| (run.row, run.from));
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
