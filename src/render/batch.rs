//! Frames of many views, with the same curves: an animation, while the camera's radius stays.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::tiles::Threads;
use super::{RenderError, blank, coverage, mask};
use crate::isoradial::Isoradials;
use crate::scene::View;

/// As many frames as there are threads, times this, are drawn side by side, each on one thread; fewer one after the
/// other, each on all threads. The last frames of a few would leave threads without work.
const SIDE_BY_SIDE: usize = 4;

/// What draws frames, and the memory that they are drawn in: as many frames' as there are threads, at most, of which
/// none is given back before this is.
#[derive(Debug)]
pub struct Batch<'a> {
    curves: &'a Isoradials,
    antialias: bool,
    spare: Mutex<Vec<Vec<u8>>>,
}

impl<'a> Batch<'a> {
    /// Frames with these curves: smooth ones, as [`coverage`] draws them, or with hard edges, as [`mask`] does.
    pub fn new(curves: &'a Isoradials, antialias: bool) -> Self {
        Self {
            curves,
            antialias,
            spare: Mutex::new(Vec::new()),
        }
    }

    /// Draws a frame of each view that the curves serve (see [`Isoradials::serves`]), on all threads of the current
    /// rayon pool, and hands it to `done`, row by row from the top, with the view's place among `views`: in any order,
    /// and from several threads at once.
    ///
    /// # Errors
    /// [`RenderError::Memory`], or what `done` returns; no more frames are begun then.
    pub fn draw<E: From<RenderError> + Send>(
        &self,
        views: &[View],
        done: impl Fn(usize, &[u8]) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let frame = |threads, (index, view): (usize, &View)| {
            let mut pixels = self.memory(view)?;
            let width = view.width() as usize;
            let render_on = if self.antialias {
                coverage::render_on
            } else {
                mask::render_on
            };
            render_on(view, self.curves, threads, &mut pixels, width)?;
            done(index, &pixels)?;
            self.spare().push(pixels);
            Ok(())
        };
        if views.len() >= SIDE_BY_SIDE * rayon::current_num_threads() {
            let views = views.par_iter().enumerate();
            views.try_for_each(|view| frame(Threads::This, view))
        } else {
            let mut views = views.iter().enumerate();
            views.try_for_each(|view| frame(Threads::All, view))
        }
    }

    /// Memory for a frame.
    fn memory(&self, view: &View) -> Result<Vec<u8>, RenderError> {
        let bytes = view.width() as usize * view.height() as usize;
        match self.spare().pop() {
            Some(pixels) if pixels.len() == bytes => Ok(pixels),
            _ => blank(view),
        }
    }

    fn spare(&self) -> std::sync::MutexGuard<'_, Vec<Vec<u8>>> {
        // A list of buffers is whole at every moment.
        self.spare.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
