//! Frames: white where a pixel's centre sees the disk at any order, black elsewhere.

pub mod mask;
pub mod needs;
pub mod pixelwise;
pub mod png;

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
        bytes: usize,
    },
    /// A ray could not be followed.
    #[error(transparent)]
    Orbit(#[from] OrbitError),
}

/// A black frame.
fn blank(view: &View) -> Result<Vec<u8>, RenderError> {
    let (width, height) = (view.width(), view.height());
    let bytes = width as usize * height as usize;
    let mut pixels = Vec::new();
    pixels
        .try_reserve_exact(bytes)
        .map_err(|_| RenderError::Memory {
            width,
            height,
            bytes,
        })?;
    pixels.resize(bytes, 0);
    Ok(pixels)
}
