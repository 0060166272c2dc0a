//! Frames one after the other into one file or pipe: as a film without sound in the YUV4MPEG2 format, or bare.
//!
//! A film's header says that its pixels are grey from 0 to 255 (`Cmono`, `XCOLORRANGE=FULL`), square, and how many come a second;
//! bare frames are nothing but bytes, row by row.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::super::StdoutError;
use super::super::picture::stdout;
use crate::output::Unfinished;
use crate::scene::ImageSize;
use crate::scene::animation::Rate;

/// How frames follow each other in one file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Y4m,
    Raw,
}

/// Where a film goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Place {
    Stdout,
    /// A file that appears when it is whole.
    File(PathBuf),
    /// A device or a pipe with a name: written as it is.
    Device(PathBuf),
}

/// A film that is being written, by several threads in turn.
#[derive(Debug)]
pub(super) struct Film {
    format: Format,
    place: Place,
    turn: Mutex<Turn>,
    next: Condvar,
}

#[derive(Debug)]
struct Turn {
    sink: Sink,
    /// The place of the frame that comes next.
    next: u64,
    /// What went wrong: no frame comes any more.
    failure: Option<anyhow::Error>,
}

#[derive(Debug)]
enum Sink {
    Open(File),
    Unfinished(Unfinished),
}

/// A frame was not taken, because it or one before it failed: [`Film::finish`] tells why.
#[derive(Debug)]
pub(super) struct Broken;

impl Format {
    /// The bytes of a film.
    pub(super) fn bytes(self, size: ImageSize, frames: u64) -> u64 {
        let pixels = u64::from(size.width) * u64::from(size.height);
        match self {
            Self::Raw => frames.saturating_mul(pixels),
            Self::Y4m => frames.saturating_mul(pixels + FRAME.len() as u64),
        }
    }
}

const FRAME: &[u8] = b"FRAME\n";

impl Film {
    /// Begins a film.
    ///
    /// # Errors
    /// What opening its file returns.
    pub(super) fn begin(
        format: Format,
        place: &Place,
        size: ImageSize,
        rate: Rate,
    ) -> anyhow::Result<Self> {
        let mut film = Self {
            format,
            place: place.clone(),
            turn: Mutex::new(Turn {
                sink: open(place).map_err(|error| unwritable(place, error))?,
                next: 0,
                failure: None,
            }),
            next: Condvar::new(),
        };
        if format == Format::Y4m {
            let ImageSize { width, height } = size;
            let header =
                format!("YUV4MPEG2 W{width} H{height} F{rate} Ip A1:1 Cmono XCOLORRANGE=FULL\n");
            let turn = film.turn.get_mut().unwrap_or_else(PoisonError::into_inner);
            let file = turn.sink.file();
            file.write_all(header.as_bytes())
                .map_err(|error| unwritable(place, error))?;
        }
        Ok(film)
    }

    /// Writes the frame that was begun as the `place`-th, from 0, once those before are written.
    ///
    /// # Errors
    /// [`Broken`], if this or a frame before failed.
    pub(super) fn write(&self, place: u64, frame: anyhow::Result<&[u8]>) -> Result<(), Broken> {
        let mut turn = self.turn();
        while turn.next != place && turn.failure.is_none() {
            turn = self.next.wait(turn).unwrap_or_else(PoisonError::into_inner);
        }
        if turn.failure.is_some() {
            return Err(Broken);
        }
        let written = frame.and_then(|pixels| {
            let mark: &[u8] = if self.format == Format::Y4m {
                FRAME
            } else {
                &[]
            };
            let file = turn.sink.file();
            file.write_all(mark)
                .and_then(|()| file.write_all(pixels))
                .map_err(|error| unwritable(&self.place, error))
        });
        turn.next += 1;
        turn.failure = written.err();
        self.next.notify_all();
        turn.failure.as_ref().map_or(Ok(()), |_| Err(Broken))
    }

    /// Ends a film that has all its frames.
    ///
    /// # Errors
    /// Why a frame was not taken, or what syncing and renaming the film's file returns.
    pub(super) fn finish(self) -> anyhow::Result<()> {
        let turn = self
            .turn
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        if let Some(failure) = turn.failure {
            return Err(failure);
        }
        match turn.sink {
            Sink::Open(_) => Ok(()),
            Sink::Unfinished(file) => file
                .finish()
                .map_err(|error| unwritable(&self.place, error)),
        }
    }

    fn turn(&self) -> MutexGuard<'_, Turn> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Sink {
    fn file(&mut self) -> &mut File {
        match self {
            Self::Open(file) => file,
            Self::Unfinished(unfinished) => unfinished.file(),
        }
    }
}

fn open(place: &Place) -> io::Result<Sink> {
    match place {
        Place::Stdout => stdout().map(Sink::Open),
        Place::Device(path) => OpenOptions::new().write(true).open(path).map(Sink::Open),
        Place::File(path) => Unfinished::after_leftovers(path).map(Sink::Unfinished),
    }
}

fn unwritable(place: &Place, error: io::Error) -> anyhow::Error {
    match place {
        Place::Stdout => StdoutError(error).into(),
        // A reader that has had enough, of a pipe with a name.
        Place::Device(_) if error.kind() == io::ErrorKind::BrokenPipe => StdoutError(error).into(),
        Place::File(path) | Place::Device(path) => {
            anyhow::anyhow!("{}: the film cannot be written: {error}", path.display())
        }
    }
}
