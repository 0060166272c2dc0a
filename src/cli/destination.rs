//! Where pictures and films go.

use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::frame_range::FrameRange;
use super::misuse::misuse;
use super::pattern::Pattern;
use super::stdio::{StdoutError, is_stdout, stdout};
use super::writable::{self, OUTPUT};
use crate::output::{Unfinished, write_whole};

/// Where a picture, the frames of an animation or a film goes.
#[derive(Debug)]
pub(super) enum Destination {
    /// The standard output.
    Stdout,
    /// A file, which appears when it is whole.
    File(PathBuf),
    /// A device or a named pipe, which is written directly.
    Device(PathBuf),
    /// A file for each frame.
    Sequence(Pattern),
}

impl Destination {
    /// The destination `path` of one picture that is made from `scene`; `-` is the standard output.
    ///
    /// # Errors
    /// The path has not the extension `extension`, is the scene's, or cannot be written.
    pub(super) fn of_picture(path: PathBuf, extension: &str, scene: &Path) -> anyhow::Result<Self> {
        if path == Path::new("-") {
            return Ok(Self::Stdout);
        }
        if !has_extension(&path, extension) {
            return Err(unsupported_extension(&path, &format!(".{extension}")));
        }
        if writable::same_file(&path, scene) {
            return Err(onto_input(OUTPUT, &path, "scene"));
        }
        writable::check(&path, OUTPUT)?;
        Ok(Self::File(path))
    }

    /// Checks that no frame of `frames` replaces a file that is read, under any name.
    ///
    /// # Errors
    /// One does; `what` is that file.
    pub(super) fn check_input(
        &self,
        input: &Path,
        what: &str,
        frames: &FrameRange,
    ) -> anyhow::Result<()> {
        let check = |path: &Path| {
            if writable::same_place(path, input) {
                return Err(onto_input(OUTPUT, path, what));
            }
            Ok(())
        };
        match self {
            Self::File(path) => check(path),
            Self::Stdout if fs::metadata(input).is_ok_and(|file| is_stdout(&file)) => {
                Err(stdout_onto_input(input, what))
            }
            Self::Stdout | Self::Device(_) => Ok(()),
            Self::Sequence(pattern) => {
                let target = fs::canonicalize(input).unwrap_or_else(|_| input.to_owned());
                let names = [input, &target].into_iter().filter_map(Path::file_name);
                let numbers = names.filter_map(|name| pattern.number(name.as_encoded_bytes()));
                let mut written = numbers.filter(|&number| frames.contains(number));
                written.try_for_each(|number| check(&pattern.file(number)))
            }
        }
    }

    /// The file that a frame goes to.
    pub(super) fn file(&self, number: i64) -> PathBuf {
        match self {
            Self::Stdout => "-".into(),
            Self::File(path) | Self::Device(path) => path.clone(),
            Self::Sequence(pattern) => pattern.file(number),
        }
    }

    /// Writes a picture: a file whole or not at all.
    ///
    /// # Errors
    /// What the system returns.
    pub(super) fn write(&self, bytes: &[u8]) -> anyhow::Result<()> {
        let written = match self {
            Self::File(path) => write_whole(path, |file| file.write_all(bytes)),
            _ => self
                .open()
                .and_then(|mut open| open.file().write_all(bytes)),
        };
        written.map_err(|error| self.error("picture", error))
    }

    /// Opens the destination to be written piece by piece.
    ///
    /// # Errors
    /// What the system returns.
    pub(super) fn open(&self) -> io::Result<OpenDestination> {
        match self {
            Self::Stdout => stdout().map(OpenDestination::Direct),
            Self::Device(path) => {
                let file = OpenOptions::new().write(true).open(path)?;
                Ok(OpenDestination::Direct(file))
            }
            Self::File(path) => Unfinished::after_leftovers(path).map(OpenDestination::Unfinished),
            Self::Sequence(_) => Err(io::ErrorKind::IsADirectory.into()),
        }
    }

    /// The error of a destination that cannot be written; `what` is the picture or the film.
    pub(super) fn error(&self, what: &str, error: io::Error) -> anyhow::Error {
        match self {
            Self::Stdout => StdoutError(error).into(),
            // The reader of a named pipe closed its end.
            Self::Device(_) if error.kind() == io::ErrorKind::BrokenPipe => {
                StdoutError(error).into()
            }
            _ => anyhow::anyhow!("{self}: the {what} cannot be written: {error}"),
        }
    }
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stdout => write!(f, "standard output"),
            Self::File(path) | Self::Device(path) => write!(f, "{}", path.display()),
            Self::Sequence(pattern) => pattern.fmt(f),
        }
    }
}

/// A destination that is being written.
#[derive(Debug)]
pub(super) enum OpenDestination {
    Direct(File),
    Unfinished(Unfinished),
}

impl OpenDestination {
    /// The file to write to.
    pub(super) fn file(&mut self) -> &mut File {
        match self {
            Self::Direct(file) => file,
            Self::Unfinished(unfinished) => unfinished.file(),
        }
    }

    /// Gives a file its name, now that it is whole.
    ///
    /// # Errors
    /// What the system returns.
    pub(super) fn finish(self) -> io::Result<()> {
        match self {
            Self::Direct(_) => Ok(()),
            Self::Unfinished(unfinished) => unfinished.finish(),
        }
    }
}

/// Whether a path has an extension, in any case.
pub(super) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|its| its.eq_ignore_ascii_case(extension))
}

/// The error of a path with another extension than those of `expected`.
pub(super) fn unsupported_extension(path: &Path, expected: &str) -> anyhow::Error {
    misuse(format!(
        "{}: unsupported extension; expected {expected}",
        path.display()
    ))
}

/// The error of an output that would replace an input.
pub(super) fn onto_input(option: &str, path: &Path, what: &str) -> anyhow::Error {
    misuse(format!(
        "{}: {option} names the {what} that is read; choose another file for the output",
        path.display()
    ))
}

/// The error of a standard output that is redirected to an input.
pub(super) fn stdout_onto_input(input: &Path, what: &str) -> anyhow::Error {
    misuse(format!(
        "{}: the standard output goes to this file, the {what} that is read; send it elsewhere",
        input.display()
    ))
}
