//! What is drawn, and where it goes. All checks come before the first frame.

use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;

use super::super::destination::Destination;
use super::super::frame_range::FrameRange;
use super::super::method::{Checked, Method, hex};
use super::super::stdio::StdoutError;
use super::super::writable;
use super::args::RenderArgs;
use super::format::Format;
use super::origin::FrameOrigin;
use super::output;
use super::png;
use super::sequence;
use crate::render::Pixels;
use crate::render::needs::Needs;
use crate::scene::{Animation, Scene};

/// Frames to be drawn, and where they go: checked.
pub(super) struct Plan<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) animation: &'a Animation,
    pub(super) frames: &'a FrameRange,
    /// The number of frames.
    pub(super) count: u64,
    /// The first frame's scene.
    pub(super) first: Scene,
    pub(super) format: Format,
    pub(super) destination: Destination,
    pub(super) needs: Needs,
    /// The files that are read, by their canonical names.
    pub(super) inputs: Vec<PathBuf>,
}

impl<'a> Plan<'a> {
    /// Checks everything; only the table may still be missing.
    ///
    /// # Errors
    /// What prevents the frames from being drawn and written.
    pub(super) fn new(
        args: &'a RenderArgs,
        animation: &'a Animation,
        frames: &'a FrameRange,
    ) -> anyhow::Result<(Self, Checked)> {
        let count = frames.count();
        let (format, destination) = output::checked(args, animation, count)?;
        let needs = Needs::of_animation(animation)?;
        let needed = needs.table().map(|candidate| candidate.name);
        let mut inputs = vec![(args.scene.clone(), "scene")];
        inputs.extend(args.method.table_path(needed).map(|table| (table, "table")));
        for (input, what) in &inputs {
            destination.check_input(input, what, frames)?;
        }
        let inputs = inputs
            .iter()
            .filter_map(|(input, _)| fs::canonicalize(input).ok());
        let inputs = inputs.collect();
        let checked = args.method.check(needed)?;
        let mut numbers = frames.iter();
        let first = animation.check(numbers.next().unwrap_or(1))?;
        if !args.dry_run
            && format != Format::Png
            && let Destination::File(path) = &destination
        {
            writable::check_space(path, format.film_bytes(first.image(), count))?;
        }
        for number in numbers {
            animation.check(number)?;
        }
        let plan = Self {
            args,
            animation,
            frames,
            count,
            first,
            format,
            destination,
            needs,
            inputs,
        };
        Ok((plan, checked))
    }

    /// Prints each frame's number, its file, and whether it would be drawn.
    ///
    /// # Errors
    /// The standard output cannot be written.
    pub(super) fn list(&self, checked: Checked) -> anyhow::Result<()> {
        // No frame was made with a table that is still missing.
        let method = checked.without_making().ok();
        let origin = method.map(|method| self.origin(&method));
        let mut stdout = io::BufWriter::new(io::stdout().lock());
        let print = |out: &mut dyn Write| {
            for number in self.frames.iter() {
                let is_finished = |origin| self.is_finished(number, origin);
                let state = if origin.as_ref().is_some_and(is_finished) {
                    "finished"
                } else {
                    "to draw"
                };
                let file = self.destination.file(number);
                writeln!(out, "{number}\t{state}\t{}", file.display())?;
            }
            out.flush()
        };
        print(&mut stdout).map_err(StdoutError)?;
        Ok(())
    }

    /// Whether a frame of a sequence is there already, and is to be kept.
    pub(super) fn is_finished(&self, number: u32, origin: &FrameOrigin) -> bool {
        match &self.destination {
            Destination::Sequence(pattern) if !self.args.overwrite => {
                let origin = origin.of_frame(number);
                let made =
                    |file: &[u8]| png::made(file, if self.one_bit() { 1 } else { 8 }, &origin);
                sequence::is_finished(&pattern.file(number), self.most_bytes(), made)
            }
            _ => false,
        }
    }

    /// What the frames are made of, apart from their number.
    pub(super) fn origin(&self, method: &Method) -> FrameOrigin {
        FrameOrigin {
            scene: hex(self.animation.to_toml().as_bytes()),
            table: method.fingerprint(),
            frame: 0,
        }
    }

    /// An upper bound for the bytes of a frame's PNG file: its pixels as they are, and a little.
    pub(super) fn most_bytes(&self) -> u64 {
        self.pixels() * 17 / 16 + 4096
    }

    /// The number of pixels of a frame.
    pub(super) fn pixels(&self) -> u64 {
        let size = self.first.image();
        u64::from(size.width) * u64::from(size.height)
    }

    /// The PNG file of a frame.
    ///
    /// # Errors
    /// Not enough memory.
    pub(super) fn encode(&self, pixels: &[u8], origin: &FrameOrigin) -> io::Result<Vec<u8>> {
        png::encode(
            Pixels::Grey8(pixels),
            self.first.image(),
            self.one_bit(),
            origin,
        )
    }

    /// Whether a pixel is one bit: where edges are hard.
    fn one_bit(&self) -> bool {
        !self.first.antialias() || !self.args.method.is_table()
    }
}
