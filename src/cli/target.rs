//! Whether a file can be written, found out before the work that makes its content.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use bytesize::ByteSize;

/// The option that names where things go, in every verb.
pub(super) const OUTPUT: &str = "-o";

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
pub(super) enum TargetError {
    #[error("{}: the folder {} does not exist; make it first, or choose another place with {option}", path.display(), folder.display())]
    NoFolder {
        path: PathBuf,
        folder: PathBuf,
        option: &'static str,
    },
    #[error("{}: {} is no folder; choose another place with {option}", path.display(), folder.display())]
    NotAFolder {
        path: PathBuf,
        folder: PathBuf,
        option: &'static str,
    },
    #[error("{} is a folder; give {option} a file's name", path.display())]
    IsAFolder { path: PathBuf, option: &'static str },
    #[error("{} is no regular file, and would be replaced by one; choose another place with {option}", path.display())]
    Special { path: PathBuf, option: &'static str },
    #[error("{}: about {} are needed there, and {} are free: make room, choose another place with -o, or fewer frames with --frames", folder.display(), ByteSize(*bytes).display().si(), ByteSize(*room).display().si())]
    NoRoom {
        folder: PathBuf,
        bytes: u64,
        room: u64,
    },
    #[error("{}: nothing can be written to the folder {} ({source}); choose another place with {option}", path.display(), folder.display())]
    Unwritable {
        path: PathBuf,
        folder: PathBuf,
        option: &'static str,
        source: io::Error,
    },
}

/// Checks that `path`, which `option` names, can be written, in a folder that exists.
///
/// # Errors
/// [`TargetError`]: why it cannot.
pub(super) fn check(path: &Path, option: &'static str) -> Result<(), TargetError> {
    check_within(path, folder_of(path), option)
}

/// Checks that `path` can be written, its folder being made where it is missing.
///
/// # Errors
/// [`TargetError`]: why it cannot.
pub(super) fn check_with_parents(path: &Path) -> Result<(), TargetError> {
    check_within(path, existing(folder_of(path)), OUTPUT)
}

/// The folder, or the nearest above it that is there.
fn existing(folder: &Path) -> &Path {
    let mut folders = folder.ancestors().map(or_current);
    folders
        .find(|folder| folder.exists())
        .unwrap_or(Path::new("."))
}

/// Checks that files can be written to a folder, which is made where it is missing.
///
/// # Errors
/// [`TargetError`]: why they cannot.
pub(super) fn check_folder(folder: &Path) -> Result<(), TargetError> {
    let folder = or_current(folder);
    check_writable(folder, existing(folder), OUTPUT)
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

fn check_within(path: &Path, folder: &Path, option: &'static str) -> Result<(), TargetError> {
    let to = || path.to_owned();
    match fs::metadata(path) {
        Ok(kind) if kind.is_dir() => Err(TargetError::IsAFolder { path: to(), option }),
        // Files are replaced by renaming: a device or a pipe of that name would be gone.
        Ok(kind) if !kind.is_file() => Err(TargetError::Special { path: to(), option }),
        _ => check_writable(path, folder, option),
    }
}

/// Checks that files can be made in a folder; `path` is what is to be there.
fn check_writable(path: &Path, folder: &Path, option: &'static str) -> Result<(), TargetError> {
    let (to, place) = (path.to_owned(), folder.to_owned());
    let unwritable = |source| TargetError::Unwritable {
        path: to.clone(),
        folder: place.clone(),
        option,
        source,
    };
    match fs::metadata(folder) {
        Ok(kind) if kind.is_dir() => {}
        Ok(_) => {
            return Err(TargetError::NotAFolder {
                path: to,
                folder: place,
                option,
            });
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(TargetError::NoFolder {
                path: to,
                folder: place,
                option,
            });
        }
        Err(error) => return Err(unwritable(error)),
    }
    // Rights, full disks and read-only mounts are the system's to judge: a nameless file asks it and leaves nothing
    // behind.
    tempfile::tempfile_in(folder).map_err(unwritable)?;
    Ok(())
}

/// How much room there is for files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Room {
    /// So many bytes.
    Known(u64),
    /// The system does not say.
    Unknown,
}

/// The room for files in a folder; the current one if it has no name.
pub(super) fn room(folder: &Path) -> Room {
    #[cfg(unix)]
    if let Ok(disk) = rustix::fs::statvfs(or_current(folder)) {
        return Room::Known(disk.f_bavail.saturating_mul(disk.f_frsize));
    }
    #[cfg(not(unix))]
    let _ = folder;
    Room::Unknown
}

/// Checks that there is room for so many bytes beside `path`.
///
/// # Errors
/// [`TargetError::NoRoom`]
pub(super) fn check_room(path: &Path, bytes: u64) -> Result<(), TargetError> {
    match room(folder_of(path)) {
        Room::Known(room) if bytes > room => Err(TargetError::NoRoom {
            folder: folder_of(path).to_owned(),
            bytes,
            room,
        }),
        _ => Ok(()),
    }
}

/// Whether both paths lead to one file that exists.
pub(super) fn same_file(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}

/// Whether the standard output goes to this file.
pub(super) fn is_stdout(file: &fs::Metadata) -> bool {
    #[cfg(unix)]
    if let Ok(stdout) = super::picture::stdout().and_then(|stdout| stdout.metadata()) {
        use std::os::unix::fs::MetadataExt;
        let place = |file: &fs::Metadata| (file.dev(), file.ino());
        return file.is_file() && place(file) == place(&stdout);
    }
    #[cfg(not(unix))]
    let _ = file;
    false
}

/// What a path leads to by links, be there a file or not.
fn led_to(path: &Path) -> PathBuf {
    // As many as systems follow.
    const MOST_LINKS: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(link) = fs::read_link(&path) else {
            break;
        };
        path = folder_of(&path).join(link);
    }
    path
}

/// Whether both paths name one place, be there a file or not.
pub(super) fn same_place(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        let path = led_to(path);
        Some((
            fs::canonicalize(folder_of(&path)).ok()?,
            path.file_name()?.to_owned(),
        ))
    };
    same_file(a, b) || (place(a).is_some() && place(a) == place(b))
}
