//! Where frames go, and in which form.

use std::ffi::OsString;
use std::fmt;
use std::fs;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::super::picture::Destination;
use super::super::{Misuse, target};
use super::RenderArgs;
use super::film::{Format, Place};
use super::pattern::Pattern;
use crate::scene::Animation;
use crate::scene::animation::FrameRange;

/// The digits of a number in a name that nobody chose.
const DIGITS: usize = 4;

/// What `--format` may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum FormatName {
    /// A grey PNG picture for each frame: 8 bits a pixel, 1 bit where edges are hard
    Png,
    /// A film of all frames, YUV4MPEG2, grey
    Y4m,
    /// The bytes of all frames, one a pixel, row by row
    Raw,
}

/// Where frames go, checked.
#[derive(Debug)]
pub(super) enum Output {
    /// One picture.
    Picture(Destination),
    /// A picture for each frame.
    Sequence(Pattern),
    /// All frames in one.
    Film(Format, Place),
}

impl Output {
    /// Where `-o` and `--format` say that `count` frames go.
    ///
    /// # Errors
    /// What stands in the way of files there.
    pub(super) fn new(
        args: &RenderArgs,
        animation: &Animation,
        count: u64,
    ) -> anyhow::Result<Self> {
        let path = args.output.clone();
        let path = path.unwrap_or_else(|| default_name(&args.scene, animation, args.format));
        let to_stdout = path == Path::new("-");
        if to_stdout && io::stdout().is_terminal() && !args.dry_run {
            return Err(Misuse::PictureToTerminal.into());
        }
        if is_folder(&path) {
            let example = path.join(default_name(&args.scene, animation, args.format));
            return Err(Misuse::Folder { path, example }.into());
        }
        let ending = path.extension().and_then(|ending| ending.to_str());
        let ending = ending.map(str::to_ascii_lowercase);
        let by_ending = match ending.as_deref() {
            Some("y4m") => FormatName::Y4m,
            Some("raw") => FormatName::Raw,
            _ => FormatName::Png,
        };
        let format = match args.format.unwrap_or(by_ending) {
            FormatName::Y4m => Format::Y4m,
            FormatName::Raw => Format::Raw,
            FormatName::Png => return Self::pictures(path, args, animation, count),
        };
        if to_stdout {
            return Ok(Self::Film(format, Place::Stdout));
        }
        if Pattern::parse(&path)?.is_some() {
            return Err(Misuse::FilmWithNumber { path }.into());
        }
        if fs::metadata(&path).is_ok_and(|kind| !kind.is_file() && !kind.is_dir()) {
            return Ok(Self::Film(format, Place::Device(path)));
        }
        if !args.dry_run {
            target::check(&path, target::OUTPUT)?;
        }
        Ok(Self::Film(format, Place::File(path)))
    }

    fn pictures(
        path: PathBuf,
        args: &RenderArgs,
        animation: &Animation,
        count: u64,
    ) -> anyhow::Result<Self> {
        const ENDINGS: &str = ".png, .y4m and .raw";
        if path == Path::new("-") {
            return if count > 1 {
                Err(Misuse::FramesToStdout.into())
            } else {
                Ok(Self::Picture(Destination::Stdout))
            };
        }
        let is_png = path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        if !is_png {
            return Err(Misuse::Ending {
                path,
                endings: ENDINGS,
            }
            .into());
        }
        // A still picture's name is its own, whatever is in it.
        let pattern = if animation.is_still() {
            None
        } else {
            Pattern::parse(&path)?
        };
        match pattern {
            Some(pattern) => {
                if !args.dry_run {
                    target::check_folder(pattern.folder())?;
                }
                Ok(Self::Sequence(pattern))
            }
            None if count > 1 && path.to_str().is_none() => {
                Err(Misuse::NumberedNotText { path }.into())
            }
            None if count > 1 => Err(Misuse::FramesWithoutNumber { path, count }.into()),
            None => Ok(Self::Picture(Destination::checked(
                path,
                ".png",
                &args.scene,
            )?)),
        }
    }

    /// Checks that nothing goes over an input, by whatever name it is reached.
    ///
    /// # Errors
    /// [`Misuse::OntoInput`]
    pub(super) fn spares(
        &self,
        input: &Path,
        what: &'static str,
        frames: &FrameRange,
    ) -> Result<(), Misuse> {
        match self {
            Self::Picture(Destination::File(path)) | Self::Film(_, Place::File(path)) => {
                not_onto(path, input, what)
            }
            Self::Picture(Destination::Stdout) | Self::Film(_, Place::Stdout) => {
                let is_stdout = fs::metadata(input).is_ok_and(|file| target::is_stdout(&file));
                if is_stdout {
                    let path = input.to_owned();
                    return Err(Misuse::StdoutOntoInput { path, what });
                }
                Ok(())
            }
            Self::Film(_, Place::Device(_)) => Ok(()),
            Self::Sequence(pattern) => {
                let led_to = fs::canonicalize(input).unwrap_or_else(|_| input.to_owned());
                for name in [input, &led_to]
                    .into_iter()
                    .filter_map(|path| path.file_name())
                {
                    if let Some(number) = pattern.number(name.as_encoded_bytes())
                        && frames.contains(number)
                    {
                        not_onto(&pattern.file(number), input, what)?;
                    }
                }
                Ok(())
            }
        }
    }

    /// The file that a frame goes to.
    pub(super) fn file(&self, number: u32) -> PathBuf {
        match self {
            Self::Picture(Destination::File(path))
            | Self::Film(_, Place::File(path) | Place::Device(path)) => path.clone(),
            Self::Picture(Destination::Stdout) | Self::Film(_, Place::Stdout) => "-".into(),
            Self::Sequence(pattern) => pattern.file(number),
        }
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Picture(destination) => destination.fmt(f),
            Self::Sequence(pattern) => pattern.fmt(f),
            Self::Film(_, Place::Stdout) => write!(f, "standard output"),
            Self::Film(_, Place::File(path) | Place::Device(path)) => {
                write!(f, "{}", path.display())
            }
        }
    }
}

/// Whether a path is meant as a folder's: one that is there, and a name with a slash at its end.
fn is_folder(path: &Path) -> bool {
    let ends_in_slash = path.to_string_lossy().ends_with(std::path::is_separator);
    ends_in_slash || (path.extension().is_none() && path.is_dir())
}

fn not_onto(path: &Path, input: &Path, what: &'static str) -> Result<(), Misuse> {
    if target::same_place(path, input) {
        return Err(Misuse::OntoInput {
            option: target::OUTPUT,
            path: path.to_owned(),
            what,
        });
    }
    Ok(())
}

/// `mine.toml` gives `mine.png`, `classic` gives `classic.png`, an animation `orbit_####.png`.
fn default_name(scene: &Path, animation: &Animation, format: Option<FormatName>) -> PathBuf {
    let mut name = scene
        .file_stem()
        .map_or_else(|| OsString::from("picture"), OsString::from);
    match format {
        Some(FormatName::Y4m) => name.push(".y4m"),
        Some(FormatName::Raw) => name.push(".raw"),
        _ if animation.is_still() => name.push(".png"),
        _ => {
            name.push("_");
            name.push("#".repeat(DIGITS));
            name.push(".png");
        }
    }
    name.into()
}
