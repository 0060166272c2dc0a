//! Reads rays from CSV, one line at a time.
//!
//! The `csv` crate has no limit on the length of a line, does not trim around quotes, and lets a field go on over
//! several lines, so that one stray quote would swallow a whole list: hence this reader.

use std::io::{BufRead, Read};

use crate::orbit::Ray;
use crate::quotation::beginning;

/// Reads rays from CSV text with a header: an iterator of rays, or of the reasons why lines hold none.
///
/// The columns `u0` and `dudphi` may be anywhere; others are ignored. Fields may have spaces around them and may be in
/// quotes, and end on the line on which they begin. Blank lines and lines that begin with `#` are skipped.
#[derive(Debug)]
pub struct RayReader<R> {
    input: R,
    name: String,
    line: u64,
    text: Vec<u8>,
    header: Header,
}

/// How many columns there are, and which of them hold the ray's numbers.
#[derive(Debug, Clone, Copy, Default)]
struct Header {
    columns: usize,
    u0: usize,
    dudphi: usize,
}

/// What is wrong in a list of rays, and where.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct RaysError {
    place: String,
    problem: Problem,
}

impl RaysError {
    /// Whether no further line can be read.
    pub fn is_final(&self) -> bool {
        matches!(self.problem, Problem::Input(_))
    }
}

#[derive(Debug, thiserror::Error)]
enum Problem {
    /// The input gives no further line.
    #[error("{0}")]
    Input(String),
    /// One line holds no ray.
    #[error("{0}")]
    Line(String),
}

/// The longest line in bytes, far beyond any list's: a file without line ends must not fill the memory.
const LONGEST_LINE: usize = 1 << 20;

impl<R: BufRead> RayReader<R> {
    /// Reads the header of `input`, which messages call `name`.
    ///
    /// # Errors
    /// [`RaysError`] where the header is missing or does not name the columns.
    pub fn new(input: R, name: String) -> Result<Self, RaysError> {
        let mut reader = Self {
            input,
            name,
            line: 0,
            text: Vec::new(),
            header: Header::default(),
        };
        match reader.read_header() {
            Ok(header) => Ok(Self { header, ..reader }),
            Err(problem) => Err(reader.at_this_line(problem)),
        }
    }

    /// Returns an error about the line read last.
    pub fn error(&self, problem: &impl ToString) -> RaysError {
        self.at_this_line(Problem::Line(problem.to_string()))
    }

    fn at_this_line(&self, problem: Problem) -> RaysError {
        let place = match self.line {
            0 => self.name.clone(),
            line => format!("{}, line {line}", self.name),
        };
        RaysError { place, problem }
    }

    fn read_header(&mut self) -> Result<Header, Problem> {
        let text = self.next_line()?.ok_or_else(|| {
            let problem =
                "there is no header: the first line names the columns, u0 and dudphi among them";
            Problem::Line(problem.into())
        })?;
        header(text).map_err(Problem::Line)
    }

    fn read_ray(&mut self) -> Result<Option<Ray>, Problem> {
        let header = self.header;
        match self.next_line()? {
            Some(text) => ray(text, header).map(Some).map_err(Problem::Line),
            None => Ok(None),
        }
    }

    /// Returns the next line that is neither blank nor a comment, trimmed.
    fn next_line(&mut self) -> Result<Option<&str>, Problem> {
        loop {
            self.text.clear();
            let mut limited = self.input.by_ref().take(LONGEST_LINE as u64 + 1);
            let read = limited
                .read_until(b'\n', &mut self.text)
                .map_err(|error| Problem::Input(format!("the rays cannot be read: {error}")))?;
            if read == 0 {
                return Ok(None);
            }
            self.line += 1;
            if read > LONGEST_LINE {
                return Err(Problem::Input(format!(
                    "the line is longer than {LONGEST_LINE} bytes, so this is not a list of rays"
                )));
            }
            let begin = self.text.trim_ascii_start();
            // Spreadsheets begin their files with a byte order mark.
            let begin = begin.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(begin);
            if !matches!(begin.trim_ascii_start().first(), None | Some(b'#')) {
                break;
            }
        }
        let text = str::from_utf8(&self.text)
            .map_err(|_| Problem::Line("the line is not UTF-8 text".into()))?;
        Ok(Some(text.trim().trim_start_matches('\u{feff}')))
    }
}

impl<R: BufRead> Iterator for RayReader<R> {
    type Item = Result<Ray, RaysError>;

    fn next(&mut self) -> Option<Self::Item> {
        let read = self.read_ray();
        read.map_err(|problem| self.at_this_line(problem))
            .transpose()
    }
}

fn header(line: &str) -> Result<Header, String> {
    let names = fields(line)?;
    Ok(Header {
        columns: names.len(),
        u0: position(&names, "u0")?,
        dudphi: position(&names, "dudphi")?,
    })
}

fn ray(line: &str, header: Header) -> Result<Ray, String> {
    let fields = fields(line)?;
    if fields.len() != header.columns {
        return Err(format!(
            "the line has {} fields and the header {}; each line has one for each column",
            fields.len(),
            header.columns
        ));
    }
    let u0 = number("u0", fields[header.u0])?;
    let dudphi = number("dudphi", fields[header.dudphi])?;
    Ray::new(u0, dudphi).map_err(|error| error.to_string())
}

/// Returns the fields of a line, without the spaces and quotes around them.
fn fields(line: &str) -> Result<Vec<&str>, String> {
    let mut quoted = false;
    let fields = line
        .split(|c| {
            quoted ^= c == '"';
            c == ',' && !quoted
        })
        .map(bare)
        .collect();
    if quoted {
        return Err(
            "a quote is opened and not closed; a field ends on the line on which it begins".into(),
        );
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

fn position(names: &[&str], column: &str) -> Result<usize, String> {
    let mut places = (0..names.len()).filter(|&k| names[k] == column);
    match (places.next(), places.next()) {
        (Some(place), None) => Ok(place),
        (Some(_), Some(_)) => Err(format!("the header names the column {column} twice")),
        (None, _) => Err(format!(
            "the header names no column {column}: it must name u0 and dudphi, and has {}",
            listed(names)
        )),
    }
}

fn number(column: &str, text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| {
        format!(
            "{column} is {}, which is not a number: write 0.25 or 2.5e-1 (and inf or -inf for a dudphi straight in or \
             out)",
            quoted(text)
        )
    })
}

/// How many characters of a field, and how many names of columns, a message repeats.
const MOST_REPEATED: usize = 40;

fn quoted(text: &str) -> String {
    format!("\"{}\"", beginning(text, MOST_REPEATED))
}

fn listed(names: &[&str]) -> String {
    let some: Vec<String> = names
        .iter()
        .take(MOST_REPEATED)
        .map(|name| quoted(name))
        .collect();
    let rest = if some.len() < names.len() {
        ", …"
    } else {
        ""
    };
    some.join(", ") + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Result<Vec<(f64, f64)>, String> {
        let rays = RayReader::new(text, "list".into()).map_err(|error| error.to_string())?;
        rays.map(|ray| ray.map(|ray| (ray.u(), ray.dudphi())))
            .collect::<Result<_, _>>()
            .map_err(|error| error.to_string())
    }

    #[test]
    fn columns_are_found_by_name_whatever_stands_around_them() {
        let text = "\u{feff}# made by hand\r\n\r\n \"note\", dudphi ,\"u0\"\r\n\"a, b\", 1e-3 ,\" 0.25\"\r\n#x\n\
                    ,-inf,.5\n,inf,5e-1";
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
    fn lines_without_a_ray_are_refused_by_number_with_what_is_allowed() {
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
            (b"u0,dudphi\n0.1,\xFF\n", 2, "not UTF-8"),
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
        let endless = std::io::BufReader::new(std::io::repeat(b'1'));
        let error = RayReader::new(endless, "zeros".into()).unwrap_err();
        assert!(error.to_string().contains("longer than"), "{error}");
    }
}
