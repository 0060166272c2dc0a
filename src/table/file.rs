//! A table's bytes: mapped from a file, or in memory.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use memmap2::{Mmap, MmapOptions};

use super::format::{self, FormatError, Head, Metadata};
use super::lookup::Lookup;
use crate::orbit::{Event, OrbitError, Orbits, Ray, TurningPoint};

/// A table of swept angles. [`Orbits`] says what it answers.
///
/// ```no_run
/// use darkness::orbit::Ray;
/// use darkness::table::Table;
///
/// let table = Table::open("tables/standard.table")?;
/// let ray = Ray::from_impact_parameter(30.0, 5.0)?;
/// for event in table.trace(ray, &[3.0, 12.0])? {
///     println!("{:?} at r = {}, φ = {}", event.kind, event.radius, event.angle);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Table {
    bytes: TableBytes,
    head: Head,
}

/// The bytes of a table, aligned for its numbers.
#[derive(Debug)]
enum TableBytes {
    Mapped(Mmap),
    Owned(Vec<u64>),
}

/// Why a table's file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// There is no such file.
    #[error("{}: there is no table there", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read.
    #[error("{}: the table cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file is not a table that this version can use.
    #[error("{}: this table cannot be used: {problem}", path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: FormatError,
    },
    /// The file cannot be written.
    #[error("{}: the table cannot be written: {source}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

impl Table {
    /// Maps the table at `path` and checks every byte of it.
    ///
    /// The file must not be changed or cut short in place while the table is in use: reading a page that has been cut
    /// off ends the process with a signal (SIGBUS). Replacing the file by renaming another over it is safe, and is
    /// what [`save`](Self::save) does. Use [`read`](Self::read) for files that others may change, and for network
    /// disks.
    ///
    /// # Errors
    /// [`TableError`]: the file is missing, cannot be read, or is not a table that this version can use. A file of
    /// the wrong length, or without a table's head, is not mapped.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, TableError> {
        let path = path.as_ref();
        let opened = OpenedFile::new(path)?;
        // SAFETY: the map is read-only and private to this process, and lives as long as the table over it. The
        // contract is that nobody changes the file's bytes in place meanwhile; this crate replaces tables by
        // renaming, which leaves a mapped file as it was.
        #[allow(unsafe_code)]
        let map = unsafe { MmapOptions::new().populate().map(&opened.file) };
        let map = map.map_err(|error| unreadable(path, error))?;
        if map.len() != opened.length || !map.starts_with(&opened.start) {
            return Err(unusable(path, FormatError::Changed));
        }
        Self::checked(TableBytes::Mapped(map), opened.head)
            .map_err(|problem| unusable(path, problem))
    }

    /// Reads the table at `path` into memory and checks every byte of it. The table does not depend on the file
    /// afterwards.
    ///
    /// # Errors
    /// Those of [`open`](Self::open).
    pub fn read(path: impl AsRef<Path>) -> Result<Self, TableError> {
        let path = path.as_ref();
        let mut opened = OpenedFile::new(path)?;
        let mut words = Vec::new();
        words
            .try_reserve_exact(opened.length / 8)
            .map_err(|_| unreadable(path, io::ErrorKind::OutOfMemory.into()))?;
        words.resize(opened.length / 8, 0_u64);
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
        let (start, rest) = bytes.split_at_mut(opened.start.len());
        start.copy_from_slice(&opened.start);
        opened
            .file
            .read_exact(rest)
            .map_err(|error| match error.kind() {
                io::ErrorKind::UnexpectedEof => unusable(path, FormatError::Changed),
                _ => unreadable(path, error),
            })?;
        Self::checked(TableBytes::Owned(words), opened.head)
            .map_err(|problem| unusable(path, problem))
    }

    /// Copies a table from the bytes of its file, every one of which is checked (see [`mod@format`]).
    ///
    /// # Errors
    /// [`FormatError`]: what is wrong with the bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FormatError> {
        let start = &bytes[..bytes.len().min(format::LONGEST_HEAD)];
        let head = format::head(start, bytes.len() as u64)?;
        // A table's length is a multiple of 8: its head has been checked.
        let mut words = vec![0_u64; bytes.len() / 8];
        bytemuck::cast_slice_mut(&mut words).copy_from_slice(bytes);
        Self::checked(TableBytes::Owned(words), head)
    }

    /// Puts a table together from its head and all its bytes, whose numbers are yet to be checked.
    fn checked(bytes: TableBytes, head: Head) -> Result<Self, FormatError> {
        let table = Self { bytes, head };
        table.head.check_numbers(table.bytes())?;
        Ok(table)
    }

    /// Puts a table together from numbers made for `metadata`; `None` where the metadata is too long.
    pub(super) fn from_numbers(metadata: Metadata, numbers: &[f64]) -> Option<Self> {
        let numbers: &[u8] = bytemuck::cast_slice(numbers);
        let (header, head) = format::header(metadata, numbers)?;
        let mut words = vec![0_u64; (header.len() + numbers.len()) / 8];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
        bytes[..header.len()].copy_from_slice(&header);
        bytes[header.len()..].copy_from_slice(numbers);
        Some(Self {
            bytes: TableBytes::Owned(words),
            head,
        })
    }

    /// Writes the table to `path`, whole or not at all. Missing folders are created.
    ///
    /// # Errors
    /// [`TableError::Unwritable`]; then whatever was at `path` is unchanged.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), TableError> {
        let path = path.as_ref();
        crate::output::write_whole(path, |file| file.write_all(self.bytes())).map_err(|source| {
            TableError::Unwritable {
                path: path.into(),
                source,
            }
        })
    }

    /// Returns the table's specification and measured error.
    pub fn metadata(&self) -> &Metadata {
        &self.head.metadata
    }

    /// Returns the bytes of the table's file.
    pub fn bytes(&self) -> &[u8] {
        match &self.bytes {
            TableBytes::Mapped(map) => map,
            TableBytes::Owned(words) => bytemuck::cast_slice(words),
        }
    }

    /// Returns the table ready for lookups. Call it once, outside the loop.
    pub fn lookup(&self) -> Lookup<'_> {
        let numbers = format::numbers(self.bytes(), self.head.numbers_at);
        let metadata = self.metadata();
        Lookup::new(&metadata.spec, numbers, metadata.measured_error)
    }

    /// Returns what happens to `ray`: its crossings of `radii` (Schwarzschild radii, above 1), in the order in which
    /// they happen, then its capture or escape. The same as [`Orbits::follow`].
    ///
    /// ```
    /// use darkness::orbit::{EventKind, Fate, Ray};
    /// use darkness::table::{Spec, Table};
    ///
    /// let table = Table::generate(&Spec::draft())?;
    /// let ray = Ray::from_impact_parameter(30.0, 5.0)?;
    /// let events = table.trace(ray, &[3.0, 12.0])?;
    /// // In through r = 12, out through r = 12, then away: the periapsis is above r = 3.
    /// assert_eq!(events.len(), 3);
    /// assert_eq!(events[2].kind, EventKind::End(Fate::Escape));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`OrbitError::Radius`] for a radius that is not above 1 or is beyond 1e100.
    pub fn trace(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError> {
        self.lookup().follow(ray, radii)
    }
}

impl Orbits for Table {
    fn follow(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError> {
        self.trace(ray, radii)
    }

    fn turning_point(&self, ray: Ray) -> Result<Option<TurningPoint>, OrbitError> {
        self.lookup().turning_point(ray)
    }

    fn first_crossing(&self, ray: Ray, radius: f64) -> Result<Option<f64>, OrbitError> {
        self.lookup().first_crossing(ray, radius)
    }

    fn u_at_angle(&self, ray: Ray, angle: f64) -> Result<Option<f64>, OrbitError> {
        self.lookup().u_at_angle(ray, angle)
    }
}

/// A table's file whose head has been read and checked. The file stands after `start`.
struct OpenedFile {
    file: File,
    length: usize,
    /// The file's first bytes, the head within them.
    start: Vec<u8>,
    head: Head,
}

impl OpenedFile {
    /// Opens the file and checks everything before its numbers, so that other files are neither mapped nor read to
    /// their end, however long they are.
    fn new(path: &Path) -> Result<Self, TableError> {
        let unreadable = |error| unreadable(path, error);
        // Before opening, since opening a pipe waits for its other end.
        let kind = std::fs::metadata(path).map_err(unreadable)?;
        if !kind.is_file() {
            let kind = if kind.is_dir() {
                "folder"
            } else {
                "pipe, a socket or a device"
            };
            return Err(unusable(path, FormatError::NoFile { kind }));
        }
        let file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let mut start = Vec::with_capacity(format::LONGEST_HEAD);
        (&file)
            .take(format::LONGEST_HEAD as u64)
            .read_to_end(&mut start)
            .map_err(unreadable)?;
        let head = format::head(&start, length).map_err(|problem| unusable(path, problem))?;
        let length = usize::try_from(length).map_err(|_| unusable(path, FormatError::Changed))?;
        if start.len() > length {
            return Err(unusable(path, FormatError::Changed));
        }
        Ok(Self {
            file,
            length,
            start,
            head,
        })
    }
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
