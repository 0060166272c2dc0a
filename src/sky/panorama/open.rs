//! Reads a panorama's file: from its header to linear light.

mod header;

use std::cell::Cell;
use std::error::Error;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::Path;

use exr::block::reader::Reader as ExrReader;
use exr::prelude::{ReadChannels, ReadLayers, Vec2};
use image::{ImageDecoder, ImageFormat, ImageReader, Limits};
use rayon::prelude::*;

use header::{HEAD, Watched, check_hdr_header, check_jpeg_end, claimed_size};

use super::Panorama;
use super::mip_level::MipLevel;
use crate::light::srgb;
use crate::quotation;
use crate::sky::{PanoramaProblem, SkyError};

/// The greatest height, half the greatest width.
pub(super) const MOST_ROWS: usize = 8192;
/// The most light that a texel holds; sums of four stay far within the range of f32.
const MOST_LIGHT: f64 = 1e30;
/// The most bytes that a PNG decoder takes beside the pixels, for rows and chunks. It inflates colour profiles, though
/// none is used: one that is larger is left out.
const MOST_ASIDE: u64 = 64 << 20;

impl Panorama {
    /// Reads a longitude–latitude picture, all of its light times 2^`exposure_stops`, with at most `max_bytes` of
    /// memory.
    ///
    /// The format is told by the file's content: PNG of 8 or 16 bits and JPEG, which are read as sRGB, or Radiance HDR
    /// and OpenEXR (the first part with channels R, G and B), which are linear, with Rec. 709 primaries. Grey pictures
    /// count as white light; alpha, embedded colour profiles, gamma and exposure values are ignored. Of float files,
    /// negative values and NaN are read as 0, and light ends at 1e30 after the exposure.
    ///
    /// The picture is twice as wide as high, at most 16384 × 8192. All of it is kept in memory, 12 bytes a pixel, and
    /// its smaller sizes with it: 16 bytes a pixel together. This is also the peak while reading, but for PNG of 16
    /// bits, of which the file's own pixels stay until they are converted:
    ///
    /// | | 8192 × 4096 | 16384 × 8192 |
    /// |---|---|---|
    /// | kept | 537 MB | 2148 MB |
    /// | peak: PNG of 16 bits, with alpha | 671 MB | 2685 MB |
    /// | peak: PNG of 16 bits | 604 MB | 2416 MB |
    /// | peak: other files | 537 MB | 2148 MB |
    ///
    /// A JPEG file's length comes on top of its pixels, and is counted too.
    ///
    /// # Errors
    /// What [`PanoramaProblem`] lists. Size and memory are checked before memory is taken.
    pub fn open(path: &Path, exposure_stops: f64, max_bytes: u64) -> Result<Self, SkyError> {
        let scale = libm::exp2(exposure_stops);
        match read(path, scale, max_bytes) {
            Ok(level) => Ok(Self::with_levels(level)),
            Err(problem) => Err(SkyError::Panorama {
                path: path.to_path_buf(),
                problem,
            }),
        }
    }
}

/// Reads the picture at its own size.
fn read(path: &Path, scale: f64, max_bytes: u64) -> Result<MipLevel, PanoramaProblem> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(PanoramaProblem::NotAFile);
    }
    let has_ended = Cell::new(false);
    let mut file = BufReader::new(Watched {
        file: File::open(path)?,
        has_ended: &has_ended,
    });
    let mut head = Vec::new();
    file.by_ref().take(HEAD).read_to_end(&mut head)?;
    file.rewind()?;
    has_ended.set(false);
    let format = image::guess_format(&head).map_err(|_| PanoramaProblem::UnknownFormat)?;
    // A size that is too large is told before a decoder stumbles over it.
    let claimed = claimed_size(format, &head);
    let claimed = claimed.map(|(width, height)| checked_height(width, height));
    let least = claimed.transpose()?.map_or(0, Panorama::bytes_of);
    // The decoder holds all of a JPEG file, and all lines of a Radiance file's header.
    match format {
        ImageFormat::Png | ImageFormat::OpenExr => {}
        ImageFormat::Jpeg => check_memory(metadata.len(), max_bytes)?,
        ImageFormat::Hdr => check_hdr_header(&head)?,
        _ => return Err(PanoramaProblem::UnknownFormat),
    }
    let level = if format == ImageFormat::OpenExr {
        read_exr(file, scale, max_bytes)
    } else {
        decode(path, format, file, scale, max_bytes)
    };
    level.map_err(|problem| match problem {
        // A decoder that runs out of memory has asked for less than the picture takes.
        PanoramaProblem::Undecodable(_) if least > max_bytes => PanoramaProblem::Memory {
            needed: least,
            allowed: max_bytes,
        },
        PanoramaProblem::Undecodable(_) if format == ImageFormat::Jpeg => {
            check_jpeg_end(path).err().unwrap_or(problem)
        }
        PanoramaProblem::Undecodable(_) if has_ended.get() => PanoramaProblem::Truncated,
        problem => problem,
    })
}

/// Decodes a PNG, JPEG or Radiance file.
fn decode(
    path: &Path,
    format: ImageFormat,
    file: impl BufRead + Seek,
    scale: f64,
    max_bytes: u64,
) -> Result<MipLevel, PanoramaProblem> {
    let mut reader = ImageReader::with_format(file, format);
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(max_bytes.min(MOST_ASIDE));
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(undecodable)?;
    let (width, height) = decoder.dimensions();
    let height = checked_height(width.into(), height.into())?;
    if format == ImageFormat::Jpeg {
        check_jpeg_end(path)?;
    }
    let length = MipLevel::length(height);
    let (colour, pixel_bytes) = (decoder.color_type(), decoder.total_bytes());
    let channels = usize::from(colour.channel_count());
    let level = 4 * length as u64;
    let kept = Panorama::bytes_of(height);
    match colour.bytes_per_pixel() / colour.channel_count() {
        1 => {
            let file = if format == ImageFormat::Jpeg {
                fs::metadata(path)?.len()
            } else {
                0
            };
            check_memory(
                kept.max(level + pixel_bytes).max(file + pixel_bytes),
                max_bytes,
            )?;
            let mut pixels = vec![0_u8; pixel_bytes as usize];
            decoder.read_image(&mut pixels).map_err(undecodable)?;
            Ok(from_srgb(height, &pixels, channels, u8::MAX.into(), scale))
        }
        2 => {
            check_memory(kept.max(level + pixel_bytes), max_bytes)?;
            let mut pixels = vec![0_u16; pixel_bytes as usize / 2];
            let bytes = bytemuck::cast_slice_mut(&mut pixels);
            decoder.read_image(bytes).map_err(undecodable)?;
            Ok(from_srgb(height, &pixels, channels, u16::MAX, scale))
        }
        // Radiance files: three floats a pixel.
        _ => {
            check_memory(kept, max_bytes)?;
            let mut values = vec![0_f32; length];
            let pixels = bytemuck::cast_slice_mut(&mut values[..length - 1]);
            decoder.read_image(pixels).map_err(undecodable)?;
            values
                .par_iter_mut()
                .for_each(|value| *value = light(*value, scale));
            Ok(MipLevel::new(height, values))
        }
    }
}

/// Makes a level of sRGB codes.
fn from_srgb<Code: Copy + Into<usize> + Sync>(
    height: usize,
    pixels: &[Code],
    channels: usize,
    most: u16,
    scale: f64,
) -> MipLevel {
    let codes = 0..=most;
    let table: Vec<f32> = codes
        .map(|code| {
            light(
                srgb::decode(f64::from(code) / f64::from(most)) as f32,
                scale,
            )
        })
        .collect();
    let mut values = vec![0.0; MipLevel::length(height)];
    let (to, from) = (
        values.par_chunks_exact_mut(6 * height),
        pixels.par_chunks_exact(2 * height * channels),
    );
    to.zip(from).for_each(|(to, from)| {
        for (to, from) in to.chunks_exact_mut(3).zip(from.chunks_exact(channels)) {
            // Grey is one channel, or two with alpha.
            let colour = if channels < 3 {
                [from[0]; 3]
            } else {
                [from[0], from[1], from[2]]
            };
            to.copy_from_slice(&colour.map(|code| table[code.into()]));
        }
    });
    MipLevel::new(height, values)
}

/// Returns a float file's light: not negative, not NaN, and finite.
fn light(value: f32, scale: f64) -> f32 {
    let value = f64::from(value) * scale;
    if value > 0.0 {
        value.min(MOST_LIGHT) as f32
    } else {
        0.0
    }
}

/// Reads the colours of an `OpenEXR` file.
fn read_exr(
    file: impl BufRead + Seek,
    scale: f64,
    max_bytes: u64,
) -> Result<MipLevel, PanoramaProblem> {
    let reader = ExrReader::read_from_buffered(file, false).map_err(undecodable)?;
    let header = reader.headers().iter().find(|header| {
        let has = |name: &str| {
            header
                .channels
                .find_index_of_channel(&name.into())
                .is_some()
        };
        !header.deep && ["R", "G", "B"].into_iter().all(has)
    });
    let header = header.ok_or_else(|| undecodable("it has no channels R, G and B"))?;
    let window = header.shared_attributes.display_window;
    let height = checked_height(window.size.width() as u64, window.size.height() as u64)?;
    // Pixels may be there for a part of the picture, and the rest is black.
    let position = header.own_attributes.layer_position;
    let first = [position.x(), position.y()].map(i64::from);
    let origin = [window.position.x(), window.position.y()].map(i64::from);
    let first = [first[0] - origin[0], first[1] - origin[1]];
    let size = [header.layer_size.width(), header.layer_size.height()];
    let all = [2 * height, height];
    if (0..2).any(|i| first[i] < 0 || first[i] as u64 + size[i] as u64 > all[i] as u64) {
        return Err(undecodable("it has pixels outside its display window"));
    }
    check_memory(Panorama::bytes_of(height), max_bytes)?;
    let first = first[0] as usize + first[1] as usize * 2 * height;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            move |_, _| vec![0.0; MipLevel::length(height)],
            move |values: &mut Vec<f32>,
                  place: Vec2<usize>,
                  (red, green, blue): (f32, f32, f32)| {
                let texel = first + place.y() * 2 * height + place.x();
                if let Some(to) = values.get_mut(3 * texel..3 * texel + 3) {
                    to.copy_from_slice(&[red, green, blue].map(|value| light(value, scale)));
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_chunks(reader)
        .map_err(undecodable)?;
    Ok(MipLevel::new(height, image.layer_data.channel_data.pixels))
}

/// Checks the size in pixels, and returns the height.
fn checked_height(width: u64, height: u64) -> Result<usize, PanoramaProblem> {
    if width != 2 * height || height == 0 {
        Err(PanoramaProblem::Shape { width, height })
    } else if height > MOST_ROWS as u64 {
        Err(PanoramaProblem::TooLarge { width, height })
    } else {
        Ok(height as usize)
    }
}

/// Checks that so many bytes are allowed, and that the system grants them: an allocation that fails ends the process.
fn check_memory(needed: u64, allowed: u64) -> Result<(), PanoramaProblem> {
    if needed > allowed {
        return Err(PanoramaProblem::Memory { needed, allowed });
    }
    let granted = usize::try_from(needed)
        .is_ok_and(|needed| Vec::<u8>::new().try_reserve_exact(needed).is_ok());
    if !granted {
        return Err(io::Error::from(io::ErrorKind::OutOfMemory).into());
    }
    Ok(())
}

fn undecodable(reason: impl Into<Box<dyn Error>>) -> PanoramaProblem {
    PanoramaProblem::Undecodable(quotation::beginning(&reason.into().to_string(), 120))
}
