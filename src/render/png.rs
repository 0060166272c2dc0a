//! Pictures as grey PNG files.

use std::io::{self, Write};
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// The bytes of an 8-bit grey PNG file with these pixels, row by row from the top.
///
/// # Errors
/// Where the number of pixels is not `width` × `height`.
pub fn encode(pixels: &[u8], width: u32, height: u32) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Up)
        .write_image(pixels, width, height, ExtendedColorType::L8)
        .map_err(io::Error::other)?;
    Ok(bytes)
}

/// Writes [such a file](encode) to `path`, whole or not at all.
///
/// # Errors
/// What the file system says.
pub fn write(path: &Path, pixels: &[u8], width: u32, height: u32) -> io::Result<()> {
    let bytes = encode(pixels, width, height)?;
    crate::output::write_whole(path, |file| file.write_all(&bytes))
}
