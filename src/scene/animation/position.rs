//! The camera's place over time.

use glam::DVec3;

use super::direction::Directions;
use super::orbit::{CameraPlace, OrbitPath};
use super::track::{Track, segment};
use crate::scene::error::SceneError;
use crate::scene::file::Interpolation;
use crate::scene::validate;
use crate::scene::vector::{direction, norm};

/// Radii that differ by at most this share are taken as equal. Rounding alone makes the radii of rotated positions
/// differ by as much, and frames of one radius share their curves.
const SAME_RADIUS: f64 = 4.0 * f64::EPSILON;

/// The camera's place over time.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Position {
    /// On an orbit.
    Orbit(OrbitPath),
    /// Through keyframes, or at one place.
    Keyframes {
        times: Vec<f64>,
        /// As they were given.
        given: Vec<DVec3>,
        radius: Track<1>,
        direction: Directions,
    },
}

impl Position {
    /// A camera that stays.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a place where no camera can be.
    pub(super) fn still(position: [f64; 3]) -> Result<Self, SceneError> {
        const KEY: &str = "camera.position";
        let position = validate::finite_vector(KEY, position)?;
        let radius = norm(position);
        validate::radius(KEY, position.to_array(), radius)?;
        Ok(Self::Keyframes {
            times: vec![1.0],
            given: vec![position],
            radius: Track::new(&[(1.0, [radius])], Interpolation::Linear),
            direction: Directions::still(position),
        })
    }

    /// Through at least one keyframe, their times rising.
    ///
    /// # Errors
    /// [`SceneError`] for a place where no camera can be, and for two on opposite sides of the hole.
    pub(super) fn new(
        keys: &[(f64, [f64; 3])],
        interpolation: Interpolation,
    ) -> Result<Self, SceneError> {
        const KEY: &str = "animation.keyframe.position";
        let given: Vec<DVec3> = keys.iter().map(|key| DVec3::from_array(key.1)).collect();
        let mut radii: Vec<(f64, [f64; 1])> = Vec::with_capacity(keys.len());
        let mut directions = Vec::with_capacity(keys.len());
        for (&(time, _), &position) in keys.iter().zip(&given) {
            let radius = norm(position);
            validate::radius(KEY, position.to_array(), radius)
                .map_err(|error| error.in_frame(time as i64))?;
            let radius = match radii.last() {
                Some(&(_, [before])) if (radius - before).abs() <= SAME_RADIUS * before => before,
                _ => radius,
            };
            radii.push((time, [radius]));
            directions.push((time, position));
        }
        Ok(Self::Keyframes {
            times: keys.iter().map(|key| key.0).collect(),
            given,
            radius: Track::new(&radii, interpolation),
            direction: Directions::new(KEY, &directions, interpolation)?,
        })
    }

    /// The place at a time.
    pub(super) fn at(&self, time: f64) -> CameraPlace {
        match self {
            Self::Orbit(orbit) => orbit.at(time),
            Self::Keyframes {
                times,
                given,
                radius,
                direction: directions,
            } => {
                let radius = radius.at(time)[0];
                let position = match segment(times, time) {
                    Ok(_) => direction(directions.at(time)) * radius,
                    Err(key) => given[key],
                };
                CameraPlace {
                    position,
                    radius,
                    up: DVec3::Z,
                }
            }
        }
    }
}
