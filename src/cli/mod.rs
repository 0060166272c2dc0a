//! The command line: one file for each verb.
//!
//! Data goes to the standard output, everything else to the standard error. The exit code is 0 for success, 1 for a
//! failure, 2 for a command line or a scene that makes no sense or names what is not there. A reader that closes the
//! standard output ends the run quietly.

mod chart;
mod completions;
mod destination;
mod frame_range;
mod interrupt;
mod isoradials;
mod job;
mod man;
mod method;
mod misuse;
mod pattern;
mod progress;
mod radius;
pub mod rays;
mod remedy;
mod render;
mod scene;
mod stdio;
mod table;
mod table_path;
mod threads;
mod trace;
mod view;
mod writable;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
pub use frame_range::{FrameRange, FrameRangeError};
use interrupt::Interrupted;
use misuse::Misuse;
use progress::{Report, warn};
use stdio::StdoutError;
use threads::{STARTING_MEMORY, check_memory};

use crate::scene::SceneError;

/// Renders what a black hole does to the light of its accretion disk.
///
/// The equation of light around a Schwarzschild hole is solved once, for all rays, into a small table. A picture of the
/// disk from any place then takes milliseconds. `darkness render` makes the table where it is missing. Lengths are in
/// Schwarzschild radii, the angles of rays in radians, those of cameras in degrees.
#[derive(Debug, Parser)]
#[command(name = "darkness", version, after_help = EXAMPLES)]
struct Cli {
    /// Print only warnings and errors
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
  darkness render orbit -o orbit.mp4         a film, by ffmpeg
  darkness scene classic > mine.toml         a scene to start from
  darkness render mine.toml
  darkness table fine                        the most accurate table
  printf 'u0,dudphi\\n0.03,0.1\\n' | darkness trace
  darkness isoradials                        Luminet's figure: rings around the hole, as isoradials.svg
  darkness view lit                          a window to look around by hand (in builds with --features view)
  darkness chart --quick                     speed against accuracy on this machine, as chart.svg
  darkness completions bash                  for zsh, fish, powershell too; darkness man: manual pages

Exit codes: 0 success, 1 failure, 2 usage error (an option, a scene, or an input that is not there), 130 and 143 stopped
by Ctrl-C and SIGTERM.";

#[derive(Debug, Subcommand)]
enum Verb {
    Render(Box<render::RenderArgs>),
    Table(table::TableArgs),
    Trace(trace::TraceArgs),
    Scene(scene::SceneArgs),
    View(view::ViewArgs),
    Isoradials(isoradials::IsoradialsArgs),
    Chart(chart::ChartArgs),
    Job(job::JobArgs),
    // Needed once, and named at the end of the help.
    #[command(hide = true)]
    Completions(completions::CompletionsArgs),
    #[command(hide = true)]
    Man(man::ManArgs),
}

/// Runs the program with the process's arguments.
pub fn run() -> ExitCode {
    interrupt::survive_quotas();
    if let Err(error) = check_memory(STARTING_MEMORY) {
        warn(&error);
        return ExitCode::FAILURE;
    }
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help, the version, or a usage error. If it cannot be printed, nothing else can.
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
        Verb::View(args) => view::run(&args, report),
        Verb::Isoradials(args) => isoradials::run(&args, report),
        Verb::Chart(args) => chart::run(&args, report),
        Verb::Job(args) => job::run(&args, report),
        Verb::Completions(args) => completions::run(&args, Cli::command()),
        Verb::Man(args) => man::run(&args, Cli::command()),
    };
    match run() {
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
            ExitCode::from(code(&error))
        }
    }
}

/// The exit code of a failed run.
fn code(error: &anyhow::Error) -> u8 {
    match (error.downcast_ref(), error.downcast_ref()) {
        (Some(interrupted), _) => Interrupted::code(interrupted),
        // The scene is a part of the command line, but a disk that fails while it is read is not.
        (_, Some(SceneError::Read { error, .. })) if error.raw_os_error().is_some() => 1,
        (_, Some(_)) => 2,
        _ if error.is::<Misuse>() => 2,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_of_the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
