//! `darkness render -o disk.svg`: the disk's outline as a path.

use std::time::Instant;

use super::super::destination::Destination;
use super::super::frame_range::FrameRange;
use super::super::misuse::{check_flat, misuse};
use super::super::progress::{Report, duration};
use super::super::stdio::print;
use super::super::threads::start_threads;
use super::args::RenderArgs;
use super::format::Format;
use super::output;
use crate::figure::{TOLERANCE, outline_svg};
use crate::isoradial::{CurveSpec, Isoradials};
use crate::orbit::exact::Exact;
use crate::render::disk_outline;
use crate::scene::{Animation, View};

/// Whether an SVG file is asked for.
pub(super) fn is_asked(args: &RenderArgs) -> bool {
    let named = args.output.as_deref().and_then(Format::of_extension);
    args.format.or(named) == Some(Format::Svg)
}

/// Writes the outline of one frame's disk. Its curves are exact, so it needs no table.
///
/// # Errors
/// The options make no sense for an outline, the scene has no disk, or the file cannot be written.
pub(super) fn run(
    args: &RenderArgs,
    animation: &Animation,
    frames: &FrameRange,
    report: Report,
) -> anyhow::Result<()> {
    for (given, flag) in [
        (args.layers.is_some(), "--layers"),
        (args.bits.is_some(), "--bits"),
        (args.exposure.is_some(), "--exposure"),
        (args.antialias.is_some(), "--antialias"),
        (args.timings, "--timings"),
        (!args.method.is_table(), "--method"),
    ] {
        if given {
            return Err(misuse(format!(
                "a .svg file holds the outline of the disk, from exact curves; leave out {flag}"
            )));
        }
    }
    if frames.count() > 1 {
        return Err(misuse(format!(
            "a .svg file holds one frame, and {} are asked for; choose one with --frames",
            frames.count()
        )));
    }
    let number = frames.last();
    let scene = animation.check(number)?;
    check_flat(&scene, "the disk's outline")?;
    if scene.disk().is_none() {
        return Err(misuse(
            "a .svg file holds the outline of the disk, and this scene has none; write a .png or .exr file",
        ));
    }
    let (_, destination) = output::checked(args, animation, 1)?;
    destination.check_input(&args.scene, "scene", frames)?;
    let destination = match destination {
        Destination::Sequence(pattern) => Destination::File(pattern.file(number)),
        destination => destination,
    };
    if args.dry_run {
        let file = destination.file(number);
        return Ok(print(&format!("{number}\tto draw\t{}\n", file.display()))?);
    }
    start_threads(args.threads.threads)?;

    let start = Instant::now();
    let view = View::new(&scene);
    let spec = CurveSpec::new(&scene, &view, TOLERANCE);
    let curves = Isoradials::new(&spec, &Exact);
    let outline = disk_outline(&view, &curves, TOLERANCE).ok_or_else(|| {
        anyhow::anyhow!(
            "this picture shows edges that are finer than rounding, and they have no outline; write a .png file, or \
             choose a wider --fov"
        )
    })?;
    destination.write(outline_svg(&outline, &scene).as_bytes())?;
    let time = duration(start.elapsed());
    report.note(format_args!("{destination}: the disk's outline in {time}"));
    Ok(())
}
