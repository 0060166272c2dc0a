//! The run: frames are drawn, written and counted.

use std::collections::HashMap;
use std::convert::Infallible;
use std::io::{self, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use bytesize::ByteSize;

use super::super::destination::Destination;
use super::super::interrupt::Interrupt;
use super::super::method::Method;
use super::super::pattern::Pattern;
use super::super::progress::{FrameProgress, ProgressKind, Report, warn};
use super::super::writable;
use super::claims::Claims;
use super::draw::{DrawnFrame, FrameReport, FrameSource};
use super::film::{Broken, Film};
use super::memory;
use super::origin::FrameOrigin;
use super::plan::Plan;
use super::run_stats::RunStats;
use super::sequence::{self, Survey};
use super::{options, sky};
use crate::output::claim::RunMark;
use crate::output::make_folder;
use crate::sky::SkySource;

/// The time between two looks at frames that other runs have claimed.
const PAUSE: Duration = Duration::from_millis(100);

/// What a run did.
pub(super) struct Outcome {
    pub(super) stats: RunStats,
    /// How many threads drew frames of their own.
    pub(super) threads: usize,
    /// What reading the sky took, where it was read.
    pub(super) reading_sky: Option<Duration>,
    /// From the first frame to the last.
    pub(super) elapsed: Duration,
    pub(super) interrupt: Interrupt,
}

/// Draws and writes the frames of a plan. The failures of single frames of a sequence are in the outcome.
///
/// # Errors
/// A picture or a film that cannot be drawn or written.
pub(super) fn run(plan: &Plan<'_>, method: &Method, report: Report) -> anyhow::Result<Outcome> {
    let interrupt = Interrupt::install()?;
    let rows = report.bar(u64::from(plan.first.size().height), "drawing", "rows");
    let row_done = || {
        if plan.count == 1 {
            rows.inc(1);
        }
    };
    let origin = plan.origin(method);
    let start = Instant::now();
    let sky = read_sky(plan, &origin, report)?;
    let reading_sky = sky.as_ref().map(|_| start.elapsed());
    let sky_bytes = sky.as_ref().map_or(0, |sky| sky::bytes(sky));
    let left = ByteSize(plan.args.max_memory.as_u64().saturating_sub(sky_bytes));
    let at_a_time = memory::frames_in(left, plan.first.size(), plan.form);
    let start = Instant::now();
    let (animation, form) = (plan.animation, plan.form);
    let stats = FrameSource::with(animation, form, method, sky, &row_done, |frames| {
        let kind = match plan.args.progress {
            ProgressKind::Auto if plan.count == 1 => ProgressKind::None,
            kind => kind,
        };
        let run = Run {
            plan,
            frames,
            origin,
            at_a_time,
            progress: report.frames(kind, plan.count, plan.pixels()),
            stats: RunStats::default(),
            interrupt: &interrupt,
        };
        match &plan.destination {
            destination if plan.format.is_film() => {
                let (size, rate) = (plan.first.size(), plan.animation.rate());
                run.film(Film::begin(plan.format, destination, size, rate)?)?;
            }
            Destination::Sequence(pattern) => run.sequence(pattern)?,
            destination => run.picture(destination)?,
        }
        anyhow::Ok(run.stats)
    })?;
    Ok(Outcome {
        stats,
        threads: FrameSource::threads(plan.count, at_a_time),
        reading_sky,
        elapsed: start.elapsed(),
        interrupt,
    })
}

/// Reads the sky, where a frame is to be drawn that shows its light.
///
/// # Errors
/// Those of [`sky::read`].
fn read_sky(
    plan: &Plan<'_>,
    origin: &FrameOrigin,
    report: Report,
) -> anyhow::Result<Option<Arc<SkySource>>> {
    let Some(sky) = plan.sky.filter(|_| plan.is_unfinished(origin)) else {
        return Ok(None);
    };
    let frame = memory::of_frame(plan.first.size(), plan.form);
    let source = sky::read(sky, frame, plan.args.max_memory, report)?;
    Ok(Some(Arc::new(source)))
}

/// What was there of a sequence when a run began.
struct Before {
    /// How many frames had a file that may be kept.
    present: u64,
    /// The [numbers](sequence::inode) of the files that are to be overwritten.
    inodes: HashMap<i64, u64>,
    /// Refuses runs with other settings until it is dropped.
    _mark: Option<RunMark>,
}

/// Makes the folder of a sequence, and checks that there is room for its files, and that no run with other settings is
/// drawing them.
fn prepare(
    plan: &Plan<'_>,
    pattern: &Pattern,
    frames: &FrameSource<'_>,
    origin: &FrameOrigin,
) -> anyhow::Result<Before> {
    let folder = pattern.folder();
    make_folder(folder).map_err(|error| {
        anyhow::anyhow!(
            "{}: the folder cannot be made: {error}; choose another place with -o",
            folder.display()
        )
    })?;
    let all = options::all_frames(plan.animation);
    let mark = sequence::join(pattern, origin, plan.depth());
    let Survey {
        present,
        foreign,
        left_over,
        is_contested,
    } = sequence::survey(pattern, plan.frames, &all, plan.is_ours(), mark.as_ref());
    if is_contested {
        anyhow::bail!(
            "{pattern}: another run is drawing these files with another scene, sky, table or version; wait until it \
             ends, or choose another name with -o"
        );
    }
    let files = |numbers: Vec<i64>| numbers.into_iter().map(|number| pattern.file(number));
    if !foreign.is_empty() && !plan.args.overwrite {
        return Err(sequence::foreign(files(foreign)));
    }
    if !left_over.is_empty() {
        warn(format_args!(
            "{}: left from before, and no frame of the animation, whose frames are {all}",
            sequence::list(files(left_over))
        ));
    }
    let missing = plan.count.saturating_sub(present);
    let most = missing.saturating_mul(plan.most_bytes());
    if writable::free_space(folder).is_some_and(|free| most > free) {
        // The bound is far above most files: three frames give a better estimate.
        let bytes = missing.saturating_mul(sample(plan, frames, origin)?);
        writable::check_space(&pattern.file(1), bytes)?;
    }
    let mut inodes = HashMap::new();
    if plan.args.overwrite {
        let inode = |number| Some((number, sequence::inode(&pattern.file(number))?));
        inodes.extend(plan.frames.iter().filter_map(inode));
    }
    Ok(Before {
        present: if plan.args.overwrite { 0 } else { present },
        inodes,
        _mark: mark,
    })
}

/// The size of the largest file of the first, the middle and the last frame.
fn sample(plan: &Plan<'_>, frames: &FrameSource<'_>, origin: &FrameOrigin) -> anyhow::Result<u64> {
    let range = plan.frames;
    let (first, last) = (range.iter().next().unwrap_or(1), range.last());
    let middle = range.above(first.midpoint(last)).unwrap_or(last);
    let most = AtomicU64::new(0);
    let done = |drawn: DrawnFrame<'_>| {
        let file = plan.encode(drawn.pixels?.0, origin)?;
        most.fetch_max(file.len() as u64, Ordering::Relaxed);
        anyhow::Ok(())
    };
    frames.draw_all([first, middle, last].into_iter(), 3, 1, |_| true, done)?;
    Ok(most.into_inner())
}

/// Frames being drawn.
struct Run<'a> {
    plan: &'a Plan<'a>,
    frames: &'a FrameSource<'a>,
    origin: FrameOrigin,
    /// How many frames may be drawn at a time.
    at_a_time: u64,
    progress: FrameProgress,
    stats: RunStats,
    interrupt: &'a Interrupt,
}

impl Run<'_> {
    /// Draws the frames of `numbers`, about `count`, that are `wanted`, until the run is interrupted.
    fn draw<E: Send>(
        &self,
        numbers: impl Iterator<Item = i64> + Send,
        count: u64,
        wanted: impl Fn(i64) -> bool + Sync,
        done: impl Fn(DrawnFrame<'_>) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let numbers = numbers.take_while(|_| !self.interrupt.is_asked());
        self.frames
            .draw_all(numbers, count, self.at_a_time, wanted, done)
    }

    /// Draws all frames of the plan, until the run is interrupted.
    fn draw_plan<E: Send>(
        &self,
        done: impl Fn(DrawnFrame<'_>) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        self.draw(self.plan.frames.iter(), self.plan.count, |_| true, done)
    }

    /// Draws one frame into one file, or to the standard output.
    fn picture(&self, destination: &Destination) -> anyhow::Result<()> {
        self.draw_plan(|drawn| self.encode_and_write(drawn, |file| destination.write(file)))
    }

    /// Draws each missing frame into its file, unless another run does, and waits until all are there. A frame that
    /// fails stops no other.
    ///
    /// # Errors
    /// The folder cannot be made or has no room, or another run draws these frames with other settings.
    fn sequence(&self, pattern: &Pattern) -> anyhow::Result<()> {
        let before = prepare(self.plan, pattern, self.frames, &self.origin)?;
        let claims = Claims::default();
        // The reason without the frame's own file name: equal reasons of many frames are reported together.
        let unwritable = |error: io::Error| anyhow::anyhow!("cannot be written: {error}");
        let wanted = |number| {
            if self.is_finished(number, &before) {
                return false;
            }
            match sequence::claim(&pattern.file(number), &self.plan.inputs) {
                // Another run may have finished the frame before the claim.
                Ok(Some(_)) if self.is_finished(number, &before) => return false,
                Ok(Some(file)) => {
                    claims.keep(number, file);
                    return true;
                }
                Ok(None) => claims.leave(number),
                Err(error) => self.stats.failed(number, &unwritable(error)),
            }
            false
        };
        let done = |drawn: DrawnFrame<'_>| {
            let number = drawn.number;
            if let Some(mut claimed) = claims.take(number) {
                let write = |bytes: &[u8]| {
                    let written = claimed.file().write_all(bytes);
                    written.and_then(|()| claimed.finish()).map_err(unwritable)
                };
                if let Err(error) = self.encode_and_write(drawn, write) {
                    self.stats.failed(number, &error);
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = self.draw(self.plan.frames.iter(), self.plan.count, wanted, done);
        for round in 0.. {
            let left = claims.take_left();
            if left.is_empty() || self.interrupt.is_asked() {
                break;
            }
            if round == 1 {
                self.progress.waiting(left.len() as u64);
            }
            if round > 0 {
                thread::sleep(PAUSE);
            }
            let Ok(()) = self.draw(left.iter().copied(), left.len() as u64, wanted, done);
        }
        self.stats.attribute(before.present);
        if self.stats.counts().by_others > 0 {
            sequence::clean(pattern, self.plan.frames);
        }
        Ok(())
    }

    /// Whether a frame is there already, and counts it if so. With `--overwrite` the files that were there `before` do
    /// not count, but those that other runs of the same command put in their place.
    fn is_finished(&self, number: i64, before: &Before) -> bool {
        let file = self.plan.destination.file(number);
        let old = before.inodes.get(&number);
        let is_old = old.is_some_and(|&old| sequence::inode(&file) == Some(old));
        let is_finished = !is_old && self.plan.is_there(number, &self.origin);
        if is_finished {
            self.stats.finished_before();
            self.progress.skipped();
        }
        is_finished
    }

    fn encode_and_write(
        &self,
        DrawnFrame { number, pixels, .. }: DrawnFrame<'_>,
        write: impl FnOnce(&[u8]) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let (pixels, effort) = pixels?;
        let start = Instant::now();
        let file = self.plan.encode(pixels, &self.origin.of_frame(number))?;
        let encoded = Instant::now();
        write(&file)?;
        self.done(number, effort, encoded - start, encoded.elapsed());
        Ok(())
    }

    /// Draws all frames into one file or pipe.
    fn film(&self, film: Film<'_>) -> anyhow::Result<()> {
        // Memory for encoded frames: as many as threads use at a time.
        let spare = Mutex::new(Vec::new());
        let spare = || spare.lock().unwrap_or_else(PoisonError::into_inner);
        let done = |drawn: DrawnFrame<'_>| {
            let (number, place) = (drawn.number, drawn.place);
            let start = Instant::now();
            let mut memory = spare().pop().unwrap_or_default();
            let (frame, effort) = match drawn.pixels {
                Ok((pixels, effort)) => (Ok(film.encode(pixels, &mut memory)), effort),
                Err(error) => (Err(error.into()), FrameReport::default()),
            };
            let encoded = Instant::now();
            film.write(place, frame)?;
            self.done(number, effort, encoded - start, encoded.elapsed());
            spare().push(memory);
            Ok::<(), Broken>(())
        };
        let drawn = self.draw_plan(done);
        if drawn.is_ok() && self.stats.counts().drawn < self.plan.count {
            // The run was interrupted: an unfinished film is not kept.
            return Ok(());
        }
        film.finish()
    }

    fn done(&self, number: i64, effort: FrameReport, encoding: Duration, writing: Duration) {
        self.stats.drawn(number, effort, encoding, writing);
        self.progress.done();
    }
}
