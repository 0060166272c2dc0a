//! A scene's frame from its curves, or ray by ray where no curves are accurate enough.

use std::time::{Duration, Instant};

use super::error::RenderError;
use super::frame::{Threads, Workspace};
use super::ink::{Averaging, Colours, Data, Display, Ink, PlaneRows, Rows};
use super::pixelwise;
use super::planes::Target;
use super::shaded::ShadedFrame;
use super::shader::Shader;
use super::sky::FrameSky;
use crate::isoradial::{EdgeError, Isoradials, RadiusMap};
use crate::orbit::path::SweptAngles;
use crate::scene::{Scene, View};

/// What a frame took, and how accurate it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameReport {
    /// The time for the memory of the frame.
    pub memory: Duration,
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
    /// Of a scene with light or a sky.
    pub(super) colours: Option<&'a Colours>,
    /// Where the form shows the sky or data of it.
    pub(super) sky: Option<FrameSky<'a>>,
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
                sky: self.sky.as_ref(),
            };
            frame.draw(&|| (), target)?;
        } else {
            self.draw_from_curves(workspace, target)?;
        }
        Ok(FrameReport {
            memory: Duration::ZERO,
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
        let averaging = if smooth {
            Averaging::Square
        } else {
            Averaging::Centre
        };
        match target {
            Target::Grey8(samples, stride) => {
                workspace.draw(view, curves, smooth, threads, samples, stride)?;
            }
            Target::Grey16(samples, stride) => {
                workspace.draw(view, curves, smooth, threads, samples, stride)?;
            }
            Target::Rgb8(samples, stride) => {
                let ink = Display::<u8>::new(self.colours()?, averaging);
                self.shade(workspace, &ink, Rows::bands(samples, view, stride));
            }
            Target::Rgb16(samples, stride) => {
                let ink = Display::<u16>::new(self.colours()?, averaging);
                self.shade(workspace, &ink, Rows::bands(samples, view, stride));
            }
            Target::Planes(planes, layers) => {
                let ink = Data::new(layers, self.colours, self.scene, averaging)?;
                self.shade(workspace, &ink, PlaneRows::bands(planes, view));
            }
        }
        Ok(())
    }

    /// Paints bands of light or data.
    fn shade<'b, I: Ink<N>, const N: usize>(
        &self,
        workspace: &mut Workspace,
        ink: &I,
        bands: impl Iterator<Item = I::Band<'b>> + Send,
    ) {
        let none = RadiusMap::default();
        let (map, curves) = (self.map.unwrap_or(&none), self.curves);
        let gaps = |order, h, meets| curves.u_in_gap(order, h, meets, self.angles);
        let shader = Shader::new(self.view, curves, map, &gaps);
        let how = (self.scene.antialias(), self.threads);
        let seen = (&shader, self.sky.as_ref());
        ShadedFrame::new(workspace.for_shading(), seen, how).paint(ink, bands);
    }

    fn colours(&self) -> Result<&Colours, RenderError> {
        self.colours.ok_or(RenderError::NoLight)
    }
}

/// Whether curves fall short of what their angles and double precision allow: a disk of any width and a lens of any
/// length bend them more than any number of nodes follows.
pub(super) fn is_unresolved(error: EdgeError, tolerance: f64) -> bool {
    error.interpolation > tolerance && error.interpolation > 4.0 * (error.angles + error.rounding)
}
