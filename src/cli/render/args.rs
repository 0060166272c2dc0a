//! The arguments of `darkness render`.

use std::path::PathBuf;

use bytesize::ByteSize;
use clap::Args;

use super::super::frame_range::FrameRange;
use super::super::method::MethodArgs;
use super::super::progress::ProgressKind;
use super::super::threads::ThreadArgs;
use super::format::Format;
use super::memory;
use crate::scene::{DEFAULT_SCENE, ImageSize, Override};

/// Render a scene as a picture or as data, or its animation as numbered files or a film
///
/// The program takes the smallest table, and the fewest orders and nodes of the image's curves, that keep every edge
/// within the scene's tolerance; --explain prints them.
///
/// Finished frames of the same scene, sky, table and version are kept: the same command continues an interrupted run.
/// The first Ctrl-C or SIGTERM finishes the frames that are begun, the second ends the run at once.
///
/// Several runs of one command share the numbered files of an animation, on one machine or on several that see one
/// folder: each frame is drawn by the run that first locks its unfinished file. A run ends when all its frames are
/// there: it waits for those that other runs are drawing, and draws those of runs that were killed. A run with another
/// scene, sky, table or version is refused while others draw the same files. With --overwrite, frames that other runs
/// have drawn since this one began are kept. Single pictures and films are not shared: each run makes its own, and the
/// last to end replaces the others'.
///
/// On a network file system each machine must see the others' locks (flock): NFS 4, NFS 3 without the mount options
/// `nolock` and `local_lock`, Lustre with the mount option `flock`. Without locks each run draws every frame that is
/// missing when it comes to it.
#[derive(Debug, Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a switch of the command line"
)]
pub(in crate::cli) struct RenderArgs {
    /// A scene's TOML file, or the name of a built-in scene (`darkness scene` lists them)
    #[arg(value_name = "SCENE", default_value = DEFAULT_SCENE)]
    pub(super) scene: PathBuf,
    /// Give any key of the scene another value, one of TOML: --set camera.fov=12, --set disk.normal=[0,1,1], --set
    /// animation.keyframe.120.fov=9 (the keyframe at frame 120). An empty value takes the key out
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = Override::parse)]
    pub(super) set: Vec<Override>,
    /// The camera's radius, in Schwarzschild radii, or its orbit's. The angles stay [default: the scene's]
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub(super) radius: Option<f64>,
    /// The camera's inclination from +z, or its orbit's: 0 is face-on to a level disk, 90 edge-on [default: the
    /// scene's]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub(super) inclination: Option<f64>,
    /// The camera's azimuth from +x, or its orbit's [default: the scene's]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub(super) azimuth: Option<f64>,
    /// The vertical field of view, or the whole angle of a fisheye [default: the scene's]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub(super) fov: Option<f64>,
    /// The output: a .png, .exr or .npz file, a .svg file for the outline of the disk alone, or - for the standard
    /// output. For an animation: such a name with #### or %04d in place of the number, or a film: .y4m, .raw, or by
    /// ffmpeg .mp4, .mov, .mkv or .webm [default: the scene's name with .png, with .exr if it names layers, with _####
    /// for an animation, in the current folder]
    #[arg(short, long, value_name = "OUT")]
    pub(super) output: Option<PathBuf>,
    /// The format, where the extension does not name it
    #[arg(long, value_name = "FORMAT", value_enum)]
    pub(super) format: Option<Format>,
    /// The frames of an animation, by their own numbers: 12, 1-240, every tenth as 1-240x10 or 1-240:10, negative ones
    /// as -9--1, several with commas [default: all]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameRange>,
    /// Draw finished frames again, and replace files that other programs made
    #[arg(long)]
    pub(super) overwrite: bool,
    /// List the frames and their files, and draw nothing
    #[arg(long, conflicts_with = "explain")]
    pub(super) dry_run: bool,
    /// How progress is shown on the standard error
    #[arg(long, value_name = "HOW", value_enum, default_value_t = ProgressKind::Auto)]
    pub(super) progress: ProgressKind,
    /// The picture's size in pixels, such as 1920x1080 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(super) size: Option<ImageSize>,
    /// Draw only a part of the picture, in whole pixels from its left and its top: the bytes of that part of the whole
    /// picture, at the cost of that part [default: the scene's, or all]
    #[arg(long, value_name = "LEFT,TOP,WIDTH,HEIGHT", value_parser = crop, allow_hyphen_values = true)]
    pub(super) crop: Option<Crop>,
    /// The largest error of an edge, in pixels, above 0 and at most 1 [default: the scene's]
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true)]
    pub(super) tolerance: Option<f64>,
    /// Smooth edges: each pixel is the share of its square that the disk covers, a linear value and not sRGB; with
    /// false, what its centre sees. Only --method table draws smooth edges [default: the scene's]
    #[arg(long, value_name = "true|false", action = clap::ArgAction::Set)]
    pub(super) antialias: Option<bool>,
    /// The layers of a .exr or .npz file, with commas: coverage, order, radius, azimuth, redshift, emission_cosine,
    /// temperature, colour, sky (where a pixel's ray leaves to), sky_uv (that place in a panorama) [default: the
    /// scene's; else coverage, and colour where there is light or a sky]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(super) layers: Option<Vec<String>>,
    /// The exposure of light in pictures and films, in stops: each doubles it [default: the scene's]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true)]
    pub(super) exposure: Option<f64>,
    /// The bits of a PNG picture's samples: 8 or 16 [default: the scene's; 1 for masks with hard edges]
    #[arg(long, value_name = "8|16", value_parser = bits)]
    pub(super) bits: Option<u8>,
    /// Print the time of each part of the work: reading the sky, memory, curves, render, encode, write
    #[arg(long, conflicts_with_all = ["explain", "dry_run"])]
    pub(super) timings: bool,
    /// Print what the picture needs and what it does not, and draw nothing. Of several frames: each figure's range, and
    /// the frame that decides
    #[arg(long, conflicts_with = "output")]
    pub(super) explain: bool,
    /// Fail where the table is missing, instead of making it: for one of many workers
    #[arg(long)]
    pub(super) require_table: bool,
    /// The most memory for the sky and the frames that are drawn at a time, such as 16GiB: for each pixel of a frame
    /// two bytes for a mask, six for 8-bit colour, twelve for 16-bit colour, eight for each number of a layer; for each
    /// pixel of a panorama sixteen
    #[arg(long, value_name = "SIZE", default_value = memory::DEFAULT, value_parser = memory::parse)]
    pub(super) max_memory: ByteSize,
    #[command(flatten)]
    pub(super) method: MethodArgs,
    #[command(flatten)]
    pub(super) threads: ThreadArgs,
}

/// The numbers of `--crop`, which are checked with the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crop(pub(super) [i64; 4]);

fn crop(text: &str) -> Result<Crop, String> {
    let numbers: Result<Vec<i64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    numbers.map(Crop).ok_or_else(|| {
        "a part of the picture is four whole numbers, LEFT,TOP,WIDTH,HEIGHT: 640,360,320,180".into()
    })
}

fn bits(text: &str) -> Result<u8, String> {
    let bits = text.parse().ok().filter(|bits| [8, 16].contains(bits));
    bits.ok_or_else(|| "a sample has 8 or 16 bits".into())
}

/// Parses a picture's size.
pub(in crate::cli) fn size(text: &str) -> Result<ImageSize, String> {
    let sides = text.split_once(['x', 'X', '×']);
    let size = sides.and_then(|(width, height)| {
        let (width, height) = (width.parse().ok()?, height.parse().ok()?);
        Some(ImageSize { width, height })
    });
    size.ok_or_else(|| "a size is width x height, in pixels: 1920x1080".into())
}
