//! What curves are built for: one camera radius, at most one disk, the part of the sky in the picture, and its pixels.
//!
//! # Pixels
//! Let p be the height of a pixel in the picture's centre, in radians. At the angle θ from the centre, a radian in any
//! direction is at most `m(θ)/p` pixels long: m is [`Projection::stretch`], `1/cos²θ` in perspective. Let a be the
//! angle between the centre and the hole, and c the angle between the centre and the corners. A ray at the angle ψ from
//! the hole's direction has `θ ≤ min(ψ + a, c)`. So a radian there is at most `m(min(ψ + a, c))/p` pixels long:
//! [`CurveSpec::pixels_per_radian`]. In an equirectangular picture angles from the horizon stand for those from the
//! centre.
//!
//! A fisheye of 360 degrees shows the direction behind the camera all round, and an equirectangular picture its poles
//! along a whole row. There a pixel is no angle at all. Where pixels are [`NARROWEST`] times narrower than in the
//! centre or more, the tolerance is that of pixels so many times narrower.

use core::f64::consts::PI;

use super::ray_angles::{angle_between, angle_of};
use super::ray_bounds::RayBounds;
use crate::orbit::invariants::{critical_slope, three_u_minus_two};
use crate::scene::{Projection, Scene, View};

/// Pixels that are narrower than in the picture's centre by more than this count as narrower by this.
const NARROWEST: f64 = 20.0;

/// What curves are built for: one camera radius, at most one disk, and one picture or several from that radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveSpec {
    /// The camera's inverse radius.
    pub u0: f64,
    /// `u0 √(1 − u0)`, the ratio of du/dφ to κ.
    pub slope_scale: f64,
    /// The inverse radii of the disk's inner and outer edge, in this order. Without a disk there are no curves.
    pub u_edges: Option<[f64; 2]>,
    /// The height of a pixel in the picture's centre, in radians: in the plane at distance 1.
    pub pixel: f64,
    /// How directions become places in the picture.
    pub projection: Projection,
    /// The angle between the picture's centre, or the horizon of an equirectangular picture, and the hole's direction,
    /// in radians.
    pub axis: f64,
    /// The angle between the picture's centre, or that horizon, and the corners, in radians.
    pub corner: f64,
    /// Bounds of the rays in the picture.
    pub window: RayBounds,
    /// The allowed error of an edge, in pixels.
    pub tolerance: f64,
}

impl CurveSpec {
    /// Describes the curves for the picture of `scene`, with edges right to `tolerance` pixels.
    pub fn new(scene: &Scene, view: &View, tolerance: f64) -> Self {
        let projection = view.lens().projection();
        let centre = view.ray_at(0.0, 0.0);
        let (x, y) = (view.x_at(0.0), view.y_at(0.0));
        let axis = libm::atan2(centre.transverse(), centre.z);
        let (axis, corner, window) = match projection {
            Projection::Perspective => {
                let corner = libm::atan((x * x + y * y).sqrt());
                (axis, corner, RayBounds::of_picture(view, axis, corner))
            }
            // Y of the upper edge is half of the whole angle. Nothing is seen beyond the rim, but the outline is
            // followed to the picture's corners: where it ended within the picture its rows would have no sides.
            Projection::Fisheye => {
                let narrowest = libm::acos(2.0 / NARROWEST - 1.0);
                let corner = (x * x + y * y).sqrt().min(PI);
                let window = RayBounds::of_picture(view, axis, corner);
                (axis, y.min(narrowest), window)
            }
            Projection::Equirectangular => {
                let height = libm::asin(view.parts()[0][2].abs().min(1.0));
                let window = RayBounds::of_picture(view, axis, PI);
                (height, libm::acos(1.0 / NARROWEST), window)
            }
        };
        Self {
            tolerance,
            pixel: (view.y_at(0.0) - view.y_at(1.0)).abs(),
            projection,
            axis,
            corner,
            window,
            ..Self::all_round(
                view.u0(),
                view.slope_scale(),
                scene.disk().map(|disk| (disk.inner, disk.outer)),
            )
        }
    }

    /// Describes the curves for all rays of a camera at inverse radius `u0`, where `slope_scale` is `u0 √(1 − u0)`.
    ///
    /// `radii` are those of the disk's inner and outer edge. A pixel is one radian and the tolerance one pixel. Set
    /// [`Self::pixel`] and [`Self::tolerance`] for others.
    pub fn all_round(u0: f64, slope_scale: f64, radii: Option<(f64, f64)>) -> Self {
        Self {
            u0,
            slope_scale,
            u_edges: radii.map(|(inner, outer)| [1.0 / inner, 1.0 / outer]),
            pixel: 1.0,
            projection: Projection::Perspective,
            axis: 0.0,
            corner: 0.0,
            window: RayBounds::ALL,
            tolerance: 1.0,
        }
    }

    /// Describes curves that serve the pictures of both. Returns `None` if the camera radii, the disks or the
    /// projections differ.
    pub fn union(&self, other: &Self) -> Option<Self> {
        let radii = |spec: &Self| (spec.u0, spec.slope_scale, spec.u_edges, spec.projection);
        (radii(self) == radii(other)).then(|| Self {
            pixel: self.pixel.min(other.pixel),
            axis: self.axis.max(other.axis),
            corner: self.corner.max(other.corner),
            window: self.window.union(&other.window),
            tolerance: self.tolerance.min(other.tolerance),
            ..*self
        })
    }

    /// Describes curves that serve the pictures beside this one too: of a camera that turns about the hole, or aside by
    /// up to half its field of view.
    pub(crate) fn ahead(&self) -> Self {
        Self {
            axis: self.axis + self.corner,
            window: self.window.widened(self.corner),
            ..*self
        }
    }

    /// Returns whether this is another picture from the same radius, with pixels of about the same size: probably the
    /// next one of a camera that turns.
    pub(crate) fn is_beside(&self, other: &Self) -> bool {
        let same = self.union(other).is_some() && self.tolerance == other.tolerance;
        same && (0.5..=2.0).contains(&(self.pixel / other.pixel))
    }

    /// Returns κ of the critical ray. It is positive (towards the hole) outside the photon sphere, negative inside.
    pub fn critical(&self) -> f64 {
        critical_kappa(self.u0, self.slope_scale)
    }

    /// Returns `m(min(psi + a, c))/p`: the most pixels in a radian, for rays at most `psi` radians from the
    /// hole's direction. Here m is [`Projection::stretch`], p is [`Self::pixel`], a is [`Self::axis`] and c is
    /// [`Self::corner`].
    pub fn pixels_per_radian(&self, psi: f64) -> f64 {
        let cosine = libm::cos((psi + self.axis).min(self.corner));
        self.projection.stretch(cosine) / self.pixel
    }

    /// Bounds the distance in the picture of two rays of one plane, in pixels, from their `h = κ − κ_c`.
    pub fn pixels(&self, h: (f64, f64)) -> f64 {
        let critical = self.critical();
        let (low, high) = (h.0.min(h.1), h.0.max(h.1));
        self.pixels_per_radian(angle_of(critical + low)) * angle_between(low, high, critical)
    }

    /// Returns the least and the greatest `h = κ − κ_c` in the picture.
    pub(super) fn h_range(&self) -> (f64, f64) {
        let (low, high) = self.window.kappa;
        (low - self.critical(), high - self.critical())
    }
}

/// Returns κ of the critical ray at inverse radius `u0`, where `slope_scale` is `u0 √(1 − u0)`.
pub(super) fn critical_kappa(u0: f64, slope_scale: f64) -> f64 {
    let size = critical_slope(u0) / slope_scale;
    if three_u_minus_two(u0) < 0.0 {
        size
    } else {
        -size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ImageSize, Navigator};

    #[test]
    fn what_lies_ahead_serves_a_camera_that_turns() {
        let spec = |scene: &Scene| CurveSpec::new(scene, &View::new(scene), scene.tolerance());
        for (name, fov) in [
            ("classic", 30.0),
            ("lit", 8.0),
            ("inside", 90.0),
            ("edge-on", 30.0),
        ] {
            let scene = Scene::builtin(name).unwrap();
            let ImageSize { width, height } = scene.image();
            let start = Navigator::new(&scene);
            let fov = start.fov_degrees().min(fov);
            let ahead = spec(&scene).ahead();
            assert!(ahead.is_beside(&spec(&scene)));
            for (right, down) in [
                (1.0, 0.3),
                (-1.0, 0.3),
                (50.0, 0.0),
                (0.0, 0.5),
                (0.0, -0.5),
            ] {
                let mut turned = start.clone();
                turned.turn(right, down);
                let mut aside = start.clone();
                aside.look(0.2 * fov * right.signum(), 0.5 * down * fov);
                for camera in [turned.camera(), aside.camera()] {
                    let next = scene.clone().with_camera(camera).unwrap();
                    let is_served = ahead.union(&spec(&next)) == Some(ahead);
                    assert!(
                        is_served,
                        "{name}: {right}, {down}: {ahead:?}, {:?}",
                        spec(&next)
                    );
                }
            }
            let finer = scene.clone().with_size(width / 4, height / 4).unwrap();
            assert!(!ahead.is_beside(&spec(&finer)));
        }
    }
}
