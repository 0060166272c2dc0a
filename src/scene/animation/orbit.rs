//! A camera's path as radius, inclination and azimuth, each from one value to another.

use glam::DVec3;

use super::track::Track;
use crate::scene::angles::outward_and_up;
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
    /// The path that `table` describes, from the frame `first` to the frame `last`.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a number that is not finite.
    pub(super) fn new(
        table: &OrbitTable,
        first: i64,
        last: i64,
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
            (last + 1, Interpolation::Linear)
        } else {
            (last, interpolation)
        };
        let from = (first as f64, spans.map(|(_, span)| span.from));
        let to = (end as f64, spans.map(|(_, span)| span.to));
        let keys = if end > first {
            &[from, to][..]
        } else {
            &[from]
        };
        Ok(Self {
            of_time: Track::new(keys, interpolation),
        })
    }

    /// The camera's place at a time.
    pub(super) fn at(&self, time: f64) -> CameraPlace {
        let [radius, inclination, azimuth] = self.of_time.at(time);
        let (outward, up) = outward_and_up(inclination, azimuth);
        CameraPlace {
            position: outward * radius,
            radius,
            up,
        }
    }
}
