//! What the user is told on the standard error: notes, warnings, and a bar for what takes long.

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressState, ProgressStyle};

use crate::quotation::printable;

/// The standard error, as the user wants it.
///
/// Nothing here can fail: where the standard error takes no more, the work goes on without words (`eprintln!` would
/// panic).
#[derive(Debug, Clone, Copy)]
pub(super) struct Report {
    quiet: bool,
}

impl Report {
    /// With `quiet`, nothing is told but what is [wrong](warn).
    pub(super) fn new(quiet: bool) -> Self {
        Self { quiet }
    }

    /// Says what happens or has been done.
    pub(super) fn note(self, message: impl Display) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{}", readable(&message));
        }
    }

    /// The progress of `total` frames of so many pixels.
    pub(super) fn frames(self, how: ProgressKind, total: u64, pixels: u64) -> FrameProgress {
        let kind = match how {
            _ if self.quiet => ProgressKind::None,
            ProgressKind::Auto if io::stderr().is_terminal() => ProgressKind::Auto,
            ProgressKind::Auto => ProgressKind::Plain,
            other => other,
        };
        let bar = (kind == ProgressKind::Auto).then(|| frame_bar(total, pixels));
        let now = Instant::now();
        FrameProgress {
            kind,
            bar,
            megapixels: pixels as f64 / 1e6,
            state: Mutex::new(Shown {
                start: now,
                told: now,
                total,
                done: 0,
            }),
        }
    }

    /// A bar of `total` steps, each of them a `unit`, which vanishes when it is dropped. Nothing is drawn where the
    /// standard error is no terminal.
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

/// How progress is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum ProgressKind {
    /// A bar on a terminal, plain lines elsewhere
    Auto,
    /// A line every few seconds
    Plain,
    /// Lines that Open Job Description's schedulers read
    Openjd,
    /// Nothing
    None,
}

/// The progress of frames, told from several threads.
pub(super) struct FrameProgress {
    kind: ProgressKind,
    bar: Option<ProgressBar>,
    megapixels: f64,
    state: Mutex<Shown>,
}

struct Shown {
    start: Instant,
    /// When a line was last written.
    told: Instant,
    /// Frames that are to be drawn, as far as is known.
    total: u64,
    done: u64,
}

impl FrameProgress {
    /// A frame was drawn.
    pub(super) fn done(&self) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        } else if self.kind != ProgressKind::None {
            self.tell(|shown| shown.done += 1);
        }
    }

    /// A frame was there already.
    pub(super) fn passed_over(&self) {
        if let Some(bar) = &self.bar {
            bar.dec_length(1);
        } else if self.kind != ProgressKind::None {
            self.tell(|shown| shown.total = shown.total.saturating_sub(1));
        }
    }

    /// Writes a line where it is time for one.
    fn tell(&self, change: impl FnOnce(&mut Shown)) {
        // Who panicked while it was locked is not here to tell.
        let Ok(mut shown) = self.state.lock() else {
            return;
        };
        change(&mut shown);
        let now = Instant::now();
        let is_last = shown.done == shown.total;
        let every = if self.kind == ProgressKind::Openjd {
            1
        } else {
            5
        };
        let is_time = now - shown.told >= Duration::from_secs(every);
        let is_told = is_time || (is_last && self.kind == ProgressKind::Openjd);
        if !is_told {
            return;
        }
        shown.told = now;
        let Shown {
            start, total, done, ..
        } = *shown;
        let rate = done as f64 / (now - start).as_secs_f64();
        let left = total.saturating_sub(done) as f64 / rate;
        let left = if left.is_finite() { left } else { 0.0 };
        let line = format!(
            "{done} of {total} frames, {rate:.1} frames/s, {:.0} megapixels/s, {} left",
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

fn frame_bar(total: u64, pixels: u64) -> ProgressBar {
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
    ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr())
        .with_style(style)
        .with_finish(ProgressFinish::AndClear)
}

/// Says what is wrong, to whoever listens.
pub(super) fn warn(message: impl Display) {
    let _ = writeln!(io::stderr(), "darkness: {}", readable(&message));
}

/// A message without what terminals obey: the names of files have any characters.
fn readable(message: &impl Display) -> String {
    let shown = |c| if c == '\n' { c } else { printable(c) };
    message.to_string().chars().map(shown).collect()
}

/// A time in a unit that suits it.
pub(super) fn duration(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds < 1.0 {
        format!("{:.1} ms", seconds * 1e3)
    } else {
        format!("{seconds:.1} s")
    }
}
