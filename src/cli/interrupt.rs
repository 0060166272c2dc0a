//! The first Ctrl-C or SIGTERM asks the run to end, the second ends it.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Whether the run has been asked to end.
#[derive(Debug, Clone, Default)]
pub(super) struct Interrupt {
    signal: Arc<AtomicUsize>,
}

/// A run that ended because it was asked to.
#[derive(Debug, thiserror::Error)]
#[error("stopped by {}: {done}", if *signal == SIGINT as usize { "Ctrl-C" } else { "SIGTERM" })]
pub(super) struct Interrupted {
    signal: usize,
    /// What has been done, and how to go on.
    done: String,
}

/// Whether whoever started the process had it ignore a signal, as shells do with Ctrl-C for what scripts run in the background.
/// Not known everywhere.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}

/// A file that grows beyond a quota (`ulimit -f`) is an error of the write that does it, and not the end of the process.
pub(super) fn survive_quotas() {
    #[cfg(unix)]
    {
        // Nobody looks at it: a signal that is handled ends nothing.
        let seen = Arc::new(AtomicBool::new(false));
        // Where it cannot be handled the write ends the process as before.
        let _ = flag::register(signal_hook::consts::SIGXFSZ, seen);
    }
}

impl Interrupted {
    /// The exit code that shells give a process which a signal ended.
    pub(super) fn code(&self) -> u8 {
        128 + self.signal as u8
    }
}

impl Interrupt {
    /// From here on the first signal is only remembered, and the second ends the process at once: what it was
    /// writing stays unfinished, under another name.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn install() -> io::Result<Self> {
        let interrupt = Self::default();
        let again = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            if is_ignored(signal) {
                continue;
            }
            // In this order: the first signal finds the second's condition unset.
            flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&again))?;
            flag::register(signal, Arc::clone(&again))?;
            flag::register_usize(signal, Arc::clone(&interrupt.signal), signal as usize)?;
        }
        Ok(interrupt)
    }

    /// Whether the run is to end.
    pub(super) fn is_asked(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// The error that a run ends with which was asked to.
    ///
    /// # Errors
    /// [`Interrupted`], where it was.
    pub(super) fn check(&self, done: impl FnOnce() -> String) -> Result<(), Interrupted> {
        match self.signal.load(Ordering::Relaxed) {
            0 => Ok(()),
            signal => Err(Interrupted {
                signal,
                done: done(),
            }),
        }
    }
}
