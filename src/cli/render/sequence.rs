//! Frames as files, one each.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::super::frame_range::FrameRange;
use super::super::pattern::Pattern;
use crate::output::{Unfinished, leftover, remove_if_dead};

/// Whether a frame's file exists, and is what is to be `made`. A file of more than `most` bytes is not.
pub(super) fn is_finished(path: &Path, most: u64, made: impl Fn(&[u8]) -> bool) -> bool {
    // Opening a pipe would wait for its writer.
    let may_be = fs::metadata(path).is_ok_and(|kind| kind.is_file() && kind.len() <= most);
    may_be && fs::read(path).is_ok_and(|file| made(&file))
}

/// Writes a frame's file, whole or not at all. A link is followed, unless it leads to one of `inputs`.
///
/// # Errors
/// What the system returns.
pub(super) fn write(path: &Path, bytes: &[u8], inputs: &[PathBuf]) -> io::Result<()> {
    // A pipe or a device would be replaced by a file.
    if fs::metadata(path).is_ok_and(|kind| !kind.is_file()) {
        return Err(io::Error::other(
            "the file exists and is not a regular file",
        ));
    }
    let is_link = fs::symlink_metadata(path).is_ok_and(|kind| kind.is_symlink());
    if is_link && fs::canonicalize(path).is_ok_and(|led_to| inputs.contains(&led_to)) {
        return Err(io::Error::other(
            "the file is a link to a file that is read",
        ));
    }
    let mut unfinished = Unfinished::new(path)?;
    unfinished.file().write_all(bytes)?;
    unfinished.finish()
}

/// Lists the folder once: removes what killed processes left of these frames, and counts the frames that have a file.
pub(super) fn clean_and_count(pattern: &Pattern, frames: &FrameRange) -> u64 {
    let folder = match pattern.folder() {
        folder if folder.as_os_str().is_empty() => Path::new("."),
        folder => folder,
    };
    let Ok(entries) = fs::read_dir(folder) else {
        return 0;
    };
    let asked = |name: &[u8]| {
        let number = pattern.number(name);
        number.is_some_and(|number| frames.contains(number))
    };
    let mut present = 0;
    for entry in entries.flatten() {
        let name = entry.file_name();
        if asked(name.as_encoded_bytes()) {
            present += 1;
        } else if leftover(&name).is_some_and(asked) {
            remove_if_dead(&entry.path());
        }
    }
    present
}
