//! Why a star catalogue, or a row of it, is refused.

use std::path::PathBuf;
use std::{fmt, io};

/// A line has at most so many bytes.
pub(super) const LONGEST_LINE: usize = 1 << 16;

/// Why a star catalogue is refused.
#[derive(Debug, thiserror::Error)]
#[error("star catalogue {}: {fault}", path.display())]
pub struct CatalogueError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub fault: CatalogueFault,
}

/// What is wrong with a star catalogue.
#[derive(Debug, thiserror::Error)]
pub enum CatalogueFault {
    /// The file cannot be read.
    #[error("the file cannot be read: {0}")]
    Read(#[from] io::Error),
    /// It is a folder, a device or a pipe.
    #[error("this is not a regular file; give a CSV file")]
    NotAFile,
    /// A line is so long that this cannot be a catalogue.
    #[error("line {0} is longer than {LONGEST_LINE} bytes; give a CSV file with one star per line")]
    LongLine(u64),
    /// There is no header.
    #[error(
        "the file is empty; its first line must name the columns, such as ra,dec,magnitude,temperature"
    )]
    NoHeader,
    /// The header is not a line of text.
    #[error("line {line}, the header, is not valid ({reason}); save the file as CSV in UTF-8")]
    BadHeader {
        /// Its line.
        line: u64,
        /// What is wrong.
        reason: String,
    },
    /// The header lacks a column.
    #[error(
        "line {line}, the header, has no column {column}; \
         it must name ra, dec, magnitude, and temperature or bv, separated by commas"
    )]
    NoColumn {
        /// The header's line.
        line: u64,
        /// The column.
        column: &'static str,
    },
    /// Two columns have the same meaning.
    #[error("line {line}, the header, names the column {column} twice; rename one of them")]
    TwoColumns {
        /// The header's line.
        line: u64,
        /// The column.
        column: &'static str,
    },
    /// No row is valid.
    #[error(
        "no row is a star; {}",
        .0.as_ref().map_or("add a line for each star below the header".into(), ToString::to_string)
    )]
    NoStar(Option<BadRow>),
    /// The stars need too much memory.
    #[error(
        "reading more than {stars} stars needs over {bytes} bytes; lower the magnitude limit or allow more memory"
    )]
    TooManyStars {
        /// The number of stars that fit.
        stars: usize,
        /// The memory that was allowed.
        bytes: u64,
    },
}

/// A row that is skipped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadRow {
    /// Its line in the file, counted from 1.
    pub line: u64,
    /// What is wrong with it.
    pub reason: String,
}

impl fmt::Display for BadRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.reason)
    }
}

/// The rows that are skipped.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct BadRows {
    /// Their number.
    pub count: u64,
    /// The first twenty of them.
    pub first: Vec<BadRow>,
}
