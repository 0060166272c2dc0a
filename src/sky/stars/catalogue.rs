//! Star catalogues: CSV files.
//!
//! ```text
//! # Lines that start with # are comments.
//! name,ra,dec,magnitude,temperature,bv
//! Sirius,101.287155,-16.716116,-1.44,9940,
//! Betelgeuse,88.792939,7.407063,0.45,,1.50
//! ```
//!
//! The first other line is the header. It names the columns, in any order, in upper or lower case:
//!
//! | column | what it holds |
//! |---|---|
//! | `ra` | right ascension in degrees; any number, wraps at 360° |
//! | `dec` | declination in degrees, −90 to 90 |
//! | `magnitude` or `mag` | visual magnitude, −60 to 60 |
//! | `temperature` or `teff` | temperature in kelvin, 100 to 10⁹ |
//! | `bv` or `b-v` | colour index B−V, −0.4 to 4 |
//!
//! One of the last two columns is enough. Where both are given in a row, the temperature counts; where neither is, the
//! star has [`DEFAULT_TEMPERATURE`]. Other columns are ignored. A row with a mistake is skipped and reported.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use super::record::{LONGEST_LINE, Record};
use super::star::{Star, StarField};
use crate::quotation;

/// The temperature, in kelvin, of a star whose row tells neither temperature nor B−V: about that of the Sun.
pub const DEFAULT_TEMPERATURE: f64 = 5800.0;

/// So many bad rows are kept with their reasons; others are only counted.
const MOST_REPORTED: usize = 20;

/// When the list of stars is full, it moves to another of twice the size: both exist for a moment.
const BYTES_PER_STAR: usize = 3 * size_of::<Star>();

const RIGHT_ASCENSION: &[&str] = &["ra"];
const DECLINATION: &[&str] = &["dec"];
const MAGNITUDE: &[&str] = &["magnitude", "mag"];
const TEMPERATURE: &[&str] = &["temperature", "teff"];
const COLOUR_INDEX: &[&str] = &["bv", "b-v"];

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

impl StarField {
    /// Reads a catalogue. Stars fainter than `magnitude_limit` are dropped. The stars take at most `max_bytes` of
    /// memory.
    ///
    /// # Errors
    /// The file cannot be read, is no regular file, has no valid header, has no valid row, or needs more memory.
    pub fn read(
        path: &Path,
        magnitude_limit: Option<f64>,
        max_bytes: u64,
    ) -> Result<(Self, BadRows), CatalogueError> {
        read(path, magnitude_limit, max_bytes).map_err(|fault| CatalogueError {
            path: path.to_owned(),
            fault,
        })
    }
}

fn read(
    path: &Path,
    magnitude_limit: Option<f64>,
    max_bytes: u64,
) -> Result<(StarField, BadRows), CatalogueFault> {
    // Opening a pipe would wait for a writer.
    if !path.metadata()?.is_file() {
        return Err(CatalogueFault::NotAFile);
    }
    let most_stars = usize::try_from(max_bytes).unwrap_or(usize::MAX) / BYTES_PER_STAR;
    let magnitude_limit = magnitude_limit.unwrap_or(f64::INFINITY);
    let mut lines = Lines::new(File::open(path)?);
    let mut record = Record::new();
    let columns = Columns::read(&mut lines, &mut record)?;
    let mut stars = Vec::new();
    let mut bad_rows = BadRows::default();
    let mut has_good_row = false;
    while lines.next()? {
        let row = record
            .parse(&lines.line)
            .and_then(|()| columns.values(&record));
        match row {
            Ok(row) => {
                has_good_row = true;
                if row.magnitude > magnitude_limit {
                    continue;
                }
                if stars.len() == most_stars {
                    return Err(CatalogueFault::TooManyStars {
                        stars: most_stars,
                        bytes: max_bytes,
                    });
                }
                stars.push(row.star());
            }
            Err(reason) => {
                bad_rows.count += 1;
                if bad_rows.first.len() < MOST_REPORTED {
                    let line = lines.number;
                    bad_rows.first.push(BadRow { line, reason });
                }
            }
        }
    }
    if !has_good_row {
        return Err(CatalogueFault::NoStar(bad_rows.first.into_iter().next()));
    }
    stars.shrink_to_fit();
    Ok((StarField { stars }, bad_rows))
}

/// The lines of a file that are neither blank nor comments.
struct Lines {
    file: BufReader<File>,
    /// The line last read, with a line feed at its end.
    line: Vec<u8>,
    /// Its number, from 1.
    number: u64,
}

impl Lines {
    fn new(file: File) -> Self {
        Self {
            file: BufReader::with_capacity(LONGEST_LINE, file),
            line: Vec::new(),
            number: 0,
        }
    }

    /// Reads the next line. Returns false at the end of the file.
    fn next(&mut self) -> Result<bool, CatalogueFault> {
        loop {
            self.line.clear();
            let length = (&mut self.file)
                .take(LONGEST_LINE as u64)
                .read_until(b'\n', &mut self.line)?;
            if length == 0 {
                return Ok(false);
            }
            self.number += 1;
            if !self.line.ends_with(b"\n") {
                if length == LONGEST_LINE {
                    return Err(CatalogueFault::LongLine(self.number));
                }
                self.line.push(b'\n');
            }
            if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                self.line.drain(..3);
            }
            if !self.line.starts_with(b"#") && !self.line.trim_ascii().is_empty() {
                return Ok(true);
            }
        }
    }
}

/// The index of each column.
struct Columns {
    right_ascension: usize,
    declination: usize,
    magnitude: usize,
    temperature: Option<usize>,
    colour_index: Option<usize>,
}

impl Columns {
    fn read(lines: &mut Lines, record: &mut Record) -> Result<Self, CatalogueFault> {
        if !lines.next()? {
            return Err(CatalogueFault::NoHeader);
        }
        let line = lines.number;
        let bad_header = |reason| CatalogueFault::BadHeader { line, reason };
        if let Err(error) = std::str::from_utf8(&lines.line) {
            return Err(bad_header(error.to_string()));
        }
        if lines.line.contains(&0) {
            return Err(bad_header("it holds zero bytes".into()));
        }
        record.parse(&lines.line).map_err(bad_header)?;
        let find = |names: &[&'static str]| {
            let is_named = |field: &[u8]| {
                names
                    .iter()
                    .any(|name| field.eq_ignore_ascii_case(name.as_bytes()))
            };
            let mut found = record.fields().enumerate().filter(|(_, f)| is_named(f));
            let index = found.next().map(|(index, _)| index);
            if found.next().is_some() {
                let column = names[0];
                return Err(CatalogueFault::TwoColumns { line, column });
            }
            Ok(index)
        };
        let demand = |names: &[&'static str]| {
            let column = names[0];
            find(names)?.ok_or(CatalogueFault::NoColumn { line, column })
        };
        let columns = Self {
            right_ascension: demand(RIGHT_ASCENSION)?,
            declination: demand(DECLINATION)?,
            magnitude: demand(MAGNITUDE)?,
            temperature: find(TEMPERATURE)?,
            colour_index: find(COLOUR_INDEX)?,
        };
        if columns.temperature.is_none() && columns.colour_index.is_none() {
            let column = "temperature or bv";
            return Err(CatalogueFault::NoColumn { line, column });
        }
        Ok(columns)
    }

    /// Returns the values of a row, or what is wrong with it.
    fn values(&self, record: &Record) -> Result<Row, String> {
        let optional = |index: Option<usize>, name, range| match index {
            Some(index) => number(record.field(index), name, range),
            None => Ok(None),
        };
        let needed = |index, name, range| {
            number(record.field(index), name, range)?.ok_or_else(|| format!("{name} is missing"))
        };
        let right_ascension = needed(self.right_ascension, "ra", [f64::MIN, f64::MAX])?;
        let declination = needed(self.declination, "dec", [-90.0, 90.0])?;
        let magnitude = needed(self.magnitude, "magnitude", [-60.0, 60.0])?;
        let temperature = optional(self.temperature, "temperature", [100.0, 1e9])?;
        let colour_index = optional(self.colour_index, "B−V", [-0.4, 4.0])?;
        Ok(Row {
            right_ascension,
            declination,
            magnitude,
            temperature: temperature
                .or(colour_index.map(temperature_of_colour_index))
                .unwrap_or(DEFAULT_TEMPERATURE),
        })
    }
}

struct Row {
    right_ascension: f64,
    declination: f64,
    magnitude: f64,
    temperature: f64,
}

impl Row {
    fn star(&self) -> Star {
        Star::new(
            self.right_ascension,
            self.declination,
            self.magnitude,
            self.temperature,
        )
    }
}

/// Returns a field's value, nothing if it is empty, or what is wrong with it.
fn number(field: &[u8], name: &str, [least, most]: [f64; 2]) -> Result<Option<f64>, String> {
    if field.is_empty() {
        return Ok(None);
    }
    let text = String::from_utf8_lossy(field);
    let quoted = quotation::beginning(&text, 20);
    match text.parse::<f64>() {
        Ok(value) if (least..=most).contains(&value) => Ok(Some(value)),
        Ok(value) if value.is_finite() => {
            Err(format!("{name} = {quoted} is not within {least} to {most}"))
        }
        _ => Err(format!("{name} = {quoted:?} is not a number")),
    }
}

/// Returns the temperature in kelvin of a star with this B−V: Ballesteros 2012, EPL 97, 34008, equation (14).
fn temperature_of_colour_index(b_v: f64) -> f64 {
    4600.0 * (1.0 / (0.92 * b_v + 1.7) + 1.0 / (0.92 * b_v + 0.62))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_bytes(
        bytes: impl AsRef<[u8]>,
        limit: Option<f64>,
        max_bytes: u64,
    ) -> Result<(StarField, BadRows), CatalogueError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stars.csv");
        std::fs::write(&path, bytes).unwrap();
        StarField::read(&path, limit, max_bytes)
    }

    fn read_text(text: &str) -> (StarField, BadRows) {
        read_bytes(text, None, 1 << 20).unwrap()
    }

    fn fault(bytes: impl AsRef<[u8]>) -> CatalogueFault {
        read_bytes(bytes, None, 1 << 20).unwrap_err().fault
    }

    #[test]
    fn columns_come_in_any_order_and_case() {
        let (field, bad) = read_text(
            "\u{feff}# a comment\r\n\r\n Mag ,\"Name, or other\",DEC,B-V, Ra,teff\r\n\
             2.5,\"a, b\",0,,90,4000\r\n# another\r\n5,,-90,0.656,0\r\n0,x,30,,-330,",
        );
        assert_eq!(bad, BadRows::default());
        let expected = [
            Star::new(90.0, 0.0, 2.5, 4000.0),
            Star::new(0.0, -90.0, 5.0, temperature_of_colour_index(0.656)),
            Star::new(30.0, 30.0, 0.0, DEFAULT_TEMPERATURE),
        ];
        for (star, expected) in field.stars.iter().zip(expected) {
            assert!((star.direction - expected.direction).length() < 1e-15);
            assert_eq!(star.temperature, expected.temperature);
            assert_eq!(star.irradiance, expected.irradiance);
        }
        assert_eq!(field.stars.len(), 3);
        assert!((field.stars[0].irradiance - 0.1).abs() < 1e-8);
        assert!((field.stars[0].direction - glam::DVec3::Y).length() < 1e-15);
        assert!((field.stars[1].direction + glam::DVec3::Z).length() < 1e-15);
    }

    #[test]
    fn bad_rows_are_named_and_others_go_on() {
        let (field, bad) = read_text(
            "ra,dec,mag,temperature,bv\n1,2,3,5000,\nx,2,3,,\n1,91,3,,\n1,2,3,99,\n1,2,3,1e10,\n1,2,3,,4.1\n\
             1,,3,,\n1,2\n1,2,nan,,\ninf,2,3,,\n\"1,2,3\n# no row\n1,2,61,,\n1,2,3,x,1\n4,5,6,,1\n",
        );
        assert_eq!(field.stars.len(), 2);
        let found: Vec<String> = bad.first.iter().map(ToString::to_string).collect();
        let expected = [
            "line 3: ra = \"x\" is not a number",
            "line 4: dec = 91 is not within -90 to 90",
            "line 5: temperature = 99 is not within 100 to 1000000000",
            "line 6: temperature = 1e10 is not within 100 to 1000000000",
            "line 7: B−V = 4.1 is not within -0.4 to 4",
            "line 8: dec is missing",
            "line 9: magnitude is missing",
            "line 10: magnitude = \"nan\" is not a number",
            "line 11: ra = \"inf\" is not a number",
            "line 12: a quotation mark is not closed",
            "line 14: magnitude = 61 is not within -60 to 60",
            "line 15: temperature = \"x\" is not a number",
        ];
        assert_eq!(found, expected);
        assert_eq!(bad.count, expected.len() as u64);
    }

    #[test]
    fn many_bad_rows_are_counted() {
        let text = format!("ra,dec,mag,bv\n1,2,3,4\n{}", "bad\n".repeat(1000));
        let (field, bad) = read_text(&text);
        assert_eq!(
            (field.stars.len(), bad.count, bad.first.len()),
            (1, 1000, 20)
        );
    }

    #[test]
    fn faint_stars_are_dropped() {
        let text = "ra,dec,mag,bv\n1,2,3,1\n1,2,4,1\n1,2,4.5,1\n";
        let count = |limit| {
            let (field, bad) = read_bytes(text, Some(limit), 1 << 20).unwrap();
            assert_eq!(bad.count, 0);
            field.stars.len()
        };
        assert_eq!([5.0, 4.0, 2.0].map(count), [3, 2, 0]);
    }

    #[test]
    fn what_is_no_catalogue_is_refused() {
        use CatalogueFault as Fault;
        let missing = StarField::read(Path::new("no-such.csv"), None, 0).unwrap_err();
        assert!(matches!(missing.fault, Fault::Read(_)));
        assert!(missing.to_string().contains("no-such.csv"));
        for place in [Path::new("."), Path::new("/dev/zero")] {
            if place.exists() {
                let error = StarField::read(place, None, 1 << 20).unwrap_err();
                assert!(matches!(error.fault, Fault::NotAFile), "{error}");
            }
        }
        assert!(matches!(fault(""), Fault::NoHeader));
        assert!(matches!(fault("# only\n\n"), Fault::NoHeader));
        assert!(matches!(
            fault("ra,mag,bv\n1,2,3\n"),
            Fault::NoColumn {
                line: 1,
                column: "dec"
            }
        ));
        assert!(matches!(
            fault("#\nra,dec,mag\n1,2,3\n"),
            Fault::NoColumn {
                line: 2,
                column: "temperature or bv"
            }
        ));
        assert!(matches!(
            fault("ra,dec,mag,magnitude,bv\n"),
            Fault::TwoColumns {
                column: "magnitude",
                ..
            }
        ));
        assert!(matches!(fault("ra,dec,mag,bv\n"), Fault::NoStar(None)));
        assert!(matches!(
            fault("ra,dec,mag,bv\nx,1,1,1\n"),
            Fault::NoStar(Some(_))
        ));
        assert!(matches!(fault(b"r\xe9,dec\n"), Fault::BadHeader { .. }));
        assert!(matches!(fault([0; 100]), Fault::BadHeader { .. }));
        assert!(matches!(fault("\"ra,dec\n\",1\n"), Fault::BadHeader { .. }));
        assert!(matches!(
            fault(vec![b'a'; LONGEST_LINE]),
            Fault::LongLine(1)
        ));
        assert!(matches!(fault("a,".repeat(2000)), Fault::BadHeader { .. }));
    }

    #[test]
    fn memory_is_bounded() {
        let text = format!("ra,dec,mag,bv\n{}", "1,2,3,4\n".repeat(100));
        let error = read_bytes(&text, None, 99 * BYTES_PER_STAR as u64).unwrap_err();
        assert!(matches!(
            error.fault,
            CatalogueFault::TooManyStars { stars: 99, .. }
        ));
        let (field, _) = read_bytes(&text, None, 100 * BYTES_PER_STAR as u64).unwrap();
        assert_eq!(field.stars.len(), 100);
    }

    #[test]
    fn temperatures_of_colour_indices() {
        // Ballesteros 2012, the text below equation (14): the Sun's B−V of 0.65 gives 5770 K to 5800 K.
        assert!((temperature_of_colour_index(0.65) - 5780.0).abs() < 20.0);
        assert!(temperature_of_colour_index(-0.4) < 22_000.0);
        assert!(temperature_of_colour_index(4.0) > 1900.0);
    }
}
