//! One star, and all stars of a sky.

use glam::DVec3;

/// A star: a black body so far away that it is a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Star {
    /// The unit vector towards it. Right ascension 0 is +x and grows counterclockwise about +z, which is declination
    /// 90°.
    pub direction: DVec3,
    /// Its irradiance without the hole, in units of a star of magnitude 0: `10^(−0.4 m)`.
    pub irradiance: f32,
    /// Its temperature in kelvin.
    pub temperature: f32,
}

impl Star {
    /// The star at this right ascension and declination in degrees. Right ascensions wrap at 360°.
    pub fn new(right_ascension: f64, declination: f64, magnitude: f64, temperature: f64) -> Self {
        let (sin_longitude, cos_longitude) = libm::sincos((right_ascension % 360.0).to_radians());
        let (sin_latitude, cos_latitude) = libm::sincos(declination.to_radians());
        let direction = DVec3::new(
            cos_latitude * cos_longitude,
            cos_latitude * sin_longitude,
            sin_latitude,
        );
        Self::at(direction, magnitude, temperature)
    }

    /// The star in a direction, which is a unit vector.
    pub fn at(direction: DVec3, magnitude: f64, temperature: f64) -> Self {
        Self {
            direction,
            irradiance: libm::exp(-0.4 * std::f64::consts::LN_10 * magnitude) as f32,
            temperature: temperature as f32,
        }
    }
}

/// The stars of a sky, from a catalogue ([`Self::read`]) or made up ([`Self::synthetic`]).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StarField {
    /// The stars, in the order of the catalogue.
    pub stars: Vec<Star>,
}
