//! Guards against senseless input of any kind: scenes, ranges, names and sizes that make no sense are refused in a
//! sentence. They do not crash the program, keep it running, or leave files behind.
#![cfg(unix)]

mod memory;
mod names;
mod scenes;

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::harness::{PROGRAM, done, printed, run_briefly, with_animation};

/// Runs the program for no more than a minute, and returns its exit code and its standard error.
fn typed(folder: &Path, args: &[&OsStr]) -> (i32, String) {
    let output = run_briefly(folder, args);
    let said = String::from_utf8(output.stderr).unwrap();
    let Some(code) = output.status.code() else {
        panic!("{args:?} ended by {}: {said}", output.status);
    };
    (code, said)
}

fn words(args: &[&'static str]) -> Vec<&'static OsStr> {
    args.iter().map(|&arg| OsStr::new(arg)).collect()
}

/// Asserts that the text is one of the program's own sentences.
fn is_sentence(said: &str) {
    assert!(
        said.starts_with("darkness: ") || said.starts_with("error: "),
        "{said}"
    );
    assert!(said.len() < 5000 && !said.contains("panicked"), "{said}");
    assert!(
        !said.contains(|c: char| c.is_control() && c != '\n'),
        "{said:?}"
    );
}

/// Guards against a file that grows without end while it is read, and against a picture that overwrites its own scene.
#[test]
fn a_file_that_is_read_is_not_written_to_by_redirection() {
    let folder = with_animation(2);
    let here = folder.path();
    let rays = format!("u0,dudphi\n{}", "0.03,0.1\n".repeat(20_000));
    fs::write(here.join("rays.csv"), &rays).unwrap();
    let scene = fs::read_to_string(here.join("small.toml")).unwrap();
    for line in [
        "trace rays.csv --method exact >> rays.csv",
        "trace - --method exact < rays.csv >> rays.csv",
        "render small.toml --frames 1-2 --format raw -o - 1<>small.toml",
        "render small.toml --frames 1 -o - >> tables/draft.table",
    ] {
        let output = Command::new("sh")
            .current_dir(here)
            .args(["-c", &format!("'{PROGRAM}' {line}")])
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        assert!(
            said.contains("the standard output goes to this file"),
            "{said}"
        );
    }
    assert_eq!(fs::read_to_string(here.join("rays.csv")).unwrap(), rays);
    assert_eq!(fs::read_to_string(here.join("small.toml")).unwrap(), scene);
    done(here, &["table", "inspect", "tables/draft.table"]);
}

/// Guards against environment variables and limits that break what the program's own options set.
#[test]
fn environment_variables_and_limits_change_nothing() {
    let folder = with_animation(2);
    let here = folder.path();
    for (line, code) in [
        ("RUST_MIN_STACK=0 {} render small.toml -q -o f_#.png", 0),
        (
            "RAYON_NUM_THREADS=20000 {} render small.toml -q -o f_#.png",
            0,
        ),
        ("RAYON_NUM_THREADS=no {} render small.toml -q -o f_#.png", 0),
        ("TMPDIR=/nowhere {} render small.toml -q -o f_#.png", 0),
        ("ulimit -f 0; {} --help > help", 0),
        ("ulimit -f 0; {} bogus 2> error", 2),
    ] {
        let line = line.replace("{}", &format!("'{PROGRAM}'"));
        let output = Command::new("sh")
            .current_dir(here)
            .args(["-c", &line])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line}: {said}");
    }
    // Ranges of a hundred million frames, of which no more are looked at than takes a moment.
    let many: Vec<String> = (2..900).map(|step| format!("1-100000000x{step}")).collect();
    let scene = fs::read_to_string(here.join("small.toml")).unwrap();
    fs::write(
        here.join("long.toml"),
        scene.replace("frames = 2\n", "frames = 100000000\n"),
    )
    .unwrap();
    let many = ["--frames", &many.join(",")];
    let explain = ["render", "long.toml", "--explain"];
    let explained = printed(here, &[&explain[..], &many].concat());
    assert!(
        explained.contains("\nframes      1000 of 1-"),
        "{explained}"
    );
}
