//! Where frames go, and in which format: `-o` and `--format`, checked.

use std::ffi::OsString;
use std::fs;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use super::super::destination::{Destination, has_extension, unsupported_extension};
use super::super::misuse::misuse;
use super::super::pattern::Pattern;
use super::super::writable::{self, OUTPUT};
use super::args::RenderArgs;
use super::form;
use super::format::Format;
use crate::render::Form;
use crate::scene::Animation;

/// The digits of the frame's number in a default name.
const DIGITS: usize = 4;

/// The format and the destination of `count` frames. A dry run needs no writable destination.
///
/// # Errors
/// The options contradict each other, or the destination cannot be written.
pub(super) fn checked(
    args: &RenderArgs,
    animation: &Animation,
    count: u64,
) -> anyhow::Result<(Format, Destination)> {
    let default = || default_name(&args.scene, animation, args.format);
    let path = args.output.clone().unwrap_or_else(default);
    let is_stdout = path == Path::new("-");
    if is_stdout && io::stdout().is_terminal() && !args.dry_run {
        return Err(misuse(
            "the standard output is a terminal, which cannot show pictures; send it to a file or a pipe, or name a \
             file with -o",
        ));
    }
    if is_folder(&path) {
        return Err(misuse(format!(
            "{} is a folder; name the files in it, as in {}",
            path.display(),
            path.join(default()).display()
        )));
    }
    let format = args.format.unwrap_or_else(|| Format::of(&path));
    let destination = if format.is_film() {
        of_film(path, format, args.dry_run)?
    } else {
        of_pictures(path, format, args, animation, count)?
    };
    Ok((format, destination))
}

fn of_film(path: PathBuf, format: Format, dry_run: bool) -> anyhow::Result<Destination> {
    let is_special =
        |path: &Path| fs::metadata(path).is_ok_and(|kind| !kind.is_file() && !kind.is_dir());
    if format.needs_ffmpeg() && (path == Path::new("-") || is_special(&path)) {
        return Err(misuse(format!(
            "ffmpeg goes back and forth in a .{} film, so it needs a file; name one with -o, or send --format y4m",
            format.extension()
        )));
    }
    if path == Path::new("-") {
        return Ok(Destination::Stdout);
    }
    if Pattern::parse(&path)?.is_some() {
        return Err(misuse(format!(
            "{}: a film is one file, and this name is a pattern for many; leave out the number, or --format",
            path.display()
        )));
    }
    if is_special(&path) {
        return Ok(Destination::Device(path));
    }
    if !dry_run {
        writable::check(&path, OUTPUT)?;
    }
    Ok(Destination::File(path))
}

fn of_pictures(
    path: PathBuf,
    format: Format,
    args: &RenderArgs,
    animation: &Animation,
    count: u64,
) -> anyhow::Result<Destination> {
    if path == Path::new("-") && count > 1 {
        return Err(misuse(
            "several frames go through a pipe as a film; choose --format y4m or --format raw, or choose one frame with \
             --frames",
        ));
    }
    let extension = format.extension();
    if path != Path::new("-") && !has_extension(&path, extension) {
        let expected = match args.format {
            Some(_) => &format!(".{extension}"),
            None => Format::EXTENSIONS,
        };
        return Err(unsupported_extension(&path, expected));
    }
    // The name of a still picture is taken literally.
    let pattern = if animation.is_still() {
        None
    } else {
        Pattern::parse(&path)?
    };
    if let Some(pattern) = pattern {
        if !args.dry_run {
            writable::check_folder(pattern.folder())?;
        }
        return Ok(Destination::Sequence(pattern));
    }
    if count == 1 {
        return Destination::of_picture(path, extension, &args.scene);
    }
    if path.to_str().is_none() {
        return Err(misuse(format!(
            "{}: the names of numbered files must be UTF-8",
            path.display()
        )));
    }
    Err(frames_without_number(&path, count))
}

/// The files of an animation's frames, `output` or the default name in the folder `frames`, and their pixels.
///
/// # Errors
/// It has no place for the frame's number, or the format of its extension cannot hold the frames.
pub(in crate::cli) fn sequence(
    scene: &Path,
    animation: &Animation,
    output: Option<&Path>,
) -> anyhow::Result<(PathBuf, Form)> {
    let default = || Path::new("frames").join(default_name(scene, animation, None));
    let path = output.map_or_else(default, Path::to_path_buf);
    let format = Format::of(&path);
    if format.is_film() || !has_extension(&path, format.extension()) {
        return Err(unsupported_extension(&path, Format::SEQUENCE_EXTENSIONS));
    }
    let form = form::of(animation, format)?;
    if Pattern::parse(&path)?.is_none() {
        return Err(frames_without_number(&path, animation.frames().into()));
    }
    Ok((path, form))
}

/// The error of one name for several frames.
fn frames_without_number(path: &Path, count: u64) -> anyhow::Error {
    misuse(format!(
        "{}: {count} frames do not fit one picture; put a place for the number in the name, as in f_####.png or \
         f_%04d.png, choose one frame with --frames, or make a film with --format y4m",
        path.display()
    ))
}

/// Whether a path names a folder: one that exists, or any name that ends in a slash.
fn is_folder(path: &Path) -> bool {
    let ends_in_slash = path.to_string_lossy().ends_with(std::path::is_separator);
    ends_in_slash || (path.extension().is_none() && path.is_dir())
}

/// `mine.toml` gives `mine.png`, `classic` gives `classic.png`, an animation `orbit_####.png`, a scene with layers
/// `mine.exr`.
fn default_name(scene: &Path, animation: &Animation, format: Option<Format>) -> PathBuf {
    let mut name = scene
        .file_stem()
        .map_or_else(|| OsString::from("picture"), OsString::from);
    let format = format.unwrap_or_else(|| Format::default_of(animation));
    if !format.is_film() && !animation.is_still() {
        name.push("_");
        name.push("#".repeat(DIGITS));
    }
    name.push(".");
    name.push(format.extension());
    name.into()
}
