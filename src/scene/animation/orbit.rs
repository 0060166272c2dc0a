//! A camera's path as radius, inclination and azimuth, each from one value to another.

use glam::DVec3;

use super::track::Track;
use crate::scene::error::SceneError;
use crate::scene::file::{Interpolation, OrbitTable};
use crate::scene::validate;

/// Where the camera is at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CameraPlace {
    pub(super) position: DVec3,
    /// |position| without the rounding of the position's components: a camera that stays at one radius has the same
    /// value, to the last bit, in each frame.
    pub(super) radius: f64,
    /// `−∂position/∂inclination`, for an orbit.
    pub(super) up: DVec3,
}

/// Radius in Schwarzschild radii, inclination from +z and azimuth from +x in degrees, over time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OrbitPath {
    of_time: Track<3>,
}

impl OrbitPath {
    /// The path that `table` describes, over `frames` frames.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a number that is not finite.
    pub(super) fn new(
        table: &OrbitTable,
        frames: u32,
        interpolation: Interpolation,
    ) -> Result<Self, SceneError> {
        let spans = [
            ("animation.orbit.radius", table.radius),
            ("animation.orbit.inclination", table.inclination),
            ("animation.orbit.azimuth", table.azimuth),
        ];
        for (key, span) in spans {
            validate::finite(key, span.from)?;
            validate::finite(key, span.to)?;
        }
        let [radius, angles @ ..] = spans.map(|(_, span)| span);
        let turns = |from: f64, to: f64| (to - from) % 360.0 == 0.0;
        let is_closed = radius.from == radius.to
            && angles.iter().all(|angle| turns(angle.from, angle.to))
            && angles.iter().any(|angle| angle.from != angle.to);
        // A closed orbit returns to its start one frame after the last, and does not come to rest there.
        let (end, interpolation) = if is_closed {
            (frames + 1, Interpolation::Linear)
        } else {
            (frames, interpolation)
        };
        let first = (1.0, spans.map(|(_, span)| span.from));
        let last = (f64::from(end), spans.map(|(_, span)| span.to));
        let keys = if end > 1 {
            &[first, last][..]
        } else {
            &[first]
        };
        Ok(Self {
            of_time: Track::new(keys, interpolation),
        })
    }

    /// The camera's place at a time.
    pub(super) fn at(&self, time: f64) -> CameraPlace {
        let [radius, inclination, azimuth] = self.of_time.at(time);
        let (sin_i, cos_i) = sine_and_cosine(inclination);
        let (sin_a, cos_a) = sine_and_cosine(azimuth);
        CameraPlace {
            position: DVec3::new(sin_i * cos_a, sin_i * sin_a, cos_i) * radius,
            radius,
            up: DVec3::new(-cos_i * cos_a, -cos_i * sin_a, sin_i),
        }
    }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90: a camera at 90° is exactly in the disk's plane.
fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    // Both are exact: a remainder is, and so is a difference of two numbers within a factor of two.
    let turned = degrees % 360.0;
    let quarters = libm::rint(turned / 90.0);
    let rest = (turned - 90.0 * quarters).to_radians();
    let (sine, cosine) = (libm::sin(rest), libm::cos(rest));
    match (quarters as i32).rem_euclid(4) {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_are_exact_and_others_right() {
        for (degrees, sine, cosine) in [
            (0.0, 0.0, 1.0),
            (90.0, 1.0, 0.0),
            (180.0, 0.0, -1.0),
            (-90.0, -1.0, 0.0),
            (3690.0, 1.0, 0.0),
        ] {
            assert_eq!(sine_and_cosine(degrees), (sine, cosine), "{degrees}");
        }
        for tenths in -9000..9000 {
            let degrees = 0.1 * f64::from(tenths);
            let (sine, cosine) = sine_and_cosine(degrees);
            assert!((sine - libm::sin(degrees.to_radians())).abs() < 1e-14);
            assert!((cosine - libm::cos(degrees.to_radians())).abs() < 1e-14);
        }
    }
}
