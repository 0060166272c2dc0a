//! Frames as files, one each.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use super::super::frame_range::FrameRange;
use super::super::pattern::Pattern;
use super::origin::HEAD;
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

/// What a folder holds of a sequence.
#[derive(Debug, Default)]
pub(super) struct Survey {
    /// How many of the frames that are asked for have a file.
    pub(super) present: u64,
    /// The numbers of those whose file another program made.
    pub(super) foreign: Vec<i64>,
    /// The numbers of frames that this program made, and that the animation no longer has.
    pub(super) left_over: Vec<i64>,
}

/// Lists the folder once, and removes what killed processes left of the frames that are `asked` for. `all` are the
/// animation's frames; `is_ours` judges by a file's first bytes.
pub(super) fn survey(
    pattern: &Pattern,
    asked: &FrameRange,
    all: &FrameRange,
    is_ours: fn(&[u8]) -> bool,
) -> Survey {
    let folder = match pattern.folder() {
        folder if folder.as_os_str().is_empty() => Path::new("."),
        folder => folder,
    };
    let mut survey = Survey::default();
    let Ok(entries) = fs::read_dir(folder) else {
        return survey;
    };
    let is_asked = |name: &[u8]| {
        let number = pattern.number(name);
        number.is_some_and(|number| asked.contains(number))
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let number = pattern.number(name.as_encoded_bytes());
        match number {
            Some(number) if asked.contains(number) => {
                survey.present += 1;
                if is_foreign(&entry.path(), is_ours) {
                    survey.foreign.push(number);
                }
            }
            Some(number) if !all.contains(number) && !is_foreign(&entry.path(), is_ours) => {
                survey.left_over.push(number);
            }
            None if leftover(&name).is_some_and(is_asked) => remove_if_dead(&entry.path()),
            _ => {}
        }
    }
    survey.foreign.sort_unstable();
    survey.left_over.sort_unstable();
    survey
}

/// Whether a regular file is at `path`, or where a link there leads to, that another program made.
pub(super) fn is_foreign(path: &Path, is_ours: fn(&[u8]) -> bool) -> bool {
    if !fs::metadata(path).is_ok_and(|kind| kind.is_file()) {
        return false;
    }
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD as u64).read_to_end(&mut head));
    read.is_err() || !is_ours(&head)
}

/// The error of `files` that another program made.
pub(super) fn foreign(files: impl ExactSizeIterator<Item = PathBuf>) -> anyhow::Error {
    anyhow::anyhow!(
        "{}: made by another program, and not replaced; move it, choose another name with -o, or replace it with \
         --overwrite",
        list(files)
    )
}

/// The first names of some files.
pub(super) fn list(files: impl ExactSizeIterator<Item = PathBuf>) -> String {
    const MOST: usize = 3;
    let more = files.len().saturating_sub(MOST);
    let names = files.take(MOST).map(|file| file.display().to_string());
    let names = names.collect::<Vec<_>>().join(", ");
    if more == 0 {
        names
    } else {
        format!("{names} and {more} more")
    }
}
