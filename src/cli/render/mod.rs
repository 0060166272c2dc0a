//! `darkness render`: a scene's picture, or the frames of its animation.
//!
//! Arguments ([`args`]) become a checked scene and its frames ([`options`]), these a plan ([`plan`]), which is run
//! ([`run`]) and reported ([`summary`]).

mod args;
mod claims;
mod draw;
mod explain;
mod exr;
mod ffmpeg;
mod figures;
mod film;
mod form;
mod format;
mod memory;
mod npz;
mod options;
mod origin;
mod output;
#[cfg(feature = "view")]
pub(super) mod picture;
mod plan;
mod png;
mod run;
mod run_stats;
mod sequence;
mod sky;
mod summary;
mod svg;
mod y4m;
mod yuv;

use std::io::{self, Write};

pub(super) use args::{RenderArgs, size as picture_size};
pub(super) use output::sequence;
use plan::Plan;
pub(super) use sky::files as sky_files;
#[cfg(feature = "view")]
pub(super) use sky::read as read_sky;

use super::progress::{ProgressKind, Report, warn};
use super::stdio::StdoutError;
use super::threads::start_threads;

/// Runs the verb.
pub(super) fn run(args: &RenderArgs, report: Report) -> anyhow::Result<()> {
    render(args, report).inspect_err(|error| {
        let stdout = error.downcast_ref::<StdoutError>();
        let is_failure = !stdout.is_some_and(StdoutError::is_closed_pipe);
        if is_failure && args.progress == ProgressKind::Openjd {
            let text = error.to_string().replace('\n', " ");
            let _ = writeln!(io::stderr(), "openjd_fail: {text}");
        }
    })
}

fn render(args: &RenderArgs, report: Report) -> anyhow::Result<()> {
    let animation = options::animation(args)?;
    let frames = options::frames(args, &animation)?;
    if animation.frames() > 1 && !animation.moves() {
        warn(format_args!(
            "nothing moves in this animation: its {} frames are equal; give it an orbit whose angles or radius go \
             [from, to], or keyframes of different values",
            animation.frames()
        ));
    }
    if animation.ignores_position() {
        warn(
            "camera.position has no effect, since keyframes set the position; remove it from one of them",
        );
    }
    if args.explain {
        return explain::run(args, &animation, &frames, report);
    }
    if svg::is_asked(args) {
        return svg::run(args, &animation, &frames, report);
    }
    let (plan, checked) = Plan::new(args, &animation, &frames)?;
    if args.dry_run {
        return plan.list(checked);
    }
    start_threads(args.threads.threads)?;
    let method = options::method(args, checked, report)?;
    let outcome = run::run(&plan, &method, report)?;
    summary::report(&plan, &method, &outcome, report)
}
