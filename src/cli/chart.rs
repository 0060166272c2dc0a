//! `darkness chart`: measures speed against accuracy on this machine.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use super::destination::{Destination, onto_input};
use super::misuse::misuse;
use super::progress::{Report, duration};
use super::stdio::print;
use super::threads::{ThreadArgs, start_threads};
use super::writable;
use crate::chart::{ChartData, ChartEffort, ChartError, draw, write_csv};
use crate::output::write_whole;
use crate::scene::{DEFAULT_SCENE, Scene};

/// Measure speed against accuracy on this machine, and draw it as an SVG figure
///
/// Every method answers the same questions: single rays, near-critical rays, and SCENE's
/// frame, as a mask and in colour. Times are medians of
/// interleaved repetitions on one thread. Run it on an otherwise idle machine.
#[derive(Debug, Args)]
pub(super) struct ChartArgs {
    /// The scene whose frame is measured: a TOML file, or the name of a built-in scene (`darkness scene` lists them)
    #[arg(value_name = "SCENE", default_value = DEFAULT_SCENE)]
    scene: PathBuf,
    /// The file to write the figure to, ending in .svg, or - for the standard output
    #[arg(short, long, value_name = "OUT.svg", default_value = "chart.svg")]
    output: PathBuf,
    /// Also write every measured point to this CSV file
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Measure with fewer rays, settings and repetitions, in seconds instead of minutes
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    threads: ThreadArgs,
}

/// Runs the verb.
pub(super) fn run(args: &ChartArgs, report: Report) -> anyhow::Result<()> {
    let scene = Scene::load(&args.scene)?.with_crop(None)?;
    if scene.disk().is_none() {
        return Err(misuse(ChartError::NoDisk.to_string()));
    }
    let destination = Destination::of_picture(args.output.clone(), "svg", &args.scene)?;
    if let Some(path) = &args.csv {
        check_csv(path, &args.output, &args.scene)?;
    }
    start_threads(args.threads.threads)?;

    let start = Instant::now();
    let chart = measure(args, &scene, report)?;
    let svg = draw::svg(&chart)?;
    if let Some(path) = &args.csv {
        write_whole(path, |file| write_csv(&chart, file)).map_err(|error| {
            anyhow::anyhow!("{}: cannot write the CSV file: {error}", path.display())
        })?;
    }
    destination.write(svg.as_bytes())?;
    report.note(chart.verdict());
    let summary = format!("{}\n", chart.scene.summary());
    match destination {
        Destination::Stdout => report.note(summary.trim_end()),
        _ => print(&summary)?,
    }
    let time = duration(start.elapsed());
    report.note(format_args!("{destination}: measured and drawn in {time}"));
    Ok(())
}

/// Checks that the CSV file can be written to `path`, and that `path` is neither the scene nor the figure.
fn check_csv(path: &Path, figure: &Path, scene: &Path) -> anyhow::Result<()> {
    const OPTION: &str = "--csv";
    if path == Path::new("-") {
        return Err(misuse(
            "--csv needs a file's name; the CSV cannot go to the standard output",
        ));
    }
    if writable::same_file(path, scene) {
        return Err(onto_input(OPTION, path, "scene"));
    }
    if figure != Path::new("-") && writable::same_place(path, figure) {
        return Err(misuse(format!(
            "{}: -o and --csv name the same file",
            path.display()
        )));
    }
    writable::check(path, OPTION)
}

/// Measures everything, with a progress bar.
fn measure(args: &ChartArgs, scene: &Scene, report: Report) -> anyhow::Result<ChartData> {
    const STEPS: f64 = 100.0;
    let bar = report.bar(STEPS as u64, "", "%");
    let progress = |what: &'static str, share: f64| {
        bar.set_message(what);
        bar.set_position((share * STEPS) as u64);
    };
    let effort = if args.quick {
        ChartEffort::Quick
    } else {
        ChartEffort::Full
    };
    let name = args.scene.file_stem().unwrap_or(args.scene.as_os_str());
    // XML allows no control characters and neither of these two.
    let is_odd = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    let name = name.to_string_lossy().replace(is_odd, "\u{fffd}");
    Ok(ChartData::measure(scene, name, effort, &progress)?)
}
