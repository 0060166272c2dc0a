//! Directions over time: points that move on the unit sphere.
//!
//! A linear motion follows the great circle between two directions at one speed. A smooth motion is a cubic Bézier
//! curve on the sphere: de Casteljau's construction with great circles in place of lines (Shoemake 1985, SIGGRAPH 19,
//! 245). Its velocity at either end is three times the arc to the neighbouring control point. At a direction between
//! two others the velocity is that of a parabola through the three, limited to 1.5 times the slower of the two arcs. At
//! the first and the last direction it is 0.

use core::f64::consts::PI;

use glam::DVec3;

use super::track::{Segment, segment};
use crate::scene::error::SceneError;
use crate::scene::file::Interpolation;
use crate::scene::vector::direction;

/// Two directions are opposite where the length of their cross product is at most this: rounding would choose the path
/// between them.
const OPPOSITE: f64 = 16.0 * f64::EPSILON;

/// A direction over time.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::scene) struct Directions {
    times: Vec<f64>,
    /// The given vectors, of any length.
    given: Vec<DVec3>,
    /// The unit vectors.
    units: Vec<DVec3>,
    /// The velocities at the times, in radians a frame; empty for linear motion.
    velocities: Vec<DVec3>,
}

impl Directions {
    /// A direction that stays.
    pub(super) fn still(direction: DVec3) -> Self {
        Self::of(&[(1.0, direction)])
    }

    /// A motion through at least one direction, none of them zero, at rising times. `key` is their name in errors.
    ///
    /// # Errors
    /// [`SceneError::Value`] for opposite directions.
    pub(super) fn new(
        key: &'static str,
        keys: &[(f64, DVec3)],
        interpolation: Interpolation,
    ) -> Result<Self, SceneError> {
        let mut directions = Self::of(keys);
        let Self { times, units, .. } = &directions;
        for (k, (pair, times)) in units.windows(2).zip(times.windows(2)).enumerate() {
            if pair[0].dot(pair[1]) < 0.0 && pair[0].cross(pair[1]).length() <= OPPOSITE {
                let reason = format!(
                    "the directions at frames {} and {} are opposite, so that no path between them is the shortest; \
                     add a keyframe between them",
                    times[0], times[1]
                );
                return Err(SceneError::value(
                    key,
                    directions.given[k + 1].to_array(),
                    reason,
                ));
            }
        }
        if interpolation == Interpolation::Smooth {
            directions.velocities = (0..keys.len()).map(|k| velocity(times, units, k)).collect();
        }
        Ok(directions)
    }

    fn of(keys: &[(f64, DVec3)]) -> Self {
        Self {
            times: keys.iter().map(|key| key.0).collect(),
            given: keys.iter().map(|key| key.1).collect(),
            units: keys.iter().map(|key| direction(key.1)).collect(),
            velocities: Vec::new(),
        }
    }

    /// The direction at a time; at a keyframe, the vector that was given.
    pub(in crate::scene) fn at(&self, time: f64) -> DVec3 {
        let Segment { first, span, share } = match segment(&self.times, time) {
            Ok(segment) => segment,
            Err(key) => return self.given[key],
        };
        let (from, to) = (self.units[first], self.units[first + 1]);
        let Some(&[leaving, arriving]) = self.velocities.get(first..first + 2) else {
            return between(from, to, share);
        };
        let (after, before) = (
            moved(from, leaving * (span / 3.0)),
            moved(to, arriving * (-span / 3.0)),
        );
        let middle = between(after, before, share);
        let (left, right) = (
            between(between(from, after, share), middle, share),
            between(middle, between(before, to, share), share),
        );
        between(left, right, share)
    }
}

/// The velocity at direction k.
fn velocity(times: &[f64], units: &[DVec3], k: usize) -> DVec3 {
    if k == 0 || k + 1 == times.len() {
        return DVec3::ZERO;
    }
    let (before, after) = (times[k] - times[k - 1], times[k + 1] - times[k]);
    let to = -arc(units[k], units[k - 1]) / before;
    let from = arc(units[k], units[k + 1]) / after;
    let mean = (to * after + from * before) / (before + after);
    let (speed, most) = (mean.length(), 1.5 * to.length().min(from.length()));
    if speed > most {
        mean * (most / speed)
    } else {
        mean
    }
}

/// The arc from one unit vector to another: a tangent at the first, as long as their angle. It is zero where they are
/// equal or opposite.
fn arc(from: DVec3, to: DVec3) -> DVec3 {
    let normal = from.cross(to);
    let angle = libm::atan2(normal.length(), from.dot(to));
    direction(normal.cross(from)) * angle
}

/// The unit vector at the end of an arc.
fn moved(from: DVec3, arc: DVec3) -> DVec3 {
    let angle = arc.length();
    debug_assert!(angle <= PI);
    if angle == 0.0 {
        return from; // Not a bit moves.
    }
    direction(from * libm::cos(angle) + direction(arc) * libm::sin(angle))
}

/// The unit vector at a share of the arc between two.
fn between(from: DVec3, to: DVec3, share: f64) -> DVec3 {
    moved(from, arc(from, to) * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(a: DVec3, b: DVec3) -> f64 {
        arc(direction(a), direction(b)).length()
    }

    #[test]
    fn at_one_speed_along_the_great_circle() {
        let keys = [(1.0, DVec3::X), (5.0, DVec3::new(0.0, 3.0, 0.0))];
        let moving = Directions::new("up", &keys, Interpolation::Linear).unwrap();
        let quarter = moving.at(2.0);
        assert!((angle(quarter, DVec3::X) - PI / 8.0).abs() < 1e-15);
        // It leaves the plane of the two by not a bit.
        assert_eq!(quarter.z, 0.0);
        assert_eq!(moving.at(5.0), DVec3::new(0.0, 3.0, 0.0));
        assert_eq!(moving.at(50.0), DVec3::new(0.0, 3.0, 0.0));
    }

    #[test]
    fn smooth_motion_has_no_jumps_in_its_velocity() {
        let keys = [
            (1.0, DVec3::X),
            (4.0, DVec3::new(0.2, 1.0, 0.5)),
            (5.0, DVec3::new(-0.1, 1.0, 0.9)),
            (11.0, DVec3::new(-1.0, -0.1, 0.1)),
            (12.0, DVec3::new(-1.0, -0.1, 0.1)),
        ];
        let moving = Directions::new("up", &keys, Interpolation::Smooth).unwrap();
        for &(time, value) in &keys {
            assert_eq!(moving.at(time), value);
            let beside = |by| angle(moving.at(time + by), value);
            assert!(beside(1e-6).max(beside(-1e-6)) < 1e-5);
        }
        let step = 1e-3;
        let places: Vec<_> = (0..12_500)
            .map(|i| direction(moving.at(step * f64::from(i))))
            .collect();
        let velocities: Vec<_> = places
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) / step)
            .collect();
        for pair in velocities.windows(2) {
            assert!((pair[1] - pair[0]).length() < 5e-3, "{pair:?}");
        }
        assert_eq!(moving.at(11.5), direction(keys[4].1));
    }

    #[test]
    fn opposite_directions_have_no_way_between_them() {
        let keys = [(3.0, DVec3::X), (9.0, DVec3::new(-2.0, 0.0, 1e-16))];
        let message = Directions::new("position", &keys, Interpolation::Smooth)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("frames 3 and 9") && message.contains("position"),
            "{message}"
        );
        let keys = [(3.0, DVec3::X), (9.0, DVec3::new(-2.0, 0.0, 1e-3))];
        assert!(Directions::new("position", &keys, Interpolation::Smooth).is_ok());
    }
}
