//! Films by ffmpeg: frames go through a pipe to the program on the path.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::process::{Child, Command, Stdio};

use super::format::Format;
use crate::output::Unfinished;

/// What ffmpeg is told of the frames: the format between the two programs has no tag for it.
const TAGS: &str = "setparams=range=tv:colorspace=bt709:color_primaries=bt709:color_trc=bt709";

/// The same of the film.
const FILM_TAGS: [&str; 8] = [
    "-color_range",
    "tv",
    "-colorspace",
    "bt709",
    "-color_primaries",
    "bt709",
    "-color_trc",
    "bt709",
];

/// The options of H.264, which everything plays. The index stands at the film's beginning, so that it plays while it is
/// loaded.
const H264: &[&str] = &["-c:v", "libx264", "-crf", "16", "-movflags", "+faststart"];

/// The options of VP9.
const VP9: &[&str] = &[
    "-c:v",
    "libvpx-vp9",
    "-crf",
    "20",
    "-b:v",
    "0",
    "-row-mt",
    "1",
    "-cpu-used",
    "4",
];

/// The most that is told of ffmpeg's own errors, in lines.
const LINES: usize = 4;

/// ffmpeg, making a film. If it is dropped before it is finished, the process is ended and its file removed.
#[derive(Debug)]
pub(super) struct Ffmpeg {
    child: Child,
    /// Where its errors go.
    errors: File,
    /// Is there until the film is finished. ffmpeg writes it by its name.
    film: Option<Unfinished>,
}

/// Checks that ffmpeg is there.
///
/// # Errors
/// It is not, or cannot be run.
pub(super) fn check(format: Format) -> anyhow::Result<()> {
    let mut version = Command::new("ffmpeg");
    version.arg("-version").stdin(Stdio::null());
    version.stdout(Stdio::null()).stderr(Stdio::null());
    version
        .status()
        .map_err(|error| unavailable(format, &error))?;
    Ok(())
}

fn unavailable(format: Format, error: &io::Error) -> anyhow::Error {
    let extension = format.extension();
    if error.kind() == io::ErrorKind::NotFound {
        anyhow::anyhow!(
            ".{extension} films are made by ffmpeg, which is not on the PATH; install it (Debian, Ubuntu: apt install \
             ffmpeg; macOS: brew install ffmpeg; Windows: winget install ffmpeg; others: https://ffmpeg.org), or write \
             a .y4m film"
        )
    } else {
        anyhow::anyhow!(".{extension} films are made by ffmpeg, which cannot be run: {error}")
    }
}

impl Ffmpeg {
    /// Starts ffmpeg. It reads a YUV4MPEG2 film.
    ///
    /// # Errors
    /// It cannot be run.
    pub(super) fn start(format: Format, film: Unfinished) -> anyhow::Result<Self> {
        let (container, codec) = match format {
            Format::Mov => ("mov", H264),
            Format::Mkv => ("matroska", H264),
            Format::Webm => ("webm", VP9),
            _ => ("mp4", H264),
        };
        // A colon in a name would name a protocol.
        let mut file = OsString::from("file:");
        file.push(film.path());
        let errors = tempfile::tempfile()?;
        let mut command = Command::new("ffmpeg");
        command.args([
            "-v",
            "error",
            "-y",
            "-f",
            "yuv4mpegpipe",
            "-i",
            "pipe:0",
            "-vf",
            TAGS,
        ]);
        command
            .args(codec)
            .args(["-pix_fmt", "yuv420p"])
            .args(FILM_TAGS);
        command.args(["-f", container]).arg(file);
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(errors.try_clone()?);
        // Ctrl-C is for this program, which ends ffmpeg.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let child = command
            .spawn()
            .map_err(|error| unavailable(format, &error))?;
        Ok(Self {
            child,
            errors,
            film: Some(film),
        })
    }

    /// Sends bytes.
    ///
    /// # Errors
    /// ffmpeg failed.
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let Some(pipe) = &mut self.child.stdin else {
            return Err(io::ErrorKind::BrokenPipe.into());
        };
        match pipe.write_all(bytes) {
            // It has ended.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(self.failure()),
            written => written,
        }
    }

    /// Ends a film that has all its frames, and gives it its name.
    ///
    /// # Errors
    /// ffmpeg failed, or the file could not be renamed.
    pub(super) fn finish(mut self) -> io::Result<()> {
        drop(self.child.stdin.take());
        if !self.child.wait()?.success() {
            return Err(self.failure());
        }
        self.film.take().map_or(Ok(()), Unfinished::finish)
    }

    /// Why ffmpeg ended.
    fn failure(&mut self) -> io::Error {
        let ended = self.child.wait();
        let ended = ended.map_or_else(|error| error.to_string(), |status| status.to_string());
        let mut text = Vec::new();
        let _ = self
            .errors
            .rewind()
            .and_then(|()| self.errors.read_to_end(&mut text));
        let text = String::from_utf8_lossy(&text);
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .collect();
        let last = lines[lines.len().saturating_sub(LINES)..].join("; ");
        io::Error::other(format!("ffmpeg failed ({ended}): {last}"))
    }
}

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        if self.film.is_some() {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}
