//! What the user is told on the standard error: notes, warnings, and a bar for what takes long.

use std::fmt::Display;
use std::io::{self, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};

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
            let _ = writeln!(io::stderr(), "{message}");
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

/// Says what is wrong, to whoever listens.
pub(super) fn warn(message: impl Display) {
    let _ = writeln!(io::stderr(), "darkness: {message}");
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
