//! Guards against a window that fails without a sentence.

use tempfile::tempdir;

use crate::display::{Screen, can_show, with_tables};
use crate::process::darkness;

/// Runs `view` without a display, and asserts that it ends with a code and a sentence.
fn ends(folder: &std::path::Path, args: &[&str], display: Option<&str>, code: i32, words: &[&str]) {
    let mut command = darkness(folder, &[&["view"], args].concat());
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    command.env_remove("WAYLAND_SOCKET");
    command.envs(display.map(|display| ("DISPLAY", display)));
    let output = command.output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(
        stderr.starts_with("darkness: ") && output.stdout.is_empty(),
        "{stderr}"
    );
    for word in words {
        assert!(stderr.contains(word), "{word} is not in: {stderr}");
    }
}

#[test]
fn without_a_display_it_says_so() {
    let folder = tempdir().unwrap();
    let words = ["there is no display", "darkness render"];
    ends(folder.path(), &["lit"], None, 1, &words);
    ends(folder.path(), &["lit"], Some(":987"), 1, &words);
    // Nothing was made before.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn scenes_and_options_are_checked_before_a_window_opens() {
    let folder = tempdir().unwrap();
    ends(
        folder.path(),
        &["no-such-scene"],
        None,
        2,
        &["no-such-scene"],
    );
    ends(
        folder.path(),
        &["lit", "--set", "disk.outer=2"],
        None,
        2,
        &["disk.outer"],
    );
    ends(
        folder.path(),
        &["lit", "--size", "0x5"],
        None,
        2,
        &["image.width"],
    );
    if !can_show() {
        return;
    }
    let folder = with_tables();
    let screen = Screen::new();
    std::fs::write(folder.path().join("bad.table"), "no table").unwrap();
    let table = ["lit", "--table", "bad.table"];
    ends(
        folder.path(),
        &table,
        Some(screen.name()),
        1,
        &["bad.table"],
    );
    let sky = ["lit", "--set", "sky.panorama=\"none.png\""];
    ends(folder.path(), &sky, Some(screen.name()), 1, &["none.png"]);
}
