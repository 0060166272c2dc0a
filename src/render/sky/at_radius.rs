//! What frames of one camera radius have of the sky in common.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::FrameSky;
use crate::isoradial::EscapeCurve;
use crate::orbit::path::SweptAngles;
use crate::orbit::{OrbitError, Orbits};
use crate::render::RenderError;
use crate::render::frame::Threads;
use crate::render::planes::Form;
use crate::scene::{Scene, View};
use crate::sky::{DEFAULT_MEMORY, SkySource, Star, StarColours};

/// The escape curve of a camera radius, and the light of stars there.
#[derive(Debug)]
pub(in crate::render) struct SkyAtRadius {
    pub(in crate::render) curve: EscapeCurve,
    /// The irradiance of each star without magnification.
    lights: Vec<[f32; 3]>,
}

impl SkyAtRadius {
    /// Computes them from swept angles. The curve takes a few tenths of a millisecond on this thread; the light of many
    /// stars takes longer, and `threads` share it.
    pub(in crate::render) fn new(
        scene: &Scene,
        view: &View,
        source: Option<&SkySource>,
        angles: &impl SweptAngles,
        threads: Threads,
    ) -> Self {
        Self {
            curve: EscapeCurve::new(view.u0(), view.slope_scale(), angles),
            lights: star_lights(scene, view, source, threads),
        }
    }

    /// Computes them by following rays, on all threads of the current rayon pool.
    ///
    /// # Errors
    /// The method's error for a ray that it cannot follow.
    pub(in crate::render) fn from_orbits(
        scene: &Scene,
        view: &View,
        source: Option<&SkySource>,
        orbits: &impl Orbits,
    ) -> Result<Self, OrbitError> {
        Ok(Self {
            curve: EscapeCurve::from_orbits(view.u0(), view.slope_scale(), orbits)?,
            lights: star_lights(scene, view, source, Threads::All),
        })
    }
}

/// The light of a sky's stars for a scene's camera.
fn star_lights(
    scene: &Scene,
    view: &View,
    source: Option<&SkySource>,
    threads: Threads,
) -> Vec<[f32; 3]> {
    let settings = scene.sky().and_then(|sky| sky.stars.as_ref());
    let (Some(settings), Some(field)) = (settings, source.and_then(SkySource::stars)) else {
        return Vec::new();
    };
    let shift = if settings.shift {
        1.0 / view.clock_rate()
    } else {
        1.0
    };
    let colours = StarColours::new(shift, settings.exposure);
    let light = |star: &Star| colours.light(star);
    if threads == Threads::All {
        field.stars.par_iter().map(light).collect()
    } else {
        field.stars.iter().map(light).collect()
    }
}

/// The sky of an animation, read when a frame first needs it: it is that of all its frames.
#[derive(Debug, Default)]
pub(in crate::render) struct SharedSky(OnceLock<Result<Arc<SkySource>, RenderError>>);

impl SharedSky {
    /// What has been read, or nothing yet.
    pub(in crate::render) fn new(read: Option<Arc<SkySource>>) -> Self {
        Self(read.map_or_else(OnceLock::new, |source| OnceLock::from(Ok(source))))
    }

    /// What has been read, if anything has.
    pub(in crate::render) fn read(&self) -> Option<Arc<SkySource>> {
        self.0.get()?.as_ref().ok().cloned()
    }

    /// The sky of a scene, where the form shows its light.
    ///
    /// # Errors
    /// [`RenderError::Sky`] for a file that cannot be read.
    pub(in crate::render) fn source(
        &self,
        scene: &Scene,
        form: Form,
    ) -> Result<Option<&SkySource>, RenderError> {
        let Some(sky) = scene.sky().filter(|_| form.shows_light()) else {
            return Ok(None);
        };
        let open = || {
            let source = SkySource::open(sky, DEFAULT_MEMORY).map(Arc::new);
            source.map_err(|error| RenderError::Sky(error.to_string()))
        };
        match self.0.get_or_init(open) {
            Ok(source) => Ok(Some(source)),
            Err(error) => Err(error.clone()),
        }
    }
}

impl<'a> FrameSky<'a> {
    /// The sky of a frame of this radius, or only its directions where no source shines.
    pub(in crate::render) fn at_radius(
        radius: &'a SkyAtRadius,
        scene: &Scene,
        view: &'a View,
        source: Option<&'a SkySource>,
        form: Form,
    ) -> Self {
        match source {
            Some(source) => {
                let faintest = faintest(form, scene.exposure());
                Self::new(
                    view,
                    &radius.curve,
                    scene,
                    (source, &radius.lights),
                    faintest,
                )
            }
            None => Self::dark(view, &radius.curve, scene),
        }
    }
}

/// Returns the least light of a pixel that counts: some hundredths of half of the first code of a picture's samples. An
/// exposure changes that; data have none.
fn faintest(form: Form, exposure: f64) -> f64 {
    match form {
        Form::Rgb8 => 1e-5 * libm::exp2(-exposure),
        Form::Rgb16 => 1e-7 * libm::exp2(-exposure),
        Form::Grey8 | Form::Grey16 | Form::Layers(_) => 1e-7,
    }
}
