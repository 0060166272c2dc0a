//! From places in a picture to directions, and back.
//!
//! A picture's point (X, Y) is counted from its centre, to the right and up. Directions have three parts: ahead of the
//! camera, to its right, and up.
//!
//! | projection | direction of (X, Y) | back |
//! |---|---|---|
//! | perspective | `(1, X, Y)` | `X = right/ahead`, `Y = up/ahead` |
//! | fisheye | `(cos ρ, X sin ρ/ρ, Y sin ρ/ρ)`, `ρ = √(X² + Y²)` | `ρ = atan2(h, ahead)`, `h = √(right² + up²)` |
//! | equirectangular | `(cos Y cos X, cos Y sin X, sin Y)` | `X = atan2(right, ahead)`, `Y = atan2(up, l)` |
//!
//! with `l = √(ahead² + right²)`. So X and Y are tangents in perspective, and radians elsewhere: the fisheye is the
//! equidistant one, in which ρ is the angle from the centre.

use core::f64::consts::PI;

use super::projection::Projection;
use super::values::{Camera, ImageSize};

/// A direction's parts ahead of the camera, to its right, and up.
pub(crate) type Direction = [f64; 3];

/// A camera's projection for a picture of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lens {
    projection: Projection,
    width: u32,
    height: u32,
    /// Half a pixel's side in X and Y.
    half_pixel: f64,
}

impl Lens {
    pub(super) fn new(camera: &Camera, size: ImageSize) -> Self {
        let half_fov = camera.fov_degrees.to_radians() / 2.0;
        let half_height = match camera.projection {
            Projection::Perspective => libm::tan(half_fov),
            Projection::Fisheye => half_fov,
            Projection::Equirectangular => PI / 2.0,
        };
        Self {
            projection: camera.projection,
            width: size.width,
            height: size.height,
            half_pixel: half_height / f64::from(size.height),
        }
    }

    pub(crate) fn projection(&self) -> Projection {
        self.projection
    }

    pub(super) fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    pub(crate) fn pixel_side(&self) -> f64 {
        2.0 * self.half_pixel
    }

    pub(super) fn x_at(&self, column: f64) -> f64 {
        (2.0 * column - f64::from(self.width)) * self.half_pixel
    }

    pub(super) fn y_at(&self, row: f64) -> f64 {
        (f64::from(self.height) - 2.0 * row) * self.half_pixel
    }

    /// Returns the direction in which (X, Y) is seen; a unit vector but in perspective.
    #[inline(always)]
    pub(crate) fn direction(&self, x: f64, y: f64) -> Direction {
        match self.projection {
            Projection::Perspective => [1.0, x, y],
            Projection::Fisheye => {
                let (sine, cosine) = libm::sincos((x * x + y * y).sqrt());
                let share = sine_share(x * x + y * y, sine);
                [cosine, x * share, y * share]
            }
            Projection::Equirectangular => {
                let ((sin_x, cos_x), (sin_y, cos_y)) = (libm::sincos(x), libm::sincos(y));
                [cos_y * cos_x, cos_y * sin_x, sin_y]
            }
        }
    }

    /// Returns how the direction of (X, Y) changes with X, and with Y.
    #[inline(always)]
    pub(crate) fn changes(&self, x: f64, y: f64) -> [Direction; 2] {
        match self.projection {
            Projection::Perspective => [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Projection::Fisheye => {
                let square = x * x + y * y;
                let (sine, cosine) = libm::sincos(square.sqrt());
                let share = sine_share(square, sine);
                // The change of sin ρ/ρ with ρ, over ρ.
                let bend = if square < SMALL {
                    square / 30.0 - 1.0 / 3.0
                } else {
                    (cosine - share) / square
                };
                [
                    [-share * x, share + bend * x * x, bend * x * y],
                    [-share * y, bend * x * y, share + bend * y * y],
                ]
            }
            Projection::Equirectangular => {
                let ((sin_x, cos_x), (sin_y, cos_y)) = (libm::sincos(x), libm::sincos(y));
                [
                    [-cos_y * sin_x, cos_y * cos_x, 0.0],
                    [-sin_y * cos_x, -sin_y * sin_x, cos_y],
                ]
            }
        }
    }

    /// Returns the solid angle of the picture about (X, Y), over that of as small a part in its centre.
    pub(crate) fn solid_angle(&self, x: f64, y: f64) -> f64 {
        match self.projection {
            Projection::Perspective => {
                let square = 1.0 + x * x + y * y;
                1.0 / (square * square.sqrt())
            }
            Projection::Fisheye => {
                let square = x * x + y * y;
                sine_share(square, libm::sin(square.sqrt()))
            }
            Projection::Equirectangular => libm::cos(y),
        }
    }

    /// Returns how much narrower a pixel about (X, Y) is across than along, as an angle: a fisheye stretches what it
    /// shows around its centre, an equirectangular picture along its rows. Flat pictures count as 1: they stretch most
    /// where they are widest, by less than others.
    pub(crate) fn narrowing(&self, x: f64, y: f64) -> f64 {
        match self.projection {
            Projection::Perspective => 1.0,
            Projection::Fisheye | Projection::Equirectangular => self.solid_angle(x, y),
        }
    }

    /// Returns where a direction of any length is seen, (X, Y); `None` behind a flat picture.
    #[inline(always)]
    pub(crate) fn point(&self, [ahead, right, up]: Direction) -> Option<(f64, f64)> {
        match self.projection {
            Projection::Perspective => (ahead > 0.0).then(|| (right / ahead, up / ahead)),
            Projection::Fisheye => {
                let across = (right * right + up * up).sqrt();
                if across == 0.0 {
                    let rho = if ahead < 0.0 { PI } else { 0.0 };
                    return Some((rho, 0.0));
                }
                let scale = libm::atan2(across, ahead) / across;
                Some((right * scale, up * scale))
            }
            Projection::Equirectangular => {
                let level = (ahead * ahead + right * right).sqrt();
                Some((libm::atan2(right, ahead), libm::atan2(up, level)))
            }
        }
    }

    /// Returns how the point at which a direction is seen moves as the direction changes.
    #[inline(always)]
    pub(crate) fn point_change(
        &self,
        [ahead, right, up]: Direction,
        [d_ahead, d_right, d_up]: Direction,
    ) -> (f64, f64) {
        match self.projection {
            Projection::Perspective => (
                (d_right - right / ahead * d_ahead) / ahead,
                (d_up - up / ahead * d_ahead) / ahead,
            ),
            Projection::Fisheye => {
                let across2 = right * right + up * up;
                let across = across2.sqrt();
                let length2 = ahead * ahead + across2;
                if across == 0.0 {
                    return (d_right / ahead, d_up / ahead);
                }
                let rho = libm::atan2(across, ahead);
                // Outwards and around the centre.
                let (cosine, sine) = (right / across, up / across);
                let outwards = cosine * d_right + sine * d_up;
                let d_rho = (ahead * outwards - across * d_ahead) / length2;
                let turn = rho * (cosine * d_up - sine * d_right) / across;
                (cosine * d_rho - sine * turn, sine * d_rho + cosine * turn)
            }
            Projection::Equirectangular => {
                let level2 = ahead * ahead + right * right;
                let level = level2.sqrt();
                let d_level = (ahead * d_ahead + right * d_right) / level;
                (
                    (ahead * d_right - right * d_ahead) / level2,
                    (level * d_up - up * d_level) / (level2 + up * up),
                )
            }
        }
    }
}

/// Below this square of ρ, powers of ρ stand for its sine.
const SMALL: f64 = 1e-4;

/// Returns `sin ρ/ρ`.
#[inline(always)]
fn sine_share(square: f64, sine: f64) -> f64 {
    if square < SMALL {
        1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))
    } else {
        sine / square.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: ImageSize = ImageSize {
        width: 200,
        height: 100,
    };

    fn lenses() -> impl Iterator<Item = Lens> {
        [
            (Projection::Perspective, 120.0),
            (Projection::Fisheye, 1e-3),
            (Projection::Fisheye, 180.0),
            (Projection::Fisheye, 360.0),
            (Projection::Equirectangular, 180.0),
        ]
        .into_iter()
        .map(|(projection, fov)| {
            let camera = Camera {
                projection,
                ..Camera::at([20.0, 0.0, 0.0], fov)
            };
            Lens::new(&camera, SIZE)
        })
    }

    /// Points of a picture: its centre, places about it, and places all over it.
    fn points(lens: &Lens) -> impl Iterator<Item = (f64, f64)> {
        let places =
            (0..21).flat_map(|i| (0..11).map(move |j| (10.0 * f64::from(i), 10.0 * f64::from(j))));
        let near = [(100.0, 50.0), (100.0, 50.0 + 1e-9), (100.02, 49.97)];
        let height = f64::from(SIZE.height);
        places.chain(near).filter_map(move |(column, row)| {
            let (x, y) = (2.0 * column - 200.0, 2.0 * row - 100.0);
            let is_seen =
                lens.projection() != Projection::Fisheye || x * x + y * y < height * height;
            is_seen.then(|| (lens.x_at(column), lens.y_at(row)))
        })
    }

    #[test]
    fn places_are_those_of_their_directions() {
        for lens in lenses() {
            let scale = lens.y_at(0.0);
            for (x, y) in points(&lens) {
                let direction = lens.direction(x, y).map(|part| 3.0 * part);
                let (found_x, found_y) = lens.point(direction).unwrap();
                // A pole has any longitude.
                let is_pole = lens.projection() == Projection::Equirectangular && y.abs() > 1.57;
                let apart = if is_pole { 0.0 } else { found_x - x };
                let turns = (apart / (2.0 * PI)).round() * 2.0 * PI;
                let off = (apart - turns).abs().max((found_y - y).abs());
                assert!(off < 1e-13 * scale, "{lens:?} {x} {y}: {off:e}");
            }
        }
    }

    /// Changes of directions, of points and of solid angles against differences.
    #[test]
    fn changes_are_differences() {
        for lens in lenses() {
            let step = 1e-4 * lens.y_at(0.0).min(1.0);
            for (x, y) in points(&lens) {
                let [with_x, with_y] = lens.changes(x, y);
                let difference = |a: Direction, b: Direction| -> Direction {
                    core::array::from_fn(|i| (a[i] - b[i]) / (2.0 * step))
                };
                let of_x = difference(lens.direction(x + step, y), lens.direction(x - step, y));
                let of_y = difference(lens.direction(x, y + step), lens.direction(x, y - step));
                for (found, known) in [(with_x, of_x), (with_y, of_y)] {
                    for (found, known) in found.into_iter().zip(known) {
                        assert!(
                            (found - known).abs() < 1e-7,
                            "{lens:?} {x} {y}: {found} {known}"
                        );
                    }
                }
                let [a, b] = [with_x, with_y];
                let normal = [
                    a[1] * b[2] - a[2] * b[1],
                    a[2] * b[0] - a[0] * b[2],
                    a[0] * b[1] - a[1] * b[0],
                ];
                let direction = lens.direction(x, y);
                let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
                let volume: f64 = (0..3).map(|i| normal[i] * direction[i]).sum();
                let known = volume / (length * length * length);
                assert!(
                    (lens.solid_angle(x, y) - known).abs() < 1e-9,
                    "{lens:?} {x} {y}"
                );

                // A step of the point follows the step of its direction; about a pole there is none.
                if lens.solid_angle(x, y) < 1e-3 {
                    continue;
                }
                let (of_x, of_y) = (
                    lens.point_change(direction, with_x),
                    lens.point_change(direction, with_y),
                );
                let off = (of_x.0 - 1.0).abs() + of_x.1.abs() + of_y.0.abs() + (of_y.1 - 1.0).abs();
                assert!(off < 1e-9, "{lens:?} {x} {y}: {of_x:?} {of_y:?}");
            }
        }
    }
}
