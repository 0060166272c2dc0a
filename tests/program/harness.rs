//! What the tests of the program share: ways to run it, and folders to run it in.

use std::collections::BTreeMap;
use std::env;
use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use darkness::scene::Animation;
use tempfile::{TempDir, tempdir};

pub(crate) use crate::process::{PROGRAM, darkness, done, finish};

/// A list of some hundred rays.
pub(crate) const REFERENCE_RAYS: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/rays.csv");

/// Where the frames of an animation go.
pub(crate) const PATTERN: &str = "out/f_####.png";

/// Runs the program, and returns its output, with the standard error as text too.
pub(crate) fn run(folder: &Path, args: &[&str]) -> (Output, String) {
    let output = darkness(folder, args).output().unwrap();
    let stderr = String::from_utf8(output.stderr.clone()).unwrap();
    (output, stderr)
}

/// Returns a command that runs another program in a folder. Its search path begins with the folder of the program under
/// test, and ends with those of the system's daemons.
pub(crate) fn tool(folder: &Path, line: &[&str]) -> Command {
    let ours = Path::new(PROGRAM).parent().unwrap();
    let others = env::var("PATH").unwrap_or_default();
    let mut command = Command::new(line[0]);
    command
        .current_dir(folder)
        .env(
            "PATH",
            format!("{}:{others}:/usr/sbin:/sbin", ours.display()),
        )
        .env_remove("DARKNESS_TABLE")
        .env("DARKNESS_CACHE", "tables")
        .args(&line[1..]);
    command
}

/// Runs another program, expects it to succeed, and returns its standard output.
pub(crate) fn tool_prints(folder: &Path, line: &[&str]) -> Vec<u8> {
    finish(&mut tool(folder, line)).0
}

/// Runs the program, expects it to succeed, and returns its standard output.
pub(crate) fn printed(folder: &Path, args: &[&str]) -> String {
    String::from_utf8(done(folder, args).0).unwrap()
}

/// Runs the program, and expects it to be refused as [`fails`] says.
pub(crate) fn refused(folder: &Path, args: &[&str], code: i32, words: &[&str]) {
    fails(&darkness(folder, args).output().unwrap(), code, words);
}

/// Asserts that a run ended with `code`, a sentence that has all of `words`, and nothing on the standard output.
pub(crate) fn fails(output: &Output, code: i32, words: &[&str]) {
    let stderr = str::from_utf8(&output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(
        stderr.starts_with("darkness: ") || (code == 2 && stderr.starts_with("error: ")),
        "{stderr}"
    );
    for word in words {
        assert!(stderr.contains(word), "{word:?} is not in: {stderr}");
    }
    assert!(output.stdout.is_empty(), "it printed something");
}

/// Runs the program with this standard input.
pub(crate) fn fed(folder: &Path, args: &[&str], input: &str) -> Output {
    let mut command = darkness(folder, args);
    command.stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A program that refuses its options reads nothing.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    child.wait_with_output().unwrap()
}

/// Runs the program with arguments that need not be text, for no more than a minute.
pub(crate) fn run_briefly(folder: &Path, args: &[&OsStr]) -> Output {
    let mut command: Command = darkness(folder, &[]);
    command.args(args).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || sender.send(child.wait_with_output()));
    let output = receiver.recv_timeout(Duration::from_secs(60));
    output
        .unwrap_or_else(|_| panic!("{args:?} takes more than a minute"))
        .unwrap()
}

/// Writes an animation of so many small frames.
pub(crate) fn write_animation(path: &Path, frames: u32) {
    let toml = Animation::load("orbit").unwrap().to_toml();
    let toml = toml
        .replace("frames = 240", &format!("frames = {frames}"))
        .replace("width = 1920", "width = 96")
        .replace("height = 1080", "height = 54");
    fs::write(path, toml).unwrap();
}

/// A folder with an animation of so many small frames in `small.toml`, and a table.
pub(crate) fn with_animation(frames: u32) -> TempDir {
    let folder = tempdir().unwrap();
    write_animation(&folder.path().join("small.toml"), frames);
    done(folder.path(), &["table", "draft"]);
    folder
}

/// A folder with the draft table in `a.table`.
pub(crate) fn with_draft() -> TempDir {
    let folder = tempdir().unwrap();
    done(folder.path(), &["table", "draft", "-o", "a.table"]);
    folder
}

/// The files of a folder and their bytes, hidden ones too; a folder within it has none.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap_or_default())
        })
        .collect()
}

/// The names of all that is in a folder, sorted.
pub(crate) fn listing(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}
