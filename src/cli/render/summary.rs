//! The report after a run: what was drawn, how accurate it is, and what it took.

use std::io::{self, Write};

use super::super::destination::Destination;
use super::super::method::Method;
use super::super::progress::{Report, count, duration, warn};
use super::draw::FrameReport;
use super::plan::Plan;
use super::run::Outcome;
use super::run_stats::Counts;

/// Reports a run.
///
/// # Errors
/// Frames that failed; an interrupted run.
pub(super) fn report(
    plan: &Plan<'_>,
    method: &Method,
    outcome: &Outcome,
    report: Report,
) -> anyhow::Result<()> {
    let counts = &*outcome.stats.counts();
    let (drawn, kept, others) = (counts.drawn, counts.finished_before, counts.by_others);
    if drawn > 0 {
        report_errors(plan, counts, report);
        if plan.args.timings {
            print_timings(counts, outcome);
        }
    }
    let finished = drawn + kept + others;
    let interrupted = outcome.interrupt.check(|| {
        let rest = match plan.destination {
            _ if finished == plan.count => "",
            Destination::Sequence(_) => "; the same command continues from there",
            _ => "; an unfinished file is not kept",
        };
        let verb = if plan.count == 1 { "is" } else { "are" };
        format!(
            "{finished} of {} {verb} finished{rest}",
            count(plan.count, "frame")
        )
    });
    match (counts.failures(&plan.destination), &interrupted) {
        (Some(failures), Ok(())) => anyhow::bail!("{failures}"),
        (Some(failures), Err(_)) => warn(failures),
        (None, _) => {}
    }
    interrupted?;

    let (destination, size) = (&plan.destination, plan.first.size());
    let what = format!("{} × {}, {method}", size.width, size.height);
    let time = duration(outcome.elapsed);
    if plan.count == 1 {
        let number = plan.frames.iter().next().unwrap_or(1);
        let file = match destination {
            Destination::Sequence(pattern) => pattern.file(number).display().to_string(),
            _ => destination.to_string(),
        };
        if others > 0 {
            report.note(format_args!("{file}: another run drew the frame"));
        } else if drawn == 0 {
            report.note(format_args!("{file}: the frame was finished before"));
        } else {
            report.note(format_args!("{file}: {what}, drawn in {time}"));
        }
    } else if drawn + others == 0 {
        report.note(format_args!(
            "{destination}: all frames were finished before"
        ));
    } else {
        let rate = drawn as f64 / outcome.elapsed.as_secs_f64();
        let before = match kept {
            0 => String::new(),
            1 => "; 1 was finished before".into(),
            kept => format!("; {kept} were finished before"),
        };
        let elsewhere = match others {
            0 => String::new(),
            others => format!("; other runs drew {others}"),
        };
        report.note(format_args!(
            "{destination}: {} of {what}, in {time}, {rate:.1} frames/s{before}{elsewhere}",
            count(drawn, "frame")
        ));
    }
    Ok(())
}

/// Reports the largest error of an edge where it exceeds the tolerance, and what would help.
fn report_errors(plan: &Plan<'_>, counts: &Counts, report: Report) {
    let Some((
        number,
        FrameReport {
            error, ray_by_ray, ..
        },
    )) = counts.worst
    else {
        return;
    };
    let frame = if plan.animation.is_still() {
        "this picture".into()
    } else {
        format!("frame {number}")
    };
    if counts.ray_by_ray > 0 {
        let of = match counts.ray_by_ray {
            1 => String::new(),
            count => format!(" of {count} such frames"),
        };
        report.note(format_args!(
            "the isoradial curves of {frame} are only right to {:.1e} pixels, so every pixel's ray{of} is followed by \
             itself: this takes a hundred times as long and leaves hard edges",
            error.total()
        ));
    }
    let off = if ray_by_ray {
        error.angles + error.rounding
    } else {
        error.total()
    };
    let allowed = plan.first.tolerance();
    if off > allowed {
        let advice = match plan.needs.table() {
            _ if error.angles <= error.rounding => "double precision cannot do better".into(),
            Some(table) => format!("the {} table is good enough", table.name),
            None => "no table is good enough, --method exact is".into(),
        };
        report.note(format_args!(
            "an edge of {frame} may be off by {off:.1e} pixels, more than the {allowed:?} asked for: {advice}"
        ));
    }
}

/// Prints the times of the parts of the work, which add up to the first line's: the time of all threads that drew
/// frames of their own.
fn print_timings(counts: &Counts, outcome: &Outcome) {
    let (threads, sky) = (outcome.threads as u32, outcome.reading_sky);
    let by_the_clock = outcome.elapsed + sky.unwrap_or_default();
    let drawing = outcome.elapsed * threads;
    let all = drawing + sky.unwrap_or_default();
    let rest = drawing.saturating_sub(counts.times.iter().sum());
    let names = ["memory", "curves", "render", "encode", "write"];
    let lines = (sky.into_iter().map(|time| ("reading the sky", time)))
        .chain(names.into_iter().zip(counts.times))
        .chain([("waiting and the rest", rest)]);
    let mut stderr = io::stderr();
    let on_threads = match threads {
        1 => String::new(),
        _ => format!(
            " on {threads} threads, {} by the clock",
            duration(by_the_clock)
        ),
    };
    let _ = writeln!(stderr, "{:>10}  in all{on_threads}", duration(all));
    for (name, time) in lines {
        let _ = writeln!(stderr, "{:>10}    {name}", duration(time));
    }
}
