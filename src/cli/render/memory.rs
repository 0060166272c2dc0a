//! The limit on the memory of frames, which the sky shares. The system grants more memory than it has, and kills the
//! process that uses it, so the limit is checked first.

use std::io;

use bytesize::ByteSize;

use super::super::misuse::misuse;
use crate::render::Form;
use crate::scene::ImageSize;

/// The default of `--max-memory`.
pub(super) const DEFAULT: &str = "4GiB";

/// Parses an amount of memory.
pub(super) fn parse(text: &str) -> Result<ByteSize, String> {
    let size = text.parse();
    size.map_err(|_| "an amount of memory has a unit: 16GiB, 500MB".into())
}

/// Checks that one frame fits in `allowed`.
///
/// # Errors
/// It does not.
pub(super) fn check(allowed: ByteSize, size: ImageSize, form: Form) -> anyhow::Result<()> {
    let needed = of_frame(size, form);
    if needed <= allowed.as_u64() {
        return Ok(());
    }
    Err(misuse(format!(
        "{} × {} pixels take about {} of memory, and {allowed} are allowed; choose a smaller picture with --size, a \
         part of it with --crop, or allow more with --max-memory",
        size.width,
        size.height,
        ByteSize(needed)
    )))
}

/// Checks that the system grants so many bytes: an allocation that fails within an encoder ends the process.
///
/// # Errors
/// It does not.
pub(super) fn grant(bytes: usize) -> io::Result<()> {
    let granted = Vec::<u8>::new().try_reserve_exact(bytes);
    granted.map_err(|_| {
        let problem = "not enough memory to encode the picture; choose a smaller one";
        io::Error::new(io::ErrorKind::OutOfMemory, problem)
    })
}

/// How many frames fit in `allowed`.
pub(super) fn frames_in(allowed: ByteSize, size: ImageSize, form: Form) -> u64 {
    allowed.as_u64() / of_frame(size, form)
}

/// The memory of a frame, in bytes, at least 1: its pixels and, generously, the file that they become.
pub(super) fn of_frame(size: ImageSize, form: Form) -> u64 {
    let pixels = u64::from(size.width) * u64::from(size.height);
    pixels.saturating_mul(2 * form.bytes() as u64).max(1)
}
