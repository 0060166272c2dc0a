//! How much memory frames may take: what would take more is refused before any is asked for. (The system grants more than it has, and
//! ends the process when it is used.)

use bytesize::ByteSize;

use super::super::Misuse;
use crate::render::batch::Sharing;
use crate::scene::ImageSize;

/// What may be taken where nothing else is said.
pub(super) const DEFAULT: &str = "4GiB";

/// An amount of memory, as it is written.
pub(super) fn size(text: &str) -> Result<ByteSize, String> {
    let size = text.parse();
    size.map_err(|_| "an amount of memory is written with its unit: 16GiB, 500MB".into())
}

/// Bytes for each pixel of a frame: its grey and, generously, its file's.
const A_PIXEL: u64 = 2;

/// What frames may take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit(pub(super) ByteSize);

impl Limit {
    /// Whether one frame of that size can be held.
    ///
    /// # Errors
    /// [`Misuse::Memory`]
    pub(super) fn check(self, size: ImageSize) -> Result<(), Misuse> {
        let needed = needed(size);
        if needed <= self.0.as_u64() {
            return Ok(());
        }
        Err(Misuse::Memory {
            width: size.width,
            height: size.height,
            needed: ByteSize(needed),
            allowed: self.0,
        })
    }

    /// How `count` frames of that size are shared out among the threads that were started.
    pub(super) fn sharing(self, size: ImageSize, count: u64) -> Sharing {
        Sharing::fastest(count, self.0.as_u64() / needed(size))
    }
}

/// The memory for a frame, at least a byte.
fn needed(size: ImageSize) -> u64 {
    let pixels = u64::from(size.width) * u64::from(size.height);
    pixels.saturating_mul(A_PIXEL).max(1)
}
