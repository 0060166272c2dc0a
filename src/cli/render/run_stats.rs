//! Counts, times and failures of a run.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::draw::Effort;

/// Counts, times and failures of frames, from all threads.
#[derive(Debug, Default)]
pub(super) struct RunStats {
    drawn: AtomicU64,
    finished_before: AtomicU64,
    curves: Nanoseconds,
    pixels: Nanoseconds,
    encoding: Nanoseconds,
    writing: Nanoseconds,
    details: Mutex<Details>,
}

#[derive(Debug, Default)]
struct Details {
    worst: Option<(u32, Effort)>,
    ray_by_ray: u64,
    /// The numbers of the frames that failed, by reason.
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

impl RunStats {
    /// Counts a frame that was drawn, encoded and written.
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
        let mut details = self.details();
        details.ray_by_ray += u64::from(effort.ray_by_ray);
        let total = effort.error.total();
        // Of equal ones the first, in whatever order they are drawn.
        let is_worse = details.worst.is_none_or(|(first, worst)| {
            total > worst.error.total() || (total == worst.error.total() && number < first)
        });
        if is_worse {
            details.worst = Some((number, effort));
        }
    }

    /// Counts a frame that was there already.
    pub(super) fn finished_before(&self) {
        self.finished_before.fetch_add(1, Ordering::Relaxed);
    }

    /// Counts a frame that could not be drawn or written.
    pub(super) fn failed(&self, number: u32, reason: &impl ToString) {
        let mut details = self.details();
        details
            .failures
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

    /// The frame with the largest error of an edge.
    pub(super) fn worst(&self) -> Option<(u32, Effort)> {
        self.details().worst
    }

    /// The number of frames whose curves were not accurate enough.
    pub(super) fn count_ray_by_ray(&self) -> u64 {
        self.details().ray_by_ray
    }

    /// The times of the parts of the work, summed over all threads.
    pub(super) fn times(&self) -> [(&'static str, Duration); 4] {
        [
            ("curves", self.curves.total()),
            ("render", self.pixels.total()),
            ("encode", self.encoding.total()),
            ("write", self.writing.total()),
        ]
    }

    /// The frames that failed, by reason, in words; [`None`] if none did.
    pub(super) fn failures(&self) -> Option<String> {
        let mut details = self.details();
        if details.failures.is_empty() {
            return None;
        }
        let count: usize = details.failures.values().map(Vec::len).sum();
        let noun = if count == 1 { "frame" } else { "frames" };
        let mut text = format!("{count} {noun} failed; the same command tries them again:");
        for (reason, frames) in &mut details.failures {
            frames.sort_unstable();
            let _ = write!(text, "\n  {}: {reason}", ranges(frames));
        }
        Some(text)
    }

    fn details(&self) -> MutexGuard<'_, Details> {
        // A panic cannot leave the counts inconsistent.
        self.details.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Formats rising numbers as an argument of `--frames`: `3-5,9`.
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
        let stats = RunStats::default();
        assert_eq!(stats.failures(), None);
        for number in [9, 3, 5, 4] {
            stats.failed(number, &"the disk is full");
        }
        stats.failed(7, &"no right");
        assert_eq!(
            stats.failures().unwrap(),
            "5 frames failed; the same command tries them again:\n  7: no right\n  3-5,9: the disk is full"
        );
    }
}
