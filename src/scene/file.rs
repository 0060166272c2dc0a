//! A scene's TOML form: names, types and defaults. What the values may be is checked in [`validate`](super::validate).

use std::fmt;

use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::animation::Interpolation;
use super::{DEFAULT_TOLERANCE, Scene, SceneError};
use crate::quotation::beginning;

/// The whole file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub(super) camera: CameraTable,
    pub(super) disk: DiskTable,
    pub(super) image: ImageTable,
    pub(super) animation: Option<AnimationTable>,
}

/// `[camera]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    /// Left out where the animation says where the camera is.
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    pub(super) position: Option<[f64; 3]>,
    #[serde(default = "hole", deserialize_with = "three_numbers")]
    pub(super) focus: [f64; 3],
    /// Its default depends on the animation.
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    pub(super) up: Option<[f64; 3]>,
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

/// `[animation]`. Frame numbers are signed as sizes are.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AnimationTable {
    pub(super) frames: i64,
    #[serde(default = "of_film")]
    pub(super) fps: f64,
    #[serde(default = "smooth", deserialize_with = "smooth_or_linear")]
    pub(super) interpolation: Interpolation,
    pub(super) orbit: Option<OrbitTable>,
    #[serde(default)]
    pub(super) keyframe: Vec<KeyframeTable>,
}

/// `animation.orbit`: radius, and angles in degrees.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OrbitTable {
    pub(super) radius: Span,
    pub(super) inclination: Span,
    pub(super) azimuth: Span,
}

/// What stays at a number, or changes from one to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
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
    /// Whether it names nothing but its frame.
    pub(super) fn is_empty(&self) -> bool {
        let vectors = [self.position, self.focus, self.up, self.normal];
        vectors.iter().all(Option::is_none) && self.fov.is_none()
    }
}

impl<'de> Deserialize<'de> for Span {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        struct Numbers;

        impl<'de> Visitor<'de> for Numbers {
            type Value = Span;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a number, or two as [from, to]")
            }

            fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Span, E> {
                Ok(Span {
                    from: value,
                    to: value,
                })
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Span, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<Span, A::Error> {
                let mut pair = [0.0; 2];
                for (count, number) in pair.iter_mut().enumerate() {
                    let next = numbers.next_element()?;
                    *number = next.ok_or_else(|| A::Error::invalid_length(count, &Self))?;
                }
                if numbers.next_element::<f64>()?.is_some() {
                    return Err(A::Error::invalid_length(3, &Self));
                }
                let [from, to] = pair;
                Ok(Span { from, to })
            }
        }

        source.deserialize_any(Numbers)
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.from == self.to {
            write!(f, "{:?}", self.from)
        } else {
            write!(f, "[{:?}, {:?}]", self.from, self.to)
        }
    }
}

fn of_film() -> f64 {
    24.0
}

fn smooth() -> Interpolation {
    Interpolation::Smooth
}

fn smooth_or_linear<'de, D: Deserializer<'de>>(source: D) -> Result<Interpolation, D::Error> {
    match String::deserialize(source)?.as_str() {
        "smooth" => Ok(Interpolation::Smooth),
        "linear" => Ok(Interpolation::Linear),
        other => Err(D::Error::custom(format_args!(
            "the interpolation is \"smooth\" or \"linear\", not \"{other}\""
        ))),
    }
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

fn maybe_three_numbers<'de, D: Deserializer<'de>>(source: D) -> Result<Option<[f64; 3]>, D::Error> {
    three_numbers(source).map(Some)
}

impl SceneFile {
    /// Reads the TOML text.
    ///
    /// # Errors
    /// [`SceneError::Toml`], with line and column.
    pub(super) fn parse(text: &str) -> Result<Self, SceneError> {
        toml::from_str(text).map_err(|error| SceneError::Toml {
            message: readable(error.to_string().trim_end()),
        })
    }
}

/// The parser's message fit to be read: it quotes the file, and names types as Rust does.
fn readable(message: &str) -> String {
    const LONGEST: usize = 200;
    let lines = message.lines().map(|line| {
        beginning(line, LONGEST)
            .replace("expected f64", "expected a number")
            .replace("expected i64", "expected a whole number")
            .replace("expected a boolean", "expected true or false")
    });
    lines.collect::<Vec<_>>().join("\n")
}

impl From<&Scene> for SceneFile {
    fn from(scene: &Scene) -> Self {
        Self {
            camera: CameraTable {
                position: Some(scene.camera.position.to_array()),
                focus: scene.camera.focus.to_array(),
                up: Some(scene.camera.up.to_array()),
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
            animation: None,
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
            animation,
        } = self;
        writeln!(f, "[camera]")?;
        line(f, "position", camera.position)?;
        writeln!(f, "focus = {:?}", camera.focus)?;
        line(f, "up", camera.up)?;
        writeln!(f, "fov = {:?}", camera.fov)?;
        writeln!(f, "\n[disk]")?;
        writeln!(f, "inner = {:?}", disk.inner)?;
        writeln!(f, "outer = {:?}", disk.outer)?;
        writeln!(f, "normal = {:?}", disk.normal)?;
        writeln!(f, "\n[image]")?;
        writeln!(f, "width = {}", image.width)?;
        writeln!(f, "height = {}", image.height)?;
        writeln!(f, "antialias = {}", image.antialias)?;
        writeln!(f, "tolerance = {:?}", image.tolerance)?;
        animation
            .as_ref()
            .map_or(Ok(()), |animation| write!(f, "\n{animation}"))
    }
}

impl fmt::Display for AnimationTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[animation]")?;
        writeln!(f, "frames = {}", self.frames)?;
        writeln!(f, "fps = {:?}", self.fps)?;
        let interpolation = match self.interpolation {
            Interpolation::Smooth => "smooth",
            Interpolation::Linear => "linear",
        };
        writeln!(f, "interpolation = \"{interpolation}\"")?;
        if let Some(orbit) = &self.orbit {
            let OrbitTable {
                radius,
                inclination,
                azimuth,
            } = orbit;
            writeln!(
                f,
                "orbit = {{ radius = {radius}, inclination = {inclination}, azimuth = {azimuth} }}"
            )?;
        }
        for keyframe in &self.keyframe {
            writeln!(f, "\n[[animation.keyframe]]")?;
            writeln!(f, "frame = {}", keyframe.frame)?;
            line(f, "position", keyframe.position)?;
            line(f, "focus", keyframe.focus)?;
            line(f, "up", keyframe.up)?;
            line(f, "fov", keyframe.fov)?;
            line(f, "normal", keyframe.normal)?;
        }
        Ok(())
    }
}

/// The line of a key that has a value.
fn line(f: &mut fmt::Formatter<'_>, key: &str, value: Option<impl fmt::Debug>) -> fmt::Result {
    value.map_or(Ok(()), |value| writeln!(f, "{key} = {value:?}"))
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
        assert_eq!(file.camera.position, Some([20.0, 0.0, 5.0]));
        assert_eq!(file.camera.focus, [0.0; 3]);
        assert_eq!((file.camera.up, file.animation), (None, None));
        assert_eq!(file.disk.normal, [0.0, 0.0, 1.0]);
        assert!(file.image.antialias);
        assert_eq!(file.image.tolerance, 0.001);
    }

    #[test]
    fn what_has_none_may_not_and_the_message_names_it() {
        for line in [
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
        assert!(
            text.contains("line 8, column 9") && text.contains("expected a whole number"),
            "{text}"
        );
        let text = message(&SHORTEST.replace("fov = 40", "fov = \"wide\""));
        assert!(text.contains("expected a number"), "{text}");
    }

    #[test]
    fn written_toml_reads_back_to_the_same_bits() {
        let mut file = SceneFile::parse(SHORTEST).unwrap();
        file.camera.position = Some([0.1 + 0.2, -1e-300, 123_456_789_012_345.0]);
        file.camera.up = Some([5e-324, f64::MAX, -0.0]);
        file.camera.fov = 1e-9;
        let back = SceneFile::parse(&file.to_string()).unwrap();
        assert_eq!(back, file);
        assert!(back.camera.up.is_some_and(|up| up[2].is_sign_negative()));
    }
}
