//! File names with a frame's number in them: `f_####.png`, `f_%04d.png`.

use std::fmt;
use std::path::{Path, PathBuf};

use super::misuse::misuse;
use crate::output::LONGEST_NAME;

/// The most digits that a number can be padded to.
const WIDEST: usize = 20;

/// The digits of the longest number, with its sign.
const MOST_DIGITS: usize = 11;

const TWO_NUMBERS: &str = "the frame's number has two places in the name; leave one";

/// The files of a sequence: one for each frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pattern {
    folder: PathBuf,
    before: String,
    width: usize,
    after: String,
    /// The pattern as it was given.
    path: PathBuf,
}

impl Pattern {
    /// The pattern of a path whose file name has a place for the number: a row of `#` (the last, of several), or
    /// printf's `%d` or `%04d`. [`None`] for a name without.
    ///
    /// # Errors
    /// A number in a folder's name, two numbers, a number that is too wide, or a name that is too long.
    pub(super) fn parse(path: &Path) -> anyhow::Result<Option<Self>> {
        let wrong = |problem: &str| Err(misuse(format!("{}: {problem}", path.display())));
        let folder = path.parent().unwrap_or(Path::new(""));
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
            return Ok(None);
        };
        let place = match (hashes(name), percent(name)) {
            (Some(_), Some(_)) => return wrong(TWO_NUMBERS),
            (_, Some((_, end, _))) if percent(&name[end..]).is_some() => return wrong(TWO_NUMBERS),
            (place, None) | (None, place) => place,
        };
        let is_numbered = |part: &str| hashes(part).is_some() || percent(part).is_some();
        let mut parts = folder.iter().filter_map(|part| part.to_str());
        let Some((start, end, width)) = place else {
            if parts.any(is_numbered) {
                return wrong("the frame's number belongs in the file's name, not in a folder's");
            }
            return Ok(None);
        };
        if width > WIDEST {
            return wrong(&format!("the frame's number has at most {WIDEST} digits"));
        }
        if name.len() - (end - start) + width.max(MOST_DIGITS) > LONGEST_NAME {
            let longest = LONGEST_NAME - MOST_DIGITS;
            return wrong(&format!(
                "names of numbered files have at most {longest} bytes"
            ));
        }
        Ok(Some(Self {
            folder: folder.to_owned(),
            before: name[..start].to_owned(),
            width,
            after: name[end..].to_owned(),
            path: path.to_owned(),
        }))
    }

    /// The folder of the frames; empty for the current one.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// A frame's file.
    pub(super) fn file(&self, number: i64) -> PathBuf {
        let number = self.written(number);
        self.folder
            .join(format!("{}{number}{}", self.before, self.after))
    }

    /// The pattern in place of a frame's file, the same however it was written.
    pub(super) fn numberless(&self) -> PathBuf {
        let number = "#".repeat(self.width);
        self.folder
            .join(format!("{}{number}{}", self.before, self.after))
    }

    /// A frame's number as printf writes it: the sign is one of the digits.
    fn written(&self, number: i64) -> String {
        format!("{number:0width$}", width = self.width)
    }

    /// The number of the frame whose file has this name.
    pub(super) fn number(&self, name: &[u8]) -> Option<i64> {
        let name = name.strip_prefix(self.before.as_bytes())?;
        let digits = name.strip_suffix(self.after.as_bytes())?;
        let digits = std::str::from_utf8(digits).ok()?;
        let number: i64 = digits.parse().ok()?;
        let is_number = u32::try_from(number.unsigned_abs()).is_ok();
        (is_number && digits == self.written(number)).then_some(number)
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())
    }
}

/// The last row of `#`: its start, its end, and the number of digits.
fn hashes(name: &str) -> Option<(usize, usize, usize)> {
    let end = name.rfind('#')? + 1;
    let start = name[..end].trim_end_matches('#').len();
    Some((start, end, end - start))
}

/// The first `%d` or `%0Nd`: its start, its end, and the number of digits.
fn percent(name: &str) -> Option<(usize, usize, usize)> {
    name.match_indices('%').find_map(|(start, _)| {
        let (width, _) = name[start + 1..].split_once('d')?;
        let end = start + 1 + width.len() + 1;
        if width.is_empty() {
            return Some((start, end, 1));
        }
        let digits = width.strip_prefix('0')?;
        let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        is_number.then(|| (start, end, digits.parse().unwrap_or(usize::MAX)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(path: &str) -> Pattern {
        Pattern::parse(Path::new(path)).unwrap().unwrap()
    }

    #[test]
    fn names_and_numbers_are_each_others() {
        for (path, number, file) in [
            ("out/f_####.png", 7, "out/f_0007.png"),
            ("f_%04d.png", 7, "f_0007.png"),
            ("/a b/#.png", 12, "/a b/12.png"),
            ("%d.png", 12, "12.png"),
            ("v2#_###.png", 12345, "v2#_12345.png"),
            ("100%_%03d.png", 5, "100%_005.png"),
            ("dots...##", 5, "dots...05"),
            ("é_##_ü.png", 5, "é_05_ü.png"),
            ("f_####.png", 0, "f_0000.png"),
            ("f_####.png", -7, "f_-007.png"),
            ("f_#.png", -12, "f_-12.png"),
        ] {
            let pattern = pattern(path);
            assert_eq!(pattern.file(number), Path::new(file));
            let name = Path::new(file).file_name().unwrap();
            assert_eq!(pattern.number(name.as_encoded_bytes()), Some(number));
        }
    }

    #[test]
    fn other_names_have_no_number() {
        let pattern = pattern("f_###.png");
        for name in [
            "f_1.png",
            "f_01.png",
            "f_0001.png",
            "f_abc.png",
            "f_.png",
            "g_001.png",
            "f_001.png~",
            "f_+12.png",
            "f_-1.png",
            "f_-0.png",
            "f_-00.png",
            "f_--1.png",
            "f_99999999999.png",
        ] {
            assert_eq!(pattern.number(name.as_bytes()), None, "{name}");
        }
        assert_eq!(pattern.number(b"f_1000.png"), Some(1000));
        assert_eq!(pattern.numberless(), Path::new("f_###.png"));
        assert_eq!(pattern.number(b"f_###.png"), None);
    }

    #[test]
    fn what_is_no_pattern_or_a_wrong_one() {
        for path in [
            "f.png", "50%.png", "%4d.png", "%x.png", "..", "/", "%0d.png", "%",
        ] {
            assert_eq!(Pattern::parse(Path::new(path)).unwrap(), None, "{path}");
        }
        for path in [
            "#/f.png",
            "%04d/f.png",
            "#_%d.png",
            "%d%d.png",
            "%0999999999999999999999999d.png",
            "%021d.png",
        ] {
            assert!(Pattern::parse(Path::new(path)).is_err(), "{path}");
        }
    }
}
