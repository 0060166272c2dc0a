//! A scene's TOML form: names, types and defaults. [`validate`](super::validate) checks the values.

use std::fmt::{self, Debug};
use std::sync::Arc;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::error::SceneError;
use super::layers::LayerSet;
use super::sky::Sky;
use super::validate;
use super::values::{DEFAULT_TOLERANCE, ImageSettings, Light, Tone};
use crate::quotation::beginning;

mod camera;
mod sky;
mod write;

pub(super) use camera::{CameraTable, Fov, Place};

/// The whole file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    #[serde(default)]
    pub(super) camera: CameraTable,
    pub(super) disk: Option<DiskTable>,
    #[serde(default, deserialize_with = "sky::sky")]
    pub(super) sky: Option<Arc<Sky>>,
    #[serde(default)]
    pub(super) image: ImageTable,
    pub(super) animation: Option<AnimationTable>,
}

/// `[disk]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DiskTable {
    #[serde(default = "innermost")]
    pub(super) inner: f64,
    #[serde(default = "default_outer")]
    pub(super) outer: f64,
    #[serde(default = "plus_z", deserialize_with = "three_numbers")]
    pub(super) normal: [f64; 3],
    #[serde(default, deserialize_with = "light")]
    pub(super) light: Option<Light>,
}

/// `[disk.light]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "the table [disk.light]")]
struct LightTable {
    model: Option<LightModel>,
    temperature: Option<f64>,
}

/// The names of the kinds of [`Light`].
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum LightModel {
    BlackBody,
    Bolometric,
}

/// `[image]`. Sizes and bits are signed so that a negative one gets the same error as a zero.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageTable {
    #[serde(default = "default_width")]
    pub(super) width: i64,
    #[serde(default = "default_height")]
    pub(super) height: i64,
    #[serde(default = "yes")]
    pub(super) antialias: bool,
    #[serde(default = "default_tolerance")]
    pub(super) tolerance: f64,
    #[serde(default)]
    pub(super) exposure: f64,
    #[serde(default)]
    pub(super) tone: Tone,
    #[serde(default = "one_byte")]
    pub(super) bits: i64,
    #[serde(default, deserialize_with = "layers")]
    pub(super) layers: LayerSet,
    #[serde(default, deserialize_with = "crop")]
    pub(super) crop: Option<[i64; 4]>,
}

impl Default for ImageTable {
    fn default() -> Self {
        Self {
            width: default_width(),
            height: default_height(),
            antialias: true,
            tolerance: DEFAULT_TOLERANCE,
            exposure: 0.0,
            tone: Tone::default(),
            bits: one_byte(),
            layers: LayerSet::default(),
            crop: None,
        }
    }
}

/// How a quantity changes between keyframes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Interpolation {
    /// With a continuous first derivative, from rest to rest.
    #[default]
    Smooth,
    /// By the same amount each frame.
    Linear,
}

/// `[animation]`. Frame numbers are signed, as sizes are.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AnimationTable {
    pub(super) frames: i64,
    #[serde(default = "one")]
    pub(super) first: i64,
    #[serde(default = "of_film")]
    pub(super) fps: f64,
    #[serde(default)]
    pub(super) interpolation: Interpolation,
    pub(super) orbit: Option<OrbitTable>,
    #[serde(default)]
    pub(super) keyframe: Vec<KeyframeTable>,
}

impl AnimationTable {
    /// Whether any quantity changes.
    pub(super) fn moves(&self) -> bool {
        let changes = |value: fn(&KeyframeTable) -> Option<[f64; 3]>| {
            let mut values = self.keyframe.iter().filter_map(value);
            let first = values.next();
            values.any(|value| Some(value) != first)
        };
        let orbit = self.orbit.as_ref();
        orbit.is_some_and(
            |OrbitTable {
                 radius,
                 inclination,
                 azimuth,
             }| {
                [radius, inclination, azimuth]
                    .iter()
                    .any(|span| span.from != span.to)
            },
        ) || changes(|keyframe| keyframe.position)
            || changes(|keyframe| keyframe.focus)
            || changes(|keyframe| keyframe.up)
            || changes(|keyframe| keyframe.normal)
            || changes(|keyframe| keyframe.fov.map(|fov| [fov; 3]))
    }
}

/// `animation.orbit`: radius, and angles in degrees.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OrbitTable {
    pub(super) radius: FromTo,
    pub(super) inclination: FromTo,
    pub(super) azimuth: FromTo,
}

/// A number that stays, or changes from one value to another.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(from = "OneOrTwo")]
pub(super) struct FromTo {
    pub(super) from: f64,
    pub(super) to: f64,
}

/// How a [`FromTo`] is written.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number, or two as [from, to]")]
enum OneOrTwo {
    One(f64),
    Two([f64; 2]),
}

impl From<OneOrTwo> for FromTo {
    fn from(written: OneOrTwo) -> Self {
        let [from, to] = match written {
            OneOrTwo::One(number) => [number; 2],
            OneOrTwo::Two(pair) => pair,
        };
        Self { from, to }
    }
}

/// `[[animation.keyframe]]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KeyframeTable {
    pub(super) frame: i64,
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    pub(super) position: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    pub(super) focus: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    pub(super) up: Option<[f64; 3]>,
    pub(super) fov: Option<f64>,
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    pub(super) normal: Option<[f64; 3]>,
}

impl KeyframeTable {
    /// Whether it sets nothing.
    pub(super) fn is_empty(&self) -> bool {
        let vectors = [self.position, self.focus, self.up, self.normal];
        vectors.iter().all(Option::is_none) && self.fov.is_none()
    }
}

/// Writes the line of a key that has a value.
fn line(f: &mut fmt::Formatter<'_>, key: &str, value: Option<impl Debug>) -> fmt::Result {
    value.map_or(Ok(()), |value| writeln!(f, "{key} = {value:?}"))
}

fn innermost() -> f64 {
    validate::ISCO_RADIUS
}

fn default_outer() -> f64 {
    12.0
}

fn default_width() -> i64 {
    1920
}

fn default_height() -> i64 {
    1080
}

fn one() -> i64 {
    1
}

fn of_film() -> f64 {
    24.0
}

fn yes() -> bool {
    true
}

fn default_tolerance() -> f64 {
    DEFAULT_TOLERANCE
}

fn one_byte() -> i64 {
    8
}

fn plus_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

/// Reads a vector. An array type would ignore a fourth number.
fn three_numbers<'de, D: Deserializer<'de>>(source: D) -> Result<[f64; 3], D::Error> {
    let numbers = Vec::<f64>::deserialize(source)?;
    <[f64; 3]>::try_from(numbers).map_err(|numbers| {
        D::Error::custom(format_args!(
            "a vector has three numbers, x, y and z; this one has {}",
            numbers.len()
        ))
    })
}

fn maybe_three_numbers<'de, D: Deserializer<'de>>(source: D) -> Result<Option<[f64; 3]>, D::Error> {
    three_numbers(source).map(Some)
}

/// Reads a disk's light. Errors name what is missing or too much.
fn light<'de, D: Deserializer<'de>>(source: D) -> Result<Option<Light>, D::Error> {
    let LightTable { model, temperature } = LightTable::deserialize(source)?;
    match (model, temperature) {
        (Some(LightModel::BlackBody), Some(temperature)) => Ok(Light::BlackBody { temperature }),
        (Some(LightModel::Bolometric), None) => Ok(Light::Bolometric),
        (None, _) => Err(
            "disk.light.model is missing; set it to \"blackbody\", with a temperature, or to \"bolometric\"",
        ),
        (Some(LightModel::BlackBody), None) => Err(
            "disk.light.temperature is missing; set the temperature of the hottest ring, in kelvin, such as 7000.0",
        ),
        (Some(LightModel::Bolometric), Some(_)) => Err(
            "disk.light.temperature means nothing for bolometric light; remove it or set model = \"blackbody\"",
        ),
    }
    .map(Some)
    .map_err(D::Error::custom)
}

/// Reads a part of the picture. An array type would ignore a fifth number.
fn crop<'de, D: Deserializer<'de>>(source: D) -> Result<Option<[i64; 4]>, D::Error> {
    let numbers = Vec::<i64>::deserialize(source)?;
    <[i64; 4]>::try_from(numbers).map(Some).map_err(|numbers| {
        D::Error::custom(format_args!(
            "a part of the picture is four whole numbers, [left, top, width, height]; this one has {}",
            numbers.len()
        ))
    })
}

/// Reads the names of layers.
fn layers<'de, D: Deserializer<'de>>(source: D) -> Result<LayerSet, D::Error> {
    LayerSet::from_names(Vec::<String>::deserialize(source)?).map_err(D::Error::custom)
}

impl SceneFile {
    /// Reads the TOML text.
    ///
    /// # Errors
    /// [`SceneError::Toml`], with line and column.
    pub(super) fn parse(text: &str) -> Result<Self, SceneError> {
        toml::from_str(text).map_err(|error| parser_error(&error))
    }

    /// The light of the disk, if there is any.
    pub(super) fn light(&self) -> Option<Light> {
        self.disk.as_ref().and_then(|disk| disk.light)
    }

    /// Checks the light, the sky and the settings of the pictures.
    ///
    /// # Errors
    /// [`SceneError::Value`] for the first value that is not allowed.
    pub(super) fn settings(&self) -> Result<ImageSettings, SceneError> {
        let (image, light) = (&self.image, self.light());
        validate::light(light, self.disk.is_some())?;
        self.sky.as_deref().map_or(Ok(()), validate::sky)?;
        let settings =
            validate::image(image.width, image.height, image.antialias, image.tolerance)?;
        validate::shape(self.camera.projection, settings.size)?;
        validate::exposure("image.exposure", image.exposure)?;
        validate::layers(image.layers, light, self.sky.is_some())?;
        let crop = image.crop.map(|part| validate::crop(part, settings.size));
        Ok(ImageSettings {
            crop: crop.transpose()?,
            exposure: image.exposure,
            tone: image.tone,
            bits: validate::bits(image.bits)?,
            layers: image.layers,
            ..settings
        })
    }
}

/// The error of the parser.
pub(super) fn parser_error(error: &toml::de::Error) -> SceneError {
    SceneError::toml(readable(error.to_string().trim_end()))
}

/// Makes the parser's message readable: it quotes lines of any length, and names types as Rust does.
fn readable(message: &str) -> String {
    const LONGEST: usize = 200;
    let lines = message.lines().map(|line| {
        beginning(line, LONGEST)
            .replace("missing field", "missing key")
            .replace("unknown field", "unknown key")
            .replace("expected f64", "expected a number")
            .replace("expected i64", "expected a whole number")
            .replace("expected a boolean", "expected true or false")
            .replace("expected a sequence", "expected a list")
            .replace("expected a string", "expected a text")
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORTEST: &str = "[camera]\nposition = [20, 0, 5]\nfov = 40\n[disk]\ninner = 3\nouter = 12\n\
                            [image]\nwidth = 64\nheight = 36\n";

    fn message(text: &str) -> String {
        SceneFile::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn what_has_a_default_may_be_left_out() {
        let file = SceneFile::parse(SHORTEST).unwrap();
        assert_eq!(file.camera.position(), Some([20.0, 0.0, 5.0]));
        assert_eq!(file.camera.focus, [0.0; 3]);
        assert_eq!((file.camera.up, file.animation), (None, None));
        assert_eq!(file.disk.unwrap().normal, [0.0, 0.0, 1.0]);
        assert!(file.image.antialias);
        assert_eq!(file.image.tolerance, 0.001);
    }

    #[test]
    fn a_table_is_as_good_without_its_defaults_as_with_them() {
        let least = SceneFile::parse("camera.position = [20, 0, 5]\n[disk]").unwrap();
        let defaults = "[camera]\nposition = [20, 0, 5]\nfov = 30\n[disk]\ninner = 3\nouter = 12\n[image]\n\
                        width = 1920\nheight = 1080\nantialias = true\ntolerance = 0.001\nbits = 8\n";
        assert_eq!(least, SceneFile::parse(defaults).unwrap());
        let in_table = SceneFile::parse("[camera]\nposition = [20, 0, 5]\n[disk]\n[image]");
        assert_eq!(in_table.unwrap(), least);
        assert_eq!(
            SceneFile::parse("[disk]").unwrap().camera,
            CameraTable::default()
        );
    }

    #[test]
    fn what_has_no_default_is_named_with_its_table() {
        let orbit = "orbit = { radius = 30, inclination = 80, azimuth = 0 }";
        for (without, key) in [
            (format!("[animation]\n{orbit}\n"), "frames"),
            (
                "[animation]\nframes = 9\norbit = { radius = 30, azimuth = 0 }\n".into(),
                "inclination",
            ),
            (
                "[animation]\nframes = 9\n[[animation.keyframe]]\nfov = 3\n".into(),
                "frame",
            ),
        ] {
            let message = message(&format!("{SHORTEST}{without}"));
            assert!(
                message.contains(&format!("missing key `{key}`")),
                "{message}"
            );
            assert!(message.contains("line 1"), "{message}");
            assert!(!message.contains("line 1, "), "{message}");
        }
    }

    #[test]
    fn unknown_keys_and_wrong_types_are_refused_with_their_place() {
        let unknown = message(&SHORTEST.replace("fov = 40", "fov = 40\ntilt = 3"));
        assert!(
            unknown.contains("`tilt`") && unknown.contains("line 4, column 1"),
            "{unknown}"
        );
        let unknown = message(&SHORTEST.replace("[disk]", "[light]\n[disk]"));
        assert!(unknown.contains("`light`"), "{unknown}");
        let short = message(&SHORTEST.replace("[20, 0, 5]", "[20, 0]"));
        assert!(short.contains("line 2, column 12"), "{short}");
        let text = message(&SHORTEST.replace("width = 64", "width = \"wide\""));
        assert!(
            text.contains("line 8, column 9") && text.contains("expected a whole number"),
            "{text}"
        );
        let text = message(&SHORTEST.replace("fov = 40", "fov = \"wide\""));
        assert!(text.contains("expected a number"), "{text}");
    }
}
