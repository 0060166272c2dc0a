//! The command line: arguments, checked options, the run. One file per verb.
//!
//! Data goes to the standard output, everything else to the standard error. The exit code is 0 where the work is
//! done, 1 where it failed, 2 where the program was misused. A reader that closes the standard output ends the run
//! quietly.

mod chart;
mod explain;
mod method;
mod picture;
mod progress;
mod rays_csv;
mod render;
mod scene;
mod table;
mod target;
mod trace;

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
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
  darkness scene classic > mine.toml         a scene to start from
  darkness render mine.toml
  darkness table fine                        the most accurate table
  darkness render --table tables/fine.table
  printf 'u0,dudphi\\n0.03,0.1\\n' | darkness trace
  darkness chart --quick                     speed against accuracy on this machine, as chart.svg

Exit codes: 0 done, 1 failed, 2 misused.";

#[derive(Debug, Subcommand)]
enum Verb {
    Render(render::RenderArgs),
    Table(table::TableArgs),
    Trace(trace::TraceArgs),
    Scene(scene::SceneArgs),
    Chart(chart::ChartArgs),
}

/// A command line that says something which cannot be meant. Exits with 2, as every other usage error does.
#[derive(Debug, thiserror::Error)]
enum Misuse {
    #[error("{}: the ending of a picture's name says its format, and the only one known here is .{ending}; for the standard output give `-o -`", path.display())]
    Ending { path: PathBuf, ending: &'static str },
    #[error(
        "the standard output is a terminal, which cannot show a PNG: send it to a file or a pipe, or give -o a file's name"
    )]
    PictureToTerminal,
    #[error("{}: {option} names the {what} that is read; choose another name for what is written", path.display())]
    OntoInput {
        option: &'static str,
        path: PathBuf,
        what: &'static str,
    },
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

/// The option of every verb that computes in parallel.
#[derive(Debug, Args)]
struct Threads {
    /// Threads to compute with; the result is the same with any number [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Starts the threads, all there will be: rayon's own start, at the first parallel loop, would panic where the system
/// refuses one.
fn start_threads(threads: Option<u16>) -> anyhow::Result<()> {
    let count = threads.map_or(0, usize::from); // 0: rayon chooses
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .build_global()
        .map_err(|error| anyhow::anyhow!("the threads to compute with cannot be started ({error}): ask for fewer with --threads"))
}

/// Runs the program on its arguments.
pub fn run() -> ExitCode {
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
            ExitCode::from(if error.is::<Misuse>() { 2 } else { 1 })
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
