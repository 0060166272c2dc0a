//! Where the camera stands over time.

use glam::DVec3;

use super::direction::Directions;
use super::orbit::Orbit;
use super::track::{Track, segment};
use super::{Interpolation, radius_at};
use crate::scene::vector::{direction, norm};
use crate::scene::{SceneError, validate};

/// Radii that differ by no more than this share are one: rounding alone makes cameras of one radius differ by as much, and what
/// is drawn for one radius serves all frames of it.
const SAME_RADIUS: f64 = 4.0 * f64::EPSILON;

/// Where the camera stands.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Position {
    /// On a short form's orbit.
    Orbit(Orbit),
    /// Through keyframes, or in one place.
    Keyframes {
        times: Vec<f64>,
        /// As they were given.
        given: Vec<DVec3>,
        radius: Track<1>,
        direction: Directions,
    },
}

/// Where the camera stands at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) position: DVec3,
    /// |position|, without the rounding of the position's components: a camera that stays at a radius has the same one to the
    /// last bit in each frame.
    pub(super) radius: f64,
    /// `−∂position/∂inclination`, for an orbit.
    pub(super) up: DVec3,
}

impl Position {
    /// One that stays.
    ///
    /// # Errors
    /// [`SceneError`] for a place where no camera can stand.
    pub(super) fn still(position: [f64; 3]) -> Result<Self, SceneError> {
        let position = validate::finite_vector("camera.position", position)?;
        let radius = norm(position);
        validate::radius(radius)?;
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
    /// [`SceneError`] for a place where no camera can stand, and for two on opposite sides of the hole.
    pub(super) fn new(
        keys: &[(f64, [f64; 3])],
        interpolation: Interpolation,
    ) -> Result<Self, SceneError> {
        let given: Vec<DVec3> = keys.iter().map(|key| DVec3::from_array(key.1)).collect();
        let mut radii: Vec<(f64, [f64; 1])> = Vec::with_capacity(keys.len());
        let mut directions = Vec::with_capacity(keys.len());
        for (&(time, _), &position) in keys.iter().zip(&given) {
            let radius = radius_at(time, position)?;
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
            direction: Directions::new("position", &directions, interpolation)?,
        })
    }

    /// The place at a time.
    pub(super) fn at(&self, time: f64) -> Place {
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
                Place {
                    position,
                    radius,
                    up: DVec3::Z,
                }
            }
        }
    }
}
