//! The table's file, byte by byte. Everything is little-endian.
//!
//! ```text
//!        0  ┌──────────────────────────────────────────────┐
//!           │ magic  89 44 52 4B 0D 0A 1A 0A               │  "\x89DRK\r\n\x1A\n": a transfer that changes line ends or
//!        8  ├──────────────────────────────────────────────┤  clears the eighth bit shows, as in PNG
//!           │ format version                           u32 │
//!       12  ├──────────────────────────────────────────────┤
//!           │ metadata length, bytes                   u32 │
//!       16  ├──────────────────────────────────────────────┤
//!           │ CRC-32 of the metadata                   u32 │
//!       20  ├──────────────────────────────────────────────┤
//!           │ CRC-32 of the numbers                    u32 │
//!       24  ├──────────────────────────────────────────────┤
//!           │ length of the numbers, bytes             u64 │
//!       32  ├──────────────────────────────────────────────┤
//!           │ CRC-32 of bytes 0 to 31                  u32 │
//!       36  ├──────────────────────────────────────────────┤
//!           │ metadata: bincode 2 (standard), [`Metadata`] │
//!           ├──────────────────────────────────────────────┤
//!           │ zeros up to a multiple of 64                 │
//!    64 · k ├──────────────────────────────────────────────┤
//!           │ numbers: f64, every one finite               │  spline coefficients: A, then the charts critical, weak, trapped,
//!           │                                              │  radial, each row by row, a row for each node of its orbit axis
//!           └──────────────────────────────────────────────┘  (and one more at either end)
//! ```
//!
//! Every byte is covered by a checksum, a comparison or the check for zero. The bytes depend on the specification and
//! on the format's version alone.

use serde::{Deserialize, Serialize};

use super::spec::Spec;

/// The first eight bytes of every table.
pub const MAGIC: [u8; 8] = *b"\x89DRK\r\n\x1A\n";

/// The version of the format: of this layout and of the functions stored. It changes with either.
pub const VERSION: u32 = 1;

const VERSION_AT: usize = 8;
const METADATA_LENGTH_AT: usize = 12;
const METADATA_CRC_AT: usize = 16;
const NUMBERS_CRC_AT: usize = 20;
const NUMBERS_LENGTH_AT: usize = 24;
const PREAMBLE_CRC_AT: usize = 32;
const METADATA_AT: usize = 36;
const ALIGNMENT: usize = 64;

/// Far above what [`Metadata`] needs (about 200 bytes); a damaged length cannot make the decoder allocate more.
const METADATA_LIMIT: usize = 4096;

/// All that comes before the numbers of any table.
pub(crate) const LONGEST_HEAD: usize = (METADATA_AT + METADATA_LIMIT).next_multiple_of(ALIGNMENT);

/// What the numbers of a table mean, in words; compared on opening.
pub const CONVENTIONS: &str = "d2u/dphi2 = 3/2 u^2 - u; u = 1/r, Schwarzschild radius 1, radians; cubic B-splines of A, B, V, Z, H";

/// What a table says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// [`CONVENTIONS`].
    pub conventions: String,
    /// The grid.
    pub spec: Spec,
    /// The largest error of a swept angle against the exact method, in radians, on points off the grid, measured when
    /// the table was made.
    pub measured_error: f64,
    /// How many swept angles were compared for it.
    pub measured_angles: u64,
}

/// Why bytes are no usable table.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum FormatError {
    /// Some other file.
    #[error("it is not a darkness table: it does not begin with a table's first eight bytes")]
    Foreign,
    /// No regular file: nothing that has a length and stays what it is.
    #[error("it is not a darkness table: a table is a regular file, and this is a {kind}")]
    NoFile {
        /// What it is.
        kind: &'static str,
    },
    /// A table whose bytes were swapped in twos, fours or eights.
    #[error(
        "it is a table with its bytes in another order, and this version of darkness reads format {VERSION}, little-endian as it was written: copy it byte by byte"
    )]
    Swapped,
    /// A table of another version of the program.
    #[error("it is a table of format {found}, and this version of darkness reads format {VERSION}")]
    Outdated {
        /// The file's version.
        found: u32,
    },
    /// The file ends early, or goes on too long.
    #[error(
        "it is {actual} bytes long and should be {expected}: a copy that did not finish, or bytes added"
    )]
    Length {
        /// Bytes there should be.
        expected: u64,
        /// Bytes there are.
        actual: u64,
    },
    /// The file changed while it was read.
    #[error("it is being written or cut by another process")]
    Changed,
    /// Some bytes are not what was written.
    #[error("it is damaged: {what}")]
    Damaged {
        /// Which check failed.
        what: &'static str,
    },
    /// The bytes are whole, and begin where numbers cannot be read in place.
    #[error(
        "its bytes do not begin at a multiple of 8 in memory; map the file or read it into an aligned buffer"
    )]
    Misaligned,
}

fn damaged(what: &'static str) -> FormatError {
    FormatError::Damaged { what }
}

/// Where the parts of a valid table lie.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    pub(crate) metadata: Metadata,
    /// Offset of the first number; they go on to the end.
    pub(crate) numbers_at: usize,
}

/// The bytes of a table up to its numbers.
pub(crate) fn header(metadata: &Metadata, numbers: &[u8]) -> Option<Vec<u8>> {
    let encoded = bincode::serde::encode_to_vec(metadata, bincode::config::standard()).ok()?;
    if encoded.len() > METADATA_LIMIT {
        return None;
    }
    let mut bytes = Vec::with_capacity(METADATA_AT + encoded.len() + ALIGNMENT);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((encoded.len() as u32).to_le_bytes());
    bytes.extend(crc32fast::hash(&encoded).to_le_bytes());
    bytes.extend(crc32fast::hash(numbers).to_le_bytes());
    bytes.extend((numbers.len() as u64).to_le_bytes());
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes.extend(encoded);
    bytes.resize(bytes.len().next_multiple_of(ALIGNMENT), 0);
    Some(bytes)
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(core::array::from_fn(|k| bytes[at + k]))
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(core::array::from_fn(|k| bytes[at + k]))
}

/// Where the metadata of a file of `actual` bytes ends, and where its numbers begin: by its preamble.
fn layout(start: &[u8], actual: u64) -> Result<(usize, usize), FormatError> {
    let seen = start.len().min(MAGIC.len());
    if start[..seen] != MAGIC[..seen] || start.is_empty() {
        let swapped = |width: usize| {
            let eights = MAGIC.chunks(width).flat_map(|word| word.iter().rev());
            eights.eq(&start[..seen])
        };
        return Err(if [2, 4, 8].into_iter().any(swapped) {
            FormatError::Swapped
        } else {
            FormatError::Foreign
        });
    }
    if start.len() < METADATA_AT {
        return Err(FormatError::Length {
            expected: METADATA_AT as u64,
            actual,
        });
    }
    let found = u32_at(start, VERSION_AT);
    if crc32fast::hash(&start[..PREAMBLE_CRC_AT]) != u32_at(start, PREAMBLE_CRC_AT) {
        // Another version may lay out its preamble in another way: a foreign version explains the mismatch as well as
        // damage does.
        return Err(if found == VERSION {
            damaged("the checksum of its preamble does not match")
        } else {
            FormatError::Outdated { found }
        });
    }
    if found != VERSION {
        return Err(FormatError::Outdated { found });
    }
    let metadata_length = u32_at(start, METADATA_LENGTH_AT) as usize;
    if metadata_length > METADATA_LIMIT {
        return Err(damaged("its metadata is longer than metadata can be"));
    }
    let metadata_end = METADATA_AT + metadata_length;
    let numbers_at = metadata_end.next_multiple_of(ALIGNMENT);
    let expected = u64_at(start, NUMBERS_LENGTH_AT)
        .checked_add(numbers_at as u64)
        .ok_or(damaged("the length of its numbers is beyond any file's"))?;
    if actual != expected {
        return Err(FormatError::Length { expected, actual });
    }
    Ok((metadata_end, numbers_at))
}

/// Checks all of a file of `actual` bytes that comes before its numbers, which is in its first [`LONGEST_HEAD`] bytes.
///
/// # Errors
/// [`FormatError`]: what is wrong.
pub(crate) fn head(start: &[u8], actual: u64) -> Result<Layout, FormatError> {
    let (metadata_end, numbers_at) = layout(start, actual)?;
    let metadata_length = metadata_end - METADATA_AT;
    let numbers_length = actual - numbers_at as u64;
    let (Some(encoded), Some(padding)) = (
        start.get(METADATA_AT..metadata_end),
        start.get(metadata_end..numbers_at),
    ) else {
        return Err(FormatError::Changed);
    };
    if crc32fast::hash(encoded) != u32_at(start, METADATA_CRC_AT) {
        return Err(damaged("the checksum of its metadata does not match"));
    }
    let config = bincode::config::standard().with_limit::<METADATA_LIMIT>();
    let (metadata, used): (Metadata, usize) = bincode::serde::decode_from_slice(encoded, config)
        .map_err(|_| damaged("its metadata cannot be decoded"))?;
    if used != metadata_length {
        return Err(damaged("its metadata has bytes to spare"));
    }
    if metadata.conventions != CONVENTIONS {
        return Err(damaged("its numbers follow other conventions"));
    }
    if !(0.0..f64::INFINITY).contains(&metadata.measured_error) {
        return Err(damaged("its measured error is no error"));
    }
    if !metadata.spec.is_sound() {
        return Err(damaged("its grid has sizes that no table has"));
    }
    if metadata
        .spec
        .coefficients()
        .checked_mul(8)
        .map(|n| n as u64)
        != Some(numbers_length)
    {
        return Err(damaged("its grid and the length of its numbers disagree"));
    }
    if padding.iter().any(|&b| b != 0) {
        return Err(damaged("the padding before its numbers is not zero"));
    }
    Ok(Layout {
        metadata,
        numbers_at,
    })
}

/// Checks every byte of a table.
pub(crate) fn parse(bytes: &[u8]) -> Result<Layout, FormatError> {
    let start = &bytes[..bytes.len().min(LONGEST_HEAD)];
    let layout = head(start, bytes.len() as u64)?;
    let numbers_at = layout.numbers_at;
    if crc32fast::hash(&bytes[numbers_at..]) != u32_at(bytes, NUMBERS_CRC_AT) {
        return Err(damaged("the checksum of its numbers does not match"));
    }
    let numbers = numbers(bytes, numbers_at)?;
    if !numbers.iter().all(|x| x.is_finite()) {
        return Err(damaged("one of its numbers is not finite"));
    }
    Ok(layout)
}

/// The numbers, read in place.
pub(crate) fn numbers(bytes: &[u8], numbers_at: usize) -> Result<&[f64], FormatError> {
    bytemuck::try_cast_slice(&bytes[numbers_at..]).map_err(|_| FormatError::Misaligned)
}
