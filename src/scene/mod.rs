//! Scenes: where the camera stands, where the disk lies, how large the picture is.
//!
//! A [`Scene`] is read from TOML, whole and checked: every number is finite, the camera stands outside the horizon
//! and outside the disk's matter and looks somewhere, the disk's orbits are stable. [`View`] turns it into what a
//! frame computes with, one ray a pixel.
//!
//! ```toml
//! [camera]
//! position = [29.5442, 0.0, 5.2094]  # required; the hole is at the origin; 1 < r ≤ 1e15
//! focus    = [0.0, 0.0, 0.0]         # default: the hole
//! up       = [0.0, 0.0, 1.0]         # default: +z
//! fov      = 30.0                    # required; vertical field of view, degrees, 0 < fov < 180
//!
//! [disk]
//! inner  = 3.0                       # required; ≥ 3, the innermost stable circular orbit
//! outer  = 12.0                      # required; > inner
//! normal = [0.0, 0.0, 1.0]           # default: +z
//!
//! [image]
//! width  = 1920                      # required
//! height = 1080                      # required
//! antialias = true                   # default; false: each pixel is what its centre sees, 255 or 0
//! tolerance = 0.001                  # default; what an edge may be off by, in pixels; 0 < tolerance ≤ 1
//! ```
//!
//! Lengths are in Schwarzschild radii, directions have any length but zero. A scene that moves has a part more, which
//! [`animation`] shows; where one picture is asked for, it is the first frame.

pub mod animation;
mod builtin;
mod camera;
mod error;
mod file;
mod validate;
mod vector;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use glam::DVec3;

pub use animation::Animation;
pub use builtin::{Builtin, builtins};
pub use camera::{Affine, PixelRay, View};
pub use error::SceneError;
pub use validate::{
    FARTHEST_CAMERA, HORIZON_RADIUS, ISCO_RADIUS, MAX_IMAGE_SIDE, MAX_TOLERANCE, NARROWEST_FOV,
    WIDEST_DISK,
};

/// The name of the scene rendered where none is asked for.
pub const DEFAULT_SCENE: &str = "classic";

/// What an edge may be off by where nothing else is asked for, in pixels: no 8-bit picture shows a thousandth of one.
pub const DEFAULT_TOLERANCE: f64 = 1e-3;

/// A static observer's camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where it stands, in Schwarzschild radii from the hole.
    pub position: DVec3,
    /// The point at the picture's centre.
    pub focus: DVec3,
    /// The direction that is up in the picture, of any length.
    pub up: DVec3,
    /// The vertical field of view, in degrees.
    pub fov_degrees: f64,
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

/// A picture's size, in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageSize {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// A checked scene: whatever holds one need check nothing again.
///
/// ```
/// use darkness::scene::Scene;
///
/// let scene = Scene::from_toml(
///     "[camera]\nposition = [20, 0, 5]\nfov = 40\n\
///      [disk]\ninner = 3\nouter = 12\n\
///      [image]\nwidth = 640\nheight = 360\n",
/// )?;
/// assert_eq!(scene.disk().outer, 12.0);
/// # Ok::<(), darkness::scene::SceneError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    camera: Camera,
    radius: f64,
    disk: Disk,
    image: ImageSize,
    antialias: bool,
    tolerance: f64,
}

impl Scene {
    /// Reads a scene from its TOML form, which the [module's page](self) shows.
    ///
    /// # Errors
    /// [`SceneError::Toml`] with line and column where the text is no TOML, a key is missing, unknown or of the wrong
    /// type; else the variant that names the value and what is allowed.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        Animation::from_toml(text)?.frame(1)
    }

    /// The built-in scene of that name, if there is one; [`builtins`] lists them.
    pub fn builtin(name: &str) -> Option<Self> {
        let builtin = builtins().iter().find(|builtin| builtin.name() == name)?;
        Self::from_toml(builtin.toml()).ok()
    }

    /// The built-in scene of that name, or else the scene in the TOML file at that path.
    ///
    /// A file that is called like a built-in scene is reached as `./classic`.
    ///
    /// # Errors
    /// [`SceneError::Unknown`] where there is neither, [`SceneError::Read`] for a file that cannot be read,
    /// [`SceneError::InFile`] for one that holds no valid scene.
    pub fn load(path_or_name: impl AsRef<Path>) -> Result<Self, SceneError> {
        load_text(path_or_name.as_ref(), Self::from_toml)
    }

    /// The same scene as a picture of another size; the vertical field of view stays.
    ///
    /// # Errors
    /// [`SceneError::ImageSide`] for a size that is not allowed.
    pub fn with_size(&self, width: u32, height: u32) -> Result<Self, SceneError> {
        let image = validate::image_size(i64::from(width), i64::from(height))?;
        Ok(Self { image, ..*self })
    }

    /// The same scene with its edges right to so many pixels.
    ///
    /// # Errors
    /// [`SceneError::Tolerance`] for a tolerance that is not allowed.
    pub fn with_tolerance(&self, pixels: f64) -> Result<Self, SceneError> {
        let tolerance = validate::tolerance(pixels)?;
        Ok(Self { tolerance, ..*self })
    }

    /// The same scene with smooth edges or with hard ones.
    #[must_use]
    pub fn with_antialias(&self, antialias: bool) -> Self {
        Self { antialias, ..*self }
    }

    /// The scene's TOML form with every key written out; [`Scene::from_toml`] reads the same scene back.
    pub fn to_toml(&self) -> String {
        file::SceneFile::from(self).to_string()
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The camera's radius, `|position|`, in Schwarzschild radii. Along an animation at one radius it is the same to the last
    /// bit, where the position's components are rounded.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The disk.
    pub fn disk(&self) -> &Disk {
        &self.disk
    }

    /// The picture's size.
    pub fn image(&self) -> ImageSize {
        self.image
    }

    /// Whether a pixel is the share of its square that the disk covers, and not what its centre sees.
    pub fn antialias(&self) -> bool {
        self.antialias
    }

    /// What an edge may be off by, in pixels.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }
}

/// What `read_as` makes of the built-in scene of that name, or else of the file at that path.
fn load_text<T>(
    path: &Path,
    read_as: impl Fn(&str) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    let builtin = builtins()
        .iter()
        .find(|builtin| path.to_str() == Some(builtin.name()));
    if let Some(builtin) = builtin {
        return read_as(builtin.toml());
    }
    let text = read(path).map_err(|error| {
        let path = path.to_owned();
        if error.kind() == io::ErrorKind::NotFound {
            SceneError::Unknown { path }
        } else {
            SceneError::Read { path, error }
        }
    })?;
    read_as(&text).map_err(|error| SceneError::InFile {
        path: path.to_owned(),
        error: Box::new(error),
    })
}

/// A scene's file has some lines; what is longer than this is something else, and may have no end.
const LONGEST_FILE: u64 = 1 << 20;

fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    let length = File::open(path)?
        .take(LONGEST_FILE + 1)
        .read_to_string(&mut text)?;
    if length as u64 > LONGEST_FILE {
        return Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "it is over 1 MiB long, which no scene is",
        ));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn load_takes_a_builtin_name() {
        assert_eq!(Scene::load("face-on").ok(), Scene::builtin("face-on"));
        assert!(Scene::builtin(DEFAULT_SCENE).is_some());
        assert!(Scene::builtin("no-such-scene").is_none());
    }

    #[test]
    fn load_reads_a_file_and_errors_name_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let scene = Scene::builtin("inside").unwrap();
        std::fs::write(&path, scene.to_toml()).unwrap();
        assert_eq!(Scene::load(&path).unwrap(), scene);

        std::fs::write(
            &path,
            scene.to_toml().replace("outer = 12.0", "outer = 2.0"),
        )
        .unwrap();
        let message = Scene::load(&path).unwrap_err().to_string();
        assert!(
            message.contains("mine.toml") && message.contains("disk.outer"),
            "{message}"
        );

        let message = Scene::load(folder.path()).unwrap_err().to_string();
        assert!(
            message.contains(&folder.path().display().to_string()),
            "{message}"
        );
    }

    #[test]
    fn load_lists_the_builtin_names_where_nothing_is_found() {
        let message = Scene::load("clasic").unwrap_err().to_string();
        assert!(
            message.contains("clasic") && message.contains("`darkness scene`"),
            "{message}"
        );
        for builtin in builtins() {
            assert!(message.contains(builtin.name()), "{message}");
        }
    }

    #[test]
    fn with_size_checks_the_size_and_keeps_the_rest() {
        let scene = Scene::builtin("classic").unwrap();
        let small = scene.with_size(64, 36).unwrap();
        assert_eq!(
            small.image(),
            ImageSize {
                width: 64,
                height: 36
            }
        );
        assert_eq!(
            (small.camera(), small.disk()),
            (scene.camera(), scene.disk())
        );
        assert!(matches!(
            scene.with_size(0, 36),
            Err(SceneError::ImageSide { .. })
        ));
        assert!(matches!(
            scene.with_size(64, 1_000_001),
            Err(SceneError::ImageSide { .. })
        ));
    }
}
