//! Frames from isoradial curves, which are built once for each span of frames.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::spans::Block;
use super::{Effort, FrameError, Frames};
use crate::isoradial::{CurveSpec, EdgeError, Isoradials};
use crate::orbit::path::SweptAngles;
use crate::render::frame::{Threads, Workspace};
use crate::render::{blank_into, locked, pixelwise};
use crate::scene::{Animation, View};

/// Frames from curves, which come from swept angles: exact ones, or those of a table.
#[derive(Debug)]
pub struct Curved<'a, A> {
    animation: &'a Animation,
    angles: &'a A,
    /// The block of the frame drawn last.
    block: Mutex<Option<Arc<Block>>>,
}

impl<'a, A: SweptAngles> Curved<'a, A> {
    /// Creates the frames of `animation`.
    pub fn new(animation: &'a Animation, angles: &'a A) -> Self {
        Self {
            animation,
            angles,
            block: Mutex::new(None),
        }
    }

    /// Returns the block that a frame is in.
    fn block(&self, number: u32) -> Arc<Block> {
        let mut kept = locked(&self.block);
        match &*kept {
            Some(block) if block.has(number) => Arc::clone(block),
            _ => {
                let block = Arc::new(Block::new(self.animation, number));
                Arc::clone(kept.insert(block))
            }
        }
    }
}

impl<A: SweptAngles> Frames for Curved<'_, A> {
    fn draw(
        &self,
        number: u32,
        on_all_threads: bool,
        workspace: &mut Workspace,
        pixels: &mut Vec<u8>,
    ) -> Result<Effort, FrameError> {
        let start = Instant::now();
        let scene = self.animation.frame(number)?;
        let view = View::new(&scene);
        blank_into(&view, pixels)?;
        let block = self.block(number);
        let own;
        let curves = match block.span(number) {
            Some(span) if span.is_shared() => {
                let draw = || Isoradials::new(&span.spec, self.angles);
                span.curves.get_or_init(draw)
            }
            _ => {
                let spec = CurveSpec::new(&scene, &view, scene.tolerance());
                own = Isoradials::new(&spec, self.angles);
                &own
            }
        };
        let drawn = Instant::now();
        let error = curves.error();
        let unresolved = is_unresolved(error, scene.tolerance());
        if unresolved {
            // Frees this frame's memory first, so that two frames are never held at a time.
            *pixels = Vec::new();
            *pixels = pixelwise::render(&scene, &view, self.angles, &|| ())?;
        } else {
            let threads = if on_all_threads {
                Threads::All
            } else {
                Threads::This
            };
            let width = view.width() as usize;
            workspace.draw(&view, curves, scene.antialias(), threads, pixels, width)?;
        }
        Ok(Effort {
            curves: drawn - start,
            pixels: drawn.elapsed(),
            error,
            ray_by_ray: unresolved,
        })
    }
}

/// Returns whether the curves are less accurate than their angles and the arithmetic allow. Very wide disks and very
/// long lenses bend them more than the greatest number of nodes can follow.
fn is_unresolved(error: EdgeError, allowed: f64) -> bool {
    error.interpolation > allowed && error.interpolation > 4.0 * (error.angles + error.rounding)
}
