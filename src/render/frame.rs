//! Draws a frame from its outline, in bands of rows. Each band is drawn by one thread.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::WHITE;
use super::arc::EdgeArc;
use super::cells::{Cells, ONE, fixed};
use super::centre::{fill_every_pixel, sees};
use super::error::{RenderError, check_buffer};
use super::path::OutlinePath;
use super::projection::Projection;
use crate::isoradial::{Boundary, Isoradials};
use crate::scene::View;

/// The largest error of an arc for smooth edges, in pixels.
const SMOOTH: f64 = 1.0 / 512.0;

/// The largest error of an arc for hard edges, in pixels. Pixels whose centres are within twice that of an arc are
/// evaluated one by one.
const HARD: f64 = 1.0 / 200.0;

/// Every pixel is evaluated by itself, with hard edges, if rounding moves an edge by more than this, in pixels, or if
/// the outline takes too many arcs. An outline has no meaning below the rounding of its curves.
const COARSE: f64 = 0.1;

/// Memory for the cells of a band, in bytes: what the nearer caches hold.
const BAND: usize = 1 << 20;

/// Who draws a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Threads {
    /// All threads of the current rayon pool.
    All,
    /// This thread alone.
    This,
}

/// The memory that frames are drawn with. It is reused: a frame like the one before allocates nothing.
#[derive(Debug, Default)]
pub struct Workspace {
    path: OutlinePath,
    /// Half of the path while it is drawn.
    half: OutlinePath,
    /// The arcs that pass each band, band by band.
    sorted: Vec<u32>,
    /// Where each band's arcs begin in that list, and where the last band's end.
    firsts: Vec<usize>,
    /// One for each thread.
    scratch: Vec<Scratch>,
}

/// What a thread draws a band with.
#[derive(Debug, Default)]
struct Scratch {
    cells: Cells,
    /// Pixels of the band whose centres are too near to an arc: column and row.
    doubtful: Vec<(u32, u32)>,
    /// The path's crossings of the left side within the band: the first row that lies wholly below, and the weight.
    left_crossings: Vec<(usize, i32)>,
}

/// A frame that is being drawn, band by band.
struct Bands<'a> {
    view: &'a View,
    curves: &'a Isoradials,
    smooth: bool,
    /// The distance from an arc within which a pixel's centre is doubtful.
    doubt: f64,
    path: &'a OutlinePath,
    sorted: &'a [u32],
    firsts: &'a [usize],
    /// The winding number along the picture's left side, without the path's crossings of it.
    left: i32,
    width: usize,
    height: usize,
    /// Rows of a band.
    rows: usize,
    stride: usize,
}

impl Workspace {
    /// Draws a frame: row j begins at `j stride` of `pixels`. With `smooth` each pixel is the share of its square that
    /// the disk covers, else white where its centre sees the disk. What lies between the rows' ends stays as it is.
    ///
    /// # Errors
    /// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
    pub fn draw(
        &mut self,
        view: &View,
        curves: &Isoradials,
        smooth: bool,
        threads: Threads,
        pixels: &mut [u8],
        stride: usize,
    ) -> Result<(), RenderError> {
        let needed = check_buffer(view, pixels, stride)?;
        let (width, height) = (view.width() as usize, view.height() as usize);
        let projection = Projection::new(view, curves);
        let tolerance = if smooth { SMOOTH } else { HARD };
        let count = match threads {
            Threads::All => rayon::current_num_threads(),
            Threads::This => 1,
        };
        self.path
            .draw(&mut self.half, &projection, tolerance, covers, count > 1);
        if curves.error().rounding > COARSE || !self.path.is_complete() {
            fill_every_pixel(view, curves, &mut pixels[..needed], stride);
            return Ok(());
        }
        let rows = (BAND / (size_of::<i64>() * width)).clamp(1, height);
        self.sort(height, rows);
        let frame = Bands {
            view,
            curves,
            smooth,
            doubt: 2.0 * (tolerance + curves.error().rounding) + 2.0 / ONE as f64,
            path: &self.path,
            sorted: &self.sorted,
            firsts: &self.firsts,
            left: left(&self.path, view, curves),
            width,
            height,
            rows,
            stride,
        };
        let bands = pixels[..needed]
            .chunks_mut(stride.saturating_mul(rows))
            .enumerate();
        self.scratch
            .resize_with(self.scratch.len().max(count), Scratch::default);
        if count == 1 {
            let scratch = &mut self.scratch[0];
            bands.for_each(|(band, pixels)| frame.draw(band, pixels, scratch));
        } else {
            let bands = Mutex::new(bands);
            // The iterator is whole even if a thread panicked while it held the lock.
            let next = || bands.lock().unwrap_or_else(PoisonError::into_inner).next();
            self.scratch[..count].par_iter_mut().for_each(|scratch| {
                while let Some((band, pixels)) = next() {
                    frame.draw(band, pixels, scratch);
                }
            });
        }
        Ok(())
    }

    /// Sorts the path's arcs into bands: counts those of each band, and places them from the last to the first.
    fn sort(&mut self, height: usize, rows: usize) {
        let band = |row: f64| (row.max(0.0) as usize).min(height - 1) / rows;
        let bands_of = |arc: &EdgeArc| {
            let (first, last) = arc.rows();
            band(first)..=band(last + 1.0 / ONE as f64)
        };
        let bands = height.div_ceil(rows);
        self.firsts.clear();
        self.firsts.resize(bands + 1, 0);
        for arc in &self.path.arcs {
            for band in bands_of(arc) {
                self.firsts[band] += 1;
            }
        }
        let mut end = 0;
        for first in &mut self.firsts {
            end += *first;
            *first = end;
        }
        self.sorted.clear();
        self.sorted.resize(end, 0);
        for (i, arc) in self.path.arcs.iter().enumerate().rev() {
            for band in bands_of(arc) {
                self.firsts[band] -= 1;
                self.sorted[self.firsts[band]] = i as u32;
            }
        }
    }
}

/// How much more of the disk there is on the inner side of a boundary than on the other.
fn covers(boundary: &Boundary) -> i32 {
    i32::from(boundary.above.is_some()) - i32::from(boundary.below.is_some())
}

impl Bands<'_> {
    /// Draws a band.
    fn draw(&self, band: usize, pixels: &mut [u8], scratch: &mut Scratch) {
        let top = band * self.rows;
        let rows = self.rows.min(self.height - top);
        let cells = &mut scratch.cells;
        cells.set(self.width, top, rows);
        scratch.doubtful.clear();
        for &arc in &self.sorted[self.firsts[band]..self.firsts[band + 1]] {
            let arc = &self.path.arcs[arc as usize];
            if self.smooth {
                cells.cover(arc);
            } else {
                cells.cross(arc, self.doubt, &mut scratch.doubtful);
            }
        }
        let mut left = self.left;
        scratch.left_crossings.clear();
        for crossing in &self.path.left_crossings {
            let first = if self.smooth {
                cells.cover_below(crossing.y, crossing.weight)
            } else {
                cells.first_below(crossing.y)
            };
            if first <= 0 {
                left += crossing.weight;
            } else if first < rows as i64 {
                scratch
                    .left_crossings
                    .push((first as usize, crossing.weight));
            }
        }
        scratch.left_crossings.sort_unstable();
        let mut crossings = scratch.left_crossings.iter().peekable();
        for row in 0..rows {
            while let Some((_, weight)) = crossings.next_if(|&&(first, _)| first <= row) {
                left += weight;
            }
            let pixels = &mut pixels[row * self.stride..][..self.width];
            fill_row(cells, row, i64::from(left) * ONE, pixels);
        }
        for &(column, row) in &scratch.doubtful {
            let (column, row) = (column as usize, row as usize);
            let is_white = sees(
                self.view,
                self.curves,
                (column as f64 + 0.5, (top + row) as f64 + 0.5),
            );
            pixels[row * self.stride + column] = if is_white { WHITE } else { 0 };
        }
    }
}

/// Fills a row of pixels with their shares.
fn fill_row(cells: &mut Cells, row: usize, left: i64, pixels: &mut [u8]) {
    pixels.fill(0);
    let pixels = core::cell::Cell::from_mut(pixels).as_slice_of_cells();
    cells.walk(
        row,
        left,
        |from, to, share| {
            if share > 0 {
                let value = grey(share);
                for pixel in &pixels[from..to] {
                    pixel.set(value);
                }
            }
        },
        |column, share| pixels[column].set(grey(share)),
    );
}

/// A share as a grey, to the nearest.
fn grey(share: i64) -> u8 {
    ((share * i64::from(WHITE) + ONE / 2) / ONE) as u8
}

/// Returns the winding number along the picture's left side, without the path's crossings of it.
///
/// It follows from one place far from the path: from whether the disk is seen there, and from what the path adds on the
/// way there from the left side.
fn left(path: &OutlinePath, view: &View, curves: &Isoradials) -> i32 {
    /// The most places that are tried.
    const MOST: u32 = 24;
    /// A place this far from the path is far enough, in pixels.
    const FAR: f64 = 2.0;
    // Places spread over the picture, the first one in its middle (Roberts 2018: the plastic number's powers). Pixels'
    // centres alone would not do: in a picture of one row all of them may lie on an edge.
    let place =
        |i: u32, share: f64, size: u32| (0.5 + f64::from(i) * share).fract() * f64::from(size);
    let mut best = (-1.0, (0.0, 0.0));
    for i in 0..MOST {
        let place = (
            place(i, 0.754_877_666_246_692_8, view.width()),
            place(i, 0.569_840_290_998_053_3, view.height()),
        );
        let distance = distance(path, place);
        if distance > best.0 {
            best = (distance, place);
        }
        if distance > FAR {
            break;
        }
    }
    i32::from(sees(view, curves, best.1)) - winding(path, best.1)
}

/// Returns about how far a place is from the path: along rows for steep arcs, along columns for flat ones.
fn distance(path: &OutlinePath, (x, y): (f64, f64)) -> f64 {
    path.arcs.iter().fold(f64::INFINITY, |least, arc| {
        let (u, v) = if arc.steep { (y, x) } else { (x, y) };
        let nearest = u.clamp(arc.u.0, arc.u.1);
        least.min((u - nearest).abs().max((v - arc.at(nearest)).abs()))
    })
}

/// Returns what the path adds to the winding number on the way down the picture's left side and then right to a place.
fn winding(path: &OutlinePath, (x, y): (f64, f64)) -> i32 {
    let is_below = |place: f64| i32::from(fixed(place) > fixed(y));
    let from_left = path
        .left_crossings
        .iter()
        .map(|crossing| crossing.weight * (1 - is_below(crossing.y)));
    let arcs = path.arcs.iter().map(|arc: &EdgeArc| {
        let passes = if arc.steep {
            let passes = is_below(arc.u.1) - is_below(arc.u.0);
            if passes != 0 && arc.at(y) < x {
                passes
            } else {
                0
            }
        } else if arc.u.0 < x {
            let last = if arc.u.1 <= x { arc.v.1 } else { arc.at(x) };
            is_below(last) - is_below(arc.v.0)
        } else {
            0
        };
        arc.weight * passes
    });
    from_left.chain(arcs).sum()
}
