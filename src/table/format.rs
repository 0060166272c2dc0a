//! The table's file, byte by byte. Everything is little-endian.
//!
//! ```text
//!        0  ┌──────────────────────────────────────────────┐
//!           │ magic  89 44 52 4B 0D 0A 1A 0A               │  "\x89DRK\r\n\x1A\n": as in PNG, a transfer that changes
//!        8  ├──────────────────────────────────────────────┤  line ends or clears the eighth bit is detected
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
//!           │ numbers: f64, every one finite               │  spline coefficients: A, then the charts critical, weak,
//!           │                                              │  trapped, radial, each row by row: one row for each node
//!           └──────────────────────────────────────────────┘  of its orbit axis, and one more at either end
//! ```
//!
//! Every byte is covered by a checksum, by a comparison, or by the check for zero. The bytes depend on nothing but the
//! specification and the format's version.

use serde::{Deserialize, Serialize};

use super::spec::Spec;

/// The first eight bytes of every table.
pub const MAGIC: [u8; 8] = *b"\x89DRK\r\n\x1A\n";

/// The version of the format. It changes with this layout and with the functions stored.
pub const VERSION: u32 = 1;

const VERSION_AT: usize = 8;
const METADATA_LENGTH_AT: usize = 12;
const METADATA_CRC_AT: usize = 16;
const NUMBERS_CRC_AT: usize = 20;
const NUMBERS_LENGTH_AT: usize = 24;
const PREAMBLE_CRC_AT: usize = 32;
const METADATA_AT: usize = 36;
const ALIGNMENT: usize = 64;

/// The greatest length of the metadata in bytes: far more than it needs (about 200), and a bound on what a damaged
/// length can make the decoder allocate.
const METADATA_LIMIT: usize = 4096;

/// The greatest length of what comes before the numbers, in bytes.
pub(super) const LONGEST_HEAD: usize = (METADATA_AT + METADATA_LIMIT).next_multiple_of(ALIGNMENT);

/// What the numbers of a table mean, in words. A table that says something else is refused.
pub const CONVENTIONS: &str = "d2u/dphi2 = 3/2 u^2 - u; u = 1/r, Schwarzschild radius 1, radians; \
    cubic B-splines of A, B, V, Z, H";

/// A table's description of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// [`CONVENTIONS`].
    pub conventions: String,
    /// The specification that the table was made from.
    pub spec: Spec,
    /// The largest error of a swept angle against the exact method, in radians, off the grid's nodes. Measured when the
    /// table was made.
    pub measured_error: f64,
    /// How many swept angles were compared to measure it.
    pub measured_angles: u64,
}

/// Why bytes are not a table that can be used.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum FormatError {
    /// The bytes are something else.
    #[error("it is not a darkness table: it does not begin with a table's first eight bytes")]
    Foreign,
    /// The path leads to something that is not a regular file.
    #[error("it is not a darkness table: a table is a regular file, and this is a {kind}")]
    NoFile {
        /// What it is.
        kind: &'static str,
    },
    /// The bytes of a table were swapped in twos, fours or eights.
    #[error(
        "its bytes are in another order, and this version of darkness reads format {VERSION}, which is little-endian: \
         copy the table byte by byte"
    )]
    Swapped,
    /// The table was made by another version of the program.
    #[error("it is a table of format {found}, and this version of darkness reads format {VERSION}")]
    Outdated {
        /// The file's version.
        found: u32,
    },
    /// The file ends early, or goes on too long.
    #[error(
        "it is {actual} bytes long and should be {expected}: a copy did not finish, or bytes were added"
    )]
    Length {
        /// The length that its first bytes give.
        expected: u64,
        /// Its length.
        actual: u64,
    },
    /// The file changed while it was read.
    #[error("another process is writing or cutting it")]
    Changed,
    /// A check failed.
    #[error("it is damaged: {what}")]
    Damaged {
        /// Which check failed.
        what: &'static str,
    },
}

fn damaged(what: &'static str) -> FormatError {
    FormatError::Damaged { what }
}

/// What a table holds before its numbers, checked.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Head {
    pub(super) metadata: Metadata,
    /// Offset of the first number in bytes. The numbers go on to the end.
    pub(super) numbers_at: usize,
    numbers_crc: u32,
}

/// Encodes the bytes of a table up to its numbers; `None` where the metadata is too long.
pub(super) fn header(metadata: Metadata, numbers: &[u8]) -> Option<(Vec<u8>, Head)> {
    let encoded = bincode::serde::encode_to_vec(&metadata, bincode::config::standard()).ok()?;
    if encoded.len() > METADATA_LIMIT {
        return None;
    }
    let numbers_crc = crc32fast::hash(numbers);
    let mut bytes = Vec::with_capacity(METADATA_AT + encoded.len() + ALIGNMENT);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((encoded.len() as u32).to_le_bytes());
    bytes.extend(crc32fast::hash(&encoded).to_le_bytes());
    bytes.extend(numbers_crc.to_le_bytes());
    bytes.extend((numbers.len() as u64).to_le_bytes());
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes.extend(encoded);
    bytes.resize(bytes.len().next_multiple_of(ALIGNMENT), 0);
    let head = Head {
        metadata,
        numbers_at: bytes.len(),
        numbers_crc,
    };
    Some((bytes, head))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(core::array::from_fn(|k| bytes[at + k]))
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(core::array::from_fn(|k| bytes[at + k]))
}

/// Checks the preamble of a file of `actual` bytes. Returns where its metadata ends and where its numbers begin.
fn preamble(start: &[u8], actual: u64) -> Result<(usize, usize), FormatError> {
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
        // Another version may lay out its preamble in another way, which explains the mismatch as well as damage does.
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

/// Checks everything that comes before the numbers in a file of `actual` bytes. `start` is the file, or its first
/// [`LONGEST_HEAD`] bytes.
///
/// # Errors
/// [`FormatError`]: the first check that fails.
pub(super) fn head(start: &[u8], actual: u64) -> Result<Head, FormatError> {
    let (metadata_end, numbers_at) = preamble(start, actual)?;
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
        return Err(damaged(
            "its measured error is not a finite number from 0 on",
        ));
    }
    if !metadata.spec.is_sound() {
        return Err(damaged(
            "its specification is not one that a table can have",
        ));
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
    Ok(Head {
        metadata,
        numbers_at,
        numbers_crc: u32_at(start, NUMBERS_CRC_AT),
    })
}

impl Head {
    /// Checks the numbers of a table whose file is `bytes`, aligned to 8.
    ///
    /// # Errors
    /// [`FormatError::Damaged`]
    pub(super) fn check_numbers(&self, bytes: &[u8]) -> Result<(), FormatError> {
        if crc32fast::hash(&bytes[self.numbers_at..]) != self.numbers_crc {
            return Err(damaged("the checksum of its numbers does not match"));
        }
        let mut numbers = numbers(bytes, self.numbers_at).iter();
        if !numbers.all(|number| number.is_finite()) {
            return Err(damaged("one of its numbers is not finite"));
        }
        Ok(())
    }
}

/// Returns the numbers, read in place. `bytes` must be aligned to 8, as maps and [`Vec<u64>`] are.
pub(super) fn numbers(bytes: &[u8], numbers_at: usize) -> &[f64] {
    bytemuck::cast_slice(&bytes[numbers_at..])
}
