//! Whether a file can be written, checked before the work that makes its content.

use std::fs;
use std::path::Path;

use anyhow::bail;
use bytesize::ByteSize;

use crate::output::{check_writable, led_to};

/// The option that names the output, in every verb.
pub(super) const OUTPUT: &str = "-o";

/// Checks that files can be written to a folder, which is made where it is missing.
///
/// # Errors
/// Why they cannot.
pub(super) fn check_folder(folder: &Path) -> anyhow::Result<()> {
    let folder = or_current(folder);
    // Links that lead in a circle are the system's to refuse.
    let led_to = led_to(folder).unwrap_or_else(|_| folder.to_owned());
    check_folder_of(existing(&led_to), folder, OUTPUT)
}

/// The folder, or the nearest above it that exists.
fn existing(folder: &Path) -> &Path {
    let mut folders = folder.ancestors().map(or_current);
    folders
        .find(|folder| folder.exists())
        .unwrap_or(Path::new("."))
}

/// The folder that holds `path`.
fn folder_of(path: &Path) -> &Path {
    or_current(path.parent().unwrap_or(path))
}

/// `folder`, or the current one for an empty path.
fn or_current(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    }
}

/// Checks that `path`, which `option` names, can be written. Its folder is made where it is missing, later.
///
/// # Errors
/// Why it cannot.
pub(super) fn check(path: &Path, option: &str) -> anyhow::Result<()> {
    match fs::metadata(path) {
        Ok(kind) if kind.is_dir() => bail!(
            "{} is a folder; give {option} a file's name",
            path.display()
        ),
        // A file is replaced by renaming, which would remove a device or a pipe.
        Ok(kind) if !kind.is_file() => bail!(
            "{} is not a regular file; choose another file with {option}",
            path.display()
        ),
        _ => {}
    }
    let cannot = |error| {
        anyhow::anyhow!(
            "{}: the file cannot be written ({error}); choose another file with {option}",
            path.display()
        )
    };
    // The file that a link leads to is the one that is written.
    let led_to = led_to(path).map_err(cannot)?;
    if led_to.exists() {
        check_writable(&led_to).map_err(cannot)?;
    }
    check_folder_of(existing(folder_of(&led_to)), path, option)
}

/// Checks that files can be made in `folder`, for `path`.
fn check_folder_of(folder: &Path, path: &Path, option: &str) -> anyhow::Result<()> {
    let (name, place) = (path.display(), folder.display());
    let made = match fs::metadata(folder) {
        Ok(kind) if !kind.is_dir() => {
            bail!("{name}: {place} is not a folder; choose another place with {option}")
        }
        // Rights, full disks and read-only mounts are the system's to judge: a nameless file leaves nothing behind.
        Ok(_) => tempfile::tempfile_in(folder).map(drop),
        Err(error) => Err(error),
    };
    made.map_err(|error| {
        anyhow::anyhow!(
            "{name}: the folder {place} cannot be written ({error}); choose another place with {option}"
        )
    })
}

/// The free space for files in a folder, in bytes, where the system says it.
pub(super) fn free_space(folder: &Path) -> Option<u64> {
    #[cfg(unix)]
    if let Ok(disk) = rustix::fs::statvfs(or_current(folder)) {
        return Some(disk.f_bavail.saturating_mul(disk.f_frsize));
    }
    #[cfg(not(unix))]
    let _ = folder;
    None
}

/// Checks that there is room for `bytes` beside `path`.
///
/// # Errors
/// There is not.
pub(super) fn check_space(path: &Path, bytes: u64) -> anyhow::Result<()> {
    let folder = existing(folder_of(path));
    match free_space(folder) {
        Some(free) if bytes > free => bail!(
            "{}: about {} are needed there, and {} are free; make room, choose another place with -o, or fewer frames \
             with --frames",
            folder.display(),
            ByteSize(bytes).display().si(),
            ByteSize(free).display().si()
        ),
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

/// Whether both paths lead to the same place, whether or not a file exists there.
pub(super) fn same_place(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        let path = led_to(path).ok()?;
        let folder = folder_of(&path);
        let there = existing(folder);
        let below = folder.strip_prefix(there).unwrap_or(folder);
        Some(
            fs::canonicalize(there)
                .ok()?
                .join(below)
                .join(path.file_name()?),
        )
    };
    same_file(a, b) || (place(a).is_some() && place(a) == place(b))
}
