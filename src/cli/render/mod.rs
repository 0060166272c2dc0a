//! `darkness render`: a scene's picture, or the frames of its animation.

mod explain;
mod film;
mod output;
pub(super) mod pattern;
mod sequence;
mod tally;

use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use explain::explain;
use film::{Broken, Film, Place};
use output::{FormatName, Output};
use pattern::Pattern;
use tally::Tally;

use super::interrupt::Interrupt;
use super::method::{Checked, Method, MethodArgs, hex};
use super::picture::Destination;
use super::progress::{FrameProgress, ProgressKind, Report, duration};
use super::target::{self, Room};
use super::{Misuse, StdoutError, Threads, start_threads};
use crate::isoradial::{EdgeError, Isoradials};
use crate::orbit::exact::Exact;
use crate::render::batch::{self, Curved, Drawn, Effort, Frames, RayByRay};
use crate::render::needs::Needs;
use crate::render::png::{self, Origin};
use crate::render::{coverage, cull, mask};
use crate::scene::animation::FrameRange;
use crate::scene::{Animation, DEFAULT_SCENE, Scene, View};

/// Render a scene as a PNG picture, or its animation as numbered PNG pictures or a film
///
/// The table, the orders of the image and the nodes of their curves are the fewest with which every edge is right to
/// the scene's tolerance; --explain tells which they are.
///
/// Frames that are there already, whole and of the same scene, table and version, are left as they are: the same command
/// goes on after whatever stopped it. The first Ctrl-C or SIGTERM finishes the frames begun, the second ends at once.
#[derive(Debug, Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a switch of the command line"
)]
pub(super) struct RenderArgs {
    /// A scene's TOML file, or the name of a built-in scene (`darkness scene` lists them)
    #[arg(value_name = "SCENE", default_value = DEFAULT_SCENE)]
    scene: PathBuf,
    /// Where the picture goes: a file ending in .png, or - for the standard output. The frames of an animation: a name with
    /// #### or %04d in place of the number, or a film's file ending in .y4m or .raw [default: the scene's name with .png, or
    /// with _####.png for an animation, in the current folder]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// What is written, where the ending of the name does not say it
    #[arg(long, value_name = "FORMAT", value_enum)]
    format: Option<FormatName>,
    /// Which frames of an animation: 12, 1-240, every tenth as 1-240x10 or 1-240:10, several with commas [default: all]
    #[arg(long, value_name = "RANGE")]
    frames: Option<FrameRange>,
    /// Draw frames that are there already too
    #[arg(long)]
    overwrite: bool,
    /// List the frames and their files, and draw nothing
    #[arg(long, conflicts_with = "explain")]
    dry_run: bool,
    /// How progress is told on the standard error
    #[arg(long, value_name = "HOW", value_enum, default_value_t = ProgressKind::Auto)]
    progress: ProgressKind,
    /// The picture's size in pixels, such as 1920x1080, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,
    /// What an edge may be off by, in pixels, above 0 and at most 1, in place of the scene's
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Smooth edges: each pixel is the share of its square that the disk covers; with false, what its centre sees. In
    /// place of the scene's; the methods that follow single rays know hard edges only
    #[arg(long, value_name = "true|false", action = clap::ArgAction::Set)]
    antialias: Option<bool>,
    /// Tell what each part of the work took: curves, render, encode, write; of one picture also culling and edges
    #[arg(long, conflicts_with_all = ["explain", "dry_run"])]
    timings: bool,
    /// Tell what the picture needs and what it does not, and draw nothing
    #[arg(long, conflicts_with = "output")]
    explain: bool,
    /// Make no table where it is missing, but fail: for one of many workers
    #[arg(long)]
    require_table: bool,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    threads: Threads,
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', 'X', '×']);
    let sides = sides.and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    sides.ok_or_else(|| "a size is written width x height, in pixels: 1920x1080".into())
}

/// Runs the verb.
pub(super) fn run(args: &RenderArgs, report: Report) -> anyhow::Result<()> {
    let run = || {
        let animation = animation(args)?;
        let frames = frames(args, &animation)?;
        if args.explain {
            return explain_one(args, &animation, &frames, report);
        }
        let job = Job::new(args, &animation, &frames)?;
        if args.dry_run {
            return job.list();
        }
        job.run(report)
    };
    run().inspect_err(|error| {
        if args.progress == ProgressKind::Openjd {
            let text = error.to_string().replace('\n', " ");
            let _ = writeln!(io::stderr(), "openjd_fail: {text}");
        }
    })
}

/// The scene asked for, with what the options change of it.
fn animation(args: &RenderArgs) -> anyhow::Result<Animation> {
    for (given, flag) in [
        (args.tolerance.is_some(), "tolerance"),
        (args.explain, "explain"),
        (args.antialias == Some(true), "antialias"),
        (args.timings, "timings"),
    ] {
        if given && !args.method.is_table() {
            return Err(Misuse::CurvesUnused { flag }.into());
        }
    }
    if args.require_table && !args.method.is_table() {
        return Err(Misuse::TableUnused.into());
    }
    let mut animation = Animation::load(&args.scene)?;
    if let Some((width, height)) = args.size {
        let sized = animation.with_size(width, height);
        animation = sized.map_err(|source| Misuse::Size {
            width,
            height,
            source,
        })?;
    }
    if let Some(antialias) = args.antialias {
        animation = animation.with_antialias(antialias)?;
    }
    if let Some(pixels) = args.tolerance {
        animation = animation
            .with_tolerance(pixels)
            .map_err(Misuse::Tolerance)?;
    }
    Ok(animation)
}

/// The frames asked for, each of which can be.
fn frames(args: &RenderArgs, animation: &Animation) -> anyhow::Result<FrameRange> {
    let all = FrameRange::up_to(animation.frames());
    let frames = args.frames.clone().unwrap_or(all);
    if let Err(source) = animation.frame(frames.last())
        && frames.last() > animation.frames()
    {
        let range = frames.to_string();
        return Err(Misuse::Frames { range, source }.into());
    }
    for number in frames.iter() {
        animation.check(number)?;
    }
    Ok(frames)
}

/// Tells what one frame needs.
fn explain_one(
    args: &RenderArgs,
    animation: &Animation,
    frames: &FrameRange,
    report: Report,
) -> anyhow::Result<()> {
    let number = frames.iter().next().unwrap_or(1);
    if args.frames.is_some() && frames.count() > 1 {
        return Err(Misuse::ExplainsOne.into());
    }
    let scene = animation.frame(number)?;
    let needs = Needs::new(&scene, &View::new(&scene));
    let needed = needs.table().map(|candidate| candidate.name);
    let checked = args.method.check(needed)?;
    start_threads(args.threads.threads)?;
    let method = ready(args, checked, report)?;
    let table = args.method.table_path(needed);
    explain(&scene, &needs, &method, table.as_deref())
}

/// The method, its table made where that is allowed.
fn ready(args: &RenderArgs, checked: Checked, report: Report) -> anyhow::Result<Method> {
    if args.require_table {
        Ok(checked.without_making()?)
    } else {
        checked.ready(report)
    }
}

/// Frames to be drawn, and where they go: checked.
struct Job<'a> {
    args: &'a RenderArgs,
    animation: &'a Animation,
    frames: &'a FrameRange,
    count: u64,
    first: Scene,
    output: Output,
    needs: Needs,
    checked: Checked,
}

impl<'a> Job<'a> {
    /// Checks all that can be before anything is drawn.
    ///
    /// # Errors
    /// What stands in the way.
    fn new(
        args: &'a RenderArgs,
        animation: &'a Animation,
        frames: &'a FrameRange,
    ) -> anyhow::Result<Self> {
        let count = frames.count();
        let output = Output::new(args, animation, count)?;
        let needs = Needs::of_animation(animation)?;
        let needed = needs.table().map(|candidate| candidate.name);
        if let Some(table) = args.method.table_path(needed) {
            output.spares(&table, frames)?;
        }
        let checked = args.method.check(needed)?;
        let first = animation.frame(frames.iter().next().unwrap_or(1))?;
        if !args.dry_run
            && let Output::Film(format, Place::File(path)) = &output
        {
            target::check_room(path, format.bytes(first.image(), count))?;
        }
        Ok(Self {
            args,
            animation,
            frames,
            count,
            first,
            output,
            needs,
            checked,
        })
    }

    /// Prints each frame's number, its file, and whether it would be drawn.
    fn list(self) -> anyhow::Result<()> {
        // A table that is yet to be made has made no frame.
        let origin = self
            .checked
            .without_making()
            .ok()
            .map(|method| origin_of(self.animation, &method));
        let mut stdout = io::BufWriter::new(io::stdout().lock());
        let print = |out: &mut dyn Write| {
            for number in self.frames.iter() {
                let file = self.output.file(number);
                let is_finished = |origin: &Origin| {
                    let origin = Origin {
                        frame: number,
                        ..origin.clone()
                    };
                    sequence::is_finished(&file, &origin)
                };
                let kept = matches!(self.output, Output::Sequence(_))
                    && !self.args.overwrite
                    && origin.as_ref().is_some_and(is_finished);
                let state = if kept { "finished" } else { "to draw" };
                writeln!(out, "{number}\t{state}\t{}", file.display())?;
            }
            out.flush()
        };
        print(&mut stdout).map_err(StdoutError)?;
        Ok(())
    }

    /// Draws the frames.
    fn run(mut self, report: Report) -> anyhow::Result<()> {
        start_threads(self.args.threads.threads)?;
        let placeholder = Checked::Ready(Method::Exact);
        let checked = std::mem::replace(&mut self.checked, placeholder);
        let method = ready(self.args, checked, report)?;
        let bar = report.bar(u64::from(self.first.image().height), "drawing", "rows");
        let single = self.count == 1;
        let row_done = || {
            if single {
                bar.inc(1);
            }
        };
        let animation = self.animation;
        match &method {
            Method::Table(table) => {
                self.draw(&Curved::new(animation, &table.lookup()), &method, report)
            }
            Method::NoTable => self.draw(&Curved::new(animation, &Exact), &method, report),
            Method::Exact => self.draw(
                &RayByRay::new(animation, &Exact, &row_done),
                &method,
                report,
            ),
            Method::Integrate(adaptive) => self.draw(
                &RayByRay::new(animation, adaptive, &row_done),
                &method,
                report,
            ),
        }
    }

    fn draw(&self, frames: &impl Frames, method: &Method, report: Report) -> anyhow::Result<()> {
        let interrupt = Interrupt::install()?;
        let size = self.first.image();
        let pixels = u64::from(size.width) * u64::from(size.height);
        let how = if self.count == 1 && self.args.progress == ProgressKind::Auto {
            ProgressKind::None
        } else {
            self.args.progress
        };
        let origin = origin_of(self.animation, method);
        let (start, tally) = (Instant::now(), Tally::default());
        if let Output::Sequence(pattern) = &self.output {
            self.prepare(pattern, frames, &origin)?;
        }
        let run = Run {
            job: self,
            origin,
            progress: report.frames(how, self.count, pixels),
            tally,
            interrupt,
        };
        match &self.output {
            Output::Picture(destination) => run.picture(frames, destination)?,
            Output::Sequence(pattern) => run.sequence(frames, pattern),
            Output::Film(format, place) => {
                let film = Film::begin(*format, place, size, self.animation.rate())?;
                run.film(frames, film)?;
            }
        }
        run.end(start, method, report)
    }

    /// Makes the folder of a sequence, and looks whether there is room for what will be in it.
    fn prepare(
        &self,
        pattern: &Pattern,
        frames: &impl Frames,
        origin: &Origin,
    ) -> anyhow::Result<()> {
        let folder = pattern.folder();
        fs::create_dir_all(folder).map_err(|error| {
            anyhow::anyhow!(
                "{}: the folder cannot be made: {error}; choose another place with -o",
                folder.display()
            )
        })?;
        let present = sequence::look_through(pattern, self.frames);
        let missing = self.count.saturating_sub(present);
        if let Room::Known(room) = target::room(folder) {
            // A frame is never larger than its pixels and a little, and mostly far smaller: what three of them take tells.
            let size = self.first.image();
            let most = missing
                .saturating_mul(u64::from(size.width) * u64::from(size.height) * 17 / 16 + 1024);
            if most > room {
                let bytes = missing.saturating_mul(self.sample(frames, origin)?);
                target::check_room(&pattern.file(1), bytes)?;
            }
        }
        Ok(())
    }

    /// The most bytes that the first, the middle and the last frame take.
    fn sample(&self, frames: &impl Frames, origin: &Origin) -> anyhow::Result<u64> {
        let (first, last) = (self.frames.iter().next().unwrap_or(1), self.frames.last());
        let mut pixels = Vec::new();
        let mut most = 0;
        for number in [first, first.midpoint(last), last] {
            frames.draw(number, true, &mut pixels)?;
            most = most.max(self.encode(&pixels, origin)?.len() as u64);
        }
        Ok(most)
    }

    fn encode(&self, pixels: &[u8], origin: &Origin) -> io::Result<Vec<u8>> {
        let size = self.first.image();
        let one_bit = !self.first.antialias() || !self.args.method.is_table();
        png::encode(pixels, (size.width, size.height), one_bit, origin)
    }
}

/// What frames are made of, but for their number.
fn origin_of(animation: &Animation, method: &Method) -> Origin {
    Origin {
        scene: hex(animation.to_toml().as_bytes()),
        table: method.fingerprint(),
        frame: 0,
    }
}

/// Frames being drawn.
struct Run<'a> {
    job: &'a Job<'a>,
    origin: Origin,
    progress: FrameProgress,
    tally: Tally,
    interrupt: Interrupt,
}

impl Run<'_> {
    /// The numbers of the frames, until the run is asked to end.
    fn numbers(&self) -> (impl Iterator<Item = u32> + Send + '_, u64) {
        let numbers = self.job.frames.iter();
        let numbers = numbers.take_while(|_| !self.interrupt.is_asked());
        (numbers, self.job.count)
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
            |_| true,
            |drawn| {
                let Drawn { number, pixels, .. } = drawn;
                let (pixels, effort) = pixels?;
                let start = Instant::now();
                let png = self.job.encode(pixels, &self.origin(number))?;
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
            let keep = !self.job.args.overwrite
                && sequence::is_finished(&pattern.file(number), &self.origin(number));
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
                self.progress.passed_over();
            }
            Ok::<(), std::convert::Infallible>(())
        };
        let Ok(()) = batch::draw(frames, self.numbers(), wanted, done);
    }

    fn write_frame(&self, drawn: Drawn<'_>, pattern: &Pattern) -> anyhow::Result<()> {
        let Drawn { number, pixels, .. } = drawn;
        let (pixels, effort) = pixels?;
        let start = Instant::now();
        let png = self.job.encode(pixels, &self.origin(number))?;
        let encoded = Instant::now();
        // The reason without the file's name: the failures of many frames are told together.
        sequence::write(&pattern.file(number), &png)
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
        let drawn = batch::draw(frames, self.numbers(), |_| true, done);
        if drawn.is_ok() && self.interrupt.is_asked() {
            // What is not whole is not kept.
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
            job,
            progress,
            tally,
            interrupt,
            ..
        } = self;
        drop(progress);
        let elapsed = start.elapsed();
        let (drawn, kept) = (tally.count_drawn(), tally.count_finished_before());
        if drawn > 0 {
            job.tell_errors(&tally, report);
        }
        if job.args.timings && drawn > 0 {
            job.tell_timings(&tally, method, elapsed)?;
        }
        interrupt.check(|| {
            let kept_for = match job.output {
                Output::Sequence(_) => "the same command goes on from there",
                _ => "nothing of an unfinished file is kept",
            };
            let count = job.count;
            format!(
                "{} of {count} frames are finished; {kept_for}",
                drawn + kept
            )
        })?;
        if let Some(failures) = tally.failures() {
            anyhow::bail!("{failures}");
        }
        let (output, size) = (&job.output, job.first.image());
        let what = format!("{} × {}, {method}", size.width, size.height);
        let time = duration(elapsed);
        if job.count == 1 {
            if kept == 1 {
                report.note(format_args!("{output}: finished before, left as it is"));
            } else {
                report.note(format_args!("{output}: {what}, drawn in {time}"));
            }
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

impl Job<'_> {
    /// Says what an edge may be off by where that is more than was asked for, and what would help.
    fn tell_errors(&self, tally: &Tally, report: Report) {
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
                1 => "its pixels are".into(),
                count => format!("the pixels of {count} frames are"),
            };
            report.note(format_args!(
                "the isoradial curves of {of} are only right to {:.1e} pixels, so {frames} followed ray by ray, which takes a hundred times as long and leaves hard edges",
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
    fn tell_timings(
        &self,
        tally: &Tally,
        method: &Method,
        elapsed: Duration,
    ) -> anyhow::Result<()> {
        let mut lines: Vec<(&str, Duration)> = tally.times().into();
        if self.count == 1 {
            let (culling, edges) = self.parts(method)?;
            lines.splice(2..2, [("of it culling", culling), ("of it edges", edges)]);
        }
        lines.push(("all, from the first frame to the last", elapsed));
        let mut stderr = io::stderr();
        for (name, time) in lines {
            let _ = writeln!(stderr, "{:>10}  {name}", duration(time));
        }
        Ok(())
    }

    /// What culling and edges of the first frame take, when the caches are warm and the memory is there.
    fn parts(&self, method: &Method) -> anyhow::Result<(Duration, Duration)> {
        let scene = &self.first;
        let view = View::new(scene);
        let sight = &crate::isoradial::Sight::new(scene, &view, scene.tolerance());
        let curves = match method {
            Method::Table(table) => Isoradials::new(sight, &table.lookup()),
            _ => Isoradials::new(sight, &Exact),
        };
        let mut pixels = mask::render(&view, &curves)?;
        let start = Instant::now();
        cull(&view, &curves, scene.antialias(), &mut pixels)?;
        let culled = Instant::now();
        let stride = view.width() as usize;
        if scene.antialias() {
            coverage::render_into(&view, &curves, &mut pixels, stride)?;
        } else {
            mask::render_into(&view, &curves, &mut pixels, stride)?;
        }
        let culling = culled - start;
        Ok((culling, culled.elapsed().saturating_sub(culling)))
    }
}
