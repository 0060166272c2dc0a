//! `darkness render`: a scene's picture.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use super::method::{Method, MethodArgs};
use super::picture::Destination;
use super::progress::{Report, duration};
use super::{Misuse, Threads, start_threads};
use crate::isoradial::Isoradials;
use crate::orbit::Orbits;
use crate::orbit::exact::Exact;
use crate::render::{RenderError, mask, pixelwise};
use crate::scene::{DEFAULT_SCENE, Scene, View};

/// Render a scene as a PNG picture
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
    let destination = Destination::new(args.output.as_deref(), &args.scene)?;
    if let Some(table) = args.method.table_path() {
        destination.spares(&table)?;
    }
    let method = args.method.check()?;
    start_threads(args.threads.threads)?;

    let method = method.ready(report)?;
    let start = Instant::now();
    let pixels = draw(&scene, &method, report)?;
    let time = duration(start.elapsed());
    let size = scene.image();
    destination.write_png(&pixels, size)?;
    report.note(format_args!(
        "{destination}: {} × {}, {method}, drawn in {time}",
        size.width, size.height
    ));
    Ok(())
}

/// The scene's pixels: from isoradial curves with a table, else ray by ray.
fn draw(scene: &Scene, method: &Method, report: Report) -> Result<Vec<u8>, RenderError> {
    let view = View::new(scene);
    match method {
        Method::Table(table) => {
            let lookup = table.lookup();
            let sight = mask::sight(scene, &view);
            let curves = Isoradials::new(&sight, &lookup);
            if curves.error() <= sight.tolerance {
                return mask::render(&view, &curves);
            }
            report.note(format_args!(
                "the isoradial curves of this view are only right to {:.1e} pixels, so every pixel's ray is looked up by itself, which takes a hundred times as long",
                curves.error()
            ));
            ray_by_ray(scene, &view, &lookup, report)
        }
        Method::Exact => ray_by_ray(scene, &view, &Exact, report),
        Method::Integrate(adaptive) => ray_by_ray(scene, &view, adaptive, report),
    }
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
