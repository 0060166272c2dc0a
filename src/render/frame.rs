//! Draws a frame from its outline, in bands of rows. Each band is drawn by one thread.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::WHITE;
use super::banded::{BandScratch, BandedOutline};
use super::cells::{Cells, ONE};
use super::centre::{fill_every_pixel, front, share_within_rim};
use super::edge_map::EdgeMap;
use super::error::{RenderError, check_buffer};
use super::path::OutlinePath;
use super::shaded::ShadedWorkspace;
use crate::isoradial::{Boundary, Isoradials};
use crate::scene::{Region, View};

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

impl Threads {
    /// How many there are.
    pub(super) fn count(self) -> usize {
        match self {
            Self::All => rayon::current_num_threads(),
            Self::This => 1,
        }
    }
}

/// The memory that frames are drawn with. It is reused: a frame like the one before allocates nothing.
#[derive(Debug, Default)]
pub struct Workspace {
    outline: BandedOutline,
    /// Half of a path while it is drawn.
    half: OutlinePath,
    /// One for each thread.
    scratch: Vec<BandScratch>,
    /// For frames with light or data.
    shaded: ShadedWorkspace,
}

/// A frame that is being drawn, band by band.
struct Bands<'a> {
    view: &'a View,
    curves: &'a Isoradials,
    outline: &'a BandedOutline,
    smooth: bool,
    stride: usize,
}

impl Workspace {
    /// What frames with light or data are drawn with.
    pub(super) fn for_shading(&mut self) -> (&mut OutlinePath, &mut ShadedWorkspace) {
        (&mut self.half, &mut self.shaded)
    }

    /// Draws a frame: row j begins at `j stride` of `pixels`. With `smooth` each pixel is the share of its square that
    /// the disk covers, else white where its centre sees the disk. What lies between the rows' ends stays as it is.
    ///
    /// # Errors
    /// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
    pub fn draw<T: MaskSample>(
        &mut self,
        view: &View,
        curves: &Isoradials,
        smooth: bool,
        threads: Threads,
        pixels: &mut [T],
        stride: usize,
    ) -> Result<(), RenderError> {
        let needed = check_buffer(view, 1, pixels, stride)?;
        let map = EdgeMap::new(view, curves);
        let count = threads.count();
        let part = view.region();
        let rows = rows_of_band(part);
        let outline = &mut self.outline;
        outline.trace(&mut self.half, &map, smooth, covers, count > 1);
        if !outline.is_meaningful(curves) {
            fill_every_pixel(view, curves, &mut pixels[..needed], stride);
            return Ok(());
        }
        outline.sort(view, part, rows, |place| {
            front(view, curves, place).is_some()
        });
        let frame = Bands {
            view,
            curves,
            outline,
            smooth,
            stride,
        };
        let bands = pixels[..needed].chunks_mut(stride.saturating_mul(rows));
        self.scratch
            .resize_with(self.scratch.len().max(count), BandScratch::default);
        on_threads(
            &mut self.scratch[..count],
            bands,
            |scratch, band, pixels| {
                frame.draw(band, pixels, scratch);
            },
        );
        Ok(())
    }
}

/// Works on bands, each thread with memory of its own.
pub(super) fn on_threads<S: Send, B: Send>(
    scratch: &mut [S],
    bands: impl Iterator<Item = B> + Send,
    work: impl Fn(&mut S, usize, B) + Sync,
) {
    let bands = bands.enumerate();
    if let [scratch] = scratch {
        bands.for_each(|(band, pixels)| work(scratch, band, pixels));
        return;
    }
    let bands = Mutex::new(bands);
    // The iterator is whole even if a thread panicked while it held the lock.
    let next = || bands.lock().unwrap_or_else(PoisonError::into_inner).next();
    scratch.par_iter_mut().for_each(|scratch| {
        while let Some((band, pixels)) = next() {
            work(scratch, band, pixels);
        }
    });
}

/// The rows of a band: as many as the nearer caches hold the cells of.
fn rows_of_band(part: Region) -> usize {
    (BAND / (size_of::<i64>() * part.width as usize)).clamp(1, part.height as usize)
}

/// How much more of the disk there is on the inner side of a boundary than on the other.
pub(super) fn covers(boundary: &Boundary) -> i32 {
    i32::from(boundary.above.is_some()) - i32::from(boundary.below.is_some())
}

impl Bands<'_> {
    /// Draws a band.
    fn draw<T: MaskSample>(&self, band: usize, pixels: &mut [T], scratch: &mut BandScratch) {
        let part = self.view.region();
        let (width, stride) = (part.width as usize, self.stride);
        let top = self.outline.draw(band, scratch);
        scratch.rows(|cells, row, left| {
            let pixels = &mut pixels[row * stride..][..width];
            fill_row(cells, row, left, pixels);
            let (from, to) = self.view.shown_columns((top + row) as u32);
            let within = |column: u32| (column.saturating_sub(part.left) as usize).min(width);
            pixels[..within(from)].fill(T::default());
            pixels[within(to)..].fill(T::default());
            if !self.smooth {
                return;
            }
            let inner = self.view.inner_columns((top + row) as u32);
            for column in (within(from)..within(inner.0)).chain(within(inner.1)..within(to)) {
                pixels[column] = self.at_rim(column, top + row);
            }
        });
        for &(column, row) in &scratch.doubtful {
            let (column, row) = (column as usize, row as usize);
            pixels[row * stride + column] = self.at_centre(column, top + row);
        }
    }

    /// The value of a pixel across a fisheye's rim: a column of the drawn part, and a row of the picture.
    fn at_rim<T: MaskSample>(&self, column: usize, row: usize) -> T {
        let left = self.view.region().left as usize;
        let corner = ((left + column) as f64, row as f64);
        let sees = |place| front(self.view, self.curves, place).is_some();
        let share = share_within_rim(self.view, corner, sees);
        T::of_share((share * ONE as f64) as i64)
    }

    /// What the centre of a pixel sees: a column of the drawn part, and a row of the picture.
    fn at_centre<T: MaskSample>(&self, column: usize, row: usize) -> T {
        let left = self.view.region().left as usize;
        let place = ((left + column) as f64 + 0.5, row as f64 + 0.5);
        if front(self.view, self.curves, place).is_some() {
            T::WHITE
        } else {
            T::default()
        }
    }
}

/// Fills a row of pixels with their shares.
fn fill_row<T: MaskSample>(cells: &mut Cells, row: usize, left: i64, pixels: &mut [T]) {
    pixels.fill(T::default());
    let pixels = core::cell::Cell::from_mut(pixels).as_slice_of_cells();
    cells.walk(
        row,
        left,
        |from, to, share| {
            if share > 0 {
                let value = T::of_share(share);
                for pixel in &pixels[from..to] {
                    pixel.set(value);
                }
            }
        },
        |column, share| pixels[column].set(T::of_share(share)),
    );
}

/// A sample of a mask: 0 where there is no disk.
pub trait MaskSample: Copy + Default + Send {
    /// Its value where the disk covers all.
    const WHITE: Self;

    /// A share of 65536, to the nearest.
    fn of_share(share: i64) -> Self;
}

impl MaskSample for u8 {
    const WHITE: Self = WHITE;

    #[inline(always)]
    fn of_share(share: i64) -> Self {
        ((share * i64::from(WHITE) + ONE / 2) / ONE) as Self
    }
}

impl MaskSample for u16 {
    const WHITE: Self = Self::MAX;

    #[inline(always)]
    fn of_share(share: i64) -> Self {
        ((share * i64::from(Self::MAX) + ONE / 2) / ONE) as Self
    }
}
