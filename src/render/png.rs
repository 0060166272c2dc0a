//! Pictures as grey PNG files.

use std::io::{self, Write};
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// Writes 8-bit grey pixels, row by row from the top, to `path`: whole or not at all.
///
/// # Errors
/// What the file system says.
pub fn write(path: &Path, pixels: &[u8], width: u32, height: u32) -> io::Result<()> {
    crate::output::write_whole(path, |file| {
        let mut bytes = Vec::new();
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Up)
            .write_image(pixels, width, height, ExtendedColorType::L8)
            .map_err(io::Error::other)?;
        file.write_all(&bytes)
    })
}
