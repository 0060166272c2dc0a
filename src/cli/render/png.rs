//! Frames as PNG files.
//!
//! Masks are grey: their values are linear coverage, and a gAMA chunk of 1.0 says so. Colour is sRGB: an sRGB chunk,
//! and for readers that do not know it the gAMA and cHRM chunks that the PNG specification pairs with it (11.3.2.5). A
//! sample has 8 or 16 bits, or one where edges are hard. Text chunks (11.3.3) before the pixels hold the program's
//! version (`Software`) and the [`FrameOrigin`]: `darkness:scene`, `darkness:table`, `darkness:frame`.

use std::borrow::Cow;
use std::io;

use png::{
    BitDepth, ColorType, Compression, Encoder, Filter, ScaledFloat, SourceChromaticities,
    SrgbRenderingIntent,
};

use super::memory;
use super::origin::{ANY_VERSION, FrameOrigin, SOFTWARE};
use crate::render::Pixels;
use crate::scene::ImageSize;

/// An upper bound for the encoder's memory apart from the pixels, in bytes.
const ENCODER_MEMORY: usize = 4 << 20;

/// The first bytes of every PNG file.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1A\n";

/// Whether a file that begins with `head` is a PNG file that some version of this program made.
pub(super) fn is_ours(head: &[u8]) -> bool {
    let text = [b"tEXt", SOFTWARE.as_bytes(), b"\0", ANY_VERSION.as_bytes()].concat();
    let has_text = |rest: &[u8]| rest.windows(text.len()).any(|window| window == text);
    head.strip_prefix(&SIGNATURE).is_some_and(has_text)
}

/// Whether `file` is a whole PNG file of `depth` bits a sample, with correct checksums, that this version of the
/// program made of `origin`.
pub(super) fn made(file: &[u8], depth: u8, origin: &FrameOrigin) -> bool {
    let mut texts = origin.texts().into_iter().peekable();
    let mut rest = file.strip_prefix(&SIGNATURE).unwrap_or_default();
    let mut has_pixels = false;
    while let Some((kind, data, after)) = chunk(rest) {
        rest = after;
        match kind {
            // Width and height, four bytes each, come before the depth.
            b"IHDR" if data.get(8) != Some(&depth) => return false,
            b"tEXt" => {
                // They come in the order in which they were written.
                let Some((keyword, text)) = texts.next() else {
                    return false;
                };
                let written = [keyword.as_bytes(), text.as_bytes()].join(&0);
                if data != written {
                    return false;
                }
            }
            b"IDAT" => has_pixels = true,
            b"IEND" => return has_pixels && texts.peek().is_none() && rest.is_empty(),
            _ => {}
        }
    }
    false
}

/// The first chunk, if it is whole: its kind, its data, and what follows.
fn chunk(bytes: &[u8]) -> Option<(&[u8; 4], &[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    // PNG is big-endian.
    let length = length
        .iter()
        .fold(0_usize, |sum, &byte| sum << 8 | usize::from(byte));
    let (checked, after) = rest.split_at_checked(length.checked_add(4)?)?;
    let (checksum, after) = after.split_first_chunk::<4>()?;
    let found = checksum
        .iter()
        .fold(0_u32, |sum, &byte| sum << 8 | u32::from(byte));
    let (kind, data) = checked.split_first_chunk()?;
    (crc32fast::hash(checked) == found).then_some((kind, data, after))
}

/// Encodes a frame. With `one_bit` a grey sample of 8 bits becomes one bit, which is set from 128 up.
///
/// # Errors
/// The number of pixels is not that of `size`, or there is not enough memory to encode them.
pub(super) fn encode(
    pixels: Pixels<'_>,
    size: ImageSize,
    one_bit: bool,
    origin: &FrameOrigin,
) -> io::Result<Vec<u8>> {
    let (color, depth, samples) = samples(pixels, size.width, one_bit)?;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, size.width, size.height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == ColorType::Rgb {
        encoder.set_source_gamma(ScaledFloat::from_scaled(45455));
        encoder.set_source_chromaticities(SourceChromaticities::new(
            (0.3127, 0.3290),
            (0.64, 0.33),
            (0.30, 0.60),
            (0.15, 0.06),
        ));
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    } else {
        encoder.set_source_gamma(ScaledFloat::new(1.0));
    }
    // Measured on masks and on the lit built-in scenes: the fastest. For 8 and 16 bits files are within a third of the
    // smallest that any filter gives at this speed. The next better compression halves them, and takes 4 to 13 times
    // as long.
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(if depth == BitDepth::One {
        Filter::Up
    } else {
        Filter::Sub
    });
    for (keyword, text) in origin.texts() {
        encoder.add_text_chunk(keyword.into(), text)?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&samples)?;
    writer.finish()?;
    Ok(bytes)
}

/// The samples as PNG holds them: packed, or with the higher byte first.
fn samples(
    pixels: Pixels<'_>,
    width: u32,
    one_bit: bool,
) -> io::Result<(ColorType, BitDepth, Cow<'_, [u8]>)> {
    // What is encoded of smooth grey is twice a tenth of it, hard grey takes an eighth packed and as much encoded.
    let room = match pixels {
        Pixels::Grey8(pixels) => pixels.len() / 2,
        Pixels::Rgb8(pixels) => pixels.len(),
        Pixels::Grey16(pixels) | Pixels::Rgb16(pixels) => 4 * pixels.len(),
        Pixels::Planes(_) => 0,
    };
    memory::grant(room + ENCODER_MEMORY)?;
    let high_first = |samples: &[u16]| {
        let bytes = samples
            .iter()
            .flat_map(|&sample| [(sample >> 8) as u8, sample as u8]);
        Cow::Owned(bytes.collect())
    };
    Ok(match pixels {
        Pixels::Grey8(pixels) if one_bit => (
            ColorType::Grayscale,
            BitDepth::One,
            packed(pixels, width as usize).into(),
        ),
        Pixels::Grey8(pixels) => (ColorType::Grayscale, BitDepth::Eight, pixels.into()),
        Pixels::Grey16(pixels) => (ColorType::Grayscale, BitDepth::Sixteen, high_first(pixels)),
        Pixels::Rgb16(pixels) => (ColorType::Rgb, BitDepth::Sixteen, high_first(pixels)),
        Pixels::Rgb8(pixels) => (ColorType::Rgb, BitDepth::Eight, pixels.into()),
        Pixels::Planes(_) => return Err(io::Error::other("a PNG picture has no layers")),
    })
}

/// Packs eight pixels into a byte, the first into the highest bit; each row starts a new byte.
fn packed(pixels: &[u8], width: usize) -> Vec<u8> {
    let mut bits = Vec::with_capacity(pixels.len().div_ceil(8));
    for row in pixels.chunks(width.max(1)) {
        let (eights, rest) = row.as_chunks::<8>();
        bits.extend(eights.iter().copied().map(byte));
        if !rest.is_empty() {
            let mut last = [0; 8];
            last[..rest.len()].copy_from_slice(rest);
            bits.push(byte(last));
        }
    }
    bits
}

/// The highest bits of eight pixels.
fn byte(pixels: [u8; 8]) -> u8 {
    let bits = pixels
        .iter()
        .fold(0, |bits, pixel| bits << 1 | u32::from(pixel >> 7));
    bits as u8
}

#[cfg(test)]
mod tests {
    use super::super::origin::tests::{
        assert_no_other_is_taken, assert_only_ours_is_taken, origin,
    };
    use super::*;

    /// What a decoder makes of a file: its header, and its samples.
    fn decoded(file: &[u8]) -> (png::Info<'static>, Vec<u8>) {
        let mut decoder = png::Decoder::new(io::Cursor::new(file));
        decoder.set_transformations(png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().unwrap();
        let mut samples = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut samples).unwrap();
        (reader.info().clone(), samples)
    }

    const SIZE: ImageSize = ImageSize {
        width: 37,
        height: 5,
    };

    #[test]
    fn masks_are_linear_and_their_pixels_and_texts_come_back() {
        let pixels: Vec<u8> = (0..37 * 5).map(|i| (i * 7 % 256) as u8).collect();
        for one_bit in [false, true] {
            let file = encode(Pixels::Grey8(&pixels), SIZE, one_bit, &origin(12)).unwrap();
            let (info, read) = decoded(&file);
            let texts: Vec<_> = info
                .uncompressed_latin1_text
                .iter()
                .map(|text| (text.keyword.as_str(), text.text.as_str()))
                .collect();
            assert!(texts.contains(&("darkness:frame", "12")), "{texts:?}");
            assert_eq!(texts.len(), 4);
            assert_eq!(info.gama_chunk, Some(ScaledFloat::from_scaled(100_000)));
            assert_eq!(info.srgb, None);
            if one_bit {
                let bit =
                    |column: usize, row: usize| read[row * 5 + column / 8] >> (7 - column % 8) & 1;
                for (i, pixel) in pixels.iter().enumerate() {
                    assert_eq!(bit(i % 37, i / 37), pixel >> 7);
                }
            } else {
                assert_eq!(read, pixels);
            }
        }
        assert!(encode(Pixels::Grey8(&pixels[1..]), SIZE, false, &origin(1)).is_err());
        assert!(encode(Pixels::Planes(&[]), SIZE, false, &origin(1)).is_err());
    }

    #[test]
    fn colour_is_srgb_and_wide_samples_come_back() {
        let wide: Vec<u16> = (0..37 * 5 * 3_u32)
            .map(|i| (i * 577 % 65_521) as u16)
            .collect();
        let bytes: Vec<u8> = wide.iter().map(|sample| *sample as u8).collect();
        for (pixels, is_colour) in [
            (Pixels::Rgb8(&bytes), true),
            (Pixels::Rgb16(&wide), true),
            (Pixels::Grey16(&wide[..37 * 5]), false),
        ] {
            let file = encode(pixels, SIZE, false, &origin(12)).unwrap();
            let (info, read) = decoded(&file);
            match pixels {
                Pixels::Rgb8(pixels) => assert_eq!(read, pixels),
                Pixels::Grey16(pixels) | Pixels::Rgb16(pixels) => {
                    assert_eq!(info.bit_depth, BitDepth::Sixteen);
                    for (pair, &sample) in read.as_chunks::<2>().0.iter().zip(pixels) {
                        assert_eq!(u16::from(pair[0]) << 8 | u16::from(pair[1]), sample);
                    }
                    assert_eq!(read.len(), 2 * pixels.len());
                }
                _ => unreachable!(),
            }
            if is_colour {
                assert_eq!(info.srgb, Some(SrgbRenderingIntent::Perceptual));
                assert_eq!(info.gama_chunk, Some(ScaledFloat::from_scaled(45455)));
                let white = info.chrm_chunk.unwrap().white;
                assert_eq!(
                    white,
                    (
                        ScaledFloat::from_scaled(31270),
                        ScaledFloat::from_scaled(32900)
                    )
                );
            } else {
                assert_eq!(info.gama_chunk, Some(ScaledFloat::from_scaled(100_000)));
            }
        }
    }

    #[test]
    fn a_file_of_another_origin_or_with_any_damage_is_not_taken_for_the_same() {
        let pixels = [0, 255, 255, 17, 0, 3];
        let size = ImageSize {
            width: 3,
            height: 2,
        };
        let file = encode(Pixels::Grey8(&pixels), size, false, &origin(12)).unwrap();
        assert!(made(&file, 8, &origin(12)));
        assert!(!made(&file, 1, &origin(12)));
        assert_no_other_is_taken(&file, &origin(12), |file, origin| made(file, 8, origin));
        assert_only_ours_is_taken(&file, is_ours);
    }
}
