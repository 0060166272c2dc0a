//! Signals: the first Ctrl-C or SIGTERM asks the run to stop, the second ends the process.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Whether the run has been asked to stop.
#[derive(Debug, Clone, Default)]
pub(super) struct Interrupt {
    signal: Arc<AtomicUsize>,
}

/// A run that stopped because it was asked to.
#[derive(Debug, thiserror::Error)]
#[error("stopped by {}: {done}", if *signal == SIGINT as usize { "Ctrl-C" } else { "SIGTERM" })]
pub(super) struct Interrupted {
    signal: usize,
    /// What has been done, and how to continue.
    done: String,
}

/// Whether the parent process had a signal ignored, as shells do with Ctrl-C for background jobs of scripts. It is
/// false where the system does not say.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}

/// Makes a write beyond a file-size limit (`ulimit -f`) return an error instead of ending the process.
pub(super) fn survive_quotas() {
    #[cfg(unix)]
    {
        // Never read: a signal with a handler does not end the process.
        let seen = Arc::new(AtomicBool::new(false));
        // Without a handler the write ends the process, as before.
        let _ = flag::register(signal_hook::consts::SIGXFSZ, seen);
    }
}

impl Interrupted {
    /// The exit code that a shell reports for a process that a signal ended.
    pub(super) fn code(&self) -> u8 {
        128 + self.signal as u8
    }
}

impl Interrupt {
    /// Installs the handlers. From here on the first signal is only recorded, and the second ends the process at once:
    /// the file that it was writing stays unfinished, under its hidden name.
    ///
    /// # Errors
    /// What the system returns.
    pub(super) fn install() -> io::Result<Self> {
        let interrupt = Self::default();
        let again = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            if is_ignored(signal) {
                continue;
            }
            // In this order: at the first signal the shutdown's condition is still unset.
            flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&again))?;
            flag::register(signal, Arc::clone(&again))?;
            flag::register_usize(signal, Arc::clone(&interrupt.signal), signal as usize)?;
        }
        Ok(interrupt)
    }

    /// Whether the run is to stop.
    pub(super) fn is_asked(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// Checks that the run was not asked to stop; `done` says what has been done.
    ///
    /// # Errors
    /// [`Interrupted`]
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
