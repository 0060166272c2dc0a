//! Why a part of the sky cannot be used.

use std::io;
use std::path::PathBuf;

use super::stars::CatalogueError;

/// Why a part of the sky cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SkyError {
    /// A panorama cannot be used.
    #[error("panorama {}: {problem}", path.display())]
    Panorama {
        /// Its file.
        path: PathBuf,
        /// What is wrong with it.
        problem: PanoramaProblem,
    },
    /// A catalogue of stars cannot be used.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
}

/// What is wrong with a panorama's file.
#[derive(Debug, thiserror::Error)]
pub enum PanoramaProblem {
    /// The file cannot be read.
    #[error("the file cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// It is a folder, a device or a pipe.
    #[error("this is not a regular file")]
    NotAFile,
    /// The file does not begin as one of the formats that are read.
    #[error("this is not a PNG, JPEG, Radiance HDR or OpenEXR picture: save it as one of these")]
    UnknownFormat,
    /// The file ends before its last pixel.
    #[error("the file ends early: copy it again, or save the picture again")]
    Truncated,
    /// The file breaks its format's rules, or uses what is not supported. The decoder's reason is in parentheses.
    #[error(
        "the picture is damaged or of an unsupported kind: save it again as PNG, JPEG, Radiance HDR or OpenEXR ({0})"
    )]
    Undecodable(String),
    /// The picture has no panorama's shape.
    #[error(
        "the picture has {width} × {height} pixels, and a panorama is twice as wide as high (2:1): choose an \
         equirectangular one"
    )]
    Shape {
        /// Its width in pixels.
        width: u64,
        /// Its height in pixels.
        height: u64,
    },
    /// The picture is too large for any machine.
    #[error(
        "the picture has {width} × {height} pixels, and at most 16384 × 8192 are read: make it smaller"
    )]
    TooLarge {
        /// Its width in pixels.
        width: u64,
        /// Its height in pixels.
        height: u64,
    },
    /// Reading it would take more memory than is allowed.
    #[error(
        "a panorama of this size needs {} MB of memory, and {} MB are allowed: allow more (--max-memory) or make it \
         smaller",
        needed.div_ceil(1_000_000),
        allowed / 1_000_000
    )]
    Memory {
        /// The bytes that reading it takes.
        needed: u64,
        /// The bytes allowed.
        allowed: u64,
    },
}
