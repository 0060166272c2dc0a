//! Guards against a command line that writes where it should not, goes on after an error, panics, or gives other
//! answers than the library.

mod camera;
mod crops;
mod isoradials;
mod projections;
mod render;
mod scene;
mod table;
mod trace;

use std::fs;
use std::process::{Command, Stdio};

use tempfile::tempdir;

use crate::harness::{
    PROGRAM, REFERENCE_RAYS, darkness, done, listing, printed, refused, with_draft,
};

const SMALL: &str = "96x54";

#[test]
fn bad_options_are_refused_as_misuse() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (args, words) in [
        (&["render", "--threads", "0"][..], "--threads"),
        (&["render", "--size", "96"], "1920x1080"),
        (&["render", "--size", "0x54"], "--size 0x54"),
        (&["render", "--size=-1x54"], "--size"),
        (&["render", "--size", "1000000x1000000"], "--size"),
        (&["render", "--method", "guess"], "integrate"),
        (
            &["render", "--integrate-tolerance", "1e-9"],
            "--method integrate",
        ),
        (
            &[
                "trace",
                "--method",
                "integrate",
                "--integrate-tolerance",
                "nan",
            ],
            "1e-13",
        ),
        (&["trace", "--radius", "1"], "above 1"),
        (&["trace", "--radius", "3,-6"], "above 1"),
        (&["trace", "--radius", "inf"], "above 1"),
        (&["table", "coarse"], "standard"),
        (&["table", "-o", "-"], "standard output"),
        (&["table", "draft", "inspect", "a.table"], "inspect"),
        (&["paint"], "paint"),
    ] {
        refused(here, args, 2, &[words]);
    }
    assert!(listing(here).is_empty(), "{:?}", listing(here));
}

#[test]
fn help_and_version_succeed_and_a_missing_verb_is_misuse() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for args in [
        &["--help"][..],
        &["render", "--help"],
        &["table", "verify", "-h"],
        &["--version"],
    ] {
        assert!(printed(here, args).len() > 10);
    }
    let help = printed(here, &["render", "--help"]).replace(['\n', ' '], "");
    for words in ["a linear value and not sRGB", "gAMA 1.0"] {
        assert!(help.contains(&words.replace(' ', "")), "{words}");
    }
    let output = darkness(here, &[]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("Usage:") && stderr.contains("Examples:"));
}

#[cfg(not(feature = "view"))]
#[test]
fn a_program_without_its_window_says_how_to_build_it_in() {
    let folder = tempdir().unwrap();
    let words = ["cargo run --release --features view -- view"];
    for args in [&["view"][..], &["view", "lit", "--size", "320x180"]] {
        refused(folder.path(), args, 1, &words);
    }
    assert!(listing(folder.path()).is_empty());
}

#[test]
fn completions_and_manual_pages_know_every_verb() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let verbs = ["render", "table", "trace", "scene", "chart", "job"];
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let text = printed(here, &["completions", shell]);
        for word in verbs.into_iter().chain(["inclination", "require-table"]) {
            assert!(text.contains(word), "{shell}: {word}");
        }
    }
    let page = printed(here, &["man"]);
    assert!(verbs.iter().all(|verb| page.contains(verb)), "{page}");
    assert!(printed(here, &["man", "render"]).contains("inclination"));
    refused(here, &["man", "paint"], 2, &["paint"]);
    done(here, &["man", "-o", "share/man1"]);
    let pages = listing(&here.join("share/man1"));
    for page in ["darkness.1", "darkness-render.1", "darkness-table-verify.1"] {
        assert!(pages.iter().any(|name| name == page), "{pages:?}");
    }
    // The help names both, in a line.
    let help = printed(here, &["--help"]);
    assert!(help.contains("darkness completions bash") && help.contains("darkness man"));
}

#[test]
fn a_reader_that_leaves_ends_the_run_quietly() {
    let folder = with_draft();
    for args in [
        &["trace", REFERENCE_RAYS, "--table", "a.table"][..],
        &["render", "--table", "a.table", "-q", "-o", "-"],
    ] {
        let mut child = Command::new(PROGRAM)
            .current_dir(folder.path())
            .args(args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
        assert_eq!(output.status.code(), Some(0));
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_standard_output_is_a_failure() {
    let folder = with_draft();
    for args in [
        &["trace", REFERENCE_RAYS, "--table", "a.table"][..],
        &["render", "--table", "a.table", "-q", "-o", "-"],
        &["table", "inspect", "a.table"],
        &["scene"],
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = Command::new(PROGRAM)
            .current_dir(folder.path())
            .args(args)
            .stdout(full)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(
            stderr.starts_with("darkness: the standard output"),
            "{stderr}"
        );
    }
}
