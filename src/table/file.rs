//! Tables in files: mapped where they are read, written whole or not at all.

use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

use memmap2::{Mmap, MmapOptions};

use super::format::{self, FormatError};
use super::spec::Spec;
use super::{FixedBytes, Memory, Table};

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
    match path.to_str() {
        _ if default_path(name) == path => format!("darkness table {name}{force}"),
        Some(path) => {
            let quoted = path.replace('\'', "'\\''");
            format!("darkness table {name}{force} -o '{quoted}'")
        }
        // What is shown of it would name another file.
        None => format!("darkness table {name}{force} -o FILE"),
    }
}

/// What to do about a file that is no usable table. One that is somebody else's is not to be written over unawares,
/// unless it lies where a table is to be.
fn mend(path: &Path, problem: &FormatError) -> String {
    let kept = Spec::NAMES.iter().any(|name| default_path(name) == path);
    if matches!(problem, FormatError::NoFile { .. }) {
        "Name a table's file".into()
    } else if *problem == FormatError::Foreign && !kept {
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

/// Maps the table at `path` and checks every byte of it. A file that is too long or too short, or none of a table, is not mapped.
///
/// The file must not be changed or cut short in place while it is mapped: what is cut off is a signal that ends the process
/// (SIGBUS). This program never does it, since it replaces files by renaming, which leaves a mapped one as it was. For
/// files that others may change, and for network disks, [`read`] is there.
///
/// # Errors
/// [`TableError`]: the file is missing, cannot be read, or is no table that this version can use.
pub fn open(path: &Path) -> Result<Table<Mmap>, TableError> {
    let (file, _) = sized(path)?;
    // SAFETY: the map is read-only and private to this process, and lives as long as the table over it. The contract
    // is that nobody changes the file's bytes in place meanwhile; this program replaces tables by renaming, which
    // leaves a mapped file as it was.
    #[allow(unsafe_code)]
    let map = unsafe { MmapOptions::new().populate().map(&file) };
    let map = map.map_err(|error| unreadable(path, error))?;
    Table::from_bytes(map).map_err(|problem| unusable(path, problem))
}

/// Reads the table at `path` into memory and checks every byte of it: whatever becomes of the file then, the table stays.
///
/// # Errors
/// Those of [`open`].
pub fn read(path: &Path) -> Result<Table<Memory>, TableError> {
    let (file, length) = sized(path)?;
    let mut words = Vec::new();
    words
        .try_reserve_exact(length.div_ceil(8))
        .map_err(|_| unreadable(path, io::ErrorKind::OutOfMemory.into()))?;
    words.resize(length.div_ceil(8), 0_u64);
    let bytes = &mut bytemuck::cast_slice_mut(&mut words)[..length];
    let cut_short = |error: io::Error| match error.kind() {
        io::ErrorKind::UnexpectedEof => unusable(path, FormatError::Changed),
        _ => unreadable(path, error),
    };
    (&file).read_exact(bytes).map_err(cut_short)?;
    if !length.is_multiple_of(8) {
        let what = "its numbers do not have eight bytes each";
        return Err(unusable(path, FormatError::Damaged { what }));
    }
    Table::from_bytes(Memory(words)).map_err(|problem| unusable(path, problem))
}

/// A table's file and its length, which is what its first bytes say. All is checked but the numbers: a file that is none of a table is
/// neither mapped nor read to its end, however long it is.
fn sized(path: &Path) -> Result<(File, usize), TableError> {
    let unreadable = |error| unreadable(path, error);
    // Asked before it is opened: to open a pipe is to wait for its other end.
    let kind = std::fs::metadata(path).map_err(unreadable)?;
    if !kind.is_file() {
        let kind = if kind.is_dir() {
            "folder"
        } else {
            "pipe, a socket or a device"
        };
        return Err(unusable(path, FormatError::NoFile { kind }));
    }
    let mut file = File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let mut start = Vec::with_capacity(format::LONGEST_HEAD);
    (&file)
        .take(format::LONGEST_HEAD as u64)
        .read_to_end(&mut start)
        .map_err(unreadable)?;
    format::head(&start, length).map_err(|problem| unusable(path, problem))?;
    file.rewind().map_err(unreadable)?;
    let length = usize::try_from(length).map_err(|_| unusable(path, FormatError::Changed))?;
    Ok((file, length))
}

fn unreadable(path: &Path, source: io::Error) -> TableError {
    let path = path.into();
    match source.kind() {
        io::ErrorKind::NotFound => TableError::Missing { path },
        _ => TableError::Unreadable { path, source },
    }
}

fn unusable(path: &Path, problem: FormatError) -> TableError {
    TableError::Unusable {
        path: path.into(),
        problem,
    }
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
