//! `darkness job`: an animation as a job for a render farm.

use std::path::{Component, Path, PathBuf};

use clap::{Args, ValueEnum};

use super::misuse::misuse;
use super::progress::Report;
use super::render;
use super::stdio::print;
use super::table_path::portable_path;
use crate::render::needs::Needs;
use crate::scene::{Animation, builtins};

/// Print an animation as a job for a render farm
///
/// Each task renders some frames into the same folder, with one table. A frame's bytes depend only on the scene, the
/// table and the frame's number, so any machines can share the work.
#[derive(Debug, Args)]
pub(super) struct JobArgs {
    /// The scheduler
    #[arg(value_enum)]
    scheduler: Scheduler,
    /// A scene's TOML file, or the name of a built-in scene
    scene: PathBuf,
    /// Frames per task
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    chunk: u32,
    /// The files of the frames, .png, .exr or .npz, with #### in place of the number [default: frames/NAME_####.png,
    /// or .exr if the scene has layers]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// The table's file [default: the one that the scene needs, in the folder tables]
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Scheduler {
    /// An Open Job Description template (2023-09), for `openjd run` and AWS Deadline Cloud
    Openjd,
    /// A script for `sbatch`
    Slurm,
}

/// The tasks that Slurm allows in an array unless its `MaxArraySize` is raised.
const SLURM_TASKS: u32 = 1001;

/// The most frames that are checked before the job is printed; each task checks its own.
const LOOKED_AT: u32 = 1_000_000;

/// Runs the verb.
pub(super) fn run(args: &JobArgs, report: Report) -> anyhow::Result<()> {
    let animation = Animation::load(&args.scene)?;
    if animation.is_still() {
        return Err(misuse(format!(
            "{}: the scene has no [animation]; `darkness render` draws its one picture",
            args.scene.display()
        )));
    }
    let frames = animation.frames();
    let (first, last) = (animation.first(), animation.last());
    for number in (first..=last).step_by(frames.div_ceil(LOOKED_AT) as usize) {
        animation.check(number)?;
    }
    let (output, form) = render::sequence(&args.scene, &animation, args.output.as_deref())?;
    let needs = Needs::of_animation(&animation, form)?;
    let table_name = needs.table().map_or("fine", |candidate| candidate.name);
    if needs.table().is_none() {
        report.note("no table is good enough for some of these frames; fine is the best there is");
    }
    let default = || portable_path(table_name);
    let table = args.table.clone().unwrap_or_else(default);
    let [scene, table, output] = [&args.scene, &table, &output].map(|path| text(path));
    let (scene, table, output) = (scene?, table?, output?);
    let sky_files = render::sky_files(animation.sky().filter(|_| form.shows_light()));
    let sky_files = sky_files.map(|(file, what)| Ok((what, text(&file.path)?)));
    let sky_files: Vec<_> = sky_files.collect::<anyhow::Result<_>>()?;

    let (template, mut pieces) = match args.scheduler {
        Scheduler::Openjd => {
            let (folder, pattern) = output.rsplit_once('/').unwrap_or((".", &output));
            let pieces = vec![
                ("SCENE", openjd_scene(&scene)),
                ("SKY", openjd_sky(&sky_files)),
                ("FOLDER", default_of(folder)),
                ("PATTERN", quoted(pattern)),
                ("TABLE", default_of(&table)),
                ("FILE", "job.yaml".into()),
                ("GIVEN", given(&scene, &sky_files, folder, &table)),
            ];
            (include_str!("job/openjd.yaml"), pieces)
        }
        Scheduler::Slurm => {
            let tasks = frames.div_ceil(args.chunk);
            if tasks > SLURM_TASKS {
                report.note(format_args!(
                    "an array of {tasks} tasks exceeds the {SLURM_TASKS} that Slurm allows by default (MaxArraySize); \
                     --chunk {} would fit",
                    frames.div_ceil(SLURM_TASKS)
                ));
            }
            let pieces = vec![
                ("SCENE", shell(&scene)),
                ("SKY", slurm_sky(&sky_files)),
                ("TABLE", shell(&table)),
                ("OUT", shell(&output)),
                ("LAST_TASK", (tasks - 1).to_string()),
                ("FILE", "job.sh".into()),
            ];
            (include_str!("job/slurm.sh"), pieces)
        }
    };
    pieces.extend([
        ("FRAMES", frames.to_string()),
        ("FIRST", first.to_string()),
        ("LAST", last.to_string()),
        ("CHUNK", args.chunk.to_string()),
        ("TABLE_NAME", table_name.to_owned()),
        ("NAME", name(&args.scene)),
        ("TITLE", args.scene.display().to_string()),
        ("VERSION", env!("CARGO_PKG_VERSION").to_owned()),
    ]);
    Ok(print(&fill(template, &pieces))?)
}

/// The job's name, from the scene's: what every scheduler and shell takes as one word.
fn name(scene: &Path) -> String {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let name = stem.replace(|c| !is_plain(c), "_");
    let name = name.trim_start_matches(['-', '.']);
    format!("darkness-{}", &name[..name.len().min(100)])
}

/// A path as text for a job: one line, and nothing that a command takes for an option.
fn text(path: &Path) -> anyhow::Result<String> {
    // YAML ends lines at the first two, and reserves the others.
    let yaml = ['\u{2028}', '\u{2029}', '\u{feff}', '\u{fffe}', '\u{ffff}'];
    let is_odd = |c: char| c.is_control() || yaml.contains(&c);
    let Some(text) = path.to_str().filter(|text| !text.contains(is_odd)) else {
        return Err(misuse(format!(
            "{}: the name has characters that a job's text cannot hold",
            path.display()
        )));
    };
    let before = if text.starts_with('-') { "./" } else { "" };
    Ok(format!("{before}{text}"))
}

/// Replaces each `@KEY@` of the template in one pass: inserted text is not searched.
fn fill(template: &str, pieces: &[(&str, String)]) -> String {
    let mut text = String::with_capacity(2 * template.len());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('@') {
        text.push_str(before);
        let piece = after.split_once('@').and_then(|(key, after)| {
            let (_, value) = pieces.iter().find(|(name, _)| *name == key)?;
            Some((value.as_str(), after))
        });
        let (value, after) = piece.unwrap_or(("@", after));
        text.push_str(value);
        rest = after;
    }
    text + rest
}

/// A string literal of JSON, which is one of YAML too.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A string literal of the shell.
fn shell(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
}

/// The scene's parameter: the name of a built-in scene, or a file. A file can be a default only below the template's
/// folder.
fn openjd_scene(scene: &str) -> String {
    let (kind, what, default) = if is_builtin(scene) {
        let default = format!("\n    default: {}", quoted(scene));
        ("STRING", "The name of a built-in scene.", default)
    } else {
        let kind = "PATH\n    objectType: FILE\n    dataFlow: IN";
        (kind, "The scene's file.", default_of(scene))
    };
    format!("  - name: Scene\n    type: {kind}\n    description: {what}{default}")
}

/// The parameters of the sky's files, so that they are shipped with the scene.
fn openjd_sky(files: &[(&str, String)]) -> String {
    let parameter = |(what, path): &(&str, String)| {
        let (name, default) = (openjd_name(what), default_of(path));
        format!(
            "\n  - name: {name}\n    type: PATH\n    objectType: FILE\n    dataFlow: IN\n    description: The scene's \
             {what}. The scene finds it by its place beside the scene's file.{default}"
        )
    };
    files.iter().map(parameter).collect()
}

/// The parameter of a file of the sky.
fn openjd_name(what: &str) -> &'static str {
    if what == "panorama" {
        "Panorama"
    } else {
        "Stars"
    }
}

/// The comment of a script that names the sky's files.
fn slurm_sky(files: &[(&str, String)]) -> String {
    let line = |(what, path): &(&str, String)| {
        format!("\n# All nodes read the scene's {what} too: {path}")
    };
    files.iter().map(line).collect()
}

/// The line of a path's default, if it can be one.
fn default_of(path: &str) -> String {
    if is_below(path) {
        format!("\n    default: {}", quoted(path))
    } else {
        String::new()
    }
}

/// The arguments for paths that cannot be defaults.
fn given(scene: &str, sky_files: &[(&str, String)], folder: &str, table: &str) -> String {
    let mut text = String::new();
    let sky_files = sky_files
        .iter()
        .map(|(what, path)| (openjd_name(what), path.as_str(), false));
    let others = [("OutputDir", folder, false), ("Table", table, false)];
    let scene = [("Scene", scene, is_builtin(scene))];
    for (name, value, is_name) in scene.into_iter().chain(sky_files).chain(others) {
        if !is_name && !is_below(value) {
            text.push_str(" -p ");
            text.push_str(&shell(&format!("{name}={value}")));
        }
    }
    text
}

fn is_builtin(scene: &str) -> bool {
    builtins().iter().any(|builtin| builtin.name() == scene)
}

/// Whether a relative path stays below its folder.
fn is_below(path: &str) -> bool {
    let mut parts = Path::new(path).components();
    parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}
