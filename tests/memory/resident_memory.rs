//! Guards against a renderer that needs much more memory than its frame and its table.
#![cfg(target_os = "linux")]

use std::fs;

use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::render::{coverage, mask};
use darkness::scene::{Scene, View};

use crate::tables;

/// The most memory that the process ever held, in bytes.
fn most() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM:"))
        .unwrap();
    1024 * line
        .split_whitespace()
        .nth(1)
        .unwrap()
        .parse::<u64>()
        .unwrap()
}

pub(crate) fn a_frame_takes_little_more_than_its_bytes() {
    let table = tables::table("standard");
    let scene = Scene::builtin("classic").unwrap();
    let (view, mut pixels) = (View::new(&scene), vec![0; 1920 * 1080]);
    let curves = Isoradials::new(
        &CurveSpec::new(&scene, &view, scene.tolerance()),
        &table.lookup(),
    );
    mask::render_into(&view, &curves, &mut pixels, 1920).unwrap();
    coverage::render_into(&view, &curves, &mut pixels, 1920).unwrap();
    let beyond = most() - pixels.len() as u64 - 303_312;
    println!(
        "{:.1} MiB beside the frame and the table",
        beyond as f64 / 1_048_576.0
    );
    assert!(beyond < 32 << 20, "{beyond} bytes");
}
