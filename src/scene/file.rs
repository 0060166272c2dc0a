//! A scene's TOML form: names, types and defaults. What the values may be is checked in [`validate`](super::validate).

use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::{DEFAULT_TOLERANCE, Scene, SceneError};

/// The whole file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub(super) camera: CameraTable,
    pub(super) disk: DiskTable,
    pub(super) image: ImageTable,
}

/// `[camera]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    #[serde(deserialize_with = "three_numbers")]
    pub(super) position: [f64; 3],
    #[serde(default = "hole", deserialize_with = "three_numbers")]
    pub(super) focus: [f64; 3],
    #[serde(default = "plus_z", deserialize_with = "three_numbers")]
    pub(super) up: [f64; 3],
    pub(super) fov: f64,
}

/// `[disk]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DiskTable {
    pub(super) inner: f64,
    pub(super) outer: f64,
    #[serde(default = "plus_z", deserialize_with = "three_numbers")]
    pub(super) normal: [f64; 3],
}

/// `[image]`. The sizes are signed so that a negative one gets the same sentence as a zero.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageTable {
    pub(super) width: i64,
    pub(super) height: i64,
    #[serde(default = "yes")]
    pub(super) antialias: bool,
    #[serde(default = "default_tolerance")]
    pub(super) tolerance: f64,
}

fn hole() -> [f64; 3] {
    [0.0; 3]
}

fn yes() -> bool {
    true
}

fn default_tolerance() -> f64 {
    DEFAULT_TOLERANCE
}

fn plus_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

/// A vector. (Read straight into an array, a fourth number would pass unnoticed.)
fn three_numbers<'de, D: Deserializer<'de>>(source: D) -> Result<[f64; 3], D::Error> {
    let numbers = Vec::<f64>::deserialize(source)?;
    <[f64; 3]>::try_from(numbers).map_err(|numbers| {
        D::Error::custom(format_args!(
            "a vector has three numbers, x, y and z, and this one has {}",
            numbers.len()
        ))
    })
}

impl SceneFile {
    /// Reads the TOML text.
    ///
    /// # Errors
    /// [`SceneError::Toml`], with line and column.
    pub(super) fn parse(text: &str) -> Result<Self, SceneError> {
        toml::from_str(text).map_err(|error| SceneError::Toml {
            message: error.to_string().trim_end().to_owned(),
        })
    }
}

impl From<&Scene> for SceneFile {
    fn from(scene: &Scene) -> Self {
        Self {
            camera: CameraTable {
                position: scene.camera.position.to_array(),
                focus: scene.camera.focus.to_array(),
                up: scene.camera.up.to_array(),
                fov: scene.camera.fov_degrees,
            },
            disk: DiskTable {
                inner: scene.disk.inner,
                outer: scene.disk.outer,
                normal: scene.disk.normal.to_array(),
            },
            image: ImageTable {
                width: i64::from(scene.image.width),
                height: i64::from(scene.image.height),
                antialias: scene.antialias,
                tolerance: scene.tolerance,
            },
        }
    }
}

/// The TOML text. Written here and not by serde: the form is fixed, this cannot fail, and `{:?}` of a finite f64 is
/// both valid TOML and the shortest decimal that reads back to the same bits, short also for 1e300.
impl fmt::Display for SceneFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            camera,
            disk,
            image,
        } = self;
        writeln!(f, "[camera]")?;
        writeln!(f, "position = {:?}", camera.position)?;
        writeln!(f, "focus = {:?}", camera.focus)?;
        writeln!(f, "up = {:?}", camera.up)?;
        writeln!(f, "fov = {:?}", camera.fov)?;
        writeln!(f, "\n[disk]")?;
        writeln!(f, "inner = {:?}", disk.inner)?;
        writeln!(f, "outer = {:?}", disk.outer)?;
        writeln!(f, "normal = {:?}", disk.normal)?;
        writeln!(f, "\n[image]")?;
        writeln!(f, "width = {}", image.width)?;
        writeln!(f, "height = {}", image.height)?;
        writeln!(f, "antialias = {}", image.antialias)?;
        writeln!(f, "tolerance = {:?}", image.tolerance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORTEST: &str = "[camera]\nposition = [20, 0, 5]\nfov = 40\n[disk]\ninner = 3\nouter = 12\n[image]\nwidth = 64\nheight = 36\n";

    fn message(text: &str) -> String {
        SceneFile::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn what_has_a_default_may_be_left_out() {
        let file = SceneFile::parse(SHORTEST).unwrap();
        assert_eq!(file.camera.position, [20.0, 0.0, 5.0]);
        assert_eq!(file.camera.focus, [0.0; 3]);
        assert_eq!(file.camera.up, [0.0, 0.0, 1.0]);
        assert_eq!(file.disk.normal, [0.0, 0.0, 1.0]);
        assert!(file.image.antialias);
        assert_eq!(file.image.tolerance, 0.001);
    }

    #[test]
    fn what_has_none_may_not_and_the_message_names_it() {
        for line in [
            "position = [20, 0, 5]",
            "fov = 40",
            "inner = 3",
            "outer = 12",
            "width = 64",
            "height = 36",
        ] {
            let key = line.split(' ').next().unwrap();
            let message = message(&SHORTEST.replace(line, ""));
            assert!(
                message.contains(&format!("`{key}`")) && message.contains("line"),
                "{message}"
            );
        }
    }

    #[test]
    fn unknown_keys_and_wrong_types_are_refused_with_their_place() {
        let unknown = message(&SHORTEST.replace("fov = 40", "fov = 40\nroll = 3"));
        assert!(
            unknown.contains("`roll`") && unknown.contains("line 4, column 1"),
            "{unknown}"
        );
        let unknown = message(&SHORTEST.replace("[disk]", "[light]\n[disk]"));
        assert!(unknown.contains("`light`"), "{unknown}");
        let short = message(&SHORTEST.replace("[20, 0, 5]", "[20, 0]"));
        assert!(short.contains("line 2, column 12"), "{short}");
        let text = message(&SHORTEST.replace("width = 64", "width = \"wide\""));
        assert!(text.contains("line 8, column 9"), "{text}");
    }

    #[test]
    fn written_toml_reads_back_to_the_same_bits() {
        let mut file = SceneFile::parse(SHORTEST).unwrap();
        file.camera.position = [0.1 + 0.2, -1e-300, 123_456_789_012_345.0];
        file.camera.up = [5e-324, f64::MAX, -0.0];
        file.camera.fov = 1e-9;
        let back = SceneFile::parse(&file.to_string()).unwrap();
        assert_eq!(back, file);
        assert!(back.camera.up[2].is_sign_negative());
    }
}
