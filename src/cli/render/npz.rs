//! Frames as NumPy archives.
//!
//! An `.npz` file is a ZIP archive of `.npy` files, stored as they are: one array for each layer, by the layer's name.
//! Arrays have the shape (height, width), or (height, width, 3) for colour, and hold 32-bit floats, the order 8-bit
//! integers. The first array, `darkness`, is a text with the program's version and the [`FrameOrigin`], a line each. ZIP
//! checks the arrays but not its own directory, so the archive's comment is the CRC-32 of all before it.
//!
//! The formats: PKWARE's APPNOTE.TXT 6.3.10 (4.3), and NumPy's `numpy.lib.format` (version 1.0).

use std::io;

use super::memory;
use super::origin::FrameOrigin;
use crate::render::Plane;
use crate::scene::{ImageSize, Layer};

/// The length of the comment: a CRC-32 in hexadecimal.
const COMMENT: usize = 8;

/// The most bytes of an archive: lengths and places have 32 bits.
pub(super) const MOST_BYTES: u64 = u32::MAX as u64;

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
/// The archive would take more than [`MOST_BYTES`], or there is not enough memory to encode the frame.
pub(super) fn encode(
    planes: &[Plane],
    size: ImageSize,
    origin: &FrameOrigin,
) -> io::Result<Vec<u8>> {
    let bytes = |plane: &Plane| size_of_val(plane.values.as_slice()) + 1024;
    let bytes = planes.iter().map(bytes).sum();
    if bytes as u64 > MOST_BYTES {
        return Err(io::Error::other(
            "an .npz file holds at most 4 GiB; choose a smaller picture, or .exr",
        ));
    }
    memory::grant(2 * bytes)?;
    let mut archive = begun(origin);
    archive.bytes.reserve_exact(bytes);
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
        archive.add(plane.layer.name(), &array);
    }
    Ok(archive.finish())
}

/// Whether `file` is a whole archive, with the right checksum, that this version of the program made of `origin`.
pub(super) fn made(file: &[u8], origin: &FrameOrigin) -> bool {
    let Some((checked, comment)) = file.split_last_chunk::<COMMENT>() else {
        return false;
    };
    file.starts_with(&begun(origin).bytes) && *comment == checksum(checked)
}

/// An archive that holds only the origin.
fn begun(origin: &FrameOrigin) -> Archive {
    let lines = origin.texts().map(|(key, text)| format!("{key}={text}"));
    let text = lines.join("\n");
    let letters: Vec<[u8; 4]> = text
        .chars()
        .map(|letter| u32::from(letter).to_le_bytes())
        .collect();
    let mut archive = Archive::default();
    archive.add(
        "darkness",
        &array(&format!("<U{}", letters.len()), "", letters.into_iter()),
    );
    archive
}

/// A `.npy` file: an array of a NumPy type, and of a shape in words.
fn array<const N: usize>(kind: &str, shape: &str, items: impl Iterator<Item = [u8; N]>) -> Vec<u8> {
    // The data begin at a multiple of 64.
    const START: usize = 128;
    const BEFORE: usize = 10;
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    let length = START - BEFORE;
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
    fn add(&mut self, name: &str, array: &[u8]) {
        let name = format!("{name}.npy");
        let place = self.bytes.len() as u32;
        // Version 2.0, no flags, stored, and the first moment that ZIP knows: the first of January 1980.
        let mut entry = [20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0].to_vec();
        for number in [
            crc32fast::hash(array),
            array.len() as u32,
            array.len() as u32,
        ] {
            entry.extend(number.to_le_bytes());
        }
        entry.extend((name.len() as u16).to_le_bytes());
        // No extra field.
        entry.extend([0, 0]);
        for part in [b"PK\x03\x04", entry.as_slice(), name.as_bytes(), array] {
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
    use super::super::origin::tests::{assert_no_other_is_taken, origin};
    use super::*;

    const SIZE: ImageSize = ImageSize {
        width: 3,
        height: 2,
    };

    fn planes() -> [Plane; 3] {
        [Layer::Order, Layer::Radius, Layer::Colour].map(|layer| Plane {
            layer,
            values: (0..6 * layer.channels()).map(|i| i as f32 - 1.0).collect(),
        })
    }

    #[test]
    fn arrays_have_their_type_their_shape_and_their_values() {
        let file = encode(&planes(), SIZE, &origin(12)).unwrap();
        let text = String::from_utf8_lossy(&file);
        for header in [
            "'descr': '|i1', 'fortran_order': False, 'shape': (2, 3), }",
            "'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 3), }",
            "radius.npy\u{fffd}NUMPY",
        ] {
            assert!(text.contains(header), "{header}");
        }
        assert!(find(&file, &[255, 0, 1, 2, 3, 4]));
        assert!(find(
            &file,
            &[-1.0_f32, 0.0, 1.0, 2.0].map(f32::to_le_bytes).concat()
        ));
    }

    fn find(file: &[u8], bytes: &[u8]) -> bool {
        file.windows(bytes.len()).any(|window| window == bytes)
    }

    #[test]
    fn a_file_of_another_origin_or_with_any_damage_is_not_taken_for_the_same() {
        let file = encode(&planes(), SIZE, &origin(12)).unwrap();
        assert_no_other_is_taken(&file, &origin(12), made);
    }
}
