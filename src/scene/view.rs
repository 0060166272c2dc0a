//! From pixels to rays in the frame of the hole.
//!
//! # Derivation
//!
//! The camera is a static observer at P, `r = |P|`, `p̂ = P/r`, and looks at F. With `V = F − P`, `L = |V|`: `f = V/L`,
//! `right = f × up` normalised, `true_up = right × f`. The [lens](super::lens) tells in which direction the picture's
//! point (X, Y) is seen, by its parts along f, right and `true_up`: `d = f + X right + Y true_up` in perspective. Of a
//! direction d only its inward part `z = −d·p̂` and its part across p̂, `t = d + z p̂`, are needed: the ray moves in
//! the plane of p̂ and t, and starts with `du/dφ = u0 √(1 − u0) z/s`, `s = |t|`.
//!
//! t is given in a basis (â, b̂) of the plane across p̂: â is along the part across p̂ of the disk's unit normal n,
//! `b̂ = p̂ × â`. So `n·b̂ = 0` and `n·t = (n·â) t_a`; z, `t_a` and `t_b` are linear in d's three parts.
//!
//! # Precision
//!
//! A far camera may have a field of view of 1e-12 rad, and t is as small. Subtracting `z p̂` from d would lose all its
//! digits. The coefficients are formed without subtracting large numbers:
//!
//! * f's part across p̂ is that of F/L and also that of V/L, since F − V = P is along p̂. The shorter of F and V gives
//!   an error of ε min(|F|, L)/L.
//! * right and `true_up` are ⟂ V, so `right·P = right·F` and `right·p̂ = right·F/r`, small where F is near the hole.

use core::f64::consts::PI;
use core::ops::Mul;

use glam::DVec3;

use super::checked::Scene;
use super::lens::{Direction, Lens};
use super::projection::Projection;
use super::values::Region;
use super::vector::{cosine, direction, norm, scaled, unit_cross};

/// n and p̂ are parallel where `|n × p̂|` is at most this: the rest is the rounding of the cross product and of the
/// norms, and gives â no direction. Taking `n·â` as 0 there changes an angle φ₁ by at most this.
const PARALLEL: f64 = 4.0 * f64::EPSILON;

/// The direction of a pixel in the frame of the hole, of arbitrary length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelRay {
    /// The inward part, `−d·p̂`: positive towards the hole's side.
    pub z: f64,
    /// The transverse part along â, the direction of the disk's normal across p̂.
    pub ta: f64,
    /// The transverse part along `b̂ = p̂ × â`, in the disk's plane.
    pub tb: f64,
}

impl PixelRay {
    /// The ray with parts that are linear in a direction's: z, `t_a` and `t_b`, each by its factors.
    #[inline(always)]
    fn of([z, ta, tb]: [Direction; 3], direction: Direction) -> Self {
        Self {
            z: dot(z, direction),
            ta: dot(ta, direction),
            tb: dot(tb, direction),
        }
    }

    /// `s = √(ta² + tb²)`, the transverse part's length. It is 0 for a radial ray, which has no orbital plane.
    pub fn transverse(self) -> f64 {
        (self.ta * self.ta + self.tb * self.tb).sqrt()
    }
}

/// What a frame computes with: the camera's radius, and each pixel's ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    radius: f64,
    u0: f64,
    slope_scale: f64,
    n_p: f64,
    n_a: f64,
    /// n, p̂, â and b̂ in the scene's axes.
    normal: DVec3,
    outward: DVec3,
    across: DVec3,
    level: DVec3,
    /// The factors of a direction's parts ahead, right and up in z, `t_a` and `t_b`.
    parts: [Direction; 3],
    lens: Lens,
    /// The part of the picture that is drawn.
    region: Region,
}

impl View {
    /// The view of a scene. Without a disk it takes +z as the disk's normal.
    pub fn new(scene: &Scene) -> Self {
        let (camera, image) = (scene.camera(), scene.image());
        let normal = scene.disk().map_or(DVec3::Z, |disk| disk.normal);
        let radius = scene.radius();
        let p = direction(camera.position);

        // Both are scaled by one power of two, so that their squares stay in range: V is not much shorter than F.
        let (view, scale) = scaled(camera.focus - camera.position);
        let focus = camera.focus / scale;
        let distance = view.length();
        let f = view / distance;
        // Two products, so that both are ⟂ f to the last digit even where up is nearly parallel to f.
        let true_up = direction(direction(view.cross(direction(camera.up))).cross(f));
        let right = direction(f.cross(true_up));

        let focus_is_near = norm(camera.focus) < radius;
        let along_p = |v: DVec3| {
            if focus_is_near {
                v.dot(camera.focus) / radius
            } else {
                v.dot(p)
            }
        };
        let (right_p, true_up_p) = (along_p(right), along_p(true_up));
        let shorter = if focus.length() < distance {
            focus
        } else {
            view
        };

        let n_p = cosine(normal, camera.position);
        let p_cross_n = unit_cross(camera.position, normal);
        let sine = p_cross_n.length();
        let (n_a, a) = if sine > PARALLEL {
            // The second cross product makes â ⟂ p̂ to the last digit; p̂ × n alone, a difference, is not.
            (sine, direction(p_cross_n.cross(p)))
        } else if true_up_p.abs() <= right_p.abs() {
            // Any direction across p̂ will do. The one of these two that is farther from p̂ has a part across p̂ of at
            // least 1/√2.
            (0.0, direction(true_up - p * true_up_p))
        } else {
            (0.0, direction(right - p * right_p))
        };
        let b = direction(p.cross(a));

        let across = |e: DVec3| [shorter.dot(e) / distance, right.dot(e), true_up.dot(e)];
        let u0 = 1.0 / radius;
        Self {
            radius,
            u0,
            // 1 − u0 = (r − 1)/r: r − 1 is exact for r < 2, where 1 − u0 would show the rounding of u0.
            slope_scale: u0 * ((radius - 1.0) / radius).sqrt(),
            n_p,
            n_a,
            normal: direction(normal),
            outward: p,
            across: a,
            level: b,
            parts: [[-f.dot(p), -right_p, -true_up_p], across(a), across(b)],
            lens: Lens::new(camera, image),
            region: scene.region(),
        }
    }

    /// The camera's radius r, in Schwarzschild radii, above 1.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The camera's inverse radius `u0 = 1/r`, between 0 and 1.
    pub fn u0(&self) -> f64 {
        self.u0
    }

    /// `u0 √(1 − u0)`: the slope `du/dφ` of a ray is this times `z/s`.
    pub fn slope_scale(&self) -> f64 {
        self.slope_scale
    }

    /// `n·p̂`, the sine of the camera's elevation above the disk's plane; exactly 0 where `normal · position` is.
    pub fn n_p(&self) -> f64 {
        self.n_p
    }

    /// `n·â = |n × p̂| ≥ 0`; 0 on the disk's axis.
    pub fn n_a(&self) -> f64 {
        self.n_a
    }

    /// The disk's unit normal n, in the scene's axes.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The unit vectors p̂, away from the hole, â and b̂, in the scene's axes.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.outward, self.across, self.level]
    }

    /// The unit vector `b̂ = p̂ × â` across p̂ and in the disk's plane, in the scene's axes.
    pub fn level(&self) -> DVec3 {
        self.level
    }

    /// `√(1 − u0)`: the rate of the camera's clock, and the ratio of a light's frequency far away to that at the
    /// camera.
    pub fn clock_rate(&self) -> f64 {
        // 1 − u0 = (r − 1)/r: r − 1 is exact for r < 2, where 1 − u0 would show the rounding of u0.
        ((self.radius - 1.0) / self.radius).sqrt()
    }

    /// `D/t_a`, where `tan φ₁ = N/D` and `N = |n·p̂| s`: it is n·â for the normal, n or −n, that points away from the
    /// camera, so that N ≥ 0.
    pub fn plane_slope(&self) -> f64 {
        if self.n_p > 0.0 { -self.n_a } else { self.n_a }
    }

    /// The factors of a direction's parts ahead of the camera, to its right and up: in z, in `t_a` and in `t_b`.
    pub(crate) fn parts(&self) -> [Direction; 3] {
        self.parts
    }

    /// The camera's projection, for this picture.
    pub(crate) fn lens(&self) -> &Lens {
        &self.lens
    }

    /// The whole picture's width, in pixels.
    pub fn width(&self) -> u32 {
        self.lens.size().0
    }

    /// The whole picture's height, in pixels.
    pub fn height(&self) -> u32 {
        self.lens.size().1
    }

    /// The part of the picture that is drawn. Places in the picture are counted from the whole picture's left and top
    /// all the same.
    pub fn region(&self) -> Region {
        self.region
    }

    /// The side of a pixel in X and Y.
    pub fn pixel_side(&self) -> f64 {
        self.lens.pixel_side()
    }

    /// X at `column` pixels from the picture's left edge, `(2 column − W) h/H`, where h is `tan(fov/2)` in perspective,
    /// `fov/2` of a fisheye and π/2 for the whole sphere. Pixel i's centre is at `i + ½`, its sides are at i and
    /// `i + 1`. `x_at(W − column)` is exactly `−x_at(column)`.
    pub fn x_at(&self, column: f64) -> f64 {
        self.lens.x_at(column)
    }

    /// Y at `row` pixels from the picture's top edge, `(H − 2 row) h/H`; pixel j's centre is at `j + ½`, its sides are
    /// at j and `j + 1`. `y_at(H − row)` is exactly `−y_at(row)`.
    pub fn y_at(&self, row: f64) -> f64 {
        self.lens.y_at(row)
    }

    /// The ray seen at (X, Y) of the picture.
    #[inline(always)]
    pub fn ray_at(&self, x: f64, y: f64) -> PixelRay {
        PixelRay::of(self.parts, self.lens.direction(x, y))
    }

    /// Returns whether something is seen at a place, in pixels from the picture's left and top: beyond the rim of a
    /// fisheye there is nothing. The rim is a circle that the picture's upper and lower sides touch.
    #[inline]
    pub fn shows(&self, (column, row): (f64, f64)) -> bool {
        if self.lens.projection() != Projection::Fisheye {
            return true;
        }
        let (width, height) = (f64::from(self.width()), f64::from(self.height()));
        // Exact for the centres of pixels.
        let (x, y) = (2.0 * column - width, 2.0 * row - height);
        x * x + y * y <= height * height
    }

    /// Returns the pixels of a row whose centres [show](Self::shows) something: the first column, and the one after the
    /// last.
    pub fn shown_columns(&self, row: u32) -> (u32, u32) {
        let (width, height) = (self.width(), self.height());
        if self.lens.projection() != Projection::Fisheye {
            return (0, width);
        }
        let from_middle = f64::from(row) + 0.5 - 0.5 * f64::from(height);
        let radius = 0.5 * f64::from(height);
        let half = ((radius - from_middle) * (radius + from_middle)).sqrt();
        let shows = |column: u32| self.shows((f64::from(column) + 0.5, f64::from(row) + 0.5));
        // The first column, up to rounding.
        let mut from = ((0.5 * f64::from(width) - half).max(0.0) as u32).saturating_sub(1);
        while from < width.div_ceil(2) && !shows(from) {
            from += 1;
        }
        (from, width - from)
    }

    /// Returns those of the [shown columns](Self::shown_columns) whose pixels lie wholly within the rim, where that is
    /// one direction: of a fisheye of 360 degrees. Beyond that direction the picture would begin again, so that of the
    /// pixels across the rim no area counts. Elsewhere all shown columns are returned.
    pub(crate) fn inner_columns(&self, row: u32) -> (u32, u32) {
        let (mut from, to) = self.shown_columns(row);
        let height = f64::from(self.height());
        if self.lens.projection() != Projection::Fisheye
            || (0.5 * height + 1.0) * self.pixel_side() < PI
        {
            return (from, to);
        }
        let row = f64::from(row);
        let farther = if row + 0.5 < 0.5 * height {
            row
        } else {
            row + 1.0
        };
        let middle = self.width().div_ceil(2);
        while from < middle && !self.shows((from.into(), farther)) {
            from += 1;
        }
        (from, (self.width() - from).max(from))
    }

    /// Returns a ray's direction, as long as the ray: its parts ahead of the camera, to its right and up. They are at
    /// right angles, so that the inverse is the transpose.
    #[inline(always)]
    pub fn direction_of(&self, PixelRay { z, ta, tb }: PixelRay) -> [f64; 3] {
        let [of_z, of_ta, of_tb] = self.parts;
        core::array::from_fn(|i| of_z[i] * z + of_ta[i] * ta + of_tb[i] * tb)
    }

    /// Returns where a ray is seen, in pixels from the picture's left and top, whether that is in the picture or not;
    /// `None` behind a flat picture. The inverse of [`Self::ray_at`].
    #[inline]
    pub fn place_of(&self, ray: PixelRay) -> Option<(f64, f64)> {
        let (x, y) = self.lens.point(self.direction_of(ray))?;
        let side = self.pixel_side();
        let (width, height) = (f64::from(self.width()), f64::from(self.height()));
        Some((0.5 * width + x / side, 0.5 * height - y / side))
    }

    /// How the ray at (X, Y) changes from a pixel to the next: to the right, and down.
    #[inline(always)]
    pub fn changes_at(&self, x: f64, y: f64) -> [PixelRay; 2] {
        let side = self.pixel_side();
        let [with_x, with_y] = self.lens.changes(x, y);
        let per_pixel = |change, side| PixelRay::of(self.parts, change) * side;
        [per_pixel(with_x, side), per_pixel(with_y, -side)]
    }

    /// The ray seen at the centre of pixel (i, j), i counted from the left, j from the top.
    pub fn pixel(&self, i: u32, j: u32) -> PixelRay {
        self.ray_at(self.x_at(f64::from(i) + 0.5), self.y_at(f64::from(j) + 0.5))
    }

    /// `du/dφ = u0 √(1 − u0) z/s` at the start of the ray, positive inward; ±∞ for a radial ray.
    pub fn dudphi(&self, ray: PixelRay) -> f64 {
        self.slope_scale * ray.z / ray.transverse()
    }

    /// The orbit angle φ₁ in [0, π) at which a ray with transverse part `ta` along â and length `s` first meets the
    /// disk's plane, `tan φ₁ = −(n·p̂)/(n·t̂)`, `n·t̂ = n_a ta/s`. It meets the plane at `φ₁ + kπ`, `k = 0, 1, 2 …`.
    ///
    /// Only positive angles count, as the camera itself is not a crossing. So where this is 0, the crossings are at
    /// `kπ`, k ≥ 1. It is 0 where `n·p̂ = 0`, also for a ray that stays in the disk's plane (`ta = 0`, the limit of its
    /// neighbours), and where φ₁ rounds to π. For s = 0 the value is meaningless.
    pub fn plane_crossing(&self, ta: f64, s: f64) -> f64 {
        if self.n_p == 0.0 {
            return 0.0;
        }
        let angle = libm::atan2(self.n_p.abs() * s, self.plane_slope() * ta);
        if angle < std::f64::consts::PI {
            angle
        } else {
            0.0
        }
    }
}

impl Mul<f64> for PixelRay {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            z: self.z * factor,
            ta: self.ta * factor,
            tb: self.tb * factor,
        }
    }
}

/// Returns a product, summed in the order of the parts.
#[inline(always)]
fn dot(a: Direction, b: Direction) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests;
