//! A scene's frame from its curves, or ray by ray where no curves are accurate enough.

use std::time::{Duration, Instant};

use super::error::RenderError;
use super::frame::{Threads, Workspace};
use super::pixelwise;
use crate::isoradial::{EdgeError, Isoradials};
use crate::orbit::path::SweptAngles;
use crate::scene::{Scene, View};

/// What a frame took, and how accurate it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameReport {
    /// The time for curves that no frame before had.
    pub curves: Duration,
    /// The time for the pixels.
    pub pixels: Duration,
    /// How far an edge may be off, in pixels.
    pub error: EdgeError,
    /// Whether each pixel's ray was followed by itself, since no curves were accurate enough.
    pub ray_by_ray: bool,
}

/// A frame whose curves are there.
pub(super) struct SceneFrame<'a, A> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) curves: &'a Isoradials,
    pub(super) angles: &'a A,
    pub(super) threads: Threads,
}

impl<A: SweptAngles> SceneFrame<'_, A> {
    /// Draws the frame from its curves, or ray by ray where these are not accurate enough.
    ///
    /// # Errors
    /// [`RenderError::Buffer`]
    pub(super) fn draw(
        &self,
        workspace: &mut Workspace,
        pixels: &mut [u8],
        stride: usize,
    ) -> Result<FrameReport, RenderError> {
        let start = Instant::now();
        let error = self.curves.error();
        let ray_by_ray = is_unresolved(error, self.scene.tolerance());
        if ray_by_ray {
            pixelwise::render_into(self.scene, self.view, self.angles, &|| (), pixels, stride)?;
        } else {
            let smooth = self.scene.antialias();
            workspace.draw(self.view, self.curves, smooth, self.threads, pixels, stride)?;
        }
        Ok(FrameReport {
            curves: Duration::ZERO,
            pixels: start.elapsed(),
            error,
            ray_by_ray,
        })
    }
}

/// Whether curves fall short of what their angles and double precision allow: a disk of any width and a lens of any
/// length bend them more than any number of nodes follows.
fn is_unresolved(error: EdgeError, tolerance: f64) -> bool {
    error.interpolation > tolerance && error.interpolation > 4.0 * (error.angles + error.rounding)
}
