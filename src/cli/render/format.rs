//! What is written: pictures or a film.

use std::path::Path;

use clap::ValueEnum;

use crate::scene::ImageSize;

/// What stands before each frame of a YUV4MPEG2 film.
pub(super) const Y4M_FRAME: &[u8] = b"FRAME\n";

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// A grey PNG picture for each frame: 8 bits a pixel, 1 bit where edges are hard
    Png,
    /// A film of all frames, YUV4MPEG2, grey
    Y4m,
    /// The bytes of all frames, one a pixel, row by row
    Raw,
}

impl Format {
    /// The extensions of all formats, in words.
    pub(super) const EXTENSIONS: &str = ".png, .y4m or .raw";

    /// The format of a path's extension, [`Self::Png`] for any other.
    pub(super) fn of(path: &Path) -> Self {
        let extension = path.extension().unwrap_or_default();
        if extension.eq_ignore_ascii_case("y4m") {
            Self::Y4m
        } else if extension.eq_ignore_ascii_case("raw") {
            Self::Raw
        } else {
            Self::Png
        }
    }

    /// The bytes of a film of `frames` frames.
    pub(super) fn film_bytes(self, size: ImageSize, frames: u64) -> u64 {
        let pixels = u64::from(size.width) * u64::from(size.height);
        let mark = if self == Self::Y4m {
            Y4M_FRAME.len()
        } else {
            0
        };
        frames.saturating_mul(pixels + mark as u64)
    }
}
