//! `darkness view`: a window in which a scene is looked at by hand.
//!
//! Only the feature `view` builds the window; without it the verb says how to build it in.

mod controls;
#[cfg(feature = "view")]
mod window;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::progress::Report;
use super::render::picture_size;
use super::threads::ThreadArgs;
use crate::scene::{DEFAULT_SCENE, ImageSize, Override};

const TABLE_HELP: &str = "The table to read, made where it is missing [env: DARKNESS_TABLE] [default: the smallest \
    that is enough]";

/// Open a window to look around a scene by hand
///
/// The window draws at the display's rate, on the processor alone. It is a part of builds with the feature `view`:
/// cargo run --release --features view -- view
#[derive(Debug, Args)]
#[command(after_help = controls::help())]
pub(super) struct ViewArgs {
    /// A scene's TOML file, or the name of a built-in scene (`darkness scene` lists them). A file that changes is read
    /// again
    #[arg(value_name = "SCENE", default_value = DEFAULT_SCENE)]
    scene: PathBuf,
    /// Give any key of the scene another value, one of TOML: --set disk.outer=20
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = Override::parse)]
    set: Vec<Override>,
    /// The window's size in pixels, such as 1280x720 [default: the scene's, if the display has room for it]
    #[arg(long, value_name = "WxH", value_parser = picture_size)]
    size: Option<ImageSize>,
    /// What the key P writes
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = PictureFormat::Png)]
    picture_format: PictureFormat,
    #[arg(long, value_name = "FILE", help = TABLE_HELP)]
    table: Option<PathBuf>,
    /// Measure this machine: turn the camera for N frames, as fast as they are drawn, print how many a second there
    /// were, and close the window
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    #[command(flatten)]
    threads: ThreadArgs,
}

/// What is written of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PictureFormat {
    /// The picture as it is seen
    Png,
    /// Linear light and layers, as 32-bit floats; for false colours the layer itself
    Exr,
}

/// Runs the verb.
///
/// # Errors
/// The program was built without the feature `view`.
#[cfg(not(feature = "view"))]
pub(super) fn run(_: &ViewArgs, _: Report) -> anyhow::Result<()> {
    anyhow::bail!(
        "this program was built without its window; build it in with: cargo run --release --features view -- view"
    )
}

/// Runs the verb.
///
/// # Errors
/// A scene, a table or a sky that cannot be read, or no display.
#[cfg(feature = "view")]
pub(super) fn run(args: &ViewArgs, report: Report) -> anyhow::Result<()> {
    window::run(args, report)
}
