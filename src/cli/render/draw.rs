//! How frames are drawn. This is the only file of the program that calls the renderer.

use std::time::{Duration, Instant};

use super::super::method::Method;
use crate::isoradial::{Isoradials, Sight};
use crate::orbit::exact::Exact;
use crate::render::batch::{self, Curved, FrameError, Frames, RayByRay, Sharing};
pub(super) use crate::render::batch::{Drawn, Effort};
use crate::render::needs::Needs;
use crate::render::{coverage, cull, mask};
use crate::scene::{Animation, Scene, View};

/// Draws the frames of an animation by some method.
pub(super) struct FrameSource<'a>(&'a dyn Frames);

impl FrameSource<'_> {
    /// Calls `body` with the frames of `animation`. Methods that follow each pixel's ray call `row_done` after each
    /// row.
    pub(super) fn with<T>(
        animation: &Animation,
        method: &Method,
        row_done: &(dyn Fn() + Sync),
        body: impl FnOnce(&FrameSource<'_>) -> T,
    ) -> T {
        match method {
            Method::Table(table) => body(&FrameSource(&Curved::new(animation, &table.lookup()))),
            Method::NoTable => body(&FrameSource(&Curved::new(animation, &Exact))),
            Method::Exact => body(&FrameSource(&RayByRay::new(animation, &Exact, row_done))),
            Method::Integrate(adaptive) => {
                body(&FrameSource(&RayByRay::new(animation, adaptive, row_done)))
            }
        }
    }

    /// Draws one frame into `pixels`, row by row from the top, on all threads.
    ///
    /// # Errors
    /// [`FrameError`]
    pub(super) fn draw_one(&self, number: u32, pixels: &mut Vec<u8>) -> Result<Effort, FrameError> {
        self.0.draw(number, true, pixels)
    }

    /// Draws the frames `numbers`, about `count`, at most `at_a_time` side by side. Frames that are not `wanted` are
    /// skipped; `done` takes each drawn frame, from several threads and in any order.
    ///
    /// # Errors
    /// The first error of `done`; no frame is begun after it.
    pub(super) fn draw_all<E: Send>(
        &self,
        numbers: impl Iterator<Item = u32> + Send,
        count: u64,
        at_a_time: u64,
        wanted: impl Fn(u32) -> bool + Sync,
        done: impl Fn(Drawn<'_>) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let sharing = Sharing::fastest(count, at_a_time);
        batch::draw(self, numbers, sharing, wanted, done)
    }
}

impl Frames for FrameSource<'_> {
    fn draw(
        &self,
        number: u32,
        on_all_threads: bool,
        pixels: &mut Vec<u8>,
    ) -> Result<Effort, FrameError> {
        self.0.draw(number, on_all_threads, pixels)
    }
}

/// What a scene needs of a table and of its curves.
pub(super) fn needs(scene: &Scene) -> Needs {
    Needs::new(scene, &View::new(scene))
}

/// The curves of a scene that needs `needs`, by a method that draws curves.
pub(super) fn curves(needs: &Needs, method: &Method) -> Isoradials {
    curves_of(&needs.sight, method)
}

fn curves_of(sight: &Sight, method: &Method) -> Isoradials {
    match method {
        Method::Table(table) => Isoradials::new(sight, &table.lookup()),
        _ => Isoradials::new(sight, &Exact),
    }
}

/// The times of culling and of edges in one frame, with warm caches and the memory at hand.
///
/// # Errors
/// [`FrameError`]
pub(super) fn parts(scene: &Scene, method: &Method) -> Result<(Duration, Duration), FrameError> {
    let view = View::new(scene);
    let curves = curves_of(&Sight::new(scene, &view, scene.tolerance()), method);
    let mut pixels = mask::render(&view, &curves)?;
    let start = Instant::now();
    cull(&view, &curves, scene.antialias(), &mut pixels)?;
    let culled = Instant::now();
    let stride = view.width() as usize;
    if scene.antialias() {
        coverage::render_into(&view, &curves, &mut pixels, stride)?;
    } else {
        mask::render_into(&view, &curves, &mut pixels, stride)?;
    }
    let culling = culled - start;
    Ok((culling, culled.elapsed().saturating_sub(culling)))
}
