//! What is to be drawn, and where it goes: all that can be checked before is.

use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;

use super::super::method::{Checked, Method, hex};
use super::super::progress::Report;
use super::super::target::{self, Room};
use super::super::{StdoutError, start_threads};
use super::film::Place;
use super::output::Output;
use super::pattern::Pattern;
use super::run::draw;
use super::{RenderArgs, ready, sequence};
use crate::orbit::exact::Exact;
use crate::render::batch::{Curved, Frames, RayByRay};
use crate::render::frame::Workspace;
use crate::render::needs::Needs;
use crate::render::png::{self, Origin};
use crate::scene::animation::FrameRange;
use crate::scene::{Animation, Scene};

/// Frames to be drawn, and where they go: checked.
pub(super) struct Plan<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) animation: &'a Animation,
    pub(super) frames: &'a FrameRange,
    pub(super) count: u64,
    pub(super) first: Scene,
    pub(super) output: Output,
    pub(super) needs: Needs,
    /// The files that are read, by the names that no link leads from.
    pub(super) inputs: Vec<PathBuf>,
}

impl<'a> Plan<'a> {
    /// Checks all that can be before anything is drawn; the table may be yet to be made.
    ///
    /// # Errors
    /// What stands in the way.
    pub(super) fn new(
        args: &'a RenderArgs,
        animation: &'a Animation,
        frames: &'a FrameRange,
    ) -> anyhow::Result<(Self, Checked)> {
        let count = frames.count();
        let output = Output::new(args, animation, count)?;
        let needs = Needs::of_animation(animation)?;
        let needed = needs.table().map(|candidate| candidate.name);
        let mut inputs = vec![(args.scene.clone(), "scene")];
        inputs.extend(args.method.table_path(needed).map(|table| (table, "table")));
        for (input, what) in &inputs {
            output.spares(input, what, frames)?;
        }
        let inputs = inputs
            .iter()
            .filter_map(|(input, _)| fs::canonicalize(input).ok());
        let inputs = inputs.collect();
        let checked = args.method.check(needed)?;
        let first = animation.frame(frames.iter().next().unwrap_or(1))?;
        if !args.dry_run
            && let Output::Film(format, Place::File(path)) = &output
        {
            target::check_room(path, format.bytes(first.image(), count))?;
        }
        for number in frames.iter() {
            animation.check(number)?;
        }
        let plan = Self {
            args,
            animation,
            frames,
            count,
            first,
            output,
            needs,
            inputs,
        };
        Ok((plan, checked))
    }

    /// Prints each frame's number, its file, and whether it would be drawn.
    pub(super) fn list(&self, checked: Checked) -> anyhow::Result<()> {
        // A table that is yet to be made has made no frame.
        let origin = checked
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
                    sequence::is_finished(&file, self.most_bytes(), &origin)
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
    pub(super) fn run(&self, checked: Checked, report: Report) -> anyhow::Result<()> {
        start_threads(self.args.threads.threads)?;
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
            Method::Table(table) => draw(
                self,
                &Curved::new(animation, &table.lookup()),
                &method,
                report,
            ),
            Method::NoTable => draw(self, &Curved::new(animation, &Exact), &method, report),
            Method::Exact => draw(
                self,
                &RayByRay::new(animation, &Exact, &row_done),
                &method,
                report,
            ),
            Method::Integrate(adaptive) => draw(
                self,
                &RayByRay::new(animation, adaptive, &row_done),
                &method,
                report,
            ),
        }
    }

    /// Makes the folder of a sequence, and looks whether there is room for what will be in it.
    pub(super) fn prepare(
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
            // Mostly they are far smaller: what three of them take tells.
            if missing.saturating_mul(self.most_bytes()) > room {
                let bytes = missing.saturating_mul(self.sample(frames, origin)?);
                target::check_room(&pattern.file(1), bytes)?;
            }
        }
        Ok(())
    }

    /// The most bytes that a frame's PNG file can have: its pixels as they are, and a little.
    pub(super) fn most_bytes(&self) -> u64 {
        let size = self.first.image();
        u64::from(size.width) * u64::from(size.height) * 17 / 16 + 4096
    }

    /// The most bytes that the first, the middle and the last frame take.
    fn sample(&self, frames: &impl Frames, origin: &Origin) -> anyhow::Result<u64> {
        let (first, last) = (self.frames.iter().next().unwrap_or(1), self.frames.last());
        let (mut workspace, mut pixels) = (Workspace::default(), Vec::new());
        let mut most = 0;
        let middle = self.frames.above(first.midpoint(last)).unwrap_or(last);
        for number in [first, middle, last] {
            frames.draw(number, true, &mut workspace, &mut pixels)?;
            most = most.max(self.encode(&pixels, origin)?.len() as u64);
        }
        Ok(most)
    }

    pub(super) fn encode(&self, pixels: &[u8], origin: &Origin) -> io::Result<Vec<u8>> {
        let size = self.first.image();
        let one_bit = !self.first.antialias() || !self.args.method.is_table();
        png::encode(pixels, (size.width, size.height), one_bit, origin)
    }
}

/// What frames are made of, but for their number.
pub(super) fn origin_of(animation: &Animation, method: &Method) -> Origin {
    Origin {
        scene: hex(animation.to_toml().as_bytes()),
        table: method.fingerprint(),
        frame: 0,
    }
}
