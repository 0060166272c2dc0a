//! A film: frames one after the other in one file or pipe.
//!
//! A YUV4MPEG2 film has a header that says the size, the frame rate, square pixels, and that pixels are grey from 0 to
//! 255 (`Cmono`, `XCOLORRANGE=FULL`). A raw film is the frames' bytes alone, row by row.

use std::io::Write;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::super::destination::{Destination, OpenDestination};
use super::format::{Format, Y4M_FRAME};
use crate::scene::ImageSize;
use crate::scene::animation::Rate;

/// A film that several threads write in turn.
#[derive(Debug)]
pub(super) struct Film<'a> {
    /// What stands before each frame.
    mark: &'static [u8],
    destination: &'a Destination,
    turn: Mutex<Turn>,
    next: Condvar,
}

#[derive(Debug)]
struct Turn {
    open: OpenDestination,
    /// The place of the next frame.
    next: u64,
    /// What went wrong; no frame is written after it.
    failure: Option<anyhow::Error>,
}

/// A frame was not written, because it or an earlier one failed: [`Film::finish`] returns why.
#[derive(Debug)]
pub(super) struct Broken;

impl<'a> Film<'a> {
    /// Opens the destination and writes the header.
    ///
    /// # Errors
    /// What the system returns.
    pub(super) fn begin(
        format: Format,
        destination: &'a Destination,
        size: ImageSize,
        rate: Rate,
    ) -> anyhow::Result<Self> {
        let ImageSize { width, height } = size;
        let (header, mark) = match format {
            Format::Y4m => (
                format!("YUV4MPEG2 W{width} H{height} F{rate} Ip A1:1 Cmono XCOLORRANGE=FULL\n"),
                Y4M_FRAME,
            ),
            Format::Raw | Format::Png => (String::new(), &[][..]),
        };
        let begun = destination.open().and_then(|mut open| {
            open.file().write_all(header.as_bytes())?;
            Ok(open)
        });
        Ok(Self {
            mark,
            destination,
            turn: Mutex::new(Turn {
                open: begun.map_err(|error| destination.error("film", error))?,
                next: 0,
                failure: None,
            }),
            next: Condvar::new(),
        })
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
        let written = frame.and_then(|pixels| {
            let file = turn.open.file();
            file.write_all(self.mark)
                .and_then(|()| file.write_all(pixels))
                .map_err(|error| self.destination.error("film", error))
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
