//! The program, run in a folder.

use std::path::Path;
use std::process::Command;

/// The program's executable file.
pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_darkness");

/// Returns a command that runs the program in a folder with these arguments, and with no table from the environment or
/// the user's cache: tables go to the folder `tables`.
pub(crate) fn darkness(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command
        .current_dir(folder)
        .env_remove("DARKNESS_TABLE")
        .env("DARKNESS_CACHE", "tables")
        .args(args);
    command
}

/// Runs a command, expects it to succeed, and returns its standard output and its standard error.
pub(crate) fn finish(command: &mut Command) -> (Vec<u8>, String) {
    let output = command.output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{command:?}: {stderr}");
    (output.stdout, stderr)
}

/// Runs the program, expects it to succeed, and returns its standard output and its standard error.
pub(crate) fn done(folder: &Path, args: &[&str]) -> (Vec<u8>, String) {
    finish(&mut darkness(folder, args))
}
