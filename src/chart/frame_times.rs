//! How the panels that measure frames take their times.

use core::time::Duration;

use super::interleaved::{Contender, rounds};
use super::measurement::{ChartEffort, ChartError, Time};

/// How much of a frame is measured.
pub(super) struct FrameEffort {
    repetitions: usize,
    /// The time after which no further repetition starts.
    time: Duration,
    /// The number of pixels on which methods that follow rays are timed.
    pub(super) sampled_pixels: u32,
    /// The largest number of pixels to compute exactly.
    pub(super) compared_pixels: u64,
    /// Seconds of one thread for computing one setting's pixels.
    seconds: f64,
}

impl FrameEffort {
    pub(super) fn of(effort: ChartEffort) -> Self {
        match effort {
            ChartEffort::Quick => Self {
                repetitions: 5,
                time: Duration::from_secs(3),
                sampled_pixels: 1024,
                compared_pixels: 1 << 17,
                seconds: 0.15,
            },
            ChartEffort::Full => Self {
                repetitions: 21,
                time: Duration::from_secs(40),
                sampled_pixels: 8192,
                compared_pixels: 1 << 22,
                seconds: 3.0,
            },
        }
    }

    /// Returns the number of pixels that a method computes in the seconds it has.
    pub(super) fn budget(&self, time: Time) -> u64 {
        (self.seconds * 1e9 / time.nanoseconds.max(1e-3)) as u64
    }

    /// Times the contenders, the baseline first: nanoseconds per pixel, and the ratio to the baseline. `pixels` is the
    /// number of pixels that one run of each computes. `progress` receives the share that is done, from 0 to 0.5.
    pub(super) fn times(
        &self,
        mut contenders: Vec<Contender<'_>>,
        pixels: &[f64],
        progress: &(dyn Fn(f64) + Sync),
    ) -> Vec<Time> {
        let mut done = 0.0;
        let bounds = (Duration::from_millis(2), self.time);
        let times = rounds(&mut contenders, self.repetitions, bounds, &mut || {
            done += 1.0;
            progress(0.5 * done / (self.repetitions + 1) as f64);
        });
        let baseline = times.median(0) * 1e9 / pixels[0];
        let ratio = |(i, pixels_of_i)| times.ratio(i, 0) * pixels_of_i / pixels[0];
        let ratios = pixels.iter().enumerate().map(ratio);
        ratios.map(|ratio| Time::new(baseline, ratio)).collect()
    }
}

/// Starts the thread on which times are taken.
///
/// # Errors
/// [`ChartError::Threads`]
pub(super) fn one_thread() -> Result<rayon::ThreadPool, ChartError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .map_err(|error| ChartError::Threads(error.to_string()))
}
