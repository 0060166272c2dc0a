//! Frames as PNG files, one each: what is finished stays, what is missing or of something else is drawn.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::pattern::Pattern;
use crate::output::{Unfinished, leftover, remove_if_dead};
use crate::render::png::Origin;
use crate::scene::animation::FrameRange;

/// Whether a frame's file is there, whole, and of the same origin. One of more than `most` bytes is none.
pub(super) fn is_finished(path: &Path, most: u64, origin: &Origin) -> bool {
    // To read a pipe is to wait for its other end.
    let may_be = fs::metadata(path).is_ok_and(|kind| kind.is_file() && kind.len() <= most);
    may_be && fs::read(path).is_ok_and(|file| origin.made(&file))
}

/// Writes a frame's file, whole or not at all; a link is followed, but to none of `inputs`.
///
/// # Errors
/// What the system says.
pub(super) fn write(path: &Path, png: &[u8], inputs: &[PathBuf]) -> io::Result<()> {
    // It would be replaced by a file.
    if fs::metadata(path).is_ok_and(|kind| !kind.is_file()) {
        return Err(io::Error::other("it is there and no regular file"));
    }
    let is_link = fs::symlink_metadata(path).is_ok_and(|kind| kind.is_symlink());
    if is_link && fs::canonicalize(path).is_ok_and(|led_to| inputs.contains(&led_to)) {
        return Err(io::Error::other(
            "it is a link to the scene or the table that is read",
        ));
    }
    let mut unfinished = Unfinished::new(path)?;
    unfinished.file().write_all(png)?;
    unfinished.finish()
}

/// Looks through the folder once: removes what killed processes left of these frames, and counts the frames that have a file.
pub(super) fn look_through(pattern: &Pattern, frames: &FrameRange) -> u64 {
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
