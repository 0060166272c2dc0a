//! What a scene is made of: a camera, a disk and a picture's size.

use glam::DVec3;
use serde::Deserialize;

use super::angles::{outward_and_up, rolled_up};
use super::layers::LayerSet;
use super::projection::Projection;

/// The largest error of an edge where none is given, in pixels: no 8-bit picture shows a thousandth of a pixel.
pub const DEFAULT_TOLERANCE: f64 = 1e-3;

/// A static observer's camera.
///
/// ```
/// use darkness::scene::Camera;
///
/// // Looks at the hole, 30° up and down, with +y up in the picture.
/// let camera = Camera {
///     up: [0.0, 1.0, 0.0].into(),
///     ..Camera::at([30.0, 0.0, 5.0], 30.0)
/// };
/// assert_eq!(camera.focus.length(), 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where the camera stands, in Schwarzschild radii; the hole is at the origin.
    pub position: DVec3,
    /// The point at the picture's centre.
    pub focus: DVec3,
    /// The direction that is up in the picture, of any length.
    pub up: DVec3,
    /// The vertical field of view, in degrees: of a fisheye its whole angle, of an equirectangular picture 180.
    pub fov_degrees: f64,
    /// How directions become places in the picture.
    pub projection: Projection,
}

impl Camera {
    /// A camera at `position` that looks at the hole, with +z up.
    pub fn at(position: impl Into<DVec3>, fov_degrees: f64) -> Self {
        Self {
            position: position.into(),
            focus: DVec3::ZERO,
            up: DVec3::Z,
            fov_degrees,
            projection: Projection::Perspective,
        }
    }

    /// A camera that looks at the hole from a radius, an inclination from +z and an azimuth from +x, in degrees. Up is
    /// where the inclination falls: +z, and at the poles the azimuth's opposite or the azimuth.
    ///
    /// ```
    /// use darkness::scene::Camera;
    ///
    /// // Face on.
    /// let camera = Camera::at_angles(30.0, 0.0, 0.0, 40.0);
    /// assert_eq!(camera.position.to_array(), [0.0, 0.0, 30.0]);
    /// ```
    pub fn at_angles(radius: f64, inclination: f64, azimuth: f64, fov_degrees: f64) -> Self {
        let (outward, up) = outward_and_up(inclination, azimuth);
        Self {
            up,
            ..Self::at(outward * radius, fov_degrees)
        }
    }

    /// The same camera, turned about its viewing direction.
    ///
    /// As in most 3D programs, the turn is right-handed about the camera's backward axis: a positive angle turns the
    /// camera counterclockwise as seen from behind it, and so the picture's content clockwise.
    #[must_use]
    pub fn rolled(self, degrees: f64) -> Self {
        Self {
            up: rolled_up(self.focus - self.position, self.up, degrees),
            ..self
        }
    }

    /// The vertical field of view of a picture of this size whose horizontal one is given, both in degrees:
    /// `tan(vertical/2) = tan(horizontal/2) height/width`.
    pub fn vertical_fov(horizontal_degrees: f64, size: ImageSize) -> f64 {
        let half_width = libm::tan(horizontal_degrees.to_radians() / 2.0);
        let aspect = f64::from(size.height) / f64::from(size.width);
        2.0 * libm::atan(half_width * aspect).to_degrees()
    }
}

/// A thin disk around the hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// The inner edge's radius, in Schwarzschild radii.
    pub inner: f64,
    /// The outer edge's radius, in Schwarzschild radii.
    pub outer: f64,
    /// The direction of the disk's axis, of any length.
    pub normal: DVec3,
}

impl Disk {
    /// A disk in the plane z = 0.
    pub fn new(inner: f64, outer: f64) -> Self {
        Self {
            inner,
            outer,
            normal: DVec3::Z,
        }
    }
}

/// A picture's size, in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageSize {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// A part of a picture, in whole pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// The columns to its left.
    pub left: u32,
    /// The rows above it.
    pub top: u32,
    /// Its pixels in a row.
    pub width: u32,
    /// Its rows.
    pub height: u32,
}

impl Region {
    /// The whole of a picture.
    pub fn whole(ImageSize { width, height }: ImageSize) -> Self {
        Self {
            left: 0,
            top: 0,
            width,
            height,
        }
    }

    /// Its size.
    pub fn size(self) -> ImageSize {
        ImageSize {
            width: self.width,
            height: self.height,
        }
    }
}

/// The light of the disk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Each ring shines as a black body.
    BlackBody {
        /// The temperature of the hottest ring, in kelvin.
        temperature: f64,
    },
    /// Grey: the energy flux of all wavelengths together.
    Bolometric,
}

/// How bright light becomes values of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tone {
    /// Highlights roll off towards white.
    #[default]
    Neutral,
    /// Highlights are clipped.
    None,
}

/// A picture's size, how its edges are drawn, and how light becomes its values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ImageSettings {
    pub(super) size: ImageSize,
    /// The part that is drawn; all of it if there is none.
    pub(super) crop: Option<Region>,
    /// Whether edges are smooth.
    pub(super) antialias: bool,
    /// The largest error of an edge, in pixels.
    pub(super) tolerance: f64,
    /// In stops: light is multiplied by 2 to this power.
    pub(super) exposure: f64,
    pub(super) tone: Tone,
    /// Of a PNG picture's sample, 8 or 16.
    pub(super) bits: u8,
    /// What `.exr` and `.npz` files hold, if it is given.
    pub(super) layers: LayerSet,
}

impl ImageSettings {
    /// The settings of a picture of which nothing else is said.
    pub(super) fn new(size: ImageSize, antialias: bool, tolerance: f64) -> Self {
        Self {
            size,
            crop: None,
            antialias,
            tolerance,
            exposure: 0.0,
            tone: Tone::Neutral,
            bits: 8,
            layers: LayerSet::default(),
        }
    }

    /// The part of the picture that is drawn.
    pub(super) fn region(&self) -> Region {
        self.crop.unwrap_or(Region::whole(self.size))
    }
}
