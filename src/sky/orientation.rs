//! Places in the sky, and the turn from the scene's axes to the sky's own.
//!
//! A *place* `(u, v)` is longitude and latitude as shares of a panorama's width and height. Its centre (½, ½) is the
//! direction +x, its top v = 1 is +z. The sky is seen from inside, so longitude grows to the left, and u to the right:
//!
//! `u = ½ − atan2(y, x)/2π`, `v = ½ + asin(z)/π`.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

/// The turn from the scene's axes to the sky's own, in which places are counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    /// Takes a direction of the sky's axes to the scene's.
    to_scene: DMat3,
}

impl Orientation {
    /// Makes the orientation of a sky that is turned by `[yaw, pitch, roll]` degrees: about the scene's z axis, then
    /// about its y axis, then about its x axis, each counterclockwise seen from the axis' positive end.
    ///
    /// As matrices: `R = Rx(roll) Ry(pitch) Rz(yaw)`. Multiples of 90° turn exactly. The angles are finite.
    pub fn new(rotation_degrees: [f64; 3]) -> Self {
        let [(sz, cz), (sy, cy), (sx, cx)] = rotation_degrees.map(sin_cos_degrees);
        // Columns.
        let rx = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
        let ry = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
        let rz = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
        Self {
            to_scene: rx * ry * rz,
        }
    }

    /// Returns a direction of the scene in the sky's own axes. Its length is kept.
    pub fn to_sky(&self, direction: DVec3) -> DVec3 {
        self.to_scene.transpose() * direction
    }

    /// Returns a direction of the sky's axes in those of the scene: the inverse of [`to_sky`](Self::to_sky).
    pub fn from_sky(&self, direction: DVec3) -> DVec3 {
        self.to_scene * direction
    }
}

impl Default for Orientation {
    /// The sky's axes are the scene's.
    fn default() -> Self {
        Self::new([0.0; 3])
    }
}

/// Returns sine and cosine of an angle in degrees, exact for multiples of 90.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turn = degrees % 360.0;
    let quarters = libm::round(turn / 90.0);
    let (sin, cos) = libm::sincos((turn - 90.0 * quarters).to_radians());
    match (quarters as i32).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Returns the place `(u, v)` of a direction in the sky's axes, of any length but 0. Both are in [0, 1].
pub fn place(direction: DVec3) -> (f64, f64) {
    let DVec3 { x, y, z } = direction;
    // By the arc tangent, since the arc sine loses half of its digits near the poles.
    let latitude = libm::atan2(z, libm::hypot(x, y));
    (0.5 - libm::atan2(y, x) / TAU, 0.5 + latitude / PI)
}

/// Returns the direction, of length 1 and in the sky's axes, of the place `(u, v)`: the inverse of [`place`].
pub fn direction(u: f64, v: f64) -> DVec3 {
    let (sin_longitude, cos_longitude) = libm::sincos((0.5 - u) * TAU);
    let (sin_latitude, cos_latitude) = libm::sincos((v - 0.5) * PI);
    DVec3::new(
        cos_latitude * cos_longitude,
        cos_latitude * sin_longitude,
        sin_latitude,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_rotation_changes_nothing() {
        let direction = DVec3::new(0.1, -0.7, 0.3);
        assert_eq!(Orientation::default().to_sky(direction), direction);
        assert_eq!(Orientation::default().from_sky(direction), direction);
        assert_eq!(
            Orientation::new([360.0, -360.0, 720.0]),
            Orientation::default()
        );
    }

    #[test]
    fn quarter_turns_are_counterclockwise_and_exact() {
        let turned = |rotation, direction| Orientation::new(rotation).from_sky(direction);
        assert_eq!(turned([90.0, 0.0, 0.0], DVec3::X), DVec3::Y);
        assert_eq!(turned([0.0, 90.0, 0.0], DVec3::Z), DVec3::X);
        assert_eq!(turned([0.0, 0.0, 90.0], DVec3::Y), DVec3::Z);
        // About fixed axes: +x goes to +y by the yaw, stays by the pitch, and goes to +z by the roll.
        assert_eq!(turned([90.0, 90.0, 90.0], DVec3::X), DVec3::Z);
        // The other order would leave it at +y.
        assert_eq!(turned([90.0, 0.0, 90.0], DVec3::X), DVec3::Z);
        assert_eq!(turned([-90.0, 0.0, 0.0], DVec3::X), -DVec3::Y);
        assert_eq!(turned([180.0, 0.0, 0.0], DVec3::X), -DVec3::X);
    }

    #[test]
    fn rotations_are_undone() {
        let orientation = Orientation::new([33.0, -71.0, 1234.5]);
        let direction = DVec3::new(0.48, -0.6, 0.64);
        let there_and_back = orientation.to_sky(orientation.from_sky(direction));
        assert!((there_and_back - direction).length() < 1e-15);
        assert!((orientation.from_sky(direction).length() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn places() {
        assert_eq!(place(DVec3::X), (0.5, 0.5));
        // Longitude grows to the left.
        assert_eq!(place(DVec3::Y), (0.25, 0.5));
        assert_eq!(place(-DVec3::Y), (0.75, 0.5));
        assert_eq!(place(DVec3::new(-1.0, 0.0, 0.0)), (0.0, 0.5));
        assert_eq!(place(DVec3::Z).1, 1.0);
        assert_eq!(place(-DVec3::Z).1, 0.0);
        for (u, v) in [(0.1, 0.2), (0.9, 0.999_999), (0.5, 1e-9)] {
            let found = place(3.0 * direction(u, v));
            assert!((found.0 - u).abs() < 1e-6_f64.min(1e-15 / v.min(1.0 - v)));
            assert!((found.1 - v).abs() < 1e-15);
        }
    }
}
