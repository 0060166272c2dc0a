//! What is drawn, and where it goes. All checks come before the first frame.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::super::destination::Destination;
use super::super::frame_range::FrameRange;
use super::super::method::{Checked, Method, hex};
use super::super::stdio::StdoutError;
use super::super::writable;
use super::args::RenderArgs;
use super::format::Format;
use super::origin::FrameOrigin;
use super::{exr, ffmpeg, film, form, memory, npz, output, png, sequence, sky};
use crate::render::needs::Needs;
use crate::render::{Form, Pixels};
use crate::scene::{Animation, Scene, Sky};

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
    /// The pixels of a frame.
    pub(super) form: Form,
    pub(super) destination: Destination,
    pub(super) needs: Needs,
    /// The sky, where the frames show its light.
    pub(super) sky: Option<&'a Sky>,
    /// What the frames' files record of the sky's files.
    sky_fingerprint: Option<String>,
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
        let form = form::checked(args, animation, format)?;
        memory::check(args.max_memory, animation.size(), form)?;
        let needs = Needs::of_animation(animation, form)?;
        let needed = needs.table().map(|candidate| candidate.name);
        let mut inputs = vec![(args.scene.clone(), "scene")];
        inputs.extend(args.method.table_path(needed).map(|table| (table, "table")));
        let sky_files = sky::files(animation.sky());
        inputs.extend(sky_files.map(|(file, what)| (file.path.clone(), what)));
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
        if !args.dry_run && format.needs_ffmpeg() {
            ffmpeg::check(format)?;
        } else if !args.dry_run
            && format.is_film()
            && let Destination::File(path) = &destination
        {
            let bytes = film::frame_bytes(format, form, first.size());
            writable::check_space(path, count.saturating_mul(bytes))?;
        }
        for number in numbers {
            animation.check(number)?;
        }
        let sky = animation.sky().filter(|_| form.shows_light());
        sky::check_files(sky)?;
        // Films record nothing.
        let sky_fingerprint = sky::fingerprint(sky.filter(|_| !format.is_film()))?;
        let plan = Self {
            args,
            animation,
            frames,
            count,
            first,
            format,
            form,
            destination,
            needs,
            sky,
            sky_fingerprint,
            inputs,
        };
        // The files of a sequence are checked when its folder is listed.
        if let Destination::File(path) = &plan.destination
            && !args.dry_run
            && plan.is_refused(path)
        {
            return Err(sequence::foreign([path.clone()].into_iter()));
        }
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
                let file = self.destination.file(number);
                let state = if origin.as_ref().is_some_and(is_finished) {
                    "finished"
                } else if self.is_refused(&file) {
                    "in the way"
                } else {
                    "to draw"
                };
                writeln!(out, "{number}\t{state}\t{}", file.display())?;
            }
            out.flush()
        };
        print(&mut stdout).map_err(StdoutError)?;
        Ok(())
    }

    /// Whether a frame of a sequence is there already, and is to be kept.
    pub(super) fn is_finished(&self, number: i64, origin: &FrameOrigin) -> bool {
        !self.args.overwrite && self.is_there(number, origin)
    }

    /// Whether a frame of a sequence is there already, whole and of this origin.
    pub(super) fn is_there(&self, number: i64, origin: &FrameOrigin) -> bool {
        let Destination::Sequence(pattern) = &self.destination else {
            return false;
        };
        let (file, origin) = (pattern.file(number), origin.of_frame(number));
        sequence::is_finished(&file, self.most_bytes(), |file| self.made(file, &origin))
    }

    /// What the frames are made of, apart from their number.
    pub(super) fn origin(&self, method: &Method) -> FrameOrigin {
        FrameOrigin {
            scene: hex(self.animation.to_toml().as_bytes()),
            table: method.fingerprint(),
            sky: self.sky_fingerprint.clone(),
            frame: 0,
        }
    }

    /// An upper bound for the bytes of a frame's file: its pixels as they are, and a little.
    pub(super) fn most_bytes(&self) -> u64 {
        self.pixels() * self.form.bytes() as u64 * 17 / 16 + 8192
    }

    /// Whether a frame is still to be drawn.
    pub(super) fn is_unfinished(&self, origin: &FrameOrigin) -> bool {
        let mut numbers = self.frames.iter();
        numbers.any(|number| !self.is_finished(number, origin))
    }

    /// The number of pixels of a frame.
    pub(super) fn pixels(&self) -> u64 {
        let size = self.first.size();
        u64::from(size.width) * u64::from(size.height)
    }

    /// The file of a frame that is a picture or data.
    ///
    /// # Errors
    /// Not enough memory, or a picture that is too large for the format.
    pub(super) fn encode(&self, pixels: Pixels<'_>, origin: &FrameOrigin) -> io::Result<Vec<u8>> {
        let size = self.first.size();
        match (self.format, pixels) {
            (Format::Exr, Pixels::Planes(planes)) => {
                let windows = (self.first.image(), self.first.region());
                exr::encode(planes, windows, origin)
            }
            (Format::Npz, Pixels::Planes(planes)) => npz::encode(planes, size, origin),
            _ => png::encode(pixels, size, self.depth() == 1, origin),
        }
    }

    /// Whether a file, by its first bytes, is one that this program made.
    pub(super) fn is_ours(&self) -> fn(&[u8]) -> bool {
        match self.format {
            Format::Exr => exr::is_ours,
            Format::Npz => npz::is_ours,
            _ => png::is_ours,
        }
    }

    /// Whether a frame's file is another program's, and is not to be replaced: where the user did not name this very
    /// file.
    fn is_refused(&self, file: &Path) -> bool {
        let is_named = match self.destination {
            Destination::Sequence(_) => false,
            Destination::File(_) => self.format.is_film() || self.args.output.is_some(),
            Destination::Stdout | Destination::Device(_) => true,
        };
        !is_named && !self.args.overwrite && sequence::is_foreign(file, self.is_ours())
    }

    /// Whether a file is whole, and what [`Self::encode`] makes of this origin.
    fn made(&self, file: &[u8], origin: &FrameOrigin) -> bool {
        match self.format {
            Format::Exr => exr::made(file, origin),
            Format::Npz => npz::made(file, origin),
            _ => png::made(file, self.depth(), origin),
        }
    }

    /// The bits of a PNG picture's samples: one where a mask's edges are hard and no number is asked for.
    pub(super) fn depth(&self) -> u8 {
        let is_hard = !self.first.antialias() || !self.args.method.is_table();
        match self.form {
            Form::Grey8 if is_hard && self.args.bits.is_none() => 1,
            Form::Grey16 | Form::Rgb16 => 16,
            _ => 8,
        }
    }
}
