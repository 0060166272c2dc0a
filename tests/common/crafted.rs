//! Table files made by hand: valid in form, with contents that no generator writes.

use darkness::table::format::{MAGIC, VERSION};

/// Offsets of the preamble's fields, as documented in `table::format`.
pub(crate) const VERSION_AT: usize = 8;
pub(crate) const METADATA_LENGTH_AT: usize = 12;
pub(crate) const METADATA_CRC_AT: usize = 16;
pub(crate) const NUMBERS_CRC_AT: usize = 20;
pub(crate) const NUMBERS_LENGTH_AT: usize = 24;
pub(crate) const PREAMBLE_CRC_AT: usize = 32;
pub(crate) const METADATA_AT: usize = 36;

pub(crate) fn write_u32(bytes: &mut [u8], at: usize, value: u32) {
    bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
}

/// Corrects the preamble's own checksum.
pub(crate) fn mend_preamble(bytes: &mut [u8]) {
    let crc = crc32fast::hash(&bytes[..PREAMBLE_CRC_AT]);
    write_u32(bytes, PREAMBLE_CRC_AT, crc);
}

/// A file with the given metadata and numbers, every checksum and length of it right.
pub(crate) fn sealed(metadata: &[u8], numbers: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0; METADATA_AT];
    bytes[..8].copy_from_slice(&MAGIC);
    write_u32(&mut bytes, VERSION_AT, VERSION);
    write_u32(&mut bytes, METADATA_LENGTH_AT, metadata.len() as u32);
    write_u32(&mut bytes, METADATA_CRC_AT, crc32fast::hash(metadata));
    write_u32(&mut bytes, NUMBERS_CRC_AT, crc32fast::hash(numbers));
    bytes[NUMBERS_LENGTH_AT..NUMBERS_LENGTH_AT + 8]
        .copy_from_slice(&(numbers.len() as u64).to_le_bytes());
    mend_preamble(&mut bytes);
    bytes.extend(metadata);
    bytes.resize(bytes.len().next_multiple_of(64), 0);
    bytes.extend(numbers);
    bytes
}
