//! How frames are drawn. This is the only file of the program that calls the renderer.

use std::sync::Arc;

use super::super::method::Method;
use crate::isoradial::{EscapeCurve, Isoradials, RadiusMap};
use crate::orbit::exact::Exact;
pub(super) use crate::render::batch::DrawnFrame;
use crate::render::batch::{self, Curved, Frames, RayByRay, Sharing};
use crate::render::needs::Needs;
pub(super) use crate::render::{Form, FrameReport};
use crate::scene::{Animation, View};
use crate::sky::SkySource;

/// Draws the frames of an animation by some method, in some form.
pub(super) struct FrameSource<'a> {
    frames: &'a dyn Frames,
    form: Form,
}

impl FrameSource<'_> {
    /// Calls `body` with the frames of `animation`. Methods that follow each pixel's ray call `row_done` after each
    /// row.
    pub(super) fn with<T>(
        animation: &Animation,
        form: Form,
        method: &Method,
        sky: Option<Arc<SkySource>>,
        row_done: &(dyn Fn() + Sync),
        body: impl FnOnce(&FrameSource<'_>) -> T,
    ) -> T {
        let draw = |frames: &dyn Frames| body(&FrameSource { frames, form });
        match method {
            Method::Table(table) => draw(&Curved::new(animation, &table.lookup(), sky)),
            Method::NoTable => draw(&Curved::new(animation, &Exact, sky)),
            Method::Exact => draw(&RayByRay::new(animation, &Exact, sky, row_done)),
            Method::Integrate(adaptive) => draw(&RayByRay::new(animation, adaptive, sky, row_done)),
        }
    }

    /// Returns how many threads draw frames of their own, of `count` frames, at most `at_a_time` of them side by side.
    pub(super) fn threads(count: u64, at_a_time: u64) -> usize {
        match Sharing::fastest(count, at_a_time) {
            Sharing::SideBySide => rayon::current_num_threads(),
            Sharing::OneByOne => 1,
        }
    }

    /// Draws the frames `numbers`, about `count`, at most `at_a_time` side by side. Frames that are not `wanted` are
    /// skipped; `done` takes each drawn frame, from several threads and in any order.
    ///
    /// # Errors
    /// The first error of `done`; no frame is begun after it.
    pub(super) fn draw_all<E: Send>(
        &self,
        numbers: impl Iterator<Item = i64> + Send,
        count: u64,
        at_a_time: u64,
        wanted: impl Fn(i64) -> bool + Sync,
        done: impl Fn(DrawnFrame<'_>) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let sharing = Sharing::fastest(count, at_a_time);
        batch::draw(self.frames, self.form, numbers, sharing, wanted, done)
    }
}

/// The curves of a scene that needs `needs`, by a method that draws curves.
pub(super) fn curves(needs: &Needs, method: &Method) -> Isoradials {
    match method {
        Method::Table(table) => Isoradials::new(&needs.curve_spec, &table.lookup()),
        _ => Isoradials::new(&needs.curve_spec, &Exact),
    }
}

/// The map of these curves' radius, by the method that drew them.
pub(super) fn map(curves: &Isoradials, method: &Method) -> RadiusMap {
    match method {
        Method::Table(table) => RadiusMap::new(curves, &table.lookup()),
        _ => RadiusMap::new(curves, &Exact),
    }
}

/// The escape curve of a view's radius, by the method that draws curves.
pub(super) fn escape_curve(view: &View, method: &Method) -> EscapeCurve {
    let (u0, slope_scale) = (view.u0(), view.slope_scale());
    match method {
        Method::Table(table) => EscapeCurve::new(u0, slope_scale, &table.lookup()),
        _ => EscapeCurve::new(u0, slope_scale, &Exact),
    }
}
