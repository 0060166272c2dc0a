//! The frames that a run has claimed, and those that it has left to other runs for now.

use std::collections::{BTreeSet, HashMap};
use std::mem;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::output::Unfinished;

/// Frames that several threads claim, draw and write.
#[derive(Debug, Default)]
pub(super) struct Claims(Mutex<ClaimedFrames>);

/// The state of [`Claims`].
#[derive(Debug, Default)]
struct ClaimedFrames {
    /// The unfinished files of this run.
    ours: HashMap<i64, Unfinished>,
    /// The frames that other runs have claimed.
    left: BTreeSet<i64>,
}

impl Claims {
    /// Keeps a claimed frame's file until the frame is drawn.
    pub(super) fn keep(&self, number: i64, file: Unfinished) {
        self.locked().ours.insert(number, file);
    }

    /// Takes a claimed frame's file. The claim ends when the file is finished or dropped.
    pub(super) fn take(&self, number: i64) -> Option<Unfinished> {
        self.locked().ours.remove(&number)
    }

    /// Leaves a frame to the run that has claimed it.
    pub(super) fn leave(&self, number: i64) {
        self.locked().left.insert(number);
    }

    /// Takes the frames that were left to others, to look at them again.
    pub(super) fn take_left(&self) -> BTreeSet<i64> {
        mem::take(&mut self.locked().left)
    }

    fn locked(&self) -> MutexGuard<'_, ClaimedFrames> {
        // A panic cannot leave the state inconsistent.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
