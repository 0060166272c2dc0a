//! Frames from isoradial curves, which are built once for each span of frames.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::spans::Block;
use super::{FrameError, Frames, locked};
use crate::isoradial::{CurveSpec, Isoradials, RadiusMap};
use crate::orbit::path::SweptAngles;
use crate::render::FrameReport;
use crate::render::frame::{Threads, Workspace};
use crate::render::ink::SharedColours;
use crate::render::planes::FrameMemory;
use crate::render::scene_frame::SceneFrame;
use crate::render::sky::{FrameSky, SharedSky, SkyAtRadius};
use crate::scene::{Animation, View};
use crate::sky::SkySource;

/// Frames from curves, which come from swept angles: exact ones, or those of a table.
#[derive(Debug)]
pub struct Curved<'a, A> {
    animation: &'a Animation,
    angles: &'a A,
    /// The block of the frame drawn last.
    block: Mutex<Option<Arc<Block>>>,
    colours: SharedColours,
    sky: SharedSky,
}

impl<'a, A: SweptAngles> Curved<'a, A> {
    /// Creates the frames of `animation`. Where no sky is given, its files are read when a frame first shows it.
    pub fn new(animation: &'a Animation, angles: &'a A, sky: Option<Arc<SkySource>>) -> Self {
        Self {
            animation,
            angles,
            block: Mutex::new(None),
            colours: SharedColours::default(),
            sky: SharedSky::new(sky),
        }
    }

    /// Returns the block that a frame is in.
    fn block(&self, number: i64) -> Arc<Block> {
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
        number: i64,
        on_all_threads: bool,
        workspace: &mut Workspace,
        memory: &mut FrameMemory,
    ) -> Result<FrameReport, FrameError> {
        let start = Instant::now();
        let scene = self.animation.frame(number)?;
        let view = View::new(&scene);
        let form = memory.form();
        let begun = Instant::now();
        let target = memory.target(&view)?;
        let memory = begun.elapsed();
        let block = self.block(number);
        let source = self.sky.source(&scene, form)?;
        let (own, own_map, own_sky);
        let threads = if on_all_threads {
            Threads::All
        } else {
            Threads::This
        };
        let sky = || SkyAtRadius::new(&scene, &view, source, self.angles, threads);
        let (curves, map, sky) = match block.span(number) {
            Some(span) if span.is_shared() => {
                let draw = || Isoradials::new(&span.spec, self.angles);
                let curves = span.curves.get_or_init(draw);
                let map = || RadiusMap::new(curves, self.angles);
                let map = form.needs_map(&scene).then(|| span.map.get_or_init(map));
                let needs_escape = form.needs_escape(&scene);
                (curves, map, needs_escape.then(|| span.sky.get_or_init(sky)))
            }
            _ => {
                let spec = CurveSpec::new(&scene, &view, scene.tolerance());
                own = Isoradials::new(&spec, self.angles);
                let map = || RadiusMap::new(&own, self.angles);
                own_map = form.needs_map(&scene).then(map);
                own_sky = form.needs_escape(&scene).then(sky);
                (&own, own_map.as_ref(), own_sky.as_ref())
            }
        };
        let frame = SceneFrame {
            scene: &scene,
            view: &view,
            curves,
            map,
            sky: sky.map(|sky| FrameSky::at_radius(sky, &scene, &view, source, form)),
            colours: self.colours.of(&scene, form),
            angles: self.angles,
            threads,
        };
        let curves = start.elapsed().saturating_sub(memory);
        let report = frame.draw(workspace, target)?;
        Ok(FrameReport {
            memory,
            curves,
            ..report
        })
    }
}
