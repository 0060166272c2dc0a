//! Counts, times and failures of a run.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::super::destination::Destination;
use super::super::progress::count;
use super::draw::FrameReport;

/// Counts, times and failures of frames, which several threads report.
#[derive(Debug, Default)]
pub(super) struct RunStats(Mutex<Counts>);

/// The state of [`RunStats`].
#[derive(Debug, Default)]
pub(super) struct Counts {
    /// Frames that were drawn, encoded and written.
    pub(super) drawn: u64,
    /// Frames that were there already.
    pub(super) finished_before: u64,
    /// Frames that other runs drew since this one began.
    pub(super) by_others: u64,
    /// Frames whose curves were not accurate enough.
    pub(super) ray_by_ray: u64,
    /// The frame with the largest error of an edge, the first of equals.
    pub(super) worst: Option<(i64, FrameReport)>,
    /// Times summed over all threads: for the frames' memory, curves, pixels, encoding and writing.
    pub(super) times: [Duration; 5],
    /// The numbers of the frames that failed, by what is wrong with their files.
    failures: BTreeMap<String, Vec<i64>>,
}

impl RunStats {
    /// Counts a frame that was drawn, encoded and written.
    pub(super) fn drawn(
        &self,
        number: i64,
        effort: FrameReport,
        encoding: Duration,
        writing: Duration,
    ) {
        let mut counts = self.counts();
        counts.drawn += 1;
        counts.ray_by_ray += u64::from(effort.ray_by_ray);
        let times = [
            effort.memory,
            effort.curves,
            effort.pixels,
            encoding,
            writing,
        ];
        for (sum, time) in counts.times.iter_mut().zip(times) {
            *sum += time;
        }
        let total = effort.error.total();
        let is_worse = counts.worst.is_none_or(|(first, worst)| {
            total > worst.error.total() || (total == worst.error.total() && number < first)
        });
        if is_worse {
            counts.worst = Some((number, effort));
        }
    }

    /// Counts a frame that was there already.
    pub(super) fn finished_before(&self) {
        self.counts().finished_before += 1;
    }

    /// Attributes to other runs the frames that were there when this one came to them, beyond the `present` ones of its
    /// beginning.
    pub(super) fn attribute(&self, present: u64) {
        let mut counts = self.counts();
        counts.by_others = counts.finished_before.saturating_sub(present);
        counts.finished_before -= counts.by_others;
    }

    /// Counts a frame that could not be drawn or written.
    pub(super) fn failed(&self, number: i64, reason: &impl ToString) {
        let mut counts = self.counts();
        let numbers = counts.failures.entry(reason.to_string()).or_default();
        numbers.push(number);
    }

    /// The counts so far.
    pub(super) fn counts(&self) -> MutexGuard<'_, Counts> {
        // A panic cannot leave the counts inconsistent.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Counts {
    /// The frames that failed, by reason, in words; [`None`] if none did.
    pub(super) fn failures(&self, destination: &Destination) -> Option<String> {
        if self.failures.is_empty() {
            return None;
        }
        let failed: usize = self.failures.values().map(Vec::len).sum();
        let again = if failed == 1 { "it" } else { "them" };
        let frames = count(failed as u64, "frame");
        let mut text = format!("{frames} failed; the same command tries {again} again:");
        for (reason, numbers) in &self.failures {
            let mut numbers = numbers.clone();
            numbers.sort_unstable();
            let name = match numbers.as_slice() {
                [only] => destination.file(*only).display().to_string(),
                _ => destination.to_string(),
            };
            let _ = write!(text, "\n  {}: {name}: {reason}", ranges(&numbers));
        }
        Some(text)
    }
}

/// Formats rising numbers as an argument of `--frames`: `3-5,9`.
fn ranges(numbers: &[i64]) -> String {
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
    use super::super::super::pattern::Pattern;
    use super::*;

    #[test]
    fn failures_are_listed_by_reason_in_ranges_that_can_be_asked_for_again() {
        let stats = RunStats::default();
        let pattern = Pattern::parse("out/f_##.png".as_ref()).unwrap().unwrap();
        let destination = Destination::Sequence(pattern);
        assert_eq!(stats.counts().failures(&destination), None);
        for number in [9, 3, 5, 4] {
            stats.failed(number, &"the disk is full");
        }
        stats.failed(7, &"no right");
        assert_eq!(
            stats.counts().failures(&destination).unwrap(),
            "5 frames failed; the same command tries them again:\n  \
             7: out/f_07.png: no right\n  3-5,9: out/f_##.png: the disk is full"
        );
    }
}
