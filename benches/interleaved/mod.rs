//! Measuring two or more contenders side by side: on a machine whose speed drifts, only ratios taken at the same
//! moment mean anything.

use std::time::Instant;

/// A way of doing the work: its name, and one run of it. What a run returns is summed up and printed as proof that it
/// ran.
pub(crate) struct Contender<'a> {
    pub(crate) name: &'a str,
    pub(crate) run: Box<dyn FnMut() -> f64 + 'a>,
}

/// Runs the contenders in turn, round after round, and prints for each the median time per item and the median of its
/// ratio to the first contender in the same round.
pub(crate) fn compare(title: &str, items: usize, rounds: usize, contenders: &mut [Contender<'_>]) {
    let mut nanoseconds = vec![Vec::with_capacity(rounds); contenders.len()];
    let mut sum = 0.0;
    for round in 0..=rounds {
        for (times, contender) in nanoseconds.iter_mut().zip(contenders.iter_mut()) {
            let start = Instant::now();
            sum += (contender.run)();
            // The first round warms the caches.
            if round > 0 {
                times.push(start.elapsed().as_secs_f64() * 1e9 / items as f64);
            }
        }
    }
    println!("{title} ({rounds} rounds, sum {sum:.6e})");
    for (times, contender) in nanoseconds.iter().zip(contenders.iter()) {
        let ratios = nanoseconds[0]
            .iter()
            .zip(times)
            .map(|(first, this)| first / this)
            .collect();
        println!(
            "  {:<34} {:>14}   {:>9.2} × as fast",
            contender.name,
            time(median(times.clone())),
            median(ratios)
        );
    }
}

/// The middle value.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn time(nanoseconds: f64) -> String {
    match nanoseconds {
        t if t < 1e3 => format!("{t:.1} ns"),
        t if t < 1e6 => format!("{:.2} µs", t / 1e3),
        t => format!("{:.2} ms", t / 1e6),
    }
}
