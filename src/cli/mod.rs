//! The command line: arguments, checked options, the run. One file per verb.
//!
//! Data goes to the standard output, everything else to the standard error. The exit code is 0 where the work is
//! done, 1 where it failed, 2 where the program was misused. A reader that closes the standard output ends the run
//! quietly.

mod chart;
mod interrupt;
mod job;
mod method;
mod picture;
mod progress;
pub mod rays;
mod remedy;
mod render;
mod scene;
mod table;
mod target;
mod trace;

use std::io::{self, Write};
use std::num::NonZero;
use std::path::PathBuf;
use std::process::ExitCode;

use bytesize::ByteSize;
use clap::{Args, Parser, Subcommand};
use interrupt::Interrupted;
use progress::{Report, warn};

/// Renders what a black hole does to the light of its accretion disk.
///
/// The equation of light around a Schwarzschild hole is solved once, for all rays, into a small table; a picture of
/// the disk from any place then takes milliseconds. `darkness render` works at once: it makes the table where it is
/// missing. Lengths are in Schwarzschild radii, angles in radians.
#[derive(Debug, Parser)]
#[command(name = "darkness", version, after_help = EXAMPLES)]
struct Cli {
    /// Say nothing but warnings and errors
    #[arg(short, long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    verb: Verb,
}

const EXAMPLES: &str = "\
Examples:
  darkness render                            the scene `classic`, as classic.png
  darkness render edge-on --size 3840x2160 -o large.png
  darkness render orbit -o 'out/f_####.png'  an animation, a file for each frame
  darkness render orbit -o - --format y4m | ffmpeg -i - orbit.mp4
  darkness scene classic > mine.toml         a scene to start from
  darkness render mine.toml
  darkness table fine                        the most accurate table
  darkness render --table tables/fine.table
  printf 'u0,dudphi\\n0.03,0.1\\n' | darkness trace
  darkness chart --quick                     speed against accuracy on this machine, as chart.svg

Exit codes: 0 done, 1 failed, 2 misused, 130 and 143 stopped by Ctrl-C and SIGTERM.";

#[derive(Debug, Subcommand)]
enum Verb {
    Render(render::RenderArgs),
    Table(table::TableArgs),
    Trace(trace::TraceArgs),
    Scene(scene::SceneArgs),
    Chart(chart::ChartArgs),
    Job(job::JobArgs),
}

/// A command line that says something which cannot be meant. Exits with 2, as every other usage error does.
#[derive(Debug, thiserror::Error)]
enum Misuse {
    #[error("{}: the ending of the name says the format, and those known here are {endings}; for the standard output give `-o -`", path.display())]
    Ending {
        path: PathBuf,
        endings: &'static str,
    },
    #[error(
        "the standard output is a terminal, which cannot show pictures: send it to a file or a pipe, or give -o a file's name"
    )]
    PictureToTerminal,
    #[error("{}: {option} names the {what} that is read; choose another name for what is written", path.display())]
    OntoInput {
        option: &'static str,
        path: PathBuf,
        what: &'static str,
    },
    #[error(
        "{}: {count} frames do not fit one picture: give the name a place for the number, as in f_####.png or f_%04d.png, choose one frame with --frames, or make a film with --format y4m", path.display()
    )]
    FramesWithoutNumber { path: PathBuf, count: u64 },
    #[error("{} is a folder: name the files in it, as in {}", path.display(), example.display())]
    Folder { path: PathBuf, example: PathBuf },
    #[error(
        "several frames go through a pipe as a film: add --format y4m or --format raw, or choose one frame with --frames"
    )]
    FramesToStdout,
    #[error("{}: a film is one file, and this is a pattern for many; leave out the number, or --format", path.display())]
    FilmWithNumber { path: PathBuf },
    #[error("{}: numbered names must be text in UTF-8", path.display())]
    NumberedNotText { path: PathBuf },
    #[error("{}: the names of numbered files have {longest} bytes at most", path.display())]
    LongName { path: PathBuf, longest: usize },
    #[error("{}: the frame's number has two places in the name; leave one", path.display())]
    TwoNumbers { path: PathBuf },
    #[error("{}: the frame's number belongs in the file's name, not in a folder's", path.display())]
    NumberInFolder { path: PathBuf },
    #[error("{}: the frame's number is filled up to {widest} digits at most", path.display())]
    WideNumber { path: PathBuf, widest: usize },
    #[error("--frames {range}: {source}")]
    Frames {
        range: String,
        source: crate::scene::SceneError,
    },
    #[error("--explain tells of one frame: choose one with --frames")]
    ExplainsOne,
    #[error("{}: the scene has no [animation], and one picture needs no farm: `darkness render` draws it", path.display())]
    StillJob { path: PathBuf },
    #[error("{}: a job is a text, and this name has characters that cannot stand in one", path.display())]
    UnprintablePath { path: PathBuf },
    #[error("--no-mmap is about a table, which only --method table reads")]
    MmapUnused,
    #[error("--require-table is about a table, which only --method table reads")]
    TableUnused,
    #[error("{}: the standard output goes to this file, the {what} that is read; send it elsewhere", path.display())]
    StdoutOntoInput { path: PathBuf, what: &'static str },
    #[error("{}: -o and --csv name one file; give each its own", path.display())]
    OneFileForTwo { path: PathBuf },
    #[error("the CSV goes to a file, not to the standard output: give --csv a file's name")]
    CsvToStdout,
    #[error("--size {width}x{height}: {source}")]
    Size {
        width: u32,
        height: u32,
        source: crate::scene::SceneError,
    },
    #[error(
        "{width} × {height} pixels take about {needed} of memory, and {allowed} are allowed: ask for a smaller picture with --size, or allow more with --max-memory"
    )]
    Memory {
        width: u32,
        height: u32,
        needed: ByteSize,
        allowed: ByteSize,
    },
    #[error(
        "DARKNESS_SIMD is `{name}`: the instruction sets that it may name are {}; set it to one of these, or not at all",
        crate::lanes::NAMES.join(", ")
    )]
    InstructionSet { name: String },
    #[error("{0}")]
    Tolerance(#[source] crate::scene::SceneError),
    #[error("--{flag} is about isoradial curves, which only --method table draws")]
    CurvesUnused { flag: &'static str },
    #[error("--integrate-tolerance says how well rays are integrated: it needs --method integrate")]
    ToleranceUnused,
    #[error(
        "a table is a file that is mapped, it cannot go to the standard output: give -o a file's name"
    )]
    TableToStdout,
    #[error(
        "there are no rays to trace: name a CSV file with the columns u0 and dudphi, or send one to the standard input (`-` reads it from the terminal)"
    )]
    NoRays,
}

/// The standard output does not take what is written.
#[derive(Debug, thiserror::Error)]
#[error("the standard output cannot be written: {0}")]
struct StdoutError(#[source] io::Error);

impl StdoutError {
    /// Whether the reader has had enough, which is no failure.
    fn is_closed_pipe(&self) -> bool {
        self.0.kind() == io::ErrorKind::BrokenPipe
    }
}

/// Prints text for the user, or for whoever reads it on.
fn print(text: &str) -> Result<(), StdoutError> {
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(StdoutError)
}

/// The option of every verb that computes in parallel.
#[derive(Debug, Args)]
struct Threads {
    /// Threads to compute with; the result is the same with any number [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// More than any machine's cores.
const MOST_THREADS: usize = 1024;

/// The stack of a thread, in bytes, whatever the environment says of stacks.
const THREAD_STACK: usize = 2 << 20;

/// What the program takes beside its frames, in bytes, with a margin.
const TO_BEGIN: usize = 32 << 20;

/// Asks for so much memory, and gives it back. Wherever else the system refuses some, the process ends.
fn check_memory(bytes: usize) -> anyhow::Result<()> {
    Vec::<u8>::new().try_reserve_exact(bytes).map_err(|_| {
        let size = ByteSize(bytes as u64);
        anyhow::anyhow!(
            "there is not the memory to begin with, {size}: allow more, or ask for fewer --threads"
        )
    })
}

/// Starts the threads, all there will be: rayon's own start, at the first parallel loop, would panic where the system
/// refuses one.
fn start_threads(threads: Option<u16>) -> anyhow::Result<()> {
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    let count = threads.map_or_else(cores, usize::from).min(MOST_THREADS);
    check_memory(count.saturating_mul(THREAD_STACK) + TO_BEGIN)?;
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .stack_size(THREAD_STACK)
        .build_global()
        .map_err(|error| anyhow::anyhow!("the threads to compute with cannot be started ({error}): ask for fewer with --threads"))
}

/// Runs the program on its arguments.
pub fn run() -> ExitCode {
    interrupt::survive_quotas();
    if let Err(error) = check_memory(TO_BEGIN) {
        warn(&error);
        return ExitCode::FAILURE;
    }
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help, the version, or a usage error. Where they cannot be printed there is nobody to tell.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let report = Report::new(cli.quiet);
    let run = || match cli.verb {
        Verb::Render(args) => render::run(&args, report),
        Verb::Table(args) => table::run(&args, report),
        Verb::Trace(args) => trace::run(&args, report),
        Verb::Scene(args) => scene::run(&args),
        Verb::Chart(args) => chart::run(&args, report),
        Verb::Job(args) => job::run(&args, report),
    };
    let checked = crate::lanes::check_environment()
        .map_err(|name| anyhow::Error::new(Misuse::InstructionSet { name }));
    match checked.and_then(|()| run()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error)
            if error
                .downcast_ref()
                .is_some_and(StdoutError::is_closed_pipe) =>
        {
            ExitCode::SUCCESS
        }
        Err(error) => {
            warn(&error);
            ExitCode::from(match error.downcast_ref::<Interrupted>() {
                Some(interrupted) => interrupted.code(),
                None if error.is::<Misuse>() => 2,
                None => 1,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_of_the_command_line_is_consistent() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
    }
}
