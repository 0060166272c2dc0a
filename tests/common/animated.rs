//! The program on an animation of small frames.

// Each test is a program of its own, and takes what it needs.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;
use darkness::scene::Animation;
use tempfile::{TempDir, tempdir};

/// The program, in a folder, with these arguments and the standard error as text.
pub(crate) fn darkness(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(cargo_bin!("darkness"));
    command
        .current_dir(folder)
        .env_remove("DARKNESS_TABLE")
        .args(args);
    command
}

pub(crate) fn run(folder: &Path, args: &[&str]) -> (Output, String) {
    let output = darkness(folder, args).output().unwrap();
    let stderr = String::from_utf8(output.stderr.clone()).unwrap();
    (output, stderr)
}

pub(crate) fn done(folder: &Path, args: &[&str]) -> (Vec<u8>, String) {
    let (output, stderr) = run(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {stderr}");
    (output.stdout, stderr)
}

pub(crate) fn refused(folder: &Path, args: &[&str], code: i32, words: &[&str]) {
    let (output, stderr) = run(folder, args);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {stderr}");
    for word in words {
        assert!(
            stderr.contains(word),
            "{args:?}: {word:?} is not in: {stderr}"
        );
    }
    assert!(output.stdout.is_empty(), "{args:?} printed something");
}

/// A folder with an animation of so many small frames in `small.toml`, and a table.
pub(crate) fn with_animation(frames: u32) -> TempDir {
    let folder = tempdir().unwrap();
    let toml = Animation::load("orbit").unwrap().to_toml();
    let toml = toml
        .replace("frames = 240", &format!("frames = {frames}"))
        .replace("width = 1920", "width = 96")
        .replace("height = 1080", "height = 54");
    fs::write(folder.path().join("small.toml"), toml).unwrap();
    done(folder.path(), &["table", "draft"]);
    folder
}

/// The files of a folder and their bytes, hidden ones too.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap_or_default())
        })
        .collect()
}

pub(crate) const PATTERN: &str = "out/f_####.png";
