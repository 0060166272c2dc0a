//! What is told of frames that were drawn: how right they are, and what they took.

use std::io::{self, Write};
use std::time::Duration;

use super::super::progress::{Report, duration};
use super::plan::Plan;
use super::tally::Tally;
use crate::isoradial::EdgeError;
use crate::render::batch::Effort;

impl Plan<'_> {
    /// Says what an edge may be off by where that is more than was asked for, and what would help.
    pub(super) fn tell_errors(&self, tally: &Tally, report: Report) {
        let unresolved = tally.count_ray_by_ray();
        let Some((
            number,
            Effort {
                error, ray_by_ray, ..
            },
        )) = tally.worst()
        else {
            return;
        };
        let of = if self.animation.is_still() {
            "this picture".into()
        } else {
            format!("frame {number}")
        };
        if unresolved > 0 {
            let frames = match unresolved {
                1 => "every pixel's ray is".into(),
                count => format!("every pixel's ray of {count} such frames is"),
            };
            report.note(format_args!(
                "the isoradial curves of {of} are only right to {:.1e} pixels, so {frames} followed by itself, which takes a hundred times as long and leaves hard edges",
                error.total()
            ));
        }
        let off = if ray_by_ray {
            error.angles + error.rounding
        } else {
            error.total()
        };
        let allowed = self.first.tolerance();
        if off > allowed {
            let EdgeError {
                angles, rounding, ..
            } = error;
            report.note(format_args!(
                "an edge of {of} may be off by {off:.1e} pixels, more than the {allowed:?} asked for: {}",
                if angles > rounding {
                    self.needs.advice()
                } else {
                    "double precision cannot do better".into()
                }
            ));
        }
    }

    /// Tells what the parts of the work took, all threads together. Of one picture culling and edges are told too, which are done
    /// once more by themselves for it.
    pub(super) fn tell_timings(&self, tally: &Tally, elapsed: Duration) -> anyhow::Result<()> {
        let mut lines: Vec<(&str, Duration)> = tally.times().into();
        lines.push(("all, from the first frame to the last", elapsed));
        let mut stderr = io::stderr();
        for (name, time) in lines {
            let _ = writeln!(stderr, "{:>10}  {name}", duration(time));
        }
        Ok(())
    }
}
