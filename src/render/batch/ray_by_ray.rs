//! Frames without curves: each pixel's ray is followed by itself.

use std::time::Instant;

use super::{FrameError, Frames};
use crate::orbit::Orbits;
use crate::render::frame::Workspace;
use crate::render::ink::SharedColours;
use crate::render::planes::FrameMemory;
use crate::render::{FrameReport, pixelwise};
use crate::scene::{Animation, View};

/// Frames whose pixels show what the rays of their centres meet, by some method.
pub struct RayByRay<'a, O> {
    animation: &'a Animation,
    orbits: &'a O,
    row_done: &'a (dyn Fn() + Sync),
    colours: SharedColours,
}

impl<'a, O: Orbits> RayByRay<'a, O> {
    /// Creates the frames of `animation`. `row_done` is called after each row of each frame.
    pub fn new(animation: &'a Animation, orbits: &'a O, row_done: &'a (dyn Fn() + Sync)) -> Self {
        Self {
            animation,
            orbits,
            row_done,
            colours: SharedColours::default(),
        }
    }
}

impl<O: Orbits> Frames for RayByRay<'_, O> {
    fn draw(
        &self,
        number: u32,
        _: bool,
        _: &mut Workspace,
        memory: &mut FrameMemory,
    ) -> Result<FrameReport, FrameError> {
        let start = Instant::now();
        let scene = self.animation.frame(number)?;
        let view = View::new(&scene);
        let form = memory.form();
        let frame = pixelwise::Frame {
            scene: &scene,
            view: &view,
            orbits: self.orbits,
            colours: self.colours.of(&scene, form),
        };
        frame.draw(self.row_done, memory.target(&view)?)?;
        Ok(FrameReport {
            pixels: start.elapsed(),
            ..FrameReport::default()
        })
    }
}
