//! What is written: pictures or a film.

use std::path::Path;

use clap::ValueEnum;

use super::super::destination::has_extension;
use crate::scene::Animation;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// A PNG picture for each frame: linear grey for masks (gAMA 1.0), sRGB for light; 8 or 16 bits a sample, 1 where a
    /// mask's edges are hard
    Png,
    /// An OpenEXR file for each frame: linear light and layers of data, as 32-bit floats
    Exr,
    /// A NumPy archive for each frame: an array for each layer
    Npz,
    /// The outline of a frame's disk as Bézier paths, white on black: right to 0.01 pixels of the picture
    Svg,
    /// A film of all frames, YUV4MPEG2: 4:2:0, BT.709, limited range
    Y4m,
    /// A film of masks, YUV4MPEG2: grey, full range, which many encoders refuse or mark as limited
    #[value(name = "y4m-gray")]
    Y4mGray,
    /// The samples of all frames, row by row: a byte of grey, or three of red, green and blue
    Raw,
    /// A film of all frames, H.264, made by ffmpeg
    Mp4,
    /// The same for QuickTime
    Mov,
    /// The same for Matroska
    Mkv,
    /// A film of all frames, VP9, made by ffmpeg
    Webm,
}

impl Format {
    /// The extensions of all formats, in words.
    pub(super) const EXTENSIONS: &str =
        ".png, .exr, .npz, .y4m, .raw, .mp4, .mov, .mkv, .webm or .svg";

    /// The extensions of the formats with a file for each frame, in words.
    pub(super) const SEQUENCE_EXTENSIONS: &str = ".png, .exr or .npz";

    /// The format of an animation's frames unless another is asked for: one that holds its layers, if it has any.
    pub(super) fn default_of(animation: &Animation) -> Self {
        if animation.layers().is_empty() {
            Self::Png
        } else {
            Self::Exr
        }
    }

    /// The format of a path's extension, if it is that of one.
    pub(super) fn of_extension(path: &Path) -> Option<Self> {
        let mut formats = Self::value_variants().iter().copied();
        formats.find(|format| has_extension(path, format.extension()))
    }

    /// The format of a path's extension, [`Self::Png`] for any other.
    pub(super) fn of(path: &Path) -> Self {
        Self::of_extension(path).unwrap_or(Self::Png)
    }

    /// The extension of its files.
    pub(super) fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Exr => "exr",
            Self::Npz => "npz",
            Self::Svg => "svg",
            Self::Y4m | Self::Y4mGray => "y4m",
            Self::Raw => "raw",
            Self::Mp4 => "mp4",
            Self::Mov => "mov",
            Self::Mkv => "mkv",
            Self::Webm => "webm",
        }
    }

    /// Whether all frames go into one file.
    pub(super) fn is_film(self) -> bool {
        !matches!(self, Self::Png | Self::Exr | Self::Npz | Self::Svg)
    }

    /// Whether a file holds layers of data.
    pub(super) fn has_layers(self) -> bool {
        matches!(self, Self::Exr | Self::Npz)
    }

    /// Whether ffmpeg makes the file.
    pub(super) fn needs_ffmpeg(self) -> bool {
        matches!(self, Self::Mp4 | Self::Mov | Self::Mkv | Self::Webm)
    }

    /// Whether four pixels share one sample of colour.
    pub(super) fn shares_chroma(self) -> bool {
        self == Self::Y4m || self.needs_ffmpeg()
    }
}
