//! Frames from isoradial curves, which are built once for each span of frames.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::spans::Block;
use super::{FrameError, Frames, locked};
use crate::isoradial::{CurveSpec, Isoradials};
use crate::orbit::path::SweptAngles;
use crate::render::FrameReport;
use crate::render::error::make_room;
use crate::render::frame::{Threads, Workspace};
use crate::render::scene_frame::SceneFrame;
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
    ) -> Result<FrameReport, FrameError> {
        let start = Instant::now();
        let scene = self.animation.frame(number)?;
        let view = View::new(&scene);
        make_room(&view, pixels)?;
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
        let frame = SceneFrame {
            scene: &scene,
            view: &view,
            curves,
            angles: self.angles,
            threads: if on_all_threads {
                Threads::All
            } else {
                Threads::This
            },
        };
        let time = start.elapsed();
        let report = frame.draw(workspace, pixels, view.width() as usize)?;
        Ok(FrameReport {
            curves: time,
            ..report
        })
    }
}
