//! Reads rays from CSV, one line at a time.
//!
//! The `csv` crate has no limit on the length of a line, does not trim around quotes, and lets a field go on over
//! several lines, so that one stray quote would swallow a whole list: hence this reader.

mod columns;

use std::io::{BufRead, Read};

use columns::Columns;
pub(super) use columns::Direction;
pub use columns::ListedRay;

use crate::orbit::OrbitError;
use crate::quotation::beginning;

/// Reads rays from CSV text with a header: an iterator of rays, or of the reasons why lines hold none.
///
/// A column `u0` or `r0` tells where each ray starts, and the first one of `dudphi`, `b` and `angle` that there is
/// tells its direction. A column `id` names it. Columns may be in any order, others are ignored. Fields may have spaces
/// around them and may be in quotes, and end on the line on which they begin. Blank lines and lines that begin with `#`
/// are skipped.
#[derive(Debug)]
pub struct RayReader<R> {
    lines: Lines<R>,
    columns: Columns,
    rays: u64,
}

/// The lines of a list.
#[derive(Debug)]
struct Lines<R> {
    input: R,
    name: String,
    number: u64,
    text: Vec<u8>,
}

/// What is wrong in a list of rays, and where.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct RaysError {
    place: String,
    problem: Problem,
}

impl RaysError {
    /// The error of a ray that cannot be followed.
    pub(super) fn unfollowed(id: &str, error: OrbitError) -> Self {
        Self {
            place: format!("ray {}", beginning(id, MOST_REPEATED)),
            problem: Problem::Line(error.to_string()),
        }
    }

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
    /// Reads the header of `input`, which messages call `name`. The rays of a list without the columns `u0` and `r0`
    /// start at the radius `from`.
    ///
    /// # Errors
    /// [`RaysError`] where the header is missing or does not name the columns.
    pub fn new(input: R, name: String, from: Option<f64>) -> Result<Self, RaysError> {
        let mut lines = Lines {
            input,
            name,
            number: 0,
            text: Vec::new(),
        };
        let columns = match lines.next() {
            Ok(Some(header)) => Columns::new(header, from).map_err(Problem::Line),
            Ok(None) => Err(Problem::Line(
                "there is no header: the first line names the columns, u0 and dudphi for example"
                    .into(),
            )),
            Err(problem) => Err(problem),
        };
        match columns {
            Ok(columns) => Ok(Self {
                lines,
                columns,
                rays: 0,
            }),
            Err(problem) => Err(lines.error(problem)),
        }
    }

    fn read_ray(&mut self) -> Result<Option<ListedRay>, Problem> {
        // A line that is no text counts too, so that numbers do not depend on what is wrong with a line.
        self.rays += 1;
        let Some(text) = self.lines.next()? else {
            return Ok(None);
        };
        let ray = self.columns.ray(text, self.rays);
        ray.map(Some).map_err(Problem::Line)
    }
}

impl<R: BufRead> Lines<R> {
    /// Returns an error about the line read last.
    fn error(&self, problem: Problem) -> RaysError {
        let place = match self.number {
            0 => self.name.clone(),
            line => format!("{}, line {line}", self.name),
        };
        RaysError { place, problem }
    }

    /// Returns the next line that is neither blank nor a comment, trimmed.
    fn next(&mut self) -> Result<Option<&str>, Problem> {
        loop {
            self.text.clear();
            let mut limited = self.input.by_ref().take(LONGEST_LINE as u64 + 1);
            let read = limited
                .read_until(b'\n', &mut self.text)
                .map_err(|error| Problem::Input(format!("the rays cannot be read: {error}")))?;
            if read == 0 {
                return Ok(None);
            }
            self.number += 1;
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
    type Item = Result<ListedRay, RaysError>;

    fn next(&mut self) -> Option<Self::Item> {
        let read = self.read_ray();
        read.map_err(|problem| self.lines.error(problem))
            .transpose()
    }
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
    use crate::orbit::Ray;

    fn read(text: &[u8]) -> Result<Vec<(f64, f64)>, String> {
        let rays = RayReader::new(text, "list".into(), None).map_err(|error| error.to_string())?;
        rays.map(|ray| ray.map(|listed| (listed.ray.u(), listed.ray.dudphi())))
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

    /// The same ray by its slope, its impact parameter and its angle, from an inverse radius, a radius and `--from`.
    #[test]
    fn columns_decide_how_a_ray_is_given() {
        let known = Ray::from_angle(8.0, 30.0_f64.to_radians()).unwrap();
        let (slope, b) = (known.dudphi(), known.impact_parameter());
        let start = [
            ("u0,", "0.125,", None),
            ("r0,", "8,", None),
            ("", "", Some(8.0)),
        ];
        let direction = [
            ("dudphi,angle", format!("{slope:?},90")),
            ("angle,b", format!("90,{b:?}")),
            ("angle", "30".into()),
        ];
        for (start, at, from) in start {
            for (name, value) in &direction {
                let text = format!("{start}{name},id\n{at}{value},\"a, b\"\n{at}{value},3\n");
                let rays = RayReader::new(text.as_bytes(), "list".into(), from).unwrap();
                let rays: Vec<ListedRay> = rays.map(Result::unwrap).collect();
                assert_eq!([&rays[0].id, &rays[1].id], ["a, b", "3"]);
                for ListedRay { ray, .. } in rays {
                    assert_eq!(ray.u(), 0.125, "{text}");
                    assert!((ray.dudphi() / slope - 1.0).abs() < 1e-14, "{text}");
                }
            }
        }
        for (degrees, slope) in [
            (0.0, f64::INFINITY),
            (90.0, 0.0),
            (150.0, -slope),
            (180.0, f64::NEG_INFINITY),
        ] {
            let ray = Direction::Degrees.ray(8.0, degrees).unwrap();
            assert!(ray.dudphi() == slope || (ray.dudphi() / slope - 1.0).abs() < 1e-14);
        }
        let both = RayReader::new(&b"u0,b\n"[..], "list".into(), Some(8.0)).unwrap_err();
        assert!(both.to_string().contains("leave out --from"), "{both}");
    }

    #[test]
    fn rays_without_an_id_are_numbered_with_those_that_are_refused() {
        let text = &b"# 1\nr0,b\n30,2\n30,x\n\n30,\xFF\n30,3\n"[..];
        let rays = RayReader::new(text, "list".into(), None).unwrap();
        let ids: Vec<String> = rays
            .filter_map(Result::ok)
            .map(|listed| listed.id)
            .collect();
        assert_eq!(ids, ["1", "4"]);
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
            (b"u0,r0,b\n", 1, "both u0 and r0"),
            (b"u0,x\n", 1, "no column dudphi, b or angle"),
            (b"b,u0,dudphi,b\n", 1, "b twice"),
            (b"r0,b\n1,1\n", 2, "radius 1.0"),
            (b"r0,b\n30,31\n", 2, "impact parameter 31.0"),
            (b"u0,b\n0.5,-1\n", 2, "impact parameter -1.0"),
            (b"u0,b\n2,-1\n", 2, "u0 = 2.0"),
            (b"r0,angle\n30,181\n", 2, "180 degrees"),
            (b"r0,angle\n30,nan\n", 2, "180 degrees"),
            (b"id,r0,angle\n\"\",30,1\n", 2, "id is empty"),
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
        let error = RayReader::new(endless, "zeros".into(), None).unwrap_err();
        assert!(error.to_string().contains("longer than"), "{error}");
    }
}
