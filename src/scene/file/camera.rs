//! `[camera]`: where it stands, by a position or by angles, its projection, and its field of view, vertical or
//! horizontal.

use serde::Deserialize;

use super::{maybe_three_numbers, three_numbers};
use crate::scene::error::SceneError;
use crate::scene::projection::{Projection, SPHERE};
use crate::scene::validate;
use crate::scene::values::{Camera, ImageSize};

/// `[camera]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "CameraKeys")]
pub(in crate::scene) struct CameraTable {
    /// Left out where the animation sets it.
    pub(in crate::scene) place: Option<Place>,
    pub(in crate::scene) focus: [f64; 3],
    /// Its default depends on the place.
    pub(in crate::scene) up: Option<[f64; 3]>,
    /// In degrees.
    pub(in crate::scene) roll: f64,
    pub(in crate::scene) projection: Projection,
    pub(in crate::scene) fov: Fov,
}

/// The vertical field of view where none is given, in degrees.
const DEFAULT_FOV: f64 = 30.0;

/// The whole angle of a fisheye where none is given, in degrees: that of a dome.
const DEFAULT_FISHEYE: f64 = 180.0;

impl Default for CameraTable {
    fn default() -> Self {
        Self {
            place: None,
            focus: [0.0; 3],
            up: None,
            roll: 0.0,
            projection: Projection::Perspective,
            fov: Fov::Vertical(DEFAULT_FOV),
        }
    }
}

/// Where a camera stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::scene) enum Place {
    Position([f64; 3]),
    /// Angles in degrees.
    Angles {
        radius: f64,
        inclination: f64,
        azimuth: f64,
    },
}

/// A field of view, in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::scene) enum Fov {
    Vertical(f64),
    Horizontal(f64),
}

/// The keys of `[camera]`, as they are written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKeys {
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    position: Option<[f64; 3]>,
    radius: Option<f64>,
    inclination: Option<f64>,
    azimuth: Option<f64>,
    #[serde(default, deserialize_with = "three_numbers")]
    focus: [f64; 3],
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    up: Option<[f64; 3]>,
    #[serde(default)]
    roll: f64,
    #[serde(default)]
    projection: Projection,
    fov: Option<f64>,
    fov_horizontal: Option<f64>,
}

impl TryFrom<CameraKeys> for CameraTable {
    type Error = &'static str;

    fn try_from(keys: CameraKeys) -> Result<Self, Self::Error> {
        let angles = (keys.radius, keys.inclination, keys.azimuth);
        let place = match (keys.position, angles) {
            (position, (None, None, None)) => position.map(Place::Position),
            (Some(_), _) => {
                return Err(
                    "camera.position and one of camera.radius, camera.inclination and camera.azimuth are both given; \
                     remove the position or the others",
                );
            }
            (None, (Some(radius), Some(inclination), azimuth)) => Some(Place::Angles {
                radius,
                inclination,
                azimuth: azimuth.unwrap_or(0.0),
            }),
            (None, (None, _, _)) => {
                return Err(
                    "camera.radius is missing beside the camera's angles; give it in Schwarzschild radii, such as 30",
                );
            }
            (None, (_, None, _)) => {
                return Err(
                    "camera.inclination is missing beside camera.radius; give it in degrees from +z, such as 80",
                );
            }
        };
        let fov = match (keys.projection, keys.fov, keys.fov_horizontal) {
            (_, Some(_), Some(_)) => {
                return Err(
                    "camera.fov and camera.fov_horizontal are both given; remove one of them",
                );
            }
            (Projection::Perspective, Some(fov), None) => Fov::Vertical(fov),
            (Projection::Perspective, None, Some(fov)) => Fov::Horizontal(fov),
            (Projection::Perspective, None, None) => Fov::Vertical(DEFAULT_FOV),
            (Projection::Fisheye, fov, None) => Fov::Vertical(fov.unwrap_or(DEFAULT_FISHEYE)),
            (Projection::Fisheye, None, Some(_)) => {
                return Err(
                    "camera.fov_horizontal has no meaning for a fisheye; camera.fov is its whole angle, up to 360",
                );
            }
            (Projection::Equirectangular, None, None) => Fov::Vertical(SPHERE),
            (Projection::Equirectangular, ..) => {
                return Err(
                    "an equirectangular picture shows the whole sphere; leave out camera.fov and camera.fov_horizontal",
                );
            }
        };
        Ok(Self {
            place,
            focus: keys.focus,
            up: keys.up,
            roll: keys.roll,
            projection: keys.projection,
            fov,
        })
    }
}

impl CameraTable {
    /// Writes angles as a position, with the direction that is up there, and a horizontal field of view as the vertical
    /// one of a picture of this size. Returns whether there were angles.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a number that is not allowed.
    pub(in crate::scene) fn normalise(&mut self, size: ImageSize) -> Result<bool, SceneError> {
        validate::finite("camera.roll", self.roll)?;
        let has_angles = matches!(self.place, Some(Place::Angles { .. }));
        if let Some(Place::Angles {
            radius,
            inclination,
            azimuth,
        }) = self.place
        {
            validate::radius("camera.radius", radius, radius)?;
            validate::finite("camera.inclination", inclination)?;
            validate::finite("camera.azimuth", azimuth)?;
            let camera = Camera::at_angles(radius, inclination, azimuth, 0.0);
            self.place = Some(Place::Position(camera.position.to_array()));
            self.up.get_or_insert(camera.up.to_array());
        }
        if let Fov::Horizontal(degrees) = self.fov {
            validate::fov("camera.fov_horizontal", degrees, self.projection)?;
            self.fov = Fov::Vertical(Camera::vertical_fov(degrees, size));
        }
        Ok(has_angles)
    }

    /// The position, where it is given as one.
    pub(in crate::scene) fn position(&self) -> Option<[f64; 3]> {
        match self.place {
            Some(Place::Position(position)) => Some(position),
            _ => None,
        }
    }
}

impl Fov {
    /// The angle itself, vertical or horizontal.
    pub(in crate::scene) fn degrees(self) -> f64 {
        match self {
            Self::Vertical(degrees) | Self::Horizontal(degrees) => degrees,
        }
    }
}
