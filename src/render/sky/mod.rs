//! The sky of a frame: what is seen beside the disk and the hole's shadow.
//!
//! The direction of a pixel's sky is smooth over the picture, so that it comes from [patches](super::patch) as the
//! disk's light does. A pixel shows the mean of panorama and grid over its footprint. Beside the shadow and about the
//! panorama's poles the footprint bends within a pixel: such pixels are cut into parts. Stars are points, added pixel
//! by pixel.

mod at_radius;
mod backdrop;
mod painter;
mod shader;
mod stars;

pub(super) use at_radius::{SharedSky, SkyAtRadius};
use backdrop::Backdrop;
pub(super) use shader::{SkyShader, SkySight};
pub(super) use stars::StarImages;
use stars::StarView;

use super::frame::Threads;
use super::tiles::{Run, TileRow};
use crate::isoradial::EscapeCurve;
use crate::scene::{Scene, View};
use crate::sky::{SkySource, StarField};
use painter::SkyPainter;

/// The sky of one frame.
pub(super) struct FrameSky<'a> {
    pub(super) shader: SkyShader<'a>,
    backdrop: Option<Backdrop<'a>>,
    stars: Option<(StarView<'a>, &'a StarField)>,
}

impl<'a> FrameSky<'a> {
    /// The directions of a view, in which nothing shines.
    pub(super) fn dark(view: &'a View, curve: &'a EscapeCurve, scene: &Scene) -> Self {
        Self {
            shader: SkyShader::new(view, curve, scene),
            backdrop: None,
            stars: None,
        }
    }

    /// The sky of a view.
    pub(super) fn new(
        view: &'a View,
        curve: &'a EscapeCurve,
        scene: &Scene,
        (source, lights): (&'a SkySource, &'a [[f32; 3]]),
        faintest: f64,
    ) -> Self {
        let shader = SkyShader::new(view, curve, scene);
        let stars = scene.sky().and_then(|sky| sky.stars.as_ref());
        let seen = |field| {
            let seen = StarView {
                shader,
                lights,
                radius: stars.map_or(0.0, |stars| stars.radius),
                faintest,
            };
            (seen, field)
        };
        Self {
            shader,
            backdrop: Backdrop::new(source, &shader),
            stars: source.stars().map(seen),
        }
    }

    /// Finds the images of stars, for bands of `rows` rows.
    pub(super) fn find_stars(&self, images: &mut StarImages, rows: usize, threads: Threads) {
        if let Some((seen, field)) = &self.stars {
            images.find(field, seen, rows, threads);
        }
    }

    /// Whether there is any light.
    pub(super) fn shines(&self) -> bool {
        self.backdrop.is_some() || self.stars.is_some()
    }

    /// Whether something fills it: not only stars.
    pub(super) fn is_filled(&self) -> bool {
        self.backdrop.is_some()
    }

    /// Whether there are stars.
    pub(super) fn has_stars(&self) -> bool {
        self.stars.is_some()
    }

    /// Paints what fills the sky into the light of runs of a band.
    pub(super) fn paint(&self, band: TileRow, runs: &[Run], light: &mut [[f32; 3]]) {
        if let Some(backdrop) = &self.backdrop {
            SkyPainter::new(self.shader, backdrop).paint(band, runs, light);
        }
    }
}
