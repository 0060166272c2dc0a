//! Frames as NumPy archives.
//!
//! An `.npz` file is a ZIP archive of deflated `.npy` files: one array for each layer, by the layer's name. Arrays have
//! the shape (height, width), or (height, width, n) where a pixel has n numbers, and hold 32-bit floats, the order
//! 8-bit integers. The first array, `darkness`, is a text with the program's version and the [`FrameOrigin`], a line
//! each. ZIP checks the arrays but not its own directory, so the archive's comment is the CRC-32 of all before it.
//!
//! The formats: PKWARE's APPNOTE.TXT 6.3.10 (4.3), and NumPy's `numpy.lib.format` (version 1.0).

use std::io::{self, Read, Write};

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;

use super::memory;
use super::origin::{ANY_VERSION, FrameOrigin, SOFTWARE};
use crate::render::Plane;
use crate::scene::{ImageSize, Layer};

/// The length of the comment: a CRC-32 in hexadecimal.
const COMMENT: usize = 8;

/// The most bytes of a frame's arrays: lengths and places have 32 bits.
const MOST_BYTES: u64 = u32::MAX as u64;

/// The name of the array that holds the [`FrameOrigin`].
const TEXTS: &str = "darkness";

/// What stands before each array of an archive.
const ENTRY: &[u8] = b"PK\x03\x04";

/// The bytes of an array before its data, which begin at a multiple of 64.
const ARRAY_HEADER: usize = 128;

/// An archive that is being written.
#[derive(Default)]
struct Archive {
    bytes: Vec<u8>,
    /// What the end of the archive says of its files.
    directory: Vec<u8>,
    files: u16,
}

/// Encodes a frame.
///
/// # Errors
/// The arrays take more than [`MOST_BYTES`], or there is not enough memory to encode the frame.
pub(super) fn encode(
    planes: &[Plane],
    size: ImageSize,
    origin: &FrameOrigin,
) -> io::Result<Vec<u8>> {
    let bytes = |plane: &Plane| size_of_val(plane.values.as_slice()) + 1024;
    let bytes: usize = planes.iter().map(bytes).sum();
    if bytes as u64 > MOST_BYTES {
        return Err(io::Error::other(
            "an .npz file holds at most 4 GiB; choose a smaller picture, or .exr",
        ));
    }
    memory::grant(2 * bytes)?;
    let mut archive = begun(origin)?;
    for plane in planes {
        let (height, width) = (size.height, size.width);
        let shape = match plane.layer.channels() {
            1 => format!("{height}, {width}"),
            channels => format!("{height}, {width}, {channels}"),
        };
        let array = if plane.layer == Layer::Order {
            // Orders beyond 127 are rings that no picture shows.
            array(
                "|i1",
                &shape,
                plane.values.iter().map(|&order| [(order as i8) as u8]),
            )
        } else {
            array(
                "<f4",
                &shape,
                plane.values.iter().map(|value| value.to_le_bytes()),
            )
        };
        archive.add(plane.layer.name(), &array)?;
    }
    Ok(archive.finish())
}

/// Whether a file that begins with `head` is an archive that some version of this program made.
pub(super) fn is_ours(head: &[u8]) -> bool {
    let text = format!("{SOFTWARE}={ANY_VERSION}");
    let letters: Vec<u8> = text
        .chars()
        .flat_map(|letter| u32::from(letter).to_le_bytes())
        .collect();
    let mut array = vec![0; ARRAY_HEADER + letters.len()];
    // The first array, after its own header in the archive and its name.
    let deflated = head.get(30 + TEXTS.len() + 4..).unwrap_or_default();
    let is_read = DeflateDecoder::new(deflated).read_exact(&mut array).is_ok();
    head.starts_with(ENTRY) && is_read && array.ends_with(&letters)
}

/// Whether `file` is a whole archive, with the right checksum, that this version of the program made of `origin`.
pub(super) fn made(file: &[u8], origin: &FrameOrigin) -> bool {
    let Some((checked, comment)) = file.split_last_chunk::<COMMENT>() else {
        return false;
    };
    let begins = begun(origin).is_ok_and(|begun| file.starts_with(&begun.bytes));
    begins && *comment == checksum(checked)
}

/// An archive that holds only the origin.
fn begun(origin: &FrameOrigin) -> io::Result<Archive> {
    let lines = origin.texts().into_iter();
    let lines = lines.map(|(key, text)| format!("{key}={text}"));
    let text = lines.collect::<Vec<_>>().join("\n");
    let letters: Vec<[u8; 4]> = text
        .chars()
        .map(|letter| u32::from(letter).to_le_bytes())
        .collect();
    let mut archive = Archive::default();
    let array = array(&format!("<U{}", letters.len()), "", letters.into_iter());
    archive.add(TEXTS, &array)?;
    Ok(archive)
}

/// A `.npy` file: an array of a NumPy type, and of a shape in words.
fn array<const N: usize>(kind: &str, shape: &str, items: impl Iterator<Item = [u8; N]>) -> Vec<u8> {
    const BEFORE: usize = 10;
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    let length = ARRAY_HEADER - BEFORE;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{header:<0$}\n", length - 1).as_bytes());
    bytes.extend(items.flatten());
    bytes
}

/// The CRC-32 of some bytes, in hexadecimal.
fn checksum(bytes: &[u8]) -> [u8; COMMENT] {
    let checksum = crc32fast::hash(bytes);
    core::array::from_fn(|i| b"0123456789abcdef"[(checksum >> (28 - 4 * i)) as usize & 15])
}

impl Archive {
    /// Adds an array.
    fn add(&mut self, name: &str, array: &[u8]) -> io::Result<()> {
        // Measured: higher levels take three times as long, for a tenth less.
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(array)?;
        let deflated = encoder.finish()?;
        let name = format!("{name}.npy");
        let place = self.bytes.len() as u32;
        // Version 2.0, no flags, deflated, and the first moment that ZIP knows: the first of January 1980.
        let mut entry = [20, 0, 0, 0, 8, 0, 0, 0, 0x21, 0].to_vec();
        for number in [
            crc32fast::hash(array),
            deflated.len() as u32,
            array.len() as u32,
        ] {
            entry.extend(number.to_le_bytes());
        }
        entry.extend((name.len() as u16).to_le_bytes());
        // No extra field.
        entry.extend([0, 0]);
        for part in [ENTRY, entry.as_slice(), name.as_bytes(), &deflated] {
            self.bytes.extend_from_slice(part);
        }
        // In the directory the version of the maker comes first; comment, disk and attributes come after.
        for part in [
            b"PK\x01\x02",
            [20, 0].as_slice(),
            &entry,
            &[0; 10],
            &place.to_le_bytes(),
            name.as_bytes(),
        ] {
            self.directory.extend_from_slice(part);
        }
        self.files += 1;
        Ok(())
    }

    /// Writes the directory and the checksum.
    fn finish(self) -> Vec<u8> {
        let Self {
            mut bytes,
            directory,
            files,
        } = self;
        let (place, length) = (bytes.len() as u32, directory.len() as u32);
        bytes.extend(directory);
        // The numbers of this disk and of the directory's are 0.
        bytes.extend(*b"PK\x05\x06\0\0\0\0");
        for count in [files, files] {
            bytes.extend(count.to_le_bytes());
        }
        for number in [length, place] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend((COMMENT as u16).to_le_bytes());
        let checksum = checksum(&bytes);
        bytes.extend(checksum);
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::super::origin::tests::{
        assert_no_other_is_taken, assert_only_ours_is_taken, origin,
    };
    use super::*;
    use std::collections::BTreeMap;

    const SIZE: ImageSize = ImageSize {
        width: 3,
        height: 2,
    };

    fn planes() -> [Plane; 5] {
        [
            Layer::Order,
            Layer::Radius,
            Layer::Colour,
            Layer::Sky,
            Layer::SkyUv,
        ]
        .map(|layer| Plane {
            layer,
            values: (0..6 * layer.channels()).map(|i| i as f32 - 1.0).collect(),
        })
    }

    /// The arrays of an archive, inflated, by their names.
    fn arrays(file: &[u8]) -> BTreeMap<String, Vec<u8>> {
        let mut arrays = BTreeMap::new();
        let mut rest = file;
        while let Some(entry) = rest.strip_prefix(b"PK\x03\x04") {
            let length = |at: usize| {
                let bytes = entry[at..].first_chunk().unwrap();
                u32::from_le_bytes(*bytes) as usize
            };
            let (deflated, name) = (length(14), entry[22] as usize);
            let (name, after) = entry[26..].split_at(name);
            let (array, after) = after.split_at(deflated);
            let mut inflated = Vec::new();
            DeflateDecoder::new(array)
                .read_to_end(&mut inflated)
                .unwrap();
            assert_eq!(inflated.len(), length(18));
            arrays.insert(String::from_utf8(name.to_vec()).unwrap(), inflated);
            rest = after;
        }
        arrays
    }

    #[test]
    fn arrays_have_their_type_their_shape_and_their_values() {
        let arrays = arrays(&encode(&planes(), SIZE, &origin(12)).unwrap());
        let floats = |count: u8| (0..count).flat_map(|i| (f32::from(i) - 1.0).to_le_bytes());
        for (name, header, values) in [
            (
                "order.npy",
                "'|i1', 'fortran_order': False, 'shape': (2, 3), }",
                vec![255, 0, 1, 2, 3, 4],
            ),
            (
                "radius.npy",
                "'<f4', 'fortran_order': False, 'shape': (2, 3), }",
                floats(6).collect(),
            ),
            (
                "colour.npy",
                "'<f4', 'fortran_order': False, 'shape': (2, 3, 3), }",
                floats(18).collect(),
            ),
            (
                "sky.npy",
                "'<f4', 'fortran_order': False, 'shape': (2, 3, 3), }",
                floats(18).collect(),
            ),
            (
                "sky_uv.npy",
                "'<f4', 'fortran_order': False, 'shape': (2, 3, 2), }",
                floats(12).collect(),
            ),
        ] {
            let (head, data) = arrays[name].split_at(128);
            assert!(
                head.starts_with(b"\x93NUMPY\x01\x00\x76\x00{'descr': "),
                "{name}"
            );
            assert!(String::from_utf8_lossy(head).contains(header), "{name}");
            assert_eq!(data, values, "{name}");
        }
        assert_eq!(arrays.len(), 6);
    }

    #[test]
    fn a_file_of_another_origin_or_with_any_damage_is_not_taken_for_the_same() {
        let file = encode(&planes(), SIZE, &origin(12)).unwrap();
        assert_no_other_is_taken(&file, &origin(12), made);
        assert_only_ours_is_taken(&file, is_ours);
    }
}
