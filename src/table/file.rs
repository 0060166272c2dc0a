//! Tables in files: mapped where they are read, written whole or not at all.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use memmap2::Mmap;

use super::format::FormatError;
use super::spec::Spec;
use super::{FixedBytes, Table};

/// Why a table's file could not be used or written. Each names the file, and says what to do.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// There is no such file.
    #[error("{}: there is no table there; make it with `{}`", path.display(), remedy(path, false))]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read.
    #[error("{}: the table cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is no usable table.
    #[error("{}: this table cannot be used: {problem}. {}", path.display(), mend(path, problem))]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: FormatError,
    },
    /// The file cannot be written.
    #[error("{}: the table cannot be written: {source}. Choose another place with -o, or make room or rights there", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// The command that makes the table at `path`: the specification that the file is named after, else the default one.
fn remedy(path: &Path, force: bool) -> String {
    let stem = path
        .file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or_default();
    let name = Spec::NAMES
        .into_iter()
        .find(|&name| name == stem)
        .unwrap_or("standard");
    let force = if force { " --force" } else { "" };
    if default_path(name) == path {
        format!("darkness table {name}{force}")
    } else {
        let quoted = path.display().to_string().replace('\'', "'\\''");
        format!("darkness table {name}{force} -o '{quoted}'")
    }
}

/// What to do about a file that is no usable table. One that is somebody else's is not to be written over unawares,
/// unless it lies where a table is to be.
fn mend(path: &Path, problem: &FormatError) -> String {
    let kept = Spec::NAMES.iter().any(|name| default_path(name) == path);
    if *problem == FormatError::Foreign && !kept {
        format!(
            "Name another file, or let a table take the place of this one with `{}`",
            remedy(path, true)
        )
    } else {
        format!("Make it anew with `{}`", remedy(path, true))
    }
}

/// Where the table of a specification is kept: `tables/NAME.table` under the current folder.
pub fn default_path(name: &str) -> PathBuf {
    Path::new("tables").join(format!("{name}.table"))
}

/// Maps the table at `path` and checks every byte of it.
///
/// The file must not be changed while it is mapped; this program never does, since it replaces files by renaming.
///
/// # Errors
/// [`TableError`]: the file is missing, cannot be read, or is no table that this version can use.
pub fn open(path: &Path) -> Result<Table<Mmap>, TableError> {
    let unreadable = |source: io::Error| match source.kind() {
        io::ErrorKind::NotFound => TableError::Missing { path: path.into() },
        _ => TableError::Unreadable {
            path: path.into(),
            source,
        },
    };
    // Asked before it is opened: to open a pipe is to wait for its other end.
    let kind = std::fs::metadata(path).map_err(unreadable)?;
    if !kind.is_file() {
        let source = io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file");
        return Err(unreadable(source));
    }
    let file = File::open(path).map_err(unreadable)?;
    let unusable = |problem| TableError::Unusable {
        path: path.into(),
        problem,
    };
    if kind.len() == 0 {
        // An empty file cannot be mapped on every system.
        return Err(unusable(FormatError::Foreign));
    }
    // SAFETY: the map is read-only and private to this process, and lives as long as the table over it. The contract
    // is that nobody changes the file's bytes in place meanwhile; this program replaces tables by renaming, which
    // leaves a mapped file as it was.
    #[allow(unsafe_code)]
    let map = unsafe { Mmap::map(&file) }.map_err(unreadable)?;
    Table::from_bytes(map).map_err(unusable)
}

/// Writes a table to `path`, whole or not at all; its folder is made where it is missing.
///
/// # Errors
/// [`TableError::Unwritable`]; then `path` is as it was.
pub fn save<B: FixedBytes>(table: &Table<B>, path: &Path) -> Result<(), TableError> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| crate::output::write_whole(path, |file| file.write_all(table.bytes())))
        .map_err(|source| TableError::Unwritable {
            path: path.into(),
            source,
        })
}
