//! Messages on the standard error: notes, warnings and progress.

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressState, ProgressStyle};

use crate::quotation::printable;

/// Messages on the standard error.
///
/// Nothing here fails: if the standard error cannot be written, the work continues silently (`eprintln!` would panic).
#[derive(Debug, Clone, Copy)]
pub(super) struct Report {
    quiet: bool,
}

impl Report {
    /// With `quiet`, only [warnings](warn) are printed.
    pub(super) fn new(quiet: bool) -> Self {
        Self { quiet }
    }

    /// Prints what happens or has been done.
    pub(super) fn note(self, message: impl Display) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{}", readable(&message));
        }
    }

    /// The progress of `total` frames, each of `pixels` pixels.
    pub(super) fn frames(self, how: ProgressKind, total: u64, pixels: u64) -> FrameProgress {
        let kind = match how {
            _ if self.quiet => ProgressKind::None,
            ProgressKind::Auto if io::stderr().is_terminal() => ProgressKind::Auto,
            ProgressKind::Auto => ProgressKind::Plain,
            other => other,
        };
        FrameProgress {
            report: self,
            kind,
            bar: frame_bar(kind, total, pixels),
            megapixels: pixels as f64 / 1e6,
            told: Mutex::new(Instant::now()),
        }
    }

    /// A sign that something goes on, which vanishes when it is dropped. It is drawn only on a terminal.
    pub(super) fn spinner(self, what: String) -> ProgressBar {
        let spinner = if self.quiet {
            ProgressBar::hidden()
        } else {
            ProgressBar::new_spinner()
        };
        spinner.enable_steady_tick(Duration::from_millis(100));
        spinner
            .with_message(what)
            .with_finish(ProgressFinish::AndClear)
    }

    /// A bar of `total` steps, each a `unit`, which vanishes when it is dropped. It is drawn only on a terminal.
    pub(super) fn bar(self, total: u64, what: &'static str, unit: &str) -> ProgressBar {
        let target = if self.quiet {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let template = format!("{{msg}} {{bar:40}} {{pos}}/{{len}} {unit}, {{eta}} left");
        let style = ProgressStyle::with_template(&template)
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        ProgressBar::with_draw_target(Some(total), target)
            .with_style(style)
            .with_message(what)
            .with_finish(ProgressFinish::AndClear)
    }
}

/// How progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum ProgressKind {
    /// A bar on a terminal, plain lines elsewhere
    Auto,
    /// A line every few seconds
    Plain,
    /// Lines for the schedulers of Open Job Description
    Openjd,
    /// Nothing
    None,
}

/// The progress of frames, which several threads report.
pub(super) struct FrameProgress {
    report: Report,
    kind: ProgressKind,
    /// Counts the frames; it is drawn for [`ProgressKind::Auto`] only.
    bar: ProgressBar,
    megapixels: f64,
    /// When a line was last printed.
    told: Mutex<Instant>,
}

impl FrameProgress {
    /// Counts a frame that was drawn.
    pub(super) fn done(&self) {
        self.tell(|bar| bar.inc(1));
    }

    /// Counts a frame that was finished before.
    pub(super) fn skipped(&self) {
        self.tell(|bar| bar.dec_length(1));
    }

    /// Tells that nothing is left to draw but frames that other runs have claimed.
    pub(super) fn waiting(&self, frames: u64) {
        let line = format!(
            "waiting for {} that other runs are drawing; Ctrl-C ends the waiting",
            count(frames, "frame")
        );
        if self.kind == ProgressKind::Openjd {
            let _ = writeln!(io::stderr(), "openjd_status: {line}");
        } else {
            self.bar.suspend(|| self.report.note(line));
        }
    }

    /// Counts a frame, and prints a line if one is due.
    fn tell(&self, step: impl FnOnce(&ProgressBar)) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        step(&self.bar);
        let (done, total) = (self.bar.position(), self.bar.length().unwrap_or(0));
        let is_due = match self.kind {
            ProgressKind::Auto | ProgressKind::None => return,
            ProgressKind::Plain => told.elapsed() >= Duration::from_secs(5),
            ProgressKind::Openjd => told.elapsed() >= Duration::from_secs(1) || done == total,
        };
        if !is_due {
            return;
        }
        *told = Instant::now();
        let rate = done as f64 / self.bar.elapsed().as_secs_f64();
        let left = total.saturating_sub(done) as f64 / rate;
        let left = if left.is_finite() { left } else { 0.0 };
        let line = format!(
            "{done} of {}, {rate:.1} frames/s, {:.0} megapixels/s, {} left",
            count(total, "frame"),
            rate * self.megapixels,
            duration(Duration::from_secs_f64(left.min(1e9)))
        );
        let mut stderr = io::stderr();
        let _ = if self.kind == ProgressKind::Openjd {
            let share = 100.0 * done as f64 / total.max(1) as f64;
            writeln!(stderr, "openjd_progress: {share:.1}\nopenjd_status: {line}")
        } else {
            writeln!(stderr, "{line}")
        };
    }
}

/// A bar that counts frames, drawn for [`ProgressKind::Auto`] only.
fn frame_bar(kind: ProgressKind, total: u64, pixels: u64) -> ProgressBar {
    let target = if kind == ProgressKind::Auto {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let megapixels = pixels as f64 / 1e6;
    let rate = move |state: &ProgressState, out: &mut dyn std::fmt::Write| {
        let rate = state.per_sec();
        let _ = write!(
            out,
            "{rate:.1} frames/s, {:.0} megapixels/s",
            rate * megapixels
        );
    };
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {rate}, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("rate", rate);
    ProgressBar::with_draw_target(Some(total), target)
        .with_style(style)
        .with_finish(ProgressFinish::AndClear)
}

/// Prints what is wrong.
pub(super) fn warn(message: impl Display) {
    let _ = writeln!(io::stderr(), "darkness: {}", readable(&message));
}

/// A message without control characters, which file names may hold.
fn readable(message: &impl Display) -> String {
    let shown = |c| if c == '\n' { c } else { printable(c) };
    message.to_string().chars().map(shown).collect()
}

/// A number of things: `1 frame`, `2 frames`.
pub(super) fn count(number: u64, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {noun}{plural}")
}

/// Formats a time in milliseconds or seconds.
pub(super) fn duration(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds < 1.0 {
        format!("{:.1} ms", seconds * 1e3)
    } else {
        format!("{seconds:.1} s")
    }
}
