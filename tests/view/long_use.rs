//! Guards against a window whose memory grows, or that works while nothing moves.

use std::fs;
use std::thread;
use std::time::Duration;

use crate::display::{Window, can_show, drawn, steered, wait_until, with_tables};

/// The memory of a process, in kilobytes.
fn memory(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().strip_suffix(" kB")?.parse().ok()
}

/// The processor time of a process, in ticks of a hundredth of a second.
fn ticks(process: u32) -> u64 {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    let (_, fields) = stat.rsplit_once(") ").unwrap();
    let fields: Vec<_> = fields.split(' ').collect();
    fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
}

#[test]
fn memory_stays_flat_over_10_000_frames() {
    if !can_show() {
        return;
    }
    let window = Window::open_in(
        with_tables(),
        &[
            "lit",
            "--size=64x36",
            "--set=image.antialias=false",
            "--frames=10000",
        ],
    );
    let process = window.process();
    let (mut samples, mut child_ended) = (Vec::new(), false);
    wait_until("10,000 frames", || {
        match memory(process) {
            Some(memory) => samples.push(memory),
            None => child_ended = true,
        }
        child_ended
    });
    let output = window.ends();
    let told = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(
        told.starts_with("lit, 64 × 36, ") && told.contains(": 10000 frames, "),
        "{told}"
    );
    // The first fifth may still touch memory for the first time.
    let settled = &samples[samples.len() / 5..];
    let (least, most) = (settled.iter().min().unwrap(), settled.iter().max().unwrap());
    assert!(settled.len() > 10, "{samples:?}");
    assert!(most - least < 2048, "{least} to {most} kB: {samples:?}");
}

#[test]
fn at_rest_nothing_is_done() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    window.shows(&drawn(&steered("lit", |_| {})));
    window.hand("mousemove 160 90 click 4");
    window.at_rest();
    let before = ticks(window.process());
    thread::sleep(Duration::from_secs(2));
    let spent = ticks(window.process()) - before;
    assert!(spent <= 2, "{spent} ticks");
}
