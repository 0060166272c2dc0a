//! The argument of `--frames`: `12`, `1-240`, every tenth as `1-240x10` or `1-240:10`, several with commas.

use core::fmt;
use core::str::FromStr;

use crate::quotation::beginning;

/// A set of frame numbers. It is written as `N`, `A-B`, `A-BxS` or `A-B:S` (from A to B in steps of S), or several of
/// these with commas.
///
/// ```
/// use darkness::cli::FrameRange;
///
/// let frames: FrameRange = "1-9x4, 3, 4-6".parse()?;
/// assert_eq!(frames.iter().collect::<Vec<_>>(), [1, 3, 4, 5, 6, 9]);
/// # Ok::<(), darkness::cli::FrameRangeError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameRange {
    steps: Vec<Steps>,
}

/// From `first` to `last` in steps of `step`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Steps {
    first: i64,
    last: i64,
    step: i64,
}

/// The largest number of a frame, and of a step.
const LARGEST: u64 = u32::MAX as u64;

/// The most parts of a range: every part is checked for each frame.
const MOST_PARTS: usize = 1000;

/// Why a text is not a range of frames.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FrameRangeError(String);

impl FromStr for FrameRange {
    type Err = FrameRangeError;

    fn from_str(text: &str) -> Result<Self, FrameRangeError> {
        let steps = text.split(',').map(|part| Steps::parse(part.trim()));
        let mut steps: Vec<Steps> = steps.collect::<Result<_, _>>()?;
        steps.sort_unstable_by_key(|steps| (steps.first, steps.last));
        // Merges ranges without steps that touch.
        steps.dedup_by(|next, before| {
            let touch =
                next.step == 1 && before.step == 1 && next.first <= before.last.saturating_add(1);
            if touch {
                before.last = before.last.max(next.last);
            }
            touch || next == before
        });
        if steps.len() > MOST_PARTS {
            let parts = steps.len();
            let reason = format!("a range of frames has at most {MOST_PARTS} parts, not {parts}");
            return Err(FrameRangeError(reason));
        }
        Ok(Self { steps })
    }
}

impl Steps {
    fn parse(part: &str) -> Result<Self, FrameRangeError> {
        let wrong = |problem| FrameRangeError(format!("`{}` {problem}", beginning(part, 40)));
        // `parse` alone would accept a plus.
        let number = |text: &str| {
            let number: Option<i64> = text.parse().ok().filter(|_| !text.starts_with('+'));
            number.filter(|number| number.unsigned_abs() <= LARGEST)
        };
        let read = || {
            let (range, step) = match part.split_once(['x', 'X', ':']) {
                Some((range, step)) => (range, Some(number(step.trim())?)),
                None => (part, None),
            };
            // A minus before the first digit is a sign.
            let range = range.trim();
            let dash = range.get(1..).and_then(|rest| rest.find('-'));
            match dash {
                Some(dash) => {
                    let (first, last) = (&range[..=dash], &range[dash + 2..]);
                    let (first, last) = (number(first.trim())?, number(last.trim())?);
                    Some((first, last, step.unwrap_or(1)))
                }
                None if step.is_none() => number(range).map(|only| (only, only, 1)),
                None => None,
            }
        };
        let (first, last, step) = read().ok_or_else(|| {
            wrong("is not a range of frames; write 12, 1-240, 1-240x10 or 1-240:10, or several with commas")
        })?;
        if step < 1 {
            return Err(wrong("has no step above 0; a step is at least 1"));
        }
        if last < first {
            return Err(wrong(
                "ends before it begins; the smaller number comes first",
            ));
        }
        let last = last - (last - first) % step;
        Ok(Self {
            first,
            last,
            step: if first == last { 1 } else { step },
        })
    }

    /// The first number above `number`.
    fn above(&self, number: i64) -> Option<i64> {
        let next = if number < self.first {
            self.first
        } else {
            // Neither overflows: numbers and steps have 33 bits.
            self.first + ((number - self.first) / self.step + 1) * self.step
        };
        (next <= self.last).then_some(next)
    }

    fn contains(&self, number: i64) -> bool {
        (self.first..=self.last).contains(&number) && (number - self.first) % self.step == 0
    }
}

impl FrameRange {
    /// The frames 1 to `last`.
    pub fn up_to(last: i64) -> Self {
        Self::all(1, last)
    }

    /// The frames `first` to `last`.
    pub fn all(first: i64, last: i64) -> Self {
        Self {
            steps: vec![Steps {
                first,
                last,
                step: 1,
            }],
        }
    }

    /// Returns the part of the range within `first` to `last`; [`None`] where nothing of it is.
    #[must_use]
    pub fn within(&self, first: i64, last: i64) -> Option<Self> {
        let cut = |steps: &Steps| {
            let first = steps.above(first - 1)?;
            let last = last.min(steps.last);
            let last = last - (last - first).rem_euclid(steps.step);
            let step = if first == last { 1 } else { steps.step };
            (first <= last).then_some(Steps { first, last, step })
        };
        let steps: Vec<Steps> = self.steps.iter().filter_map(cut).collect();
        (!steps.is_empty()).then_some(Self { steps })
    }

    /// The numbers in rising order.
    pub fn iter(&self) -> impl Iterator<Item = i64> + Send + '_ {
        core::iter::successors(self.first(), |&number| self.above(number))
    }

    /// The smallest number of the range above `number`.
    pub fn above(&self, number: i64) -> Option<i64> {
        let above = self.steps.iter().filter_map(|steps| steps.above(number));
        above.min()
    }

    /// Whether a number is in the range.
    pub fn contains(&self, number: i64) -> bool {
        self.steps.iter().any(|steps| steps.contains(number))
    }

    /// The smallest number.
    pub fn first(&self) -> Option<i64> {
        self.steps.iter().map(|steps| steps.first).min()
    }

    /// The greatest number.
    pub fn last(&self) -> i64 {
        self.steps.iter().map(|steps| steps.last).max().unwrap_or(0)
    }

    /// The number of frames.
    pub fn count(&self) -> u64 {
        match self.steps.as_slice() {
            [Steps { first, last, step }] => ((last - first) / step) as u64 + 1,
            _ => self.iter().count() as u64,
        }
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, Steps { first, last, step }) in self.steps.iter().enumerate() {
            if place > 0 {
                write!(f, ",")?;
            }
            match (first == last, step) {
                (true, _) => write!(f, "{first}")?,
                (false, 1) => write!(f, "{first}-{last}")?,
                (false, _) => write!(f, "{first}-{last}x{step}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Vec<i64> {
        let range: FrameRange = text.parse().unwrap();
        let numbers: Vec<i64> = range.iter().collect();
        assert_eq!(range.count(), numbers.len() as u64, "{text}");
        assert_eq!(range.last(), *numbers.last().unwrap(), "{text}");
        assert!(numbers.iter().all(|&number| range.contains(number)));
        assert_eq!(range.to_string().parse::<FrameRange>().unwrap(), range);
        numbers
    }

    #[test]
    fn all_ways_to_write_a_range() {
        assert_eq!(numbers("7"), [7]);
        assert_eq!(numbers("3-6"), [3, 4, 5, 6]);
        assert_eq!(numbers("1-10x4"), [1, 5, 9]);
        assert_eq!(numbers("1-10:4"), [1, 5, 9]);
        assert_eq!(numbers(" 1 - 10 X 4 , 2"), [1, 2, 5, 9]);
        assert_eq!(numbers("5-5x7"), [5]);
        assert_eq!(numbers("8-9,1-3,2-4,3"), [1, 2, 3, 4, 8, 9]);
        assert_eq!(numbers("1-9x2,1-9x3"), [1, 3, 4, 5, 7, 9]);
        assert_eq!(numbers("0"), [0]);
        assert_eq!(numbers("-3--1"), [-3, -2, -1]);
        assert_eq!(numbers("-3 - 2 x 2"), [-3, -1, 1]);
        assert_eq!(numbers("-1,-9--8,1"), [-9, -8, -1, 1]);
        assert!(!"1-9x2".parse::<FrameRange>().unwrap().contains(4));
    }

    #[test]
    fn a_range_is_cut_at_numbers() {
        for (text, end, cut) in [
            ("1-241", 240, "1-240"),
            ("235-250", 240, "235-240"),
            ("1-9x4,3,7-8", 7, "1-5x4,3,7"),
            ("1-9x4,20-30", 3, "1"),
            ("4,2", 9, "2,4"),
        ] {
            let range: FrameRange = text.parse().unwrap();
            assert_eq!(range.within(1, end).unwrap().to_string(), cut);
        }
        let range: FrameRange = "-9-9x4,20".parse().unwrap();
        assert_eq!(range.within(-3, 2).unwrap().to_string(), "-1");
        assert_eq!(range.within(-5, 4).unwrap().to_string(), "-5-3x4");
        let range: FrameRange = "5-9,12".parse().unwrap();
        assert_eq!(range.within(1, 4), None);
    }

    #[test]
    fn the_ends_of_the_numbers() {
        assert_eq!(
            numbers("4294967294-4294967295"),
            [LARGEST as i64 - 1, LARGEST as i64]
        );
        assert_eq!(numbers("1-4294967295x4294967294"), [1, LARGEST as i64]);
        let all: FrameRange = "1-4294967295".parse().unwrap();
        assert_eq!(all.count(), LARGEST);
        assert_eq!(all.iter().nth(1000), Some(1001));
        assert_eq!(FrameRange::up_to(3).iter().collect::<Vec<_>>(), [1, 2, 3]);
    }

    #[test]
    fn what_is_no_range_is_refused_with_the_part_that_is_wrong() {
        for text in [
            "",
            ",",
            "1,",
            "a",
            "1-",
            "-",
            "--1",
            "1--",
            "1---2",
            "1-2-3",
            "1x2",
            "1-9x",
            "1-9x2x3",
            "+1",
            "1.5",
            "4294967296",
            "-4294967296",
            "١",
        ] {
            let error = text.parse::<FrameRange>().unwrap_err().to_string();
            assert!(error.contains("is not a range"), "{text}: {error}");
        }
        for text in ["1-3x0", "0-0:0", "1-9:-1"] {
            let error = text.parse::<FrameRange>().unwrap_err().to_string();
            assert!(error.contains("no step above 0"), "{text}: {error}");
        }
        let error = "1--2".parse::<FrameRange>().unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("`1--2` ends before it begins")
        );
        let error = "1-3,5-1".parse::<FrameRange>().unwrap_err();
        assert!(error.to_string().starts_with("`5-1` ends before it begins"));
    }
}
