//! Why a frame could not be drawn, and the memory that it takes.

use crate::orbit::OrbitError;
use crate::scene::View;

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
    make_room(view, &mut pixels)?;
    Ok(pixels)
}

/// Makes `pixels` as long as a frame. Old content may stay.
///
/// # Errors
/// [`RenderError::Memory`]
pub(super) fn make_room(view: &View, pixels: &mut Vec<u8>) -> Result<(), RenderError> {
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
        // Asks for what drawing takes beside the frame and gives it back: a later refusal would end the process.
        Vec::<u8>::new()
            .try_reserve_exact(WORKING_MEMORY)
            .map_err(|_| memory())?;
    }
    pixels.resize(length, 0);
    Ok(())
}

/// Returns the bytes from the first pixel of a frame to its last, where rows are `stride` bytes apart.
///
/// # Errors
/// [`RenderError::Buffer`] where rows overlap, or `pixels` is shorter.
pub(super) fn check_buffer(
    view: &View,
    pixels: &[u8],
    stride: usize,
) -> Result<usize, RenderError> {
    let (width, height) = (view.width() as usize, view.height() as usize);
    let needed = stride.saturating_mul(height - 1).saturating_add(width);
    if stride < width || pixels.len() < needed {
        return Err(RenderError::Buffer {
            width,
            height,
            stride,
            bytes: pixels.len(),
        });
    }
    Ok(needed)
}
