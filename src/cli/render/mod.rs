//! `darkness render`: a scene's picture, or the frames of its animation.

mod explain;
mod film;
mod memory;
mod output;
pub(super) mod pattern;
mod plan;
mod run;
mod sequence;
mod tally;
mod told;

use std::io::{self, Write};
use std::path::PathBuf;

use bytesize::ByteSize;
use clap::Args;
use explain::explain;
use memory::Limit;
use output::FormatName;
use plan::Plan;

use super::method::{Checked, Method, MethodArgs};
use super::progress::{ProgressKind, Report};
use super::{Misuse, StdoutError, Threads, start_threads};
use crate::render::needs::Needs;
use crate::scene::animation::FrameRange;
use crate::scene::{Animation, DEFAULT_SCENE, ImageSize, View};

/// Render a scene as a PNG picture, or its animation as numbered PNG pictures or a film
///
/// The table, the orders of the image and the nodes of their curves are the fewest with which every edge is right to
/// the scene's tolerance; --explain tells which they are.
///
/// Frames that are there already, whole and of the same scene, table and version, are left as they are: the same command
/// goes on after whatever stopped it. The first Ctrl-C or SIGTERM finishes the frames begun, the second ends at once.
#[derive(Debug, Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a switch of the command line"
)]
pub(super) struct RenderArgs {
    /// A scene's TOML file, or the name of a built-in scene (`darkness scene` lists them)
    #[arg(value_name = "SCENE", default_value = DEFAULT_SCENE)]
    scene: PathBuf,
    /// Where the picture goes: a file ending in .png, or - for the standard output. The frames of an animation: a name with
    /// #### or %04d in place of the number, or a film's file ending in .y4m or .raw [default: the scene's name with .png, or
    /// with _####.png for an animation, in the current folder]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// What is written, where the ending of the name does not say it
    #[arg(long, value_name = "FORMAT", value_enum)]
    format: Option<FormatName>,
    /// Which frames of an animation: 12, 1-240, every tenth as 1-240x10 or 1-240:10, several with commas [default: all]
    #[arg(long, value_name = "RANGE")]
    frames: Option<FrameRange>,
    /// Draw frames that are there already too
    #[arg(long)]
    overwrite: bool,
    /// List the frames and their files, and draw nothing
    #[arg(long, conflicts_with = "explain")]
    dry_run: bool,
    /// How progress is told on the standard error
    #[arg(long, value_name = "HOW", value_enum, default_value_t = ProgressKind::Auto)]
    progress: ProgressKind,
    /// The picture's size in pixels, such as 1920x1080, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,
    /// What an edge may be off by, in pixels, above 0 and at most 1, in place of the scene's
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Smooth edges: each pixel is the share of its square that the disk covers; with false, what its centre sees. In
    /// place of the scene's; the methods that follow single rays know hard edges only
    #[arg(long, value_name = "true|false", action = clap::ArgAction::Set)]
    antialias: Option<bool>,
    /// Tell what each part of the work took: curves, render, encode, write; of one picture also culling and edges
    #[arg(long, conflicts_with_all = ["explain", "dry_run"])]
    timings: bool,
    /// Tell what the picture needs and what it does not, and draw nothing
    #[arg(long, conflicts_with = "output")]
    explain: bool,
    /// Make no table where it is missing, but fail: for one of many workers
    #[arg(long)]
    require_table: bool,
    /// The most memory that frames may take, such as 16GiB: two bytes for each pixel, of as many frames as are drawn side by side
    #[arg(long, value_name = "SIZE", default_value = memory::DEFAULT, value_parser = memory::size)]
    max_memory: ByteSize,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    threads: Threads,
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', 'X', '×']);
    let sides = sides.and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    sides.ok_or_else(|| "a size is written width x height, in pixels: 1920x1080".into())
}

/// Runs the verb.
pub(super) fn run(args: &RenderArgs, report: Report) -> anyhow::Result<()> {
    let run = || {
        let animation = animation(args)?;
        let frames = frames(args, &animation)?;
        if args.explain {
            return explain_one(args, &animation, &frames, report);
        }
        let (plan, checked) = Plan::new(args, &animation, &frames)?;
        if args.dry_run {
            return plan.list(checked);
        }
        plan.run(checked, report)
    };
    run().inspect_err(|error| {
        let is_failure = !error
            .downcast_ref()
            .is_some_and(StdoutError::is_closed_pipe);
        if is_failure && args.progress == ProgressKind::Openjd {
            let text = error.to_string().replace('\n', " ");
            let _ = writeln!(io::stderr(), "openjd_fail: {text}");
        }
    })
}

/// The scene asked for, with what the options change of it.
fn animation(args: &RenderArgs) -> anyhow::Result<Animation> {
    for (given, flag) in [
        (args.tolerance.is_some(), "tolerance"),
        (args.explain, "explain"),
        (args.antialias == Some(true), "antialias"),
        (args.timings, "timings"),
    ] {
        if given && !args.method.is_table() {
            return Err(Misuse::CurvesUnused { flag }.into());
        }
    }
    if args.require_table && !args.method.is_table() {
        return Err(Misuse::TableUnused.into());
    }
    let mut animation = Animation::load(&args.scene)?;
    let memory = Limit(args.max_memory);
    if let Some((width, height)) = args.size {
        memory.check(ImageSize { width, height })?;
        let sized = animation.with_size(width, height);
        animation = sized.map_err(|source| Misuse::Size {
            width,
            height,
            source,
        })?;
    }
    if let Some(antialias) = args.antialias {
        animation = animation.with_antialias(antialias)?;
    }
    if let Some(pixels) = args.tolerance {
        animation = animation
            .with_tolerance(pixels)
            .map_err(Misuse::Tolerance)?;
    }
    memory.check(animation.image())?;
    Ok(animation)
}

/// The frames asked for, which the animation has.
fn frames(args: &RenderArgs, animation: &Animation) -> anyhow::Result<FrameRange> {
    let all = FrameRange::up_to(animation.frames());
    let frames = args.frames.clone().unwrap_or(all);
    if let Err(source) = animation.frame(frames.last())
        && frames.last() > animation.frames()
    {
        let range = frames.to_string();
        return Err(Misuse::Frames { range, source }.into());
    }
    Ok(frames)
}

/// Tells what one frame needs.
fn explain_one(
    args: &RenderArgs,
    animation: &Animation,
    frames: &FrameRange,
    report: Report,
) -> anyhow::Result<()> {
    let number = frames.iter().next().unwrap_or(1);
    if args.frames.is_some() && frames.iter().nth(1).is_some() {
        return Err(Misuse::ExplainsOne.into());
    }
    let scene = animation.frame(number)?;
    let needs = Needs::new(&scene, &View::new(&scene));
    let needed = needs.table().map(|candidate| candidate.name);
    let checked = args.method.check(needed)?;
    start_threads(args.threads.threads)?;
    let method = ready(args, checked, report)?;
    let table = args.method.table_path(needed);
    explain(&scene, &needs, &method, table.as_deref())
}

/// The method, its table made where that is allowed.
fn ready(args: &RenderArgs, checked: Checked, report: Report) -> anyhow::Result<Method> {
    if args.require_table {
        checked.without_making()
    } else {
        checked.ready(report)
    }
}
