//! Frames as files, one each.
//!
//! Runs of one command share the frames of a sequence without a scheduler. A run [claims](claim) a frame before it
//! draws it, by the lock on the frame's unfinished file, and looks again later at frames that others have claimed. Runs
//! with other settings would replace each other's frames: each run leaves a [mark](join) beside the frames while it
//! lasts, and is refused where it finds another's.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::super::frame_range::FrameRange;
use super::super::method::hex;
use super::super::pattern::Pattern;
use super::origin::{FrameOrigin, HEAD};
use crate::output::claim::RunMark;
use crate::output::{Unfinished, leftover, remove_if_dead, remove_leftovers};

/// Whether a frame's file exists, and is what is to be `made`. A file of more than `most` bytes is not.
pub(super) fn is_finished(path: &Path, most: u64, made: impl Fn(&[u8]) -> bool) -> bool {
    // Opening a pipe would wait for its writer.
    let may_be = fs::metadata(path).is_ok_and(|kind| kind.is_file() && kind.len() <= most);
    may_be && fs::read(path).is_ok_and(|file| made(&file))
}

/// The number of the file at `path` on its disk, if one is there: a file that replaces it has another. It is always 0
/// where the system does not tell.
pub(super) fn inode(path: &Path) -> Option<u64> {
    let kind = fs::metadata(path).ok()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        Some(kind.ino())
    }
    #[cfg(not(unix))]
    {
        let _ = kind;
        Some(0)
    }
}

/// Begins a frame's file that no other process is writing; [`None`] while one is. A link is followed, unless it leads
/// to one of `inputs`.
///
/// # Errors
/// What the system returns.
pub(super) fn claim(path: &Path, inputs: &[PathBuf]) -> io::Result<Option<Unfinished>> {
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
    Unfinished::claim(path)
}

/// Joins the runs that draw a sequence from one origin, in samples of so many bits. Returns [`None`] where files cannot
/// be locked: runs then know nothing of each other.
pub(super) fn join(pattern: &Pattern, origin: &FrameOrigin, bits: u8) -> Option<RunMark> {
    let settings = hex(format!("{:?} {bits}", origin.texts()).as_bytes());
    RunMark::join(&pattern.numberless(), settings.get(..6)?).ok()
}

/// Whether a mark in a folder is that of runs with other settings than those of `mark`, and one of them is running. One
/// whose runs were killed is removed.
fn is_other_run(file: &Path, mark: Option<&RunMark>) -> bool {
    mark.is_some_and(|mark| mark.name().file_name() != file.file_name())
        && matches!(remove_if_dead(file), Ok(false))
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
    /// Whether another run with other settings is drawing the sequence.
    pub(super) is_contested: bool,
}

/// Lists the folder once, and removes what killed processes left of the frames that are `asked` for. `all` are the
/// animation's frames; `is_ours` judges by a file's first bytes; `mark` is that of this run.
pub(super) fn survey(
    pattern: &Pattern,
    asked: &FrameRange,
    all: &FrameRange,
    is_ours: fn(&[u8]) -> bool,
    mark: Option<&RunMark>,
) -> Survey {
    let mut survey = Survey::default();
    let Ok(entries) = fs::read_dir(folder(pattern)) else {
        return survey;
    };
    let marked = pattern.numberless();
    let is_mark = |name: &[u8]| {
        marked
            .file_name()
            .is_some_and(|mark| mark.as_encoded_bytes() == name)
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
            None if leftover(&name).is_some_and(is_asked) => {
                let _ = remove_if_dead(&entry.path());
            }
            None if leftover(&name).is_some_and(is_mark) => {
                survey.is_contested |= is_other_run(&entry.path(), mark);
            }
            _ => {}
        }
    }
    survey.foreign.sort_unstable();
    survey.left_over.sort_unstable();
    survey
}

/// Removes what runs that were killed meanwhile left of frames that were there already.
pub(super) fn clean(pattern: &Pattern, asked: &FrameRange) {
    remove_leftovers(folder(pattern), |name| {
        let number = pattern.number(name);
        number.is_some_and(|number| asked.contains(number))
    });
}

/// The folder of a sequence.
fn folder(pattern: &Pattern) -> &Path {
    match pattern.folder() {
        folder if folder.as_os_str().is_empty() => Path::new("."),
        folder => folder,
    }
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
