//! Where a picture goes.

use std::fmt;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::{Misuse, StdoutError, target};
use crate::output::write_whole;

/// Where a picture goes, checked.
#[derive(Debug)]
pub(super) enum Destination {
    Stdout,
    File(PathBuf),
}

impl Destination {
    /// The place `path`, for a picture of that ending, with its dot, that is made of `scene`; - is the standard output.
    ///
    /// # Errors
    /// What stands in the way of a picture there.
    pub(super) fn checked(
        path: PathBuf,
        ending: &'static str,
        scene: &Path,
    ) -> anyhow::Result<Self> {
        if path == Path::new("-") {
            return Ok(Self::Stdout);
        }
        let has_ending = path
            .extension()
            .is_some_and(|its| its.eq_ignore_ascii_case(&ending[1..]));
        if !has_ending {
            return Err(Misuse::Ending {
                path,
                endings: ending,
            }
            .into());
        }
        if target::same_file(&path, scene) {
            return Err(Misuse::OntoInput {
                option: target::OUTPUT,
                path,
                what: "scene",
            }
            .into());
        }
        target::check(&path, target::OUTPUT)?;
        Ok(Self::File(path))
    }

    /// Writes a picture's bytes: a file whole or not at all.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write(&self, bytes: &[u8]) -> anyhow::Result<()> {
        match self {
            Self::File(path) => write_whole(path, |file| file.write_all(bytes)).map_err(|error| {
                anyhow::anyhow!("{}: the picture cannot be written: {error}", path.display())
            }),
            Self::Stdout => {
                stdout()
                    .and_then(|mut stdout| stdout.write_all(bytes))
                    .map_err(StdoutError)?;
                Ok(())
            }
        }
    }
}

/// The standard output without the buffer that looks for line ends in it, and that takes it for a success where there is
/// none.
///
/// # Errors
/// What the system says.
pub(super) fn stdout() -> io::Result<File> {
    #[cfg(unix)]
    let owned = std::os::fd::AsFd::as_fd(&io::stdout()).try_clone_to_owned()?;
    #[cfg(windows)]
    let owned = std::os::windows::io::AsHandle::as_handle(&io::stdout()).try_clone_to_owned()?;
    Ok(File::from(owned))
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stdout => write!(f, "standard output"),
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}
