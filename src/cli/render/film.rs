//! A film: frames one after the other in one file or pipe, or through ffmpeg.
//!
//! A raw film is the frames' samples alone, row by row: a byte of grey for each pixel of a mask, or three bytes of red,
//! green and blue. [`y4m`] describes the others.

use std::io::{self, Write};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::super::destination::{Destination, OpenDestination};
use super::ffmpeg::Ffmpeg;
use super::format::Format;
use super::y4m;
use crate::render::{Form, Pixels};
use crate::scene::ImageSize;
use crate::scene::animation::Rate;

/// A film that several threads write in turn.
#[derive(Debug)]
pub(super) struct Film<'a> {
    format: Format,
    size: ImageSize,
    destination: &'a Destination,
    turn: Mutex<Turn>,
    next: Condvar,
}

#[derive(Debug)]
struct Turn {
    open: OpenFilm,
    /// The place of the next frame.
    next: u64,
    /// What went wrong; no frame is written after it.
    failure: Option<anyhow::Error>,
}

/// A film that is being written.
#[derive(Debug)]
enum OpenFilm {
    Direct(OpenDestination),
    Through(Ffmpeg),
}

impl OpenFilm {
    /// Opens the destination of a film.
    fn begin(format: Format, destination: &Destination) -> anyhow::Result<Self> {
        let open = destination
            .open()
            .map_err(|error| destination.error("film", error))?;
        match open {
            OpenDestination::Unfinished(file) if format.needs_ffmpeg() => {
                Ok(Self::Through(Ffmpeg::start(format, file)?))
            }
            open => Ok(Self::Direct(open)),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Direct(open) => open.file().write_all(bytes),
            Self::Through(ffmpeg) => ffmpeg.write(bytes),
        }
    }

    fn finish(self) -> io::Result<()> {
        match self {
            Self::Direct(open) => open.finish(),
            Self::Through(ffmpeg) => ffmpeg.finish(),
        }
    }
}

/// The bytes of a frame in a film that ffmpeg does not make.
pub(super) fn frame_bytes(format: Format, form: Form, size: ImageSize) -> u64 {
    let pixels = u64::from(size.width) * u64::from(size.height);
    let mark = y4m::MARK.len() as u64;
    match format {
        Format::Y4m => pixels + pixels / 2 + mark,
        Format::Y4mGray => pixels + mark,
        _ => pixels * form.bytes() as u64,
    }
}

/// A frame was not written, because it or an earlier one failed: [`Film::finish`] returns why.
#[derive(Debug)]
pub(super) struct Broken;

impl<'a> Film<'a> {
    /// Opens the destination and writes the header.
    ///
    /// # Errors
    /// What the system returns; ffmpeg cannot be started.
    pub(super) fn begin(
        format: Format,
        destination: &'a Destination,
        size: ImageSize,
        rate: Rate,
    ) -> anyhow::Result<Self> {
        let header = match format {
            Format::Raw => String::new(),
            Format::Y4mGray => y4m::grey_header(size, rate),
            _ => y4m::header(size, rate),
        };
        let mut open = OpenFilm::begin(format, destination)?;
        let begun = open.write(header.as_bytes());
        begun.map_err(|error| destination.error("film", error))?;
        Ok(Self {
            format,
            size,
            destination,
            turn: Mutex::new(Turn {
                open,
                next: 0,
                failure: None,
            }),
            next: Condvar::new(),
        })
    }

    /// The bytes of a frame; `frame` is memory for them.
    pub(super) fn encode<'p>(&self, pixels: Pixels<'p>, frame: &'p mut Vec<u8>) -> &'p [u8] {
        match (self.format, pixels) {
            (Format::Raw, Pixels::Grey8(samples) | Pixels::Rgb8(samples)) => samples,
            (Format::Y4mGray, Pixels::Grey8(samples)) => {
                frame.clear();
                frame.extend_from_slice(y4m::MARK);
                frame.extend_from_slice(samples);
                frame
            }
            _ => {
                y4m::encode(pixels, self.size, frame);
                frame
            }
        }
    }

    /// Writes the frame with this place, from 0, after all frames before it.
    ///
    /// # Errors
    /// [`Broken`], if this or an earlier frame failed.
    pub(super) fn write(&self, place: u64, frame: anyhow::Result<&[u8]>) -> Result<(), Broken> {
        let mut turn = self.turn();
        while turn.next != place && turn.failure.is_none() {
            turn = self.next.wait(turn).unwrap_or_else(PoisonError::into_inner);
        }
        if turn.failure.is_some() {
            return Err(Broken);
        }
        let written = frame.and_then(|frame| {
            let written = turn.open.write(frame);
            written.map_err(|error| self.destination.error("film", error))
        });
        turn.next += 1;
        turn.failure = written.err();
        self.next.notify_all();
        turn.failure.as_ref().map_or(Ok(()), |_| Err(Broken))
    }

    /// Ends a film that has all its frames.
    ///
    /// # Errors
    /// Why a frame failed, or what syncing and renaming the film's file returns.
    pub(super) fn finish(self) -> anyhow::Result<()> {
        let turn = self
            .turn
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        match turn.failure {
            Some(failure) => Err(failure),
            None => turn
                .open
                .finish()
                .map_err(|error| self.destination.error("film", error)),
        }
    }

    fn turn(&self) -> MutexGuard<'_, Turn> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
