//! Frames from isoradial curves, which are drawn once for each span of frames.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::spans::Block;
use super::{Effort, FrameError, Frames};
use crate::isoradial::{EdgeError, Isoradials, Sight};
use crate::orbit::path::SweptAngles;
use crate::render::frame::{Threads, Workspace};
use crate::render::{blank_into, locked, pixelwise};
use crate::scene::{Animation, View};

/// Frames whose pixels come from curves, and these from swept angles: of a table, or exact.
#[derive(Debug)]
pub struct Curved<'a, A> {
    animation: &'a Animation,
    angles: &'a A,
    /// The spans last asked for.
    block: Mutex<Option<Arc<Block>>>,
}

impl<'a, A: SweptAngles> Curved<'a, A> {
    /// The frames of `animation`.
    pub fn new(animation: &'a Animation, angles: &'a A) -> Self {
        Self {
            animation,
            angles,
            block: Mutex::new(None),
        }
    }

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
                let draw = || Isoradials::new(&span.sight, self.angles);
                span.curves.get_or_init(draw)
            }
            _ => {
                let sight = Sight::new(&scene, &view, scene.tolerance());
                own = Isoradials::new(&sight, self.angles);
                &own
            }
        };
        let drawn = Instant::now();
        let error = curves.error();
        let unresolved = is_unresolved(error, scene.tolerance());
        if unresolved {
            // Two frames are not held at a time.
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

/// Whether the curves fall short of what their angles and the arithmetic allow: where a disk of any width and a lens
/// of any length bend them more than any number of nodes follows.
fn is_unresolved(error: EdgeError, allowed: f64) -> bool {
    error.interpolation > allowed && error.interpolation > 4.0 * (error.angles + error.rounding)
}
