//! `darkness render`: a scene's picture.

use std::io::{self, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;

use super::explain::explain;
use super::method::{Method, MethodArgs};
use super::picture::Destination;
use super::progress::{Report, duration};
use super::{Misuse, Threads, start_threads};
use crate::isoradial::{EdgeError, Isoradials};
use crate::orbit::Orbits;
use crate::orbit::exact::Exact;
use crate::orbit::path::SweptAngles;
use crate::render::needs::Needs;
use crate::render::{RenderError, coverage, cull, mask, pixelwise};
use crate::scene::{DEFAULT_SCENE, Scene, View};

/// Render a scene as a PNG picture
///
/// The table, the orders of the image and the nodes of their curves are the fewest with which every edge is right to
/// the scene's tolerance; --explain tells which they are.
#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// A scene's TOML file, or the name of a built-in scene (`darkness scene` lists them)
    #[arg(value_name = "SCENE", default_value = DEFAULT_SCENE)]
    scene: PathBuf,
    /// Where the picture goes: a file ending in .png, or - for the standard output [default: the scene's name with
    /// .png, in the current folder]
    #[arg(short, long, value_name = "OUT.png")]
    output: Option<PathBuf>,
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
    /// Tell what each part of the work took: curves, culling, edges, encoding
    #[arg(long, conflicts_with = "explain")]
    timings: bool,
    /// Tell what the picture needs and what it does not, and draw nothing
    #[arg(long, conflicts_with = "output")]
    explain: bool,
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
    let scene = scene(args)?;
    let destination = (!args.explain)
        .then(|| Destination::new(args.output.as_deref(), &args.scene))
        .transpose()?;
    let view = View::new(&scene);
    let needs = Needs::new(&scene, &view);
    let needed = needs.table().map(|candidate| candidate.name);
    let table = args.method.table_path(needed);
    if let (Some(destination), Some(table)) = (&destination, &table) {
        destination.spares(table)?;
    }
    let method = args.method.check(needed)?;
    start_threads(args.threads.threads)?;

    let method = method.ready(report)?;
    let Some(destination) = destination else {
        return explain(&scene, &needs, &method, table.as_deref());
    };
    let start = Instant::now();
    let pixels = draw(&scene, &view, &needs, &method, report)?;
    let drawn = start.elapsed();
    let time = duration(drawn);
    let size = scene.image();
    let start = Instant::now();
    destination.write_png(&pixels, size)?;
    let written = start.elapsed();
    if args.timings {
        tell_timings(&scene, &view, &needs, &method, (drawn, written))?;
    }
    report.note(format_args!(
        "{destination}: {} × {}, {method}, drawn in {time}",
        size.width, size.height
    ));
    Ok(())
}

/// The scene asked for, with what the options change of it.
fn scene(args: &RenderArgs) -> anyhow::Result<Scene> {
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
    let mut scene = Scene::load(&args.scene)?;
    if let Some((width, height)) = args.size {
        scene = scene
            .with_size(width, height)
            .map_err(|source| Misuse::Size {
                width,
                height,
                source,
            })?;
    }
    if let Some(antialias) = args.antialias {
        scene = scene.with_antialias(antialias);
    }
    if let Some(pixels) = args.tolerance {
        scene = scene.with_tolerance(pixels).map_err(Misuse::Tolerance)?;
    }
    Ok(scene)
}

/// Tells what the parts of a picture from curves took. Curves, culling and edges are done once more by themselves, when
/// the caches are warm and the memory is there.
fn tell_timings(
    scene: &Scene,
    view: &View,
    needs: &Needs,
    method: &Method,
    (drawn, written): (Duration, Duration),
) -> anyhow::Result<()> {
    let start = Instant::now();
    let curves = match method {
        Method::Table(table) => Isoradials::new(&needs.sight, &table.lookup()),
        _ => Isoradials::new(&needs.sight, &Exact),
    };
    let for_curves = start.elapsed();
    let mut pixels = mask::render(view, &curves)?;
    let start = Instant::now();
    cull(view, &curves, scene.antialias(), &mut pixels)?;
    let for_culling = start.elapsed();
    let start = Instant::now();
    if scene.antialias() {
        coverage::render_into(view, &curves, &mut pixels, view.width() as usize)?;
    } else {
        mask::render_into(view, &curves, &mut pixels, view.width() as usize)?;
    }
    let for_frame = start.elapsed();
    let lines = [
        ("curves", for_curves),
        ("culling", for_culling),
        ("edges", for_frame.saturating_sub(for_culling)),
        ("encoding and writing", written),
        ("all but that, for the first time", drawn),
    ];
    let mut stderr = io::stderr();
    for (name, time) in lines {
        let _ = writeln!(stderr, "{:>10}  {name}", duration(time));
    }
    Ok(())
}

/// The scene's pixels: from isoradial curves with a table, else ray by ray.
fn draw(
    scene: &Scene,
    view: &View,
    needs: &Needs,
    method: &Method,
    report: Report,
) -> Result<Vec<u8>, RenderError> {
    match method {
        Method::Table(table) => by_curves(scene, view, needs, &table.lookup(), report),
        Method::NoTable => by_curves(scene, view, needs, &Exact, report),
        Method::Exact => ray_by_ray(scene, view, &Exact, report),
        Method::Integrate(adaptive) => ray_by_ray(scene, view, adaptive, report),
    }
}

fn by_curves(
    scene: &Scene,
    view: &View,
    needs: &Needs,
    angles: &impl SweptAngles,
    report: Report,
) -> Result<Vec<u8>, RenderError> {
    let curves = Isoradials::new(&needs.sight, angles);
    let (error, allowed) = (curves.error(), scene.tolerance());
    if is_unresolved(error, allowed) {
        report.note(format_args!(
            "the isoradial curves of this view are only right to {:.1e} pixels, so every pixel's ray is followed by itself, which takes a hundred times as long and leaves hard edges",
            error.total()
        ));
        warn_of(error.angles + error.rounding, error, needs, report);
        return ray_by_ray(scene, view, angles, report);
    }
    warn_of(error.total(), error, needs, report);
    if scene.antialias() {
        coverage::render(view, &curves)
    } else {
        mask::render(view, &curves)
    }
}

/// Says what an edge may be off by where that is more than was asked for, and what would help.
fn warn_of(off: f64, error: EdgeError, needs: &Needs, report: Report) {
    let allowed = needs.sight.tolerance;
    if off > allowed {
        report.note(format_args!(
            "an edge of this picture may be off by {off:.1e} pixels, more than the {allowed:?} asked for: {}",
            if error.angles > error.rounding {
                needs.advice()
            } else {
                "double precision cannot do better".into()
            }
        ));
    }
}

/// Whether the curves fall short of what their angles and the arithmetic allow: where a disk of any width and a lens
/// of any length bend them more than any number of nodes follows.
fn is_unresolved(error: EdgeError, allowed: f64) -> bool {
    error.interpolation > allowed && error.interpolation > 4.0 * (error.angles + error.rounding)
}

fn ray_by_ray(
    scene: &Scene,
    view: &View,
    orbits: &impl Orbits,
    report: Report,
) -> Result<Vec<u8>, RenderError> {
    let bar = report.bar(u64::from(view.height()), "drawing", "rows");
    pixelwise::render(scene, view, orbits, &|| bar.inc(1))
}
