//! Guards against frames that depend on the processor's instruction set.

use std::fs;
use std::path::Path;

use crate::harness::{darkness, fails, finish};

const SETS: [&str; 4] = ["scalar", "sse4.2", "avx2", "avx512"];

/// Draws a picture with one instruction set, or with the best one below it that the machine has.
fn drawn(set: &str, scene: &str, antialias: &str, folder: &Path) -> Vec<u8> {
    let picture = folder.join("frame.png");
    let args = ["render", scene, "--quiet", "--antialias", antialias];
    let mut command = darkness(folder, &args);
    command
        .args(["--size", "640x360", "-o", "frame.png"])
        .env("DARKNESS_SIMD", set);
    finish(&mut command);
    fs::read(picture).unwrap()
}

#[test]
fn every_instruction_set_draws_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["classic", "edge-on", "inside", "photon-ring"] {
        for antialias in ["true", "false"] {
            let frames = SETS.map(|set| drawn(set, scene, antialias, folder.path()));
            for (set, frame) in SETS.iter().zip(&frames) {
                assert!(
                    *frame == frames[0],
                    "{scene}, antialias {antialias}: {set} and {} differ",
                    SETS[0]
                );
            }
        }
    }
}

#[test]
fn an_unknown_instruction_set_is_refused() {
    let mut command = darkness(Path::new("."), &["scene"]);
    command.env("DARKNESS_SIMD", "avx3");
    fails(&command.output().unwrap(), 2, &["avx3", "sse4.2"]);
}
