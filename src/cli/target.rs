//! Whether a file can be written, found out before the work that makes its content.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
pub(super) enum TargetError {
    #[error("{}: the folder {} does not exist; make it first, or choose another place with -o", path.display(), folder.display())]
    NoFolder { path: PathBuf, folder: PathBuf },
    #[error("{}: {} is no folder; choose another place with -o", path.display(), folder.display())]
    NotAFolder { path: PathBuf, folder: PathBuf },
    #[error("{} is a folder; give -o a file's name", path.display())]
    IsAFolder { path: PathBuf },
    #[error("{} is no regular file, and would be replaced by one; choose another place with -o", path.display())]
    Special { path: PathBuf },
    #[error("{}: nothing can be written to the folder {} ({source}); choose another place with -o", path.display(), folder.display())]
    Unwritable {
        path: PathBuf,
        folder: PathBuf,
        source: io::Error,
    },
}

/// Checks that `path` can be written, in a folder that exists.
///
/// # Errors
/// [`TargetError`]: why it cannot.
pub(super) fn check(path: &Path) -> Result<(), TargetError> {
    check_within(path, folder_of(path))
}

/// Checks that `path` can be written, its folder being made where it is missing.
///
/// # Errors
/// [`TargetError`]: why it cannot.
pub(super) fn check_with_parents(path: &Path) -> Result<(), TargetError> {
    let existing = folder_of(path)
        .ancestors()
        .map(or_current)
        .find(|folder| folder.exists());
    check_within(path, existing.unwrap_or(Path::new(".")))
}

/// The folder that holds `path`.
fn folder_of(path: &Path) -> &Path {
    or_current(path.parent().unwrap_or(path))
}

/// The current folder where a path is cut down to nothing.
fn or_current(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    }
}

fn check_within(path: &Path, folder: &Path) -> Result<(), TargetError> {
    let (to, place) = (path.to_owned(), folder.to_owned());
    match fs::metadata(path) {
        Ok(kind) if kind.is_dir() => return Err(TargetError::IsAFolder { path: to }),
        // Files are replaced by renaming: a device or a pipe of that name would be gone.
        Ok(kind) if !kind.is_file() => return Err(TargetError::Special { path: to }),
        _ => {}
    }
    let unwritable = |source| TargetError::Unwritable {
        path: to.clone(),
        folder: place.clone(),
        source,
    };
    match fs::metadata(folder) {
        Ok(kind) if kind.is_dir() => {}
        Ok(_) => {
            return Err(TargetError::NotAFolder {
                path: to,
                folder: place,
            });
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(TargetError::NoFolder {
                path: to,
                folder: place,
            });
        }
        Err(error) => return Err(unwritable(error)),
    }
    // Rights, full disks and read-only mounts are the system's to judge: a nameless file asks it and leaves nothing
    // behind.
    tempfile::tempfile_in(folder).map_err(unwritable)?;
    Ok(())
}

/// Whether both paths lead to one file that exists.
pub(super) fn same_file(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
