//! Values that take the place of those in a scene's file.
//!
//! They are put into the TOML before it is read as a scene, so that a scene is checked as if they stood in its file.

use serde::Deserialize;
use toml::{Table, Value};

use super::angles::radius_and_angles;
use super::error::SceneError;
use super::file::{SceneFile, parser_error};

/// The keys of `[camera]` that take the place of `position`.
const ANGLES: [&str; 3] = ["camera.radius", "camera.inclination", "camera.azimuth"];

/// A value that takes the place of one in a scene's file.
///
/// A key has its tables before it: `camera.fov`, `disk.light.temperature`. That of a keyframe has its frame's number:
/// `animation.keyframe.120.fov`. A key that excludes others takes their place too: the camera's `radius`, `inclination`
/// and `azimuth` that of its `position`, which gives those of the three that are left out. In a scene with an orbit
/// they are the orbit's.
///
/// ```
/// use darkness::scene::{Animation, Override};
///
/// let face_on = Override::parse("camera.inclination=0")?;
/// let wide = Override::parse("camera.fov=50")?;
/// let scene = Animation::load_with("classic", &[face_on, wide])?.frame(1)?;
/// assert_eq!(scene.camera().fov_degrees, 50.0);
/// # Ok::<(), darkness::scene::SceneError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// What it comes from, in errors.
    source: String,
    key: String,
    /// `None` takes the key out.
    value: Option<Value>,
}

impl Override {
    /// Reads `KEY=VALUE`. The value is one of TOML; a text may stand without its quotes. An empty one takes the key out
    /// of the file.
    ///
    /// # Errors
    /// [`SceneError::Toml`] for a text without `=`, or without a key.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let (key, value) = text
            .split_once('=')
            .map(|(key, value)| (key.trim(), value.trim()))
            .filter(|(key, _)| key.split('.').all(|part| !part.is_empty()))
            .ok_or_else(|| SceneError::toml("write KEY=VALUE, such as camera.fov=12"))?;
        let value =
            (!value.is_empty()).then(|| value.parse().unwrap_or_else(|_| Value::from(value)));
        Ok(Self {
            source: format!("--set {text}"),
            key: key.to_owned(),
            value,
        })
    }

    /// Returns the override of a key by a value. Errors begin with its `source`, such as the name of an option.
    pub fn new(source: String, key: &str, value: impl Into<Value>) -> Self {
        Self {
            source,
            key: key.to_owned(),
            value: Some(value.into()),
        }
    }

    /// Puts the value into a scene's table.
    ///
    /// # Errors
    /// [`SceneError::Toml`] for a key that leads nowhere, or that would change nothing.
    fn apply(&self, scene: &mut Table) -> Result<(), SceneError> {
        if let Some(moved) = self.moved_by_keyframes(scene) {
            return Err(SceneError::toml(format!(
                "the animation's keyframes set the {moved}, so that this would change nothing; change theirs, as in \
                 --set animation.keyframe.FRAME.{moved}=VALUE"
            )));
        }
        let has_orbit = get(scene, "animation.orbit").is_some();
        if has_orbit && self.key == "camera.position" {
            return Err(SceneError::toml(
                "animation.orbit sets the position, so that this would change nothing; set camera.radius, \
                 camera.inclination or camera.azimuth",
            ));
        }
        let mut key = self.key.clone();
        if ANGLES.contains(&self.key.as_str()) {
            if has_orbit {
                key = key.replace("camera.", "animation.orbit.");
            } else if let Some(Value::Table(camera)) = scene.get_mut("camera") {
                position_to_angles(camera, self.value.as_ref());
            }
        }
        for excluded in excluded(&key) {
            put(scene, excluded, None)?;
        }
        // The scene's own field of view is that of its own projection.
        if key == "camera.projection" {
            put(scene, "camera.fov", None)?;
            put(scene, "camera.fov_horizontal", None)?;
        }
        put(scene, &key, self.value.clone())
    }

    /// The quantity of this key, where keyframes set it.
    fn moved_by_keyframes(&self, scene: &Table) -> Option<&'static str> {
        let quantity = match self.key.as_str() {
            "camera.fov" | "camera.fov_horizontal" => "fov",
            "camera.focus" => "focus",
            "camera.up" => "up",
            "disk.normal" => "normal",
            key if key == "camera.position" || ANGLES.contains(&key) => "position",
            _ => return None,
        };
        let keyframes = get(scene, "animation.keyframe")?.as_array()?;
        let is_moved = keyframes
            .iter()
            .any(|keyframe| keyframe.get(quantity).is_some());
        is_moved.then_some(quantity)
    }

    /// Whether an error is of this key's value.
    fn is_cause_of(&self, error: &SceneError) -> bool {
        match error {
            SceneError::Value { key, .. } => {
                let of_orbit = key.replace("animation.orbit.", "camera.");
                of_orbit == self.key || key.starts_with(&format!("{}.", self.key))
            }
            SceneError::InFrame { error, .. } => self.is_cause_of(error),
            SceneError::Toml { message } => {
                let leaf = self.key.rsplit('.').next().unwrap_or_default();
                let problem = message.split(", expected").next().unwrap_or_default();
                message.contains(&self.key) || problem.contains(&format!("`{leaf}`"))
            }
            _ => false,
        }
    }

    /// The error, said to be of this override. What it comes from names the key already.
    fn blamed(&self, error: &SceneError) -> SceneError {
        SceneError::Override {
            from: self.source.clone(),
            problem: match error {
                SceneError::Value { key, reason, .. } if *key == self.key => reason.clone(),
                _ => error.to_string(),
            },
        }
    }
}

/// Reads a scene's text with values that take the place of some of its own.
///
/// # Errors
/// [`SceneError::Toml`]; [`SceneError::Override`] where the overrides exclude each other, or one of them is wrong.
pub(super) fn parse(text: &str, overrides: &[Override]) -> Result<SceneFile, SceneError> {
    if overrides.is_empty() {
        return SceneFile::parse(text);
    }
    for (place, this) in overrides.iter().enumerate() {
        let excludes = |other: &&Override| {
            other.key == this.key || excluded(&this.key).contains(&other.key.as_str())
        };
        if let Some(other) = overrides[..place].iter().find(excludes) {
            let error = format!("{} sets this too; leave out one of them", other.source);
            return Err(this.blamed(&SceneError::toml(error)));
        }
    }
    let mut scene: Table = toml::from_str(text).map_err(|error| parser_error(&error))?;
    // A projection takes the scene's field of view away, but not one that is given beside it.
    let (projections, others): (Vec<_>, Vec<_>) = overrides
        .iter()
        .partition(|this| this.key == "camera.projection");
    for this in projections.into_iter().chain(others) {
        this.apply(&mut scene)
            .map_err(|error| this.blamed(&error))?;
    }
    SceneFile::deserialize(scene).map_err(|error| match toml::from_str::<SceneFile>(text) {
        // The same is wrong in the file itself, where it has a line and a column.
        Err(own) if own.message() == error.message() => parser_error(&own),
        _ => blame(parser_error(&error), overrides),
    })
}

/// The error, said to be of the override that causes it, if one does.
pub(super) fn blame(error: SceneError, overrides: &[Override]) -> SceneError {
    if matches!(error, SceneError::Override { .. }) {
        return error;
    }
    // What is wrong with a table as a whole is wrong because of a key in it.
    let message = error.to_string();
    let is_in_table = |this: &&Override| {
        let table = this.key.rsplit_once('.').map_or("", |(table, _)| table);
        message.ends_with(&format!("in `{table}`"))
    };
    let cause = overrides.iter().find(|this| this.is_cause_of(&error));
    match cause.or_else(|| overrides.iter().find(is_in_table)) {
        Some(cause) => cause.blamed(&error),
        None => error,
    }
}

/// The keys that may not stand beside a key.
fn excluded(key: &str) -> &'static [&'static str] {
    match key {
        "camera.fov" => &["camera.fov_horizontal"],
        "camera.fov_horizontal" => &["camera.fov"],
        "camera.position" => &ANGLES,
        _ if ANGLES.contains(&key) => &["camera.position"],
        _ => &[],
    }
}

/// Writes a camera's position as radius, inclination and azimuth. An upward direction of +z, the default of a position,
/// is left to the angles where the inclination becomes `value`, if it would be parallel to the view from a pole.
fn position_to_angles(camera: &mut Table, value: Option<&Value>) {
    let vector = |value: &Value| -> Option<[f64; 3]> { value.clone().try_into().ok() };
    let Some(position) = camera.get("position").and_then(vector) else {
        return;
    };
    let is_plus_z = camera.get("up").and_then(vector) == Some([0.0, 0.0, 1.0]);
    let inclination: Option<f64> = value.and_then(|value| value.clone().try_into().ok());
    if is_plus_z && inclination.is_some_and(|degrees| degrees % 180.0 == 0.0) {
        camera.remove("up");
    }
    camera.remove("position");
    let angles = radius_and_angles(position.into());
    for (key, number) in ["radius", "inclination", "azimuth"].into_iter().zip(angles) {
        camera.insert(key.to_owned(), number.into());
    }
}

/// The value of a key with its tables before it.
fn get<'a>(scene: &'a Table, key: &str) -> Option<&'a Value> {
    let (first, rest) = key.split_once('.')?;
    scene.get(first)?.get(rest)
}

/// Puts a value in, or takes one out. Tables that are missing are made.
fn put(table: &mut Table, key: &str, value: Option<Value>) -> Result<(), SceneError> {
    let Some((first, rest)) = key.split_once('.') else {
        match value {
            Some(value) => table.insert(key.to_owned(), value),
            None => table.remove(key),
        };
        return Ok(());
    };
    if value.is_none() && !table.contains_key(first) {
        return Ok(());
    }
    let within = table.entry(first).or_insert_with(|| Table::new().into());
    match within {
        Value::Table(table) => put(table, rest, value),
        Value::Array(keyframes) => {
            let (frame, rest) = rest.split_once('.').unwrap_or((rest, "frame"));
            let number: Option<i64> = frame.parse().ok();
            let has_frame = |keyframe: &&mut Table| {
                number.is_some() && keyframe.get("frame").and_then(Value::as_integer) == number
            };
            let mut tables = keyframes.iter_mut().filter_map(Value::as_table_mut);
            match tables.find(has_frame) {
                Some(keyframe) => put(keyframe, rest, value),
                None => Err(SceneError::toml(format!(
                    "there is no {first} at frame {frame}"
                ))),
            }
        }
        _ => Err(SceneError::toml(format!(
            "{first} is no table, so that it has no {rest}"
        ))),
    }
}
