//! Times two or more contenders in turn. Where a machine's speed drifts, only ratios measured at the same moment are
//! meaningful.

use std::time::{Duration, Instant};

/// One way to do the work. The values that its runs return are summed, so that the compiler cannot drop them.
pub struct Contender<'a> {
    /// Its name.
    pub name: &'a str,
    /// Runs it once.
    pub run: Box<dyn FnMut() -> f64 + 'a>,
}

/// The times of all contenders in all rounds.
#[derive(Debug, Clone)]
pub struct Times {
    /// Seconds per run, by contender and round.
    seconds: Vec<Vec<f64>>,
    /// The sum of the values that all runs returned.
    pub sum: f64,
}

/// Runs the contenders in turn on this thread, in one round to warm up and `rounds` that count. Calls `round_done`
/// after each round.
///
/// Within its turn a contender whose run is shorter than `least` is repeated until it takes that long, so that the
/// caches hold its own data. After `most` no further round starts, except the first that counts.
pub fn rounds(
    contenders: &mut [Contender<'_>],
    rounds: usize,
    (least, most): (Duration, Duration),
    round_done: &mut dyn FnMut(),
) -> Times {
    let mut seconds = vec![Vec::with_capacity(rounds); contenders.len()];
    let mut repeats = vec![1_u32; contenders.len()];
    let mut sum = 0.0;
    let begun = Instant::now();
    for round in 0..=rounds {
        if round > 1 && begun.elapsed() > most {
            break;
        }
        for (i, contender) in contenders.iter_mut().enumerate() {
            let start = Instant::now();
            for _ in 0..repeats[i] {
                sum += (contender.run)();
            }
            let time = start.elapsed().as_secs_f64();
            // The first round warms the caches.
            if round > 0 {
                seconds[i].push(time / f64::from(repeats[i]));
            } else {
                repeats[i] = (least.as_secs_f64() / time.max(1e-9))
                    .ceil()
                    .clamp(1.0, 1e4) as u32;
            }
        }
        round_done();
    }
    Times { seconds, sum }
}

impl Times {
    /// Returns the median time of one run of contender `i`, in seconds.
    pub fn median(&self, i: usize) -> f64 {
        median(self.seconds[i].clone())
    }

    /// Returns the time of contender `baseline` divided by the time of contender `i`: the median of the ratios in each
    /// round.
    pub fn ratio(&self, i: usize, baseline: usize) -> f64 {
        let rounds = self.seconds[baseline].iter().zip(&self.seconds[i]);
        median(rounds.map(|(base, this)| base / this).collect())
    }
}

/// Returns the middle value, or NaN for an empty list. Of two middle values it returns the larger.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_contender_runs_in_every_round_and_short_runs_are_repeated() {
        use core::cell::Cell;
        let (short, long) = (Cell::new(0), Cell::new(0));
        let counting = |counter: &Cell<i32>, pause| {
            counter.set(counter.get() + 1);
            std::thread::sleep(pause);
            1.0
        };
        let mut done = 0;
        let times = rounds(
            &mut [
                Contender {
                    name: "short",
                    run: Box::new(|| counting(&short, Duration::ZERO)),
                },
                Contender {
                    name: "long",
                    run: Box::new(|| counting(&long, Duration::from_millis(5))),
                },
            ],
            3,
            (Duration::from_millis(5), Duration::MAX),
            &mut || done += 1,
        );
        assert_eq!((long.get(), done), (4, 4));
        assert!(short.get() > 4, "{}", short.get());
        assert_eq!(times.sum, f64::from(short.get() + long.get()));
        assert!(times.ratio(0, 1) > 1.0 && times.median(1) >= 5e-3);
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert!(median(Vec::new()).is_nan());
    }
}
