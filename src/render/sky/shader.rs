//! What the ray of any place in the picture sees of the sky, from the escape curve of the camera's radius.
//!
//! # Footprint
//! A ray leaves in the direction `D = p̂ cos Φ + t̂ sin Φ`. Let ψ be its angle from the hole's direction, and α its
//! azimuth about it. From a pixel to the next
//!
//! ```text
//! dψ = (z ds − s dz)/(s² + z²),   ds = (t_a dt_a + t_b dt_b)/s,   dα = (t_a dt_b − t_b dt_a)/s²
//! dD = (t̂ cos Φ − p̂ sin Φ) dΦ/dψ dψ + (p̂ × t̂) sin Φ dα
//! ```
//!
//! z, `t_a` and `t_b` are affine in the picture, so that this is exact.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::isoradial::{Escape, EscapeCurve};
use crate::render::tiles::{Rectangle, TileRow};
use crate::scene::{PixelRay, Scene, View};
use crate::sky::Orientation;

/// Closer than this to straight away from the hole, as a sine, all directions about it change alike.
const AXIS: f64 = 1e-7;

/// The least squared sine of a place's distance from a pole: its longitude changes without bound there.
const POLE: f64 = 1e-24;

/// Finds where rays of a view leave to.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct SkyShader<'a> {
    pub(super) view: &'a View,
    pub(super) curve: &'a EscapeCurve,
    orientation: Orientation,
    /// p̂, â and b̂, in the sky's axes.
    axes: [DVec3; 3],
}

/// What a ray sees of the sky.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct SkySight {
    /// (X, Y) in the picture.
    point: (f64, f64),
    ray: PixelRay,
    s: f64,
    escape: Escape,
    sine: f64,
    cosine: f64,
    /// The unit vector in which it leaves, in the sky's axes.
    pub(in crate::render) direction: DVec3,
}

/// How a direction changes from a pixel to the next one, to the right and down.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct Footprint {
    pub(super) along_x: DVec3,
    pub(super) along_y: DVec3,
}

impl<'a> SkyShader<'a> {
    /// The directions of a view, in the axes of a scene's sky.
    pub(in crate::render) fn new(view: &'a View, curve: &'a EscapeCurve, scene: &Scene) -> Self {
        let rotation = scene.sky().map_or([0.0; 3], |sky| sky.rotation);
        let orientation = Orientation::new(rotation);
        Self {
            view,
            curve,
            orientation,
            axes: view.axes().map(|axis| orientation.to_sky(axis)),
        }
    }

    /// The view whose rays these are.
    pub(in crate::render) fn view(&self) -> &'a View {
        self.view
    }

    /// Returns a direction of the sky's axes in those of the scene.
    pub(in crate::render) fn in_scene(&self, direction: DVec3) -> DVec3 {
        self.orientation.from_sky(direction)
    }

    /// p̂, â and b̂, in the sky's axes.
    pub(super) fn axes(&self) -> [DVec3; 3] {
        self.axes
    }

    /// Returns what is seen at a place, in pixels from the picture's left and its top; `None` in the hole's shadow.
    #[inline]
    pub(in crate::render) fn at(&self, (x, y): (f64, f64)) -> Option<SkySight> {
        let point = (self.view.x_at(x), self.view.y_at(y));
        let ray = self.view.ray_at(point.0, point.1);
        let s = ray.transverse();
        let escape = self.curve.at(ray.z, s)?;
        Some(self.sight(point, (ray, s), escape))
    }

    /// Returns what the ray at (X, Y) sees, s the length of its transverse part, if it sweeps a known angle.
    #[inline]
    pub(in crate::render) fn sight(
        &self,
        point: (f64, f64),
        (ray, s): (PixelRay, f64),
        escape: Escape,
    ) -> SkySight {
        let (sine, cosine) = libm::sincos(escape.angle);
        let [p, a, b] = self.axes;
        let direction = if s > 0.0 {
            p * cosine + (a * ray.ta + b * ray.tb) * (sine / s)
        } else {
            p
        };
        SkySight {
            point,
            ray,
            s,
            escape,
            sine,
            cosine,
            direction,
        }
    }

    /// Returns how the direction changes from pixel to pixel.
    #[inline]
    pub(in crate::render) fn footprint(&self, sight: &SkySight) -> Footprint {
        let [p, a, b] = self.axes;
        let PixelRay { z, ta, tb } = sight.ray;
        let length2 = z * z + sight.s * sight.s;
        let change = |change: PixelRay| {
            let (dz, da, db) = (change.z, change.ta, change.tb);
            if sight.s <= AXIS * -z {
                return (a * da + b * db) * (sight.escape.rate / -z);
            }
            let s = sight.s;
            let (cos_a, sin_a) = (ta / s, tb / s);
            let ds = cos_a * da + sin_a * db;
            let turn = -sight.escape.rate * (z * ds - s * dz) / length2;
            let across = sight.sine / s * (cos_a * db - sin_a * da);
            let outward = (a * cos_a + b * sin_a) * sight.cosine - p * sight.sine;
            outward * turn + (b * cos_a - a * sin_a) * across
        };
        let [along_x, along_y] = self.view.changes_at(sight.point.0, sight.point.1);
        Footprint {
            along_x: change(along_x),
            along_y: change(along_y),
        }
    }

    /// Whether a rectangle of pixels lies in the hole's shadow, as far as its middle tells: over a distance in the
    /// picture, in X and Y, `z − κ_c s` changes by at most `√(1 + κ_c²)` times that.
    pub(in crate::render) fn is_in_shadow(&self, bounds: Rectangle, band: TileRow) -> bool {
        let ((left, upper), (right, lower)) = bounds.centres(band);
        let (width, height) = (right - left + 1.0, lower - upper + 1.0);
        let reach = 0.5 * (width * width + height * height).sqrt() * self.view.pixel_side();
        let (x, y) = (0.5 * (left + right), 0.5 * (upper + lower));
        let ray = self.view.ray_at(self.view.x_at(x), self.view.y_at(y));
        let critical = self.curve.critical();
        let excess = ray.z - critical * ray.transverse();
        excess > (1.0 + critical * critical).sqrt() * reach
    }

    /// Returns how much the angle swept changes from pixel to pixel, at most: `|dΦ/dψ| |∇ψ|`. Beside the shadow this is
    /// the inverse of the distance from its edge, in pixels.
    pub(super) fn swept_per_pixel(&self, sight: &SkySight) -> f64 {
        // Straight away from the hole ψ grows alike in all directions.
        let (x, y) = if sight.s > 0.0 {
            self.outward(sight)
        } else {
            (self.view.pixel_side() / sight.ray.z, 0.0)
        };
        sight.escape.rate * (x * x + y * y).sqrt()
    }

    /// Returns how the angle from the hole's direction changes from pixel to pixel, to the right and down.
    pub(super) fn outward(&self, sight: &SkySight) -> (f64, f64) {
        outward(self.view, sight.point, (sight.ray, sight.s))
    }
}

/// Returns how the angle from the hole's direction changes from pixel to pixel, to the right and down, for the ray at
/// (X, Y), s the length of its transverse part.
pub(super) fn outward(view: &View, point: (f64, f64), (ray, s): (PixelRay, f64)) -> (f64, f64) {
    if s == 0.0 {
        return (0.0, 0.0);
    }
    let PixelRay { z, ta, tb } = ray;
    let length2 = z * z + s * s;
    let [across, down] = view.changes_at(point.0, point.1).map(|change| {
        let ds = (ta * change.ta + tb * change.tb) / s;
        (z * ds - s * change.z) / length2
    });
    (across, down)
}

/// Returns how the place of a direction changes with it.
#[inline]
pub(super) fn place_change(direction: DVec3, change: DVec3) -> [f32; 2] {
    let across2 = (direction.x * direction.x + direction.y * direction.y).max(POLE);
    let across = across2.sqrt();
    let longitude = (direction.x * change.y - direction.y * change.x) / across2;
    let outward = (direction.x * change.x + direction.y * change.y) / across;
    let latitude = change.z * across - direction.z * outward;
    [(-longitude / TAU) as f32, (latitude / PI) as f32]
}

#[cfg(test)]
mod tests;
