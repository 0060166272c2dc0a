//! Printing what contenders side by side come to.

use std::time::Duration;

pub(crate) use darkness::chart::interleaved::Contender;
use darkness::chart::interleaved::rounds as run_rounds;

/// Runs the contenders in turn, round after round, and prints for each the median time per item and in all, and the median of its
/// ratio to the first contender in the same round.
pub(crate) fn compare(title: &str, items: usize, rounds: usize, contenders: &mut [Contender<'_>]) {
    let times = run_rounds(
        contenders,
        rounds,
        (Duration::ZERO, Duration::MAX),
        &mut || (),
    );
    println!("{title} ({rounds} rounds, sum {:.6e})", times.sum);
    for (i, contender) in contenders.iter().enumerate() {
        println!(
            "  {:<34} {:>14} {:>14}   {:>9.3} × as fast",
            contender.name,
            time(times.median(i) * 1e9 / items as f64),
            time(times.median(i) * 1e9),
            times.ratio(i, 0)
        );
    }
}

fn time(nanoseconds: f64) -> String {
    match nanoseconds {
        t if t < 1e3 => format!("{t:.1} ns"),
        t if t < 1e6 => format!("{:.2} µs", t / 1e3),
        t => format!("{:.2} ms", t / 1e6),
    }
}
