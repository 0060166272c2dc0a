//! Rays from CSV, one line at a time.

use std::io::{self, BufRead, Read};

use super::{OrbitError, Ray};
use crate::quotation::beginning;

/// Rays read from CSV text with a header: an iterator of them, or of why a line holds none.
///
/// Columns stand in any order, others than `u0` and `dudphi` are ignored. Fields may have spaces around them and
/// stand in quotes. Blank lines and lines that begin with `#` are skipped.
#[derive(Debug)]
pub struct Rays<R> {
    input: R,
    name: String,
    line: u64,
    text: Vec<u8>,
    columns: Columns,
}

/// Where the header says the ray's numbers stand.
#[derive(Debug, Clone, Copy, Default)]
struct Columns {
    count: usize,
    u0: usize,
    dudphi: usize,
}

/// What is wrong in a file of rays, and where.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct RaysError {
    place: String,
    problem: Problem,
}

impl RaysError {
    /// Whether no line after this one can be read.
    pub fn is_final(&self) -> bool {
        matches!(self.problem, Problem::Unreadable(_) | Problem::TooLong)
    }
}

/// What is wrong with a line.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The system does not give the text.
    #[error("the rays cannot be read: {0}")]
    Unreadable(io::Error),
    /// A line is longer than any list's.
    #[error("the line is longer than {LONGEST} bytes, so this is no list of rays")]
    TooLong,
    /// A line is no text.
    #[error("the line is no UTF-8 text")]
    NotText,
    /// A quote is opened and not closed.
    #[error("a quote is opened and not closed; a field ends on the line it begins on")]
    OpenQuote,
    /// There is no line that says anything.
    #[error("there is no header: the first line names the columns, u0 and dudphi among them")]
    NoHeader,
    /// The header lacks a column.
    #[error("the header names no column {missing}: it must name u0 and dudphi, and has {found}")]
    NoColumn {
        /// The column.
        missing: &'static str,
        /// The columns that it has, the first of very many.
        found: String,
    },
    /// The header names a column twice.
    #[error("the header names the column {column} twice")]
    Ambiguous {
        /// The column.
        column: &'static str,
    },
    /// A line has more or fewer fields than the header.
    #[error(
        "the line has {found} fields and the header {expected}: each line has one for each column"
    )]
    Fields {
        /// Fields of the header.
        expected: usize,
        /// Fields of the line.
        found: usize,
    },
    /// A field is no number.
    #[error(
        "{column} is {text}, which is no number: write 0.25 or 2.5e-1 (and inf or -inf for a dudphi straight in or out)"
    )]
    NoNumber {
        /// The field's column.
        column: &'static str,
        /// The field, in quotes, its beginning if it is very long.
        text: String,
    },
    /// The numbers are none of a ray.
    #[error("{0}")]
    Ray(#[from] OrbitError),
}

/// The longest line there may be: far beyond any list's, and a file without line ends does not fill the memory.
const LONGEST: usize = 1 << 20;

impl<R: BufRead> Rays<R> {
    /// The rays of `input`, which messages call `name`. Reads the header.
    ///
    /// # Errors
    /// [`RaysError`] where the header is missing or does not name the columns.
    pub fn new(input: R, name: String) -> Result<Self, RaysError> {
        let mut rays = Self {
            input,
            name,
            line: 0,
            text: Vec::new(),
            columns: Columns::default(),
        };
        match rays.header() {
            Ok(columns) => {
                rays.columns = columns;
                Ok(rays)
            }
            Err(problem) => Err(rays.error(problem)),
        }
    }

    /// `problem`, with the place of the line read last.
    pub fn error(&self, problem: Problem) -> RaysError {
        let place = match self.line {
            0 => self.name.clone(),
            line => format!("{}, line {line}", self.name),
        };
        RaysError { place, problem }
    }

    fn header(&mut self) -> Result<Columns, Problem> {
        let text = self.next_line()?.ok_or(Problem::NoHeader)?;
        let fields = fields(text)?;
        Ok(Columns {
            count: fields.len(),
            u0: position(&fields, "u0")?,
            dudphi: position(&fields, "dudphi")?,
        })
    }

    fn ray(&mut self) -> Result<Option<Ray>, Problem> {
        let columns = self.columns;
        let Some(text) = self.next_line()? else {
            return Ok(None);
        };
        let fields = fields(text)?;
        if fields.len() != columns.count {
            return Err(Problem::Fields {
                expected: columns.count,
                found: fields.len(),
            });
        }
        let u0 = number("u0", fields[columns.u0])?;
        let dudphi = number("dudphi", fields[columns.dudphi])?;
        Ok(Some(Ray::new(u0, dudphi)?))
    }

    /// The next line that says something, trimmed.
    fn next_line(&mut self) -> Result<Option<&str>, Problem> {
        loop {
            self.text.clear();
            let mut limited = self.input.by_ref().take(LONGEST as u64 + 1);
            let read = limited
                .read_until(b'\n', &mut self.text)
                .map_err(Problem::Unreadable)?;
            if read == 0 {
                return Ok(None);
            }
            self.line += 1;
            if read > LONGEST {
                return Err(Problem::TooLong);
            }
            let begin = self.text.trim_ascii_start();
            // Spreadsheets begin their files with a byte order mark.
            let begin = begin.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(begin);
            if !matches!(begin.trim_ascii_start().first(), None | Some(b'#')) {
                break;
            }
        }
        let text = str::from_utf8(&self.text).map_err(|_| Problem::NotText)?;
        Ok(Some(text.trim().trim_start_matches('\u{feff}')))
    }
}

impl<R: BufRead> Iterator for Rays<R> {
    type Item = Result<Ray, RaysError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.ray()
            .map_err(|problem| self.error(problem))
            .transpose()
    }
}

/// The fields of a line, without the spaces and quotes around them.
fn fields(line: &str) -> Result<Vec<&str>, Problem> {
    let mut quoted = false;
    let fields = line
        .split(|c| {
            quoted ^= c == '"';
            c == ',' && !quoted
        })
        .map(bare)
        .collect();
    if quoted {
        return Err(Problem::OpenQuote);
    }
    Ok(fields)
}

fn bare(field: &str) -> &str {
    let field = field.trim();
    let inner = field
        .strip_prefix('"')
        .and_then(|field| field.strip_suffix('"'));
    inner.map_or(field, str::trim)
}

fn position(header: &[&str], column: &'static str) -> Result<usize, Problem> {
    let mut places = (0..header.len()).filter(|&k| header[k] == column);
    match (places.next(), places.next()) {
        (Some(place), None) => Ok(place),
        (Some(_), Some(_)) => Err(Problem::Ambiguous { column }),
        (None, _) => Err(Problem::NoColumn {
            missing: column,
            found: listed(header),
        }),
    }
}

fn number(column: &'static str, text: &str) -> Result<f64, Problem> {
    text.parse().map_err(|_| Problem::NoNumber {
        column,
        text: quoted(text),
    })
}

/// The most of anybody's text that a message repeats, in characters and in names.
const MOST_REPEATED: usize = 40;

fn quoted(text: &str) -> String {
    format!("\"{}\"", beginning(text, MOST_REPEATED))
}

/// The names of columns.
fn listed(header: &[&str]) -> String {
    let names: Vec<String> = header
        .iter()
        .take(MOST_REPEATED)
        .map(|name| quoted(name))
        .collect();
    let rest = if names.len() < header.len() {
        ", …"
    } else {
        ""
    };
    names.join(", ") + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Result<Vec<(f64, f64)>, String> {
        let rays = Rays::new(text, "list".into()).map_err(|error| error.to_string())?;
        rays.map(|ray| ray.map(|ray| (ray.u(), ray.dudphi())))
            .collect::<Result<_, _>>()
            .map_err(|error| error.to_string())
    }

    #[test]
    fn columns_are_found_by_name_whatever_stands_around_them() {
        let text = "\u{feff}# made by hand\r\n\r\n \"note\", dudphi ,\"u0\"\r\n\"a, b\", 1e-3 ,\" 0.25\"\r\n#x\n,-inf,.5\n,inf,5e-1";
        assert_eq!(
            read(text.as_bytes()),
            Ok(vec![
                (0.25, 1e-3),
                (0.5, f64::NEG_INFINITY),
                (0.5, f64::INFINITY)
            ])
        );
        assert_eq!(read(b"u0,dudphi\n"), Ok(vec![]));
    }

    #[test]
    fn what_is_no_ray_is_refused_with_its_line_and_what_is_allowed() {
        for (text, line, words) in [
            (&b"# nothing\n"[..], 1, "no header"),
            (b"u,dudphi\n", 1, "no column u0"),
            (b"u0,dudphi,u0\n", 1, "u0 twice"),
            (
                b"u0,dudphi\n0.1,0.1\n\n0.1\n",
                4,
                "1 fields and the header 2",
            ),
            (b"u0,dudphi\n0.1,0.1,\n", 2, "3 fields"),
            (b"u0,dudphi\n0.1,fast\n", 2, "dudphi is \"fast\""),
            (b"u0,dudphi\n,1\n", 2, "u0 is \"\""),
            (b"u0,dudphi\n1.0,1\n", 2, "outside the horizon"),
            (b"u0,dudphi\ninf,1\n", 2, "outside the horizon"),
            (b"u0,dudphi\n0.1,nan\n", 2, "not a number"),
            (b"u0,dudphi\n\"0.1,1\n", 2, "a quote is opened"),
            (b"u0,dudphi\n0.1,\xFF\n", 2, "no UTF-8"),
        ] {
            let message = read(text).unwrap_err();
            let begin = format!("list, line {line}: ");
            assert!(message.starts_with(&begin), "{message}");
            assert!(message.contains(words), "{message}");
        }
        let message = read(b"").unwrap_err();
        assert!(message.starts_with("list: there is no header"), "{message}");
    }

    /// Guards against a megabyte of message, and against one that sets a terminal's colours.
    #[test]
    fn messages_repeat_little_of_what_they_refuse() {
        let long = format!("u0,dudphi\n0.1,\u{1b}[31m{}\n", "x".repeat(100_000));
        let wide = format!("\u{7},{}\n", "y,".repeat(100_000));
        for text in [long, wide] {
            let message = read(text.as_bytes()).unwrap_err();
            assert!(message.len() < 500, "{} bytes", message.len());
            assert!(!message.contains(char::is_control), "{message}");
        }
    }

    #[test]
    fn a_file_without_line_ends_is_not_read_to_its_end() {
        let endless = io::BufReader::new(io::repeat(b'1'));
        let error = Rays::new(endless, "zeros".into()).unwrap_err();
        assert!(error.to_string().contains("longer than"), "{error}");
    }
}
