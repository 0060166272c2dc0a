//! Views of a sky without a disk, and what their rays see by the exact method alone.

use core::f64::consts::PI;
use std::sync::Arc;

use darkness::Renderer;
use darkness::orbit::exact::Exact;
use darkness::orbit::invariants::Orbit;
use darkness::orbit::path::SweptAngles;
use darkness::orbit::{Fate, Ray};
use darkness::scene::{Camera, ImageSize, Layer, LayerSet, Scene, Sky, View};
use darkness::sky::SkySource;
use glam::DVec3;

/// An oblique place at a radius.
pub(crate) fn position(radius: f64) -> DVec3 {
    DVec3::new(0.62, -0.53, 0.41).normalize() * radius
}

/// The scene of a camera at a place that looks in a direction.
pub(crate) fn looking(
    position: DVec3,
    towards: DVec3,
    fov: f64,
    (width, height): (u32, u32),
    sky: &Sky,
) -> Scene {
    let camera = Camera {
        focus: position + towards * position.length(),
        up: DVec3::new(0.3, 0.2, 1.0),
        ..Camera::at(position, fov)
    };
    Scene::without_disk(camera, sky.clone(), ImageSize { width, height }).unwrap()
}

/// The linear light of a scene.
pub(crate) fn light(renderer: &mut Renderer<impl SweptAngles>, scene: &Scene) -> Vec<[f32; 3]> {
    let layers = LayerSet::default().with(Layer::Colour);
    let planes = renderer.render_layers(scene, layers).unwrap();
    planes[0].values.as_chunks::<3>().0.to_vec()
}

/// The same before what a sky holds.
pub(crate) fn light_of<A: SweptAngles>(
    renderer: Renderer<A>,
    scene: &Scene,
    source: SkySource,
) -> (Renderer<A>, Vec<[f32; 3]>) {
    let mut renderer = renderer.with_sky(scene.sky().unwrap().clone(), Arc::new(source));
    let light = light(&mut renderer, scene);
    (renderer, light)
}

/// The rays of one camera radius, by the exact method.
#[derive(Clone, Copy)]
pub(crate) struct ExactRays {
    pub(crate) u0: f64,
    pub(crate) slope_scale: f64,
    /// The angle of the critical ray from the hole's direction.
    pub(crate) critical: f64,
}

impl ExactRays {
    pub(crate) fn new(radius: f64) -> Self {
        let u0 = 1.0 / radius;
        let slope_scale = u0 * ((radius - 1.0) / radius).sqrt();
        // e² = 4/27, by κ = w/scale, w² = (u − 2/3)² (u + 1/3); negative inside the photon sphere.
        let w = (2.0 / 3.0 - u0) * (u0 + 1.0 / 3.0).sqrt();
        let critical = libm::atan2(slope_scale, w);
        Self {
            u0,
            slope_scale,
            critical,
        }
    }

    /// The angle swept by the ray with these inward and transverse parts; `None` where it is captured.
    pub(crate) fn swept(&self, z: f64, s: f64) -> Option<f64> {
        let ray = Ray::new(self.u0, self.slope_scale * z / s).unwrap();
        let orbit = Orbit::new(ray);
        (orbit.fate() == Fate::Escape).then(|| Exact.to_end(&orbit))
    }

    /// The same of the ray at an angle ψ from the hole's direction.
    pub(crate) fn swept_at(&self, psi: f64) -> Option<f64> {
        self.swept(libm::cos(psi), libm::sin(psi))
    }

    /// The angle ψ of the ray that sweeps an angle.
    pub(crate) fn psi_of(&self, angle: f64) -> f64 {
        // By halves of the logarithm of ψ − ψ_c, which tells rays beside the critical one apart.
        let (mut low, mut high) = (
            -40.0 + libm::log(self.critical),
            libm::log(PI - self.critical),
        );
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            let psi = self.critical + libm::exp(middle);
            if self.swept_at(psi).is_none_or(|swept| swept > angle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.critical + libm::exp(0.5 * (low + high))
    }

    /// `−dΦ/dψ`, by Richardson's extrapolation of central differences.
    pub(crate) fn rate(&self, psi: f64) -> f64 {
        let step = 0.04 * (psi - self.critical);
        let slope = |step: f64| {
            let at = |psi: f64| {
                // Beyond ψ = π the ray is that on the other side, and the angle goes on below 0.
                if psi <= PI {
                    self.swept_at(psi).unwrap()
                } else {
                    -self.swept_at(2.0 * PI - psi).unwrap()
                }
            };
            (at(psi - step) - at(psi + step)) / (2.0 * step)
        };
        let [a, b, c] = [step, 0.5 * step, 0.25 * step].map(slope);
        let (ab, bc) = ((4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0);
        (16.0 * bc - ab) / 15.0
    }

    /// The direction in which the ray of a place in a picture leaves.
    pub(crate) fn leaves(&self, view: &View, (x, y): (f64, f64)) -> Option<DVec3> {
        let ray = view.ray_at(view.x_at(x), view.y_at(y));
        let s = ray.transverse();
        let angle = self.swept(ray.z, s)?;
        let [p, a, b] = view.axes();
        let t = (a * ray.ta + b * ray.tb) / s;
        Some(p * libm::cos(angle) + t * libm::sin(angle))
    }
}

/// The derivative of a vector at 0, by Richardson's extrapolation of central differences.
pub(crate) fn derivative(step: f64, at: impl Fn(f64) -> DVec3) -> DVec3 {
    let slope = |step: f64| (at(step) - at(-step)) / (2.0 * step);
    let [a, b, c] = [step, 0.5 * step, 0.25 * step].map(slope);
    let (ab, bc) = ((4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0);
    (16.0 * bc - ab) / 15.0
}

/// The solid angle of a pixel: the mean of `(1 + X² + Y²)^{−3/2}` by Gauss's rule of 3 × 3 nodes.
pub(crate) fn solid_angle(view: &View, (i, j): (usize, usize)) -> f64 {
    let node = 0.5 * (0.6_f64).sqrt();
    let nodes = [(-node, 5.0 / 18.0), (0.0, 8.0 / 18.0), (node, 5.0 / 18.0)];
    let mut sum = 0.0;
    for (dx, wx) in nodes {
        for (dy, wy) in nodes {
            let x = view.x_at(i as f64 + 0.5 + dx);
            let y = view.y_at(j as f64 + 0.5 + dy);
            let square = 1.0 + x * x + y * y;
            sum += wx * wy / (square * square.sqrt());
        }
    }
    sum * view.pixel_side() * view.pixel_side()
}
