//! How frames are drawn. This is the only file of the program that calls the renderer.

use super::super::method::Method;
use crate::isoradial::Isoradials;
use crate::orbit::exact::Exact;
use crate::render::batch::{self, Curved, FrameError, Frames, RayByRay, Sharing};
use crate::render::frame::Workspace;
use crate::render::needs::Needs;
pub(super) use crate::render::{Form, FrameReport, Pixels};
use crate::scene::{Animation, Scene, View};

/// Draws the frames of an animation by some method.
pub(super) struct FrameSource<'a>(&'a dyn Frames);

/// A frame of a run: drawn, or failed.
pub(super) struct DrawnFrame<'a> {
    /// Its number in the animation.
    pub(super) number: u32,
    /// The number of frames that were begun before it.
    pub(super) place: u64,
    /// Its pixels.
    pub(super) pixels: Result<(Pixels<'a>, FrameReport), FrameError>,
}

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
        done: impl Fn(DrawnFrame<'_>) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let sharing = Sharing::fastest(count, at_a_time);
        batch::draw(self, numbers, sharing, wanted, |drawn| {
            let grey = |(pixels, report)| (Pixels::Grey8(pixels), report);
            done(DrawnFrame {
                number: drawn.number,
                place: drawn.place,
                pixels: drawn.pixels.map(grey),
            })
        })
    }
}

impl Frames for FrameSource<'_> {
    fn draw(
        &self,
        number: u32,
        on_all_threads: bool,
        workspace: &mut Workspace,
        pixels: &mut Vec<u8>,
    ) -> Result<FrameReport, FrameError> {
        self.0.draw(number, on_all_threads, workspace, pixels)
    }
}

/// Checks that frames can be drawn in a form.
///
/// # Errors
/// They cannot.
pub(super) fn check(form: Form) -> anyhow::Result<()> {
    match form {
        Form::Grey8 => Ok(()),
        _ => anyhow::bail!("only masks of 8 bits can be drawn, as .png, .y4m or .raw"),
    }
}

/// What a scene needs of a table and of its curves.
pub(super) fn needs(scene: &Scene) -> Needs {
    Needs::new(scene, &View::new(scene))
}

/// The curves of a scene that needs `needs`, by a method that draws curves.
pub(super) fn curves(needs: &Needs, method: &Method) -> Isoradials {
    match method {
        Method::Table(table) => Isoradials::new(&needs.curve_spec, &table.lookup()),
        _ => Isoradials::new(&needs.curve_spec, &Exact),
    }
}
