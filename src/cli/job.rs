//! `darkness job`: an animation as a job of a farm's scheduler.

use std::path::{Component, Path, PathBuf};

use clap::{Args, ValueEnum};

use super::progress::Report;
use super::render::pattern::Pattern;
use super::{Misuse, print};
use crate::render::needs::Needs;
use crate::scene::{Animation, builtins};
use crate::table;

/// Print an animation as a job for the machines of a farm
///
/// Each task renders some frames into the same folder, with one table. A frame's bytes depend on the scene, the table and its number
/// alone, so that any machines can share the work.
#[derive(Debug, Args)]
pub(super) struct JobArgs {
    /// What the job is for
    #[arg(value_enum)]
    scheduler: Scheduler,
    /// A scene's TOML file, or the name of a built-in scene
    scene: PathBuf,
    /// How many frames a task renders
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    chunk: u32,
    /// The frames' files, with #### in place of the number [default: frames/NAME_####.png]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// The table's file [default: in tables, the one that the scene needs]
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Scheduler {
    /// An Open Job Description template (2023-09), which `openjd run` and AWS Deadline Cloud take
    Openjd,
    /// A script for `sbatch`
    Slurm,
}

/// The tasks of an array that Slurm allows where nobody has raised its `MaxArraySize`.
const SLURM_TASKS: u32 = 1001;

/// The most frames that are looked at before the job is printed; each task looks at its own.
const LOOKED_AT: u32 = 1_000_000;

/// Runs the verb.
pub(super) fn run(args: &JobArgs, report: Report) -> anyhow::Result<()> {
    let animation = Animation::load(&args.scene)?;
    if animation.is_still() {
        return Err(Misuse::StillJob {
            path: args.scene.clone(),
        }
        .into());
    }
    let frames = animation.frames();
    for number in (1..=frames).step_by(frames.div_ceil(LOOKED_AT) as usize) {
        animation.check(number)?;
    }
    let needs = Needs::of_animation(&animation)?;
    let table_name = needs.table().map_or("fine", |candidate| candidate.name);
    if needs.table().is_none() {
        report.note(
            "no table is good enough for some of these frames: fine is the best that there is",
        );
    }
    let default = || table::default_path(table_name);
    let table = args.table.clone().unwrap_or_else(default);
    let name = args.scene.file_stem().unwrap_or(args.scene.as_os_str());
    let name = name.to_string_lossy();
    let default = || Path::new("frames").join(format!("{name}_####.png"));
    let output = args.output.clone().unwrap_or_else(default);
    let is_png = output
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    if !is_png {
        let (path, endings) = (output, ".png");
        return Err(Misuse::Ending { path, endings }.into());
    }
    if Pattern::parse(&output)?.is_none() {
        let (path, count) = (output, u64::from(frames));
        return Err(Misuse::FramesWithoutNumber { path, count }.into());
    }
    let [scene, table, output] = [&args.scene, &table, &output].map(|path| text(path));
    let (scene, table, output) = (scene?, table?, output?);

    let text = match args.scheduler {
        Scheduler::Openjd => {
            let (folder, pattern) = output.rsplit_once('/').unwrap_or((".", &output));
            let pieces = [
                ("SCENE", openjd_scene(&scene)),
                ("FOLDER", default_of(folder)),
                ("PATTERN", quoted(pattern)),
                ("TABLE", default_of(&table)),
                ("FILE", "job.yaml".into()),
                ("GIVEN", given(&scene, folder, &table)),
            ];
            fill(
                include_str!("job/openjd.yaml"),
                &pieces,
                args,
                frames,
                table_name,
            )
        }
        Scheduler::Slurm => {
            let tasks = frames.div_ceil(args.chunk);
            if tasks > SLURM_TASKS {
                report.note(format_args!(
                    "an array of {tasks} tasks is more than the {SLURM_TASKS} that Slurm allows where MaxArraySize is not raised: --chunk {} would do",
                    frames.div_ceil(SLURM_TASKS)
                ));
            }
            let pieces = [
                ("SCENE", shell(&scene)),
                ("TABLE", shell(&table)),
                ("OUT", shell(&output)),
                ("LAST_TASK", (tasks - 1).to_string()),
                ("FILE", "job.sh".into()),
            ];
            fill(
                include_str!("job/slurm.sh"),
                &pieces,
                args,
                frames,
                table_name,
            )
        }
    };
    Ok(print(&text)?)
}

/// A path as text, which the job is: nothing that a command could take for an option.
fn text(path: &Path) -> Result<String, Misuse> {
    // YAML takes some more for ends of lines, and one for a mark of its own.
    let is_odd = |c: char| {
        c.is_control()
            || matches!(
                c,
                '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}'
            )
    };
    let text = path.to_str().filter(|text| !text.contains(is_odd));
    let as_path = |text: &str| {
        let before = if text.starts_with('-') { "./" } else { "" };
        format!("{before}{text}")
    };
    text.map(as_path).ok_or_else(|| Misuse::UnprintablePath {
        path: path.to_owned(),
    })
}

/// The template with each `@KEY@` replaced, in one pass: what is put in is not looked through.
fn fill(
    template: &str,
    pieces: &[(&str, String)],
    args: &JobArgs,
    frames: u32,
    table_name: &str,
) -> String {
    let common = [
        ("FRAMES", frames.to_string()),
        ("CHUNK", args.chunk.to_string()),
        ("TABLE_NAME", table_name.to_owned()),
        ("TITLE", args.scene.display().to_string()),
        ("VERSION", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    let mut text = String::with_capacity(2 * template.len());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('@') {
        text.push_str(before);
        let piece = after.split_once('@').and_then(|(key, after)| {
            let mut all = pieces.iter().chain(&common);
            let (_, value) = all.find(|(name, _)| *name == key)?;
            Some((value, after))
        });
        if let Some((value, after)) = piece {
            text.push_str(value);
            rest = after;
        } else {
            text.push('@');
            rest = after;
        }
    }
    text + rest
}

/// A string that is one in YAML and JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A string that a shell takes as it is.
fn shell(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
}

/// The scene's parameter. A built-in scene is a name and no file; the default of a file's must be a path below the
/// template's folder.
fn openjd_scene(scene: &str) -> String {
    let (kind, what) = if is_builtin(scene) {
        ("STRING", "The name of a built-in scene.")
    } else {
        (
            "PATH\n    objectType: FILE\n    dataFlow: IN",
            "The scene's file.",
        )
    };
    let default = if is_builtin(scene) {
        format!("\n    default: {}", quoted(scene))
    } else {
        default_of(scene)
    };
    format!("  - name: Scene\n    type: {kind}\n    description: {what}{default}")
}

/// The line of a path's default, where it can have one.
fn default_of(path: &str) -> String {
    if is_below(path) {
        format!("\n    default: {}", quoted(path))
    } else {
        String::new()
    }
}

/// What must be given where it cannot be a default.
fn given(scene: &str, folder: &str, table: &str) -> String {
    let mut text = String::new();
    for (name, value, is_name) in [
        ("Scene", scene, is_builtin(scene)),
        ("OutputDir", folder, false),
        ("Table", table, false),
    ] {
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

/// Whether a path leads to a place below the folder that it counts from.
fn is_below(path: &str) -> bool {
    let mut parts = Path::new(path).components();
    parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}
