//! A scene's frame from its curves, or ray by ray where no curves are accurate enough.

use std::time::{Duration, Instant};

use super::error::RenderError;
use super::frame::{Threads, Workspace};
use super::ink::{Averaging, Colours, Data, Rgb8, Rgb16, Rows};
use super::pixelwise;
use super::planes::Target;
use super::shaded::{ShadedFrame, rows_of_band};
use super::shader::Shader;
use crate::isoradial::{EdgeError, Isoradials, RadiusMap};
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
    /// Where the form needs one.
    pub(super) map: Option<&'a RadiusMap>,
    /// Of a scene with light.
    pub(super) colours: Option<&'a Colours>,
    pub(super) angles: &'a A,
    pub(super) threads: Threads,
}

impl<A: SweptAngles> SceneFrame<'_, A> {
    /// Draws the frame from its curves, or ray by ray where these are not accurate enough.
    ///
    /// # Errors
    /// [`RenderError::Buffer`]; [`RenderError::NoLight`] for colours of a scene without light.
    pub(super) fn draw(
        &self,
        workspace: &mut Workspace,
        target: Target<'_>,
    ) -> Result<FrameReport, RenderError> {
        let start = Instant::now();
        target.check(self.view)?;
        let error = self.curves.error();
        let ray_by_ray = is_unresolved(error, self.scene.tolerance());
        if ray_by_ray {
            let frame = pixelwise::Frame {
                scene: self.scene,
                view: self.view,
                orbits: self.angles,
                colours: self.colours,
            };
            frame.draw(&|| (), target)?;
        } else {
            self.draw_from_curves(workspace, target)?;
        }
        Ok(FrameReport {
            curves: Duration::ZERO,
            pixels: start.elapsed(),
            error,
            ray_by_ray,
        })
    }

    fn draw_from_curves(
        &self,
        workspace: &mut Workspace,
        target: Target<'_>,
    ) -> Result<(), RenderError> {
        let (view, curves, threads) = (self.view, self.curves, self.threads);
        let smooth = self.scene.antialias();
        let target = match target {
            Target::Grey8(samples, stride) => {
                return workspace.draw(view, curves, smooth, threads, samples, stride);
            }
            Target::Grey16(samples, stride) => {
                return workspace.draw(view, curves, smooth, threads, samples, stride);
            }
            shaded => shaded,
        };
        let none = RadiusMap::default();
        let gaps = |order, h, meets| curves.u_in_gap(order, h, meets, self.angles);
        let shader = Shader::new(view, curves, self.map.unwrap_or(&none), &gaps);
        let how = (smooth, threads);
        let averaging = if smooth {
            Averaging::Square
        } else {
            Averaging::Centre
        };
        let width = view.width() as usize;
        let rows = rows_of_band(width);
        match target {
            Target::Grey8(..) | Target::Grey16(..) => {}
            Target::Rgb8(samples, stride) => {
                let ink = Rgb8(self.colours()?, averaging);
                let bands = Rows::bands(samples, stride, 3 * width, rows);
                ShadedFrame::new(workspace.for_shading(), &shader, how).paint(&ink, bands);
            }
            Target::Rgb16(samples, stride) => {
                let ink = Rgb16(self.colours()?, averaging);
                let bands = Rows::bands(samples, stride, 3 * width, rows);
                ShadedFrame::new(workspace.for_shading(), &shader, how).paint(&ink, bands);
            }
            Target::Planes(planes, layers) => {
                let ink = Data::new(layers, self.colours, self.scene.light(), averaging)?;
                let bands = Data::bands(planes, width, rows);
                ShadedFrame::new(workspace.for_shading(), &shader, how)
                    .paint(&ink, bands.into_iter());
            }
        }
        Ok(())
    }

    fn colours(&self) -> Result<&Colours, RenderError> {
        self.colours.ok_or(RenderError::NoLight)
    }
}

/// Whether curves fall short of what their angles and double precision allow: a disk of any width and a lens of any
/// length bend them more than any number of nodes follows.
fn is_unresolved(error: EdgeError, tolerance: f64) -> bool {
    error.interpolation > tolerance && error.interpolation > 4.0 * (error.angles + error.rounding)
}
