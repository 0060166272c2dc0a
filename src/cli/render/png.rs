//! Frames as grey PNG files that record their origin.
//!
//! Smooth frames have 8 bits a pixel, frames with hard edges (pixels of 0 or 255) one bit. Text chunks (PNG
//! specification, 11.3.3) before the pixels hold the program's version (`Software`) and the [`FrameOrigin`]:
//! `darkness:scene`, `darkness:table`, `darkness:frame`.

use std::io;

use png::{BitDepth, ColorType, Compression, Encoder, Filter};

/// An upper bound for the encoder's memory apart from the pixels, in bytes.
const ENCODER_MEMORY: usize = 4 << 20;

/// The first bytes of every PNG file.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1A\n";

/// What a frame was made of: with the program's version, all that its bytes depend on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FrameOrigin {
    /// The SHA-256 of the scene's TOML form, as hexadecimal digits.
    pub(super) scene: String,
    /// The SHA-256 of the table's file, or the name of the method in place of a table.
    pub(super) table: String,
    /// The frame's number.
    pub(super) frame: u32,
}

impl FrameOrigin {
    /// The origin of another frame of the same animation.
    pub(super) fn of_frame(&self, frame: u32) -> Self {
        Self {
            frame,
            ..self.clone()
        }
    }

    /// The text chunks, as keyword and text.
    fn texts(&self) -> [(&'static str, String); 4] {
        [
            (
                "Software",
                concat!("darkness ", env!("CARGO_PKG_VERSION")).into(),
            ),
            ("darkness:scene", self.scene.clone()),
            ("darkness:table", self.table.clone()),
            ("darkness:frame", self.frame.to_string()),
        ]
    }

    /// Whether `file` is a whole PNG file, with correct checksums, that this version of the program made of this
    /// origin.
    pub(super) fn made(&self, file: &[u8]) -> bool {
        let mut texts = self.texts().into_iter().peekable();
        let mut rest = file.strip_prefix(&SIGNATURE).unwrap_or_default();
        let mut has_pixels = false;
        while let Some((kind, data, after)) = chunk(rest) {
            rest = after;
            match kind {
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

/// Encodes grey pixels, row by row from the top, with 8 bits a pixel; or with one bit, which is set where the pixel is
/// at least 128.
///
/// # Errors
/// The number of pixels is not `width` × `height`, or there is not enough memory to encode them.
pub(super) fn encode(
    pixels: &[u8],
    (width, height): (u32, u32),
    one_bit: bool,
    origin: &FrameOrigin,
) -> io::Result<Vec<u8>> {
    check_memory(pixels.len())?;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Grayscale);
    // Measured: the fastest, and within a sixth of the smallest file.
    encoder.set_compression(Compression::Fast);
    for (keyword, text) in origin.texts() {
        encoder.add_text_chunk(keyword.into(), text)?;
    }
    if one_bit {
        encoder.set_depth(BitDepth::One);
        encoder.set_filter(Filter::Up);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&packed(pixels, width as usize))?;
        writer.finish()?;
    } else {
        encoder.set_depth(BitDepth::Eight);
        encoder.set_filter(Filter::Sub);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(pixels)?;
        writer.finish()?;
    }
    Ok(bytes)
}

/// Checks that the system grants the memory to encode `pixels` pixels: an allocation that fails in the encoder ends the
/// process.
fn check_memory(pixels: usize) -> io::Result<()> {
    // Hard frames take an eighth packed and as much encoded; smooth ones twice a tenth.
    let mut room = Vec::<u8>::new();
    room.try_reserve_exact(pixels / 2 + ENCODER_MEMORY)
        .map_err(|_| {
            let problem =
                format!("not enough memory to encode {pixels} pixels; choose a smaller picture");
            io::Error::new(io::ErrorKind::OutOfMemory, problem)
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
    use super::*;

    fn origin(frame: u32) -> FrameOrigin {
        FrameOrigin {
            scene: "5c".repeat(32),
            table: "none".into(),
            frame,
        }
    }

    #[test]
    fn the_pixels_and_the_texts_come_back() {
        let (width, height) = (37, 5);
        let pixels: Vec<u8> = (0..width * height).map(|i| (i * 7 % 256) as u8).collect();
        for one_bit in [false, true] {
            let file = encode(&pixels, (width, height), one_bit, &origin(12)).unwrap();
            let mut reader = png::Decoder::new(io::Cursor::new(&file))
                .read_info()
                .unwrap();
            let texts: Vec<_> = reader
                .info()
                .uncompressed_latin1_text
                .iter()
                .map(|text| (text.keyword.clone(), text.text.clone()))
                .collect();
            assert!(
                texts.contains(&("darkness:frame".into(), "12".into())),
                "{texts:?}"
            );
            assert_eq!(texts.len(), 4);
            let mut read = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut read).unwrap();
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
        assert!(encode(&pixels[1..], (width, height), false, &origin(1)).is_err());
    }

    #[test]
    fn a_file_of_another_origin_or_with_any_damage_is_not_taken_for_the_same() {
        let pixels = [0, 255, 255, 17, 0, 3];
        let file = encode(&pixels, (3, 2), false, &origin(12)).unwrap();
        assert!(origin(12).made(&file));
        assert!(!origin(13).made(&file));
        assert!(
            !FrameOrigin {
                scene: "5d".repeat(32),
                ..origin(12)
            }
            .made(&file)
        );
        assert!(
            !FrameOrigin {
                table: "exact".into(),
                ..origin(12)
            }
            .made(&file)
        );
        for length in 0..file.len() {
            assert!(!origin(12).made(&file[..length]), "{length}");
        }
        assert!(!origin(12).made(&[&file[..], b"\n"].concat()));
        let mut damaged = file.clone();
        for at in 0..file.len() {
            for bit in 0..8 {
                damaged[at] ^= 1 << bit;
                assert!(!origin(12).made(&damaged), "{at}");
                damaged[at] ^= 1 << bit;
            }
        }
    }
}
