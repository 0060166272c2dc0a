//! The run: frames are drawn, written and counted.

use std::convert::Infallible;
use std::time::{Duration, Instant};

use super::super::interrupt::Interrupt;
use super::super::method::Method;
use super::super::picture::Destination;
use super::super::progress::{FrameProgress, ProgressKind, Report, duration, warn};
use super::film::{Broken, Film};
use super::memory::Limit;
use super::output::Output;
use super::pattern::Pattern;
use super::plan::{Plan, origin_of};
use super::sequence;
use super::tally::Tally;
use crate::render::batch::{self, Drawn, Effort, Frames, Sharing};
use crate::render::png::Origin;

/// Draws the frames of a plan.
///
/// # Errors
/// Frames that could not be drawn or written; [`Interrupted`](super::super::interrupt::Interrupted).
pub(super) fn draw(
    plan: &Plan<'_>,
    frames: &impl Frames,
    method: &Method,
    report: Report,
) -> anyhow::Result<()> {
    let interrupt = Interrupt::install()?;
    let size = plan.first.image();
    let pixels = u64::from(size.width) * u64::from(size.height);
    let how = match plan.args.progress {
        ProgressKind::Auto if plan.count == 1 => ProgressKind::None,
        how => how,
    };
    let origin = origin_of(plan.animation, method);
    let start = Instant::now();
    if let Output::Sequence(pattern) = &plan.output {
        plan.prepare(pattern, frames, &origin)?;
    }
    let run = Run {
        plan,
        origin,
        progress: report.frames(how, plan.count, pixels),
        tally: Tally::default(),
        interrupt,
    };
    match &plan.output {
        Output::Picture(destination) => run.picture(frames, destination)?,
        Output::Sequence(pattern) => run.sequence(frames, pattern),
        Output::Film(format, place) => {
            let film = Film::begin(*format, place, size, plan.animation.rate())?;
            run.film(frames, film)?;
        }
    }
    run.end(start, method, report)
}

/// Frames being drawn.
struct Run<'a> {
    plan: &'a Plan<'a>,
    origin: Origin,
    progress: FrameProgress,
    tally: Tally,
    interrupt: Interrupt,
}

impl Run<'_> {
    /// The numbers of the frames, until the run is asked to end.
    fn numbers(&self) -> impl Iterator<Item = u32> + Send + '_ {
        let numbers = self.plan.frames.iter();
        numbers.take_while(|_| !self.interrupt.is_asked())
    }

    /// How the threads share frames out.
    fn sharing(&self) -> Sharing {
        let limit = Limit(self.plan.args.max_memory);
        limit.sharing(self.plan.first.image(), self.plan.count)
    }

    fn origin(&self, number: u32) -> Origin {
        Origin {
            frame: number,
            ..self.origin.clone()
        }
    }

    /// Draws the one frame into one file, or to the standard output.
    fn picture(&self, frames: &impl Frames, destination: &Destination) -> anyhow::Result<()> {
        batch::draw(
            frames,
            self.numbers(),
            Sharing::OneByOne,
            |_| true,
            |drawn| {
                let Drawn { number, pixels, .. } = drawn;
                let (pixels, effort) = pixels?;
                let start = Instant::now();
                let png = self.plan.encode(pixels, &self.origin(number))?;
                let encoded = Instant::now();
                destination.write(&png)?;
                self.done(number, effort, (encoded - start, encoded.elapsed()));
                anyhow::Ok(())
            },
        )
    }

    /// Draws each frame that is missing into its file. One that fails stops no other.
    fn sequence(&self, frames: &impl Frames, pattern: &Pattern) {
        let wanted = |number| {
            let keep = !self.plan.args.overwrite
                && sequence::is_finished(
                    &pattern.file(number),
                    self.plan.most_bytes(),
                    &self.origin(number),
                );
            if keep {
                self.tally.finished_before();
                self.progress.passed_over();
            }
            !keep
        };
        let done = |drawn: Drawn<'_>| {
            let number = drawn.number;
            if let Err(error) = self.write_frame(drawn, pattern) {
                self.tally.failed(number, &error);
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = batch::draw(frames, self.numbers(), self.sharing(), wanted, done);
    }

    fn write_frame(&self, drawn: Drawn<'_>, pattern: &Pattern) -> anyhow::Result<()> {
        let Drawn { number, pixels, .. } = drawn;
        let (pixels, effort) = pixels?;
        let start = Instant::now();
        let png = self.plan.encode(pixels, &self.origin(number))?;
        let encoded = Instant::now();
        // The reason without the file's name: the failures of many frames are told together.
        sequence::write(&pattern.file(number), &png, &self.plan.inputs)
            .map_err(|error| anyhow::anyhow!("{pattern} cannot be written: {error}"))?;
        self.done(number, effort, (encoded - start, encoded.elapsed()));
        Ok(())
    }

    /// Draws all frames into one file or pipe.
    fn film(&self, frames: &impl Frames, film: Film) -> anyhow::Result<()> {
        let done = |drawn: Drawn<'_>| {
            let (number, place) = (drawn.number, drawn.place);
            let (pixels, effort) = match drawn.pixels {
                Ok((pixels, effort)) => (Ok(pixels), effort),
                Err(error) => (Err(error.into()), Effort::default()),
            };
            let start = Instant::now();
            film.write(place, pixels)?;
            self.done(number, effort, (Duration::ZERO, start.elapsed()));
            Ok::<(), Broken>(())
        };
        let drawn = batch::draw(frames, self.numbers(), self.sharing(), |_| true, done);
        if drawn.is_ok() && self.tally.count_drawn() < self.plan.count {
            // The run was asked to end: what is not whole is not kept.
            return Ok(());
        }
        film.finish()
    }

    fn done(&self, number: u32, effort: Effort, times: (Duration, Duration)) {
        self.tally.drawn(number, effort, times);
        self.progress.done();
    }

    /// Says what was done, and what went wrong.
    fn end(self, start: Instant, method: &Method, report: Report) -> anyhow::Result<()> {
        let Self {
            plan,
            progress,
            tally,
            interrupt,
            ..
        } = self;
        drop(progress);
        let elapsed = start.elapsed();
        let (drawn, kept) = (tally.count_drawn(), tally.count_finished_before());
        if drawn > 0 {
            plan.tell_errors(&tally, report);
        }
        if plan.args.timings && drawn > 0 {
            plan.tell_timings(&tally, elapsed)?;
        }
        let failures = tally.failures();
        let finished = drawn + kept;
        let stopped = interrupt.check(|| {
            let rest = match plan.output {
                _ if finished == plan.count => "",
                Output::Sequence(_) => "; the same command goes on from there",
                _ => "; nothing of an unfinished file is kept",
            };
            format!("{finished} of {} frames are finished{rest}", plan.count)
        });
        if let Some(failures) = failures {
            if stopped.is_err() {
                warn(&failures);
            } else {
                anyhow::bail!("{failures}");
            }
        }
        stopped?;
        let (output, size) = (&plan.output, plan.first.image());
        let what = format!("{} × {}, {method}", size.width, size.height);
        let time = duration(elapsed);
        if drawn == 0 {
            let all = if kept == 1 {
                "the frame was"
            } else {
                "all frames were"
            };
            report.note(format_args!("{output}: {all} finished before"));
            return Ok(());
        }
        if plan.count == 1 {
            report.note(format_args!("{output}: {what}, drawn in {time}"));
            return Ok(());
        }
        let rate = drawn as f64 / elapsed.as_secs_f64();
        let before = match kept {
            0 => String::new(),
            kept => format!("; {kept} were finished before"),
        };
        report.note(format_args!(
            "{output}: {drawn} frames of {what}, in {time}, {rate:.1} frames/s{before}"
        ));
        Ok(())
    }
}
