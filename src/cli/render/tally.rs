//! What frames took, and what went wrong with them.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::render::batch::Effort;

/// Counts and times of frames, from all threads.
#[derive(Debug, Default)]
pub(super) struct Tally {
    drawn: AtomicU64,
    finished_before: AtomicU64,
    curves: Nanoseconds,
    pixels: Nanoseconds,
    encoding: Nanoseconds,
    writing: Nanoseconds,
    rest: Mutex<Rest>,
}

#[derive(Debug, Default)]
struct Rest {
    worst: Option<(u32, Effort)>,
    ray_by_ray: u64,
    /// Frames by what went wrong.
    failures: BTreeMap<String, Vec<u32>>,
}

#[derive(Debug, Default)]
struct Nanoseconds(AtomicU64);

impl Nanoseconds {
    fn add(&self, time: Duration) {
        self.0.fetch_add(time.as_nanos() as u64, Ordering::Relaxed);
    }

    fn total(&self) -> Duration {
        Duration::from_nanos(self.0.load(Ordering::Relaxed))
    }
}

impl Tally {
    /// A frame was drawn, encoded and written.
    pub(super) fn drawn(
        &self,
        number: u32,
        effort: Effort,
        (encoding, writing): (Duration, Duration),
    ) {
        self.drawn.fetch_add(1, Ordering::Relaxed);
        self.curves.add(effort.curves);
        self.pixels.add(effort.pixels);
        self.encoding.add(encoding);
        self.writing.add(writing);
        let mut rest = self.rest();
        rest.ray_by_ray += u64::from(effort.ray_by_ray);
        let total = effort.error.total();
        // The first of equals, whatever the order in which they come.
        let is_worse = rest.worst.is_none_or(|(first, worst)| {
            total > worst.error.total() || (total == worst.error.total() && number < first)
        });
        if is_worse {
            rest.worst = Some((number, effort));
        }
    }

    /// A frame was there already.
    pub(super) fn finished_before(&self) {
        self.finished_before.fetch_add(1, Ordering::Relaxed);
    }

    /// A frame could not be drawn or written.
    pub(super) fn failed(&self, number: u32, reason: &impl ToString) {
        let mut rest = self.rest();
        rest.failures
            .entry(reason.to_string())
            .or_default()
            .push(number);
    }

    pub(super) fn count_drawn(&self) -> u64 {
        self.drawn.load(Ordering::Relaxed)
    }

    pub(super) fn count_finished_before(&self) -> u64 {
        self.finished_before.load(Ordering::Relaxed)
    }

    /// The frame whose edges may be off by the most.
    pub(super) fn worst(&self) -> Option<(u32, Effort)> {
        self.rest().worst
    }

    /// How many frames' curves were not good enough.
    pub(super) fn count_ray_by_ray(&self) -> u64 {
        self.rest().ray_by_ray
    }

    /// The time that the parts of the work took, all threads together.
    pub(super) fn times(&self) -> [(&'static str, Duration); 4] {
        [
            ("curves", self.curves.total()),
            ("render", self.pixels.total()),
            ("encode", self.encoding.total()),
            ("write", self.writing.total()),
        ]
    }

    /// Which frames failed, and why; none if none did.
    pub(super) fn failures(&self) -> Option<String> {
        let mut rest = self.rest();
        if rest.failures.is_empty() {
            return None;
        }
        let count: usize = rest.failures.values().map(Vec::len).sum();
        let noun = if count == 1 { "frame" } else { "frames" };
        let mut text = format!("{count} {noun} failed, the same command tries them again:");
        for (reason, frames) in &mut rest.failures {
            frames.sort_unstable();
            let _ = write!(text, "\n  {}: {reason}", ranges(frames));
        }
        Some(text)
    }

    fn rest(&self) -> MutexGuard<'_, Rest> {
        // Counts are whole at every moment.
        self.rest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Rising numbers as a range of frames that can be asked for: `3-5,9`.
fn ranges(numbers: &[u32]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let text: Vec<String> = runs
        .map(|run| match run {
            [only] => only.to_string(),
            [first, .., last] => format!("{first}-{last}"),
            [] => String::new(),
        })
        .collect();
    text.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_are_listed_by_reason_in_ranges_that_can_be_asked_for_again() {
        let tally = Tally::default();
        assert_eq!(tally.failures(), None);
        for number in [9, 3, 5, 4] {
            tally.failed(number, &"the disk is full");
        }
        tally.failed(7, &"no right");
        assert_eq!(
            tally.failures().unwrap(),
            "5 frames failed, the same command tries them again:\n  7: no right\n  3-5,9: the disk is full"
        );
    }
}
