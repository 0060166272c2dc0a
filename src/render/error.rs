//! Why a frame could not be drawn, and the memory that it takes.

use crate::orbit::OrbitError;
use crate::scene::{Region, View};

/// Why a frame could not be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// There is not enough memory for the frame.
    #[error(
        "a picture of {width} × {height} pixels takes {bytes} bytes of memory, more than there is"
    )]
    Memory {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The bytes of the picture.
        bytes: u64,
    },
    /// The buffer is too small for the frame, or its rows are too near to each other.
    #[error(
        "a picture of {width} × {height} pixels with rows {stride} bytes apart does not fit a buffer of {bytes} bytes"
    )]
    Buffer {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes from one row to the next.
        stride: usize,
        /// The bytes of the buffer.
        bytes: usize,
    },
    /// Colours or temperatures were asked of a scene that has none.
    #[error(
        "the scene's disk has no light to show: give it a [disk.light] table, with a temperature for temperatures"
    )]
    NoLight,
    /// A file of the sky could not be read: why.
    #[error("{0}")]
    Sky(String),
    /// A ray could not be followed.
    #[error(transparent)]
    Orbit(#[from] OrbitError),
}

/// More than the curves and the workspace of a frame take, in bytes.
const WORKING_MEMORY: usize = 16 << 20;

/// Returns a black frame.
///
/// # Errors
/// [`RenderError::Memory`]
pub(super) fn blank(view: &View) -> Result<Vec<u8>, RenderError> {
    let mut pixels = Vec::new();
    make_room(view, 1, &mut pixels)?;
    Ok(pixels)
}

/// Makes `samples` as long as a frame with so many `channels`. Old content may stay.
///
/// # Errors
/// [`RenderError::Memory`]
pub(super) fn make_room<T: Copy + Default>(
    view: &View,
    channels: usize,
    samples: &mut Vec<T>,
) -> Result<(), RenderError> {
    let Region { width, height, .. } = view.region();
    let length = u64::from(width) * u64::from(height) * channels as u64;
    let bytes = length * size_of::<T>() as u64;
    let memory = || RenderError::Memory {
        width,
        height,
        bytes,
    };
    let length = usize::try_from(length).map_err(|_| memory())?;
    let more = length.saturating_sub(samples.len());
    samples.try_reserve_exact(more).map_err(|_| memory())?;
    if more > 0 {
        // Asks for what drawing takes beside the frame and gives it back: a later refusal would end the process.
        Vec::<u8>::new()
            .try_reserve_exact(WORKING_MEMORY)
            .map_err(|_| memory())?;
    }
    samples.resize(length, T::default());
    Ok(())
}

/// Returns the samples from the first one of a frame to its last, where rows are `stride` samples apart.
///
/// # Errors
/// [`RenderError::Buffer`] where rows overlap, or `samples` is shorter.
pub(super) fn check_buffer<T>(
    view: &View,
    channels: usize,
    samples: &[T],
    stride: usize,
) -> Result<usize, RenderError> {
    let part = view.region();
    let (width, height) = (part.width as usize, part.height as usize);
    let row = channels * width;
    let needed = stride.saturating_mul(height - 1).saturating_add(row);
    if stride < row || samples.len() < needed {
        return Err(RenderError::Buffer {
            width,
            height,
            stride: stride.saturating_mul(size_of::<T>()),
            bytes: size_of_val(samples),
        });
    }
    Ok(needed)
}
