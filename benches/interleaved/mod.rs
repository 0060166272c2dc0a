//! Prints the times of contenders that run in turn.

use std::time::Duration;

pub(crate) use darkness::chart::interleaved::Contender;
use darkness::chart::interleaved::rounds as run_rounds;

/// Runs the contenders in turn, in every round. Prints each contender's median time, per item and in total, and the
/// median over the rounds of the first contender's time divided by its own.
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
