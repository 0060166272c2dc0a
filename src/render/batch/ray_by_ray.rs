//! Frames without curves: each pixel's ray is followed by itself.

use std::sync::Arc;
use std::time::Instant;

use super::{FrameError, Frames};
use crate::orbit::Orbits;
use crate::render::frame::Workspace;
use crate::render::ink::SharedColours;
use crate::render::planes::FrameMemory;
use crate::render::sky::{FrameSky, SharedSky, SkyAtRadius};
use crate::render::{FrameReport, RenderError, pixelwise};
use crate::scene::{Animation, View};
use crate::sky::SkySource;

/// Frames whose pixels show what the rays of their centres meet, by some method.
pub struct RayByRay<'a, O> {
    animation: &'a Animation,
    orbits: &'a O,
    row_done: &'a (dyn Fn() + Sync),
    colours: SharedColours,
    sky: SharedSky,
}

impl<'a, O: Orbits> RayByRay<'a, O> {
    /// Creates the frames of `animation`, with its sky as in [`Curved::new`](super::Curved::new). `row_done` is called
    /// after each row of each frame.
    pub fn new(
        animation: &'a Animation,
        orbits: &'a O,
        sky: Option<Arc<SkySource>>,
        row_done: &'a (dyn Fn() + Sync),
    ) -> Self {
        Self {
            animation,
            orbits,
            row_done,
            colours: SharedColours::default(),
            sky: SharedSky::new(sky),
        }
    }
}

impl<O: Orbits> Frames for RayByRay<'_, O> {
    fn draw(
        &self,
        number: i64,
        _: bool,
        _: &mut Workspace,
        memory: &mut FrameMemory,
    ) -> Result<FrameReport, FrameError> {
        let start = Instant::now();
        let scene = self.animation.frame(number)?;
        let view = View::new(&scene);
        let form = memory.form();
        let target = memory.target(&view)?;
        let memory = start.elapsed();
        let source = self.sky.source(&scene, form)?;
        let radius = if form.needs_escape(&scene) {
            let radius = SkyAtRadius::from_orbits(&scene, &view, source, self.orbits);
            Some(radius.map_err(RenderError::from)?)
        } else {
            None
        };
        let sky = radius
            .as_ref()
            .map(|radius| FrameSky::at_radius(radius, &scene, &view, source, form));
        let frame = pixelwise::Frame {
            scene: &scene,
            view: &view,
            orbits: self.orbits,
            colours: self.colours.of(&scene, form),
            sky: sky.as_ref(),
        };
        frame.draw(self.row_done, target)?;
        Ok(FrameReport {
            memory,
            pixels: start.elapsed().saturating_sub(memory),
            ..FrameReport::default()
        })
    }
}
