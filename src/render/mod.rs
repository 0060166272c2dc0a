//! Frames: what a pixel's centre sees, white where that is the disk at any order ([`mask`], [`pixelwise`]), or the share
//! of its square that the disk covers ([`coverage`]); of many views [side by side](batch).
//!
//! A viewer or an encoder has frames drawn into memory of its own:
//!
//! ```
//! use darkness::isoradial::{Isoradials, CurveSpec};
//! use darkness::orbit::exact::Exact;
//! use darkness::render::coverage;
//! use darkness::scene::{Scene, View};
//!
//! let scene = Scene::builtin("classic").unwrap().with_size(320, 180)?;
//! let view = View::new(&scene);
//! // From a table's lookup in place of Exact in half the time.
//! let curves = Isoradials::new(&CurveSpec::new(&scene, &view, scene.tolerance()), &Exact);
//! // Rows of 320 bytes, 512 apart.
//! let mut memory = vec![0; 512 * 180];
//! coverage::render_into(&view, &curves, &mut memory, 512)?;
//! assert!(memory.contains(&255));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arc;
pub mod batch;
mod cells;
pub mod coverage;
pub mod frame;
pub mod mask;
pub mod needs;
mod path;
pub mod pixelwise;
mod projection;

use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use crate::orbit::OrbitError;
use crate::scene::View;

/// Why a frame could not be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// The frame is too large for the memory there is.
    #[error(
        "a picture of {width} × {height} pixels takes {bytes} bytes of memory, more than there is: ask for a smaller one"
    )]
    Memory {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// What they take.
        bytes: u64,
    },
    /// The frame does not fit the buffer it is to be drawn into.
    #[error(
        "a picture of {width} × {height} pixels, its rows {stride} bytes apart, does not fit a buffer of {bytes} bytes"
    )]
    Buffer {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// From one row to the next.
        stride: usize,
        /// What there is.
        bytes: usize,
    },
    /// A ray could not be followed.
    #[error(transparent)]
    Orbit(#[from] OrbitError),
}

/// A frame of which each pixel (column, row) is found by itself.
fn each_pixel(
    view: &View,
    value: impl Fn(usize, usize) -> u8 + Sync,
) -> Result<Vec<u8>, RenderError> {
    let mut pixels = blank(view)?;
    pixels
        .par_chunks_exact_mut(view.width() as usize)
        .enumerate()
        .for_each(|(row, pixels)| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                *pixel = value(column, row);
            }
        });
    Ok(pixels)
}

/// White: the disk.
pub const WHITE: u8 = 255;

/// What is behind a lock: whole at every moment here, also where a thread panicked.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// More than curves and whatever else a frame takes beside its pixels, in bytes.
const BESIDE: usize = 16 << 20;

/// A black frame.
fn blank(view: &View) -> Result<Vec<u8>, RenderError> {
    let mut pixels = Vec::new();
    blank_into(view, &mut pixels)?;
    Ok(pixels)
}

/// Makes room for a frame: what was there may stay.
fn blank_into(view: &View, pixels: &mut Vec<u8>) -> Result<(), RenderError> {
    let (width, height) = (view.width(), view.height());
    let bytes = u64::from(width) * u64::from(height);
    let memory = || RenderError::Memory {
        width,
        height,
        bytes,
    };
    let length = usize::try_from(bytes).map_err(|_| memory())?;
    let more = length.saturating_sub(pixels.len());
    pixels.try_reserve_exact(more).map_err(|_| memory())?;
    if more > 0 {
        // What drawing takes beside it: asked for and given back, since where it is refused later the process ends.
        Vec::<u8>::new()
            .try_reserve_exact(BESIDE)
            .map_err(|_| memory())?;
    }
    pixels.resize(length, 0);
    Ok(())
}
