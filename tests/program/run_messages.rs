//! Guards against a run that tells something else than what it does: which frames, how far it is, how long parts took.
#![cfg(unix)]

use std::fs;

use tempfile::tempdir;

use crate::harness::{PATTERN, done, files, run, with_animation};

/// Guards against "1 frames", and against a pattern that is told in place of a file.
#[test]
fn one_frame_is_told_of_as_one_with_its_name() {
    let folder = with_animation(4);
    let here = folder.path();
    let render = [
        "render",
        "small.toml",
        "-o",
        PATTERN,
        "--progress",
        "openjd",
    ];
    let one = [&render[..], &["--frames", "3"]].concat();
    let (_, stderr) = done(here, &one);
    assert!(
        stderr.contains("out/f_0003.png: 96 × 54, table draft"),
        "{stderr}"
    );
    assert!(stderr.contains("1 of 1 frame, "), "{stderr}");
    assert!(
        done(here, &one)
            .1
            .contains("out/f_0003.png: the frame was finished before")
    );
    fs::create_dir(here.join("out/f_0002.png")).unwrap();
    let (output, stderr) = run(here, &[&render[..], &["--frames", "2-3"]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr.contains(
            "1 frame failed; the same command tries it again:\n  2: out/f_0002.png: cannot"
        ),
        "{stderr}"
    );
    let (_, stderr) = done(here, &[&render[..], &["--frames", "3-4"]].concat());
    assert!(
        stderr.contains("1 frame of 96 × 54") && stderr.contains("; 1 was finished before"),
        "{stderr}"
    );
    assert!(!stderr.contains(" 1 frames"), "{stderr}");
}

#[test]
fn a_dry_run_lists_frames_and_files_and_draws_nothing() {
    let folder = with_animation(5);
    let here = folder.path();
    done(
        here,
        &["render", "small.toml", "-o", PATTERN, "--frames", "2"],
    );
    let before = files(&here.join("out"));
    let (list, _) = done(
        here,
        &[
            "render",
            "small.toml",
            "-o",
            PATTERN,
            "--frames",
            "1-3",
            "--dry-run",
        ],
    );
    let list = String::from_utf8(list).unwrap();
    assert_eq!(
        list,
        "1\tto draw\tout/f_0001.png\n2\tfinished\tout/f_0002.png\n3\tto draw\tout/f_0003.png\n"
    );
    assert!(files(&here.join("out")) == before);
    // No table is made either.
    let other = tempdir().unwrap();
    let (list, _) = done(
        other.path(),
        &["render", "orbit", "--frames", "7", "--dry-run"],
    );
    assert_eq!(list, b"7\tto draw\torbit_0007.png\n");
    assert!(files(other.path()).is_empty());
}

#[test]
fn progress_is_reported_in_the_form_that_is_asked_for() {
    let folder = with_animation(30);
    let here = folder.path();
    let stderr = |progress: &[&str]| {
        let args = [
            &["render", "small.toml", "-o", PATTERN, "--overwrite"],
            progress,
        ]
        .concat();
        done(here, &args).1
    };
    // Within the first second only the last line is printed.
    let openjd = stderr(&["--progress", "openjd"]);
    let lines: Vec<_> = openjd.lines().collect();
    assert!(lines.contains(&"openjd_progress: 100.0"), "{openjd}");
    assert!(
        lines
            .iter()
            .any(|line| line.starts_with("openjd_status: 30 of 30 frames, ")),
        "{openjd}"
    );
    for how in ["auto", "plain", "none"] {
        let text = stderr(&["--progress", how]);
        assert_eq!(text.lines().count(), 1, "{text}");
    }
    assert_eq!(stderr(&["--quiet"]), "");
    let (_, failed) = run(
        here,
        &[
            "render",
            "small.toml",
            "--frames",
            "99",
            "--progress",
            "openjd",
        ],
    );
    assert!(failed.contains("openjd_fail: "), "{failed}");
    let timings = stderr(&["--timings"]);
    assert!(timings.contains("frames/s"), "{timings}");
}

/// Guards against parts above their whole, and parts that are of another run.
#[test]
fn the_times_of_the_parts_add_up_to_the_whole() {
    let folder = with_animation(40);
    let here = folder.path();
    let render = ["render", "small.toml", "--overwrite", "--timings"];
    for options in [
        &["-o", PATTERN, "--threads", "2"][..],
        &["-o", PATTERN, "--threads", "1"],
        &["-o", "a.raw"],
        &["-o", "f_#.exr", "--frames", "3"],
    ] {
        let (_, stderr) = done(here, &[&render[..], options].concat());
        let milliseconds = |line: &str| -> f64 {
            let (number, _) = line.trim_start().split_once(" ms ").unwrap();
            number.parse().unwrap()
        };
        let lines: Vec<&str> = stderr
            .lines()
            .filter(|line| line.starts_with(' '))
            .collect();
        let parts = [
            "memory",
            "curves",
            "render",
            "encode",
            "write",
            "waiting and the rest",
        ];
        assert!(lines[0].contains(" ms  in all"), "{stderr}");
        assert_eq!(lines.len(), 1 + parts.len(), "{stderr}");
        for (line, part) in lines[1..].iter().zip(parts) {
            assert!(line.ends_with(&format!(" ms    {part}")), "{stderr}");
        }
        let sum: f64 = lines[1..].iter().map(|line| milliseconds(line)).sum();
        // Each number has one decimal.
        assert!(
            (sum - milliseconds(lines[0])).abs() < 0.05 * 7.01,
            "{stderr}"
        );
    }
}
