//! Compares what pixels show of the light with each pixel's own exact ray.

use rayon::prelude::*;

use super::super::exact_self_check::angle_in_two_parts;
use super::super::measurement::Quantiles;
use super::super::pixel_choice::{affordable, rows};
use crate::light::{Radiance, RadianceTable, Sight, SightGeometry, flux, rec709};
use crate::orbit::exact::Exact;
use crate::orbit::invariants::Orbit;
use crate::orbit::path::turns;
use crate::orbit::{OrbitError, Ray};
use crate::render::{Plane, pixelwise};
use crate::scene::{Layer, LayerSet, Light, Scene, View};

/// What one pixel shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShownLight {
    order: u32,
    redshift: f64,
    /// The luminance of the hottest ring at rest is 1.
    luminance: f64,
}

/// The errors of a method over the pixels compared.
#[derive(Debug, Clone)]
pub(super) struct LightErrors {
    /// Relative errors of the redshift.
    pub(super) redshift: Option<Quantiles>,
    /// Errors of the luminance; that of the hottest ring is 1.
    pub(super) luminance: Option<Quantiles>,
    /// The number of pixels that miss the disk, see it by mistake, or see another order of its image.
    pub(super) wrong: u64,
    pub(super) compared: u64,
}

/// The layers that [`ExactSights::of_layers`] compares.
pub(super) fn compared_layers() -> LayerSet {
    [Layer::Order, Layer::Radius, Layer::Redshift]
        .into_iter()
        .collect()
}

/// The exact light of some rows.
pub(super) struct ExactSights<'a> {
    scene: &'a Scene,
    view: &'a View,
    /// The colours that frames are drawn with.
    colours: RadianceTable,
    rows: Vec<(u32, Vec<Option<ShownLight>>)>,
}

impl<'a> ExactSights<'a> {
    /// Computes rows of a scene whose disk shines as `light`, on all threads: evenly spread rows with at most `most`
    /// pixels in total, but at least one.
    pub(super) fn new(
        scene: &'a Scene,
        view: &'a View,
        light: Light,
        most: u64,
    ) -> Result<Self, OrbitError> {
        let radiance = Radiance::new(light);
        let rows: Result<Vec<_>, _> = rows(view, most)
            .into_par_iter()
            .map(|j| {
                let row: Result<Vec<_>, OrbitError> = (0..view.width())
                    .map(|i| {
                        let sight = pixelwise::sight(scene, view, &Exact, (i, j))?;
                        Ok(sight.map(|sight| ShownLight {
                            order: sight.order,
                            redshift: sight.redshift,
                            luminance: rec709::luminance(
                                radiance.rgb(amplitude(sight.u, sight.redshift)),
                            ),
                        }))
                    })
                    .collect();
                row.map(|row| (j, row))
            })
            .collect();
        Ok(Self {
            scene,
            view,
            colours: RadianceTable::new(&radiance),
            rows: rows?,
        })
    }

    /// Returns the number of pixels computed.
    pub(super) fn pixels(&self) -> u64 {
        self.rows.iter().map(|(_, row)| row.len() as u64).sum()
    }

    /// Returns the errors of a method that follows each pixel's ray, over evenly spread rows with at most `budget`
    /// pixels in total, but at least one.
    pub(super) fn of_pixels(
        &self,
        sight: &(dyn Fn((u32, u32)) -> Option<Sight> + Sync),
        budget: u64,
    ) -> LightErrors {
        let rows = affordable(&self.rows, self.view, budget);
        let pairs = rows.into_par_iter().flat_map_iter(|(j, row)| {
            row.iter().zip(0..).map(move |(truth, i)| {
                let shown = sight((i, *j));
                let shown = shown.map(|sight| self.shown(sight.order, sight.u, sight.redshift));
                (*truth, shown)
            })
        });
        errors(&pairs.collect::<Vec<_>>())
    }

    /// Returns the errors of the [`compared_layers`] of a frame with hard edges. The luminance follows from radius and
    /// redshift: colours themselves are means over a pixel where they change steeply, and these are of its centre.
    pub(super) fn of_layers(&self, planes: &[Plane]) -> LightErrors {
        let (mut order, mut radius, mut redshift) = (&[][..], &[][..], &[][..]);
        for plane in planes {
            match plane.layer {
                Layer::Order => order = &plane.values,
                Layer::Radius => radius = &plane.values,
                Layer::Redshift => redshift = &plane.values,
                _ => {}
            }
        }
        let width = self.view.width() as usize;
        let pairs = self.rows.iter().flat_map(|(j, row)| {
            row.iter().enumerate().map(move |(i, truth)| {
                let pixel = *j as usize * width + i;
                let shown = (order[pixel] >= 0.0).then(|| {
                    let (u, redshift) =
                        (1.0 / f64::from(radius[pixel]), f64::from(redshift[pixel]));
                    self.shown(order[pixel] as u32, u, redshift)
                });
                (*truth, shown)
            })
        });
        errors(&pairs.collect::<Vec<_>>())
    }

    /// Returns what a pixel sees by exact integrals that are split in two; see [`angle_in_two_parts`].
    pub(super) fn sight_in_two_parts(&self, place: (u32, u32)) -> Option<Sight> {
        let sight = pixelwise::sight(self.scene, self.view, &Exact, place).ok()??;
        let pixel = self.view.pixel(place.0, place.1);
        let orbit = Orbit::new(Ray::new(self.view.u0(), self.view.dudphi(pixel)).ok()?);
        let first = self.view.plane_crossing(pixel.ta, pixel.transverse());
        let from = if first > 0.0 {
            first
        } else {
            core::f64::consts::PI
        };
        let angle = from + f64::from(sight.order) * core::f64::consts::PI;
        let to = orbit.point_at(sight.u)?;
        // Whether the path to u turns: what gives an angle closer to the pixel's own.
        let is_towards = orbit.inward == (to.u > orbit.start.u);
        let direct = is_towards.then(|| angle_in_two_parts(&orbit, to, false));
        let turning = turns(&orbit).then(|| angle_in_two_parts(&orbit, to, true));
        let error = [direct, turning].into_iter().flatten();
        let error = error.map(|swept| (swept - angle).abs()).reduce(f64::min)?;
        let u = sight.u + error * to.slope;
        Some(SightGeometry::new(self.view).sight(pixel, sight.order, u))
    }

    fn shown(&self, order: u32, u: f64, redshift: f64) -> ShownLight {
        let rgb = self.colours.rgb(amplitude(u, redshift) as f32);
        ShownLight {
            order,
            redshift,
            luminance: rec709::luminance(rgb.map(f64::from)),
        }
    }
}

/// The amplitude of what a ray sees: [`crate::light`] defines it.
pub(super) fn amplitude(u: f64, redshift: f64) -> f64 {
    redshift * redshift * flux::signed_root(u)
}

/// Compares pairs of the exact light and a method's.
fn errors(pairs: &[(Option<ShownLight>, Option<ShownLight>)]) -> LightErrors {
    let (mut redshift, mut luminance, mut wrong) = (Vec::new(), Vec::new(), 0);
    for pair in pairs {
        match pair {
            (None, None) => {}
            (Some(truth), Some(shown)) if truth.order == shown.order => {
                redshift.push((shown.redshift / truth.redshift - 1.0).abs());
                luminance.push((shown.luminance - truth.luminance).abs());
            }
            _ => wrong += 1,
        }
    }
    LightErrors {
        redshift: Quantiles::of(redshift),
        luminance: Quantiles::of(luminance),
        wrong,
        compared: pairs.len() as u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Renderer;
    use crate::chart::methods::Stepper;

    fn small() -> (Scene, View, Light) {
        let scene = Scene::builtin("lit").unwrap();
        let scene = scene.with_size(160, 90).unwrap().with_antialias(false);
        let view = View::new(&scene);
        let light = scene.light().unwrap();
        (scene, view, light)
    }

    #[test]
    fn errors_fall_with_the_step_and_exact_light_is_right() {
        let (scene, view, light) = small();
        let truth = ExactSights::new(&scene, &view, light, 160 * 30).unwrap();
        assert_eq!(truth.pixels(), 160 * 30);
        let worst = |h| {
            let stepper = Stepper::rk4(h);
            let errors = truth.of_pixels(&|place| stepper.sight(&scene, &view, place), 160 * 30);
            (errors.redshift.unwrap().max, errors.wrong)
        };
        let (coarse, fine) = (worst(0.1), worst(0.02));
        assert!(
            coarse.0 > 100.0 * fine.0 && fine.0 < 1e-5,
            "{coarse:?}, {fine:?}"
        );
        let itself = truth.of_pixels(&|place| truth.sight_in_two_parts(place), u64::MAX);
        assert_eq!((itself.wrong, itself.compared), (0, 160 * 30));
        assert!(itself.redshift.unwrap().max < 1e-12, "{itself:?}");
        // What is left is the rounding of colours.
        assert!(itself.luminance.unwrap().max < 1e-4, "{itself:?}");
    }

    #[test]
    fn a_frame_from_the_map_is_right_and_one_of_another_scene_is_not() {
        let (scene, view, light) = small();
        let truth = ExactSights::new(&scene, &view, light, u64::MAX).unwrap();
        let mut renderer = Renderer::with_angles(Exact);
        let mut frame = |scene: &Scene| renderer.render_layers(scene, compared_layers()).unwrap();
        let right = truth.of_layers(&frame(&scene));
        assert_eq!((right.wrong, right.compared), (0, 160 * 90));
        assert!(right.redshift.unwrap().max < 1e-6, "{right:?}");
        assert!(right.luminance.unwrap().max < 1e-5, "{right:?}");
        let mut camera = *scene.camera();
        camera.position *= 1.01;
        let farther = scene.clone().with_camera(camera).unwrap();
        let farther = farther
            .with_antialias(false)
            .with_light(scene.light())
            .unwrap();
        let farther = truth.of_layers(&frame(&farther));
        assert!(
            farther.wrong > 10 && farther.redshift.unwrap().max > 1e-4,
            "{farther:?}"
        );
    }
}
