//! Scenes that move: a [`Scene`] for each frame.
//!
//! ```toml
//! [animation]
//! frames = 240                            # required; they are numbered from 1
//! fps = 24                                # default; frames a second, for films
//! interpolation = "smooth"                # default; or "linear"
//! # Each of the three a number or [from, to]; degrees, the inclination from +z.
//! orbit = { radius = 30.0, inclination = 80.0, azimuth = [0.0, 360.0] }
//!
//! # Or, in place of the orbit or beside one that leaves the position to it:
//! [[animation.keyframe]]
//! frame = 1
//! position = [60.0, 0.0, 10.0]            # any of position, focus, up, fov, normal
//! ```
//!
//! # Orbits
//! At the radius r, inclination i and azimuth a the camera stands at `r (sin i cos a, sin i sin a, cos i)`. Where
//! nothing else is up, `−∂position/∂i` is, which is defined at the poles too. The first frame is at `from`, the last
//! at `to`; but where a full turn leads back to the first frame's place, all frames are equally far apart and the last
//! one is as far before the first: the film can be shown in a loop.
//!
//! # Keyframes
//! Each quantity is interpolated between the keyframes that name it, and stays before the first and after the last of
//! them; one that no keyframe names is the scene's own. A position moves as a radius and a direction (`direction.rs`),
//! so that between two keyframes it never comes closer to the hole than both of them.
//!
//! # Smooth and linear
//! A linear quantity changes by the same amount each frame. A smooth one has a continuous first derivative, is never
//! beyond the keyframes beside it (`track.rs`), and comes from rest and to rest at its first and last keyframe.

mod direction;
mod orbit;
mod position;
mod range;
mod rate;
mod track;

use std::path::Path;

use glam::DVec3;

use super::file::{KeyframeTable, SceneFile};
use super::vector::{cosine, norm};
use super::{Camera, Disk, ImageSize, Scene, SceneError, load_text, validate};
use direction::Directions;
use orbit::Orbit;
use position::{Place, Position};
pub use range::{FrameRange, FrameRangeError};
pub use rate::Rate;
use track::Track;

/// The most frames of an animation.
pub const MAX_FRAMES: u32 = 100_000_000;

/// Between keyframes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// With a continuous first derivative, from rest to rest.
    Smooth,
    /// By the same amount each frame.
    Linear,
}

/// A scene at each of its frames, which are numbered from 1. A scene that does not move is an animation of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    file: SceneFile,
    frames: u32,
    rate: Rate,
    position: Position,
    focus: Track<3>,
    up: Up,
    fov: Track<1>,
    inner: f64,
    outer: f64,
    normal: Directions,
    picture: validate::Picture,
}

/// What is up in the picture.
#[derive(Debug, Clone, PartialEq)]
enum Up {
    Given(Directions),
    /// `−∂position/∂inclination`.
    OfOrbit,
}

impl Animation {
    /// Reads an animation from its TOML form: a scene's, which [its page](super) shows, with the part that is shown
    /// [here](self).
    ///
    /// # Errors
    /// Those of [`Scene::from_toml`], for whatever is wrong with all frames. What is wrong with one frame, [`Self::frame`] says.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        Self::new(SceneFile::parse(text)?)
    }

    /// The built-in scene of that name, or else the one in the TOML file at that path.
    ///
    /// # Errors
    /// Those of [`Scene::load`].
    pub fn load(path_or_name: impl AsRef<Path>) -> Result<Self, SceneError> {
        load_text(path_or_name.as_ref(), Self::from_toml)
    }

    fn new(mut file: SceneFile) -> Result<Self, SceneError> {
        let picture = validate::picture(&file.image)?;
        let table = file.animation.take();
        let (frames, rate) = match &table {
            Some(table) => (frames(table.frames)?, Rate::new(table.fps)?),
            None => (1, Rate::default()),
        };
        let interpolation = table
            .as_ref()
            .map_or(Interpolation::Linear, |table| table.interpolation);
        let keyframes: &[KeyframeTable] = table.as_ref().map_or(&[], |table| &table.keyframe);
        check_order(keyframes, frames)?;
        let orbit = table.as_ref().and_then(|table| table.orbit.as_ref());
        let orbit = orbit.map(|orbit| Orbit::new(orbit, frames, interpolation));

        let keys = Keys {
            keyframes,
            interpolation,
        };
        let position = keys.vectors("position", |keyframe| keyframe.position)?;
        let position = match (orbit, position.as_slice(), file.camera.position) {
            (Some(_), [_, ..], _) => return Err(SceneError::OrbitAndPosition),
            (Some(orbit), [], _) => Position::Orbit(orbit?),
            (None, [_, ..], _) => Position::new(&position, interpolation)?,
            (None, [], Some(position)) => Position::still(position)?,
            (None, [], None) => return Err(SceneError::NoPosition),
        };
        let focus = keys.vectors("focus", |keyframe| keyframe.focus)?;
        let up = keys.directions("up", |keyframe| keyframe.up)?;
        if !matches!(position, Position::Orbit(_)) {
            file.camera.up.get_or_insert([0.0, 0.0, 1.0]);
        }
        let up = match (up, file.camera.up) {
            (Some(up), _) => Up::Given(up),
            (None, Some(up)) => Up::Given(Directions::still(validate::finite_direction(
                "camera.up",
                up,
            )?)),
            (None, None) => Up::OfOrbit,
        };
        let fov = keys.named("fov", |keyframe| keyframe.fov.map(|fov| [fov]))?;
        let normal = keys.directions("normal", |keyframe| keyframe.normal)?;
        let focus_of_scene = validate::finite_vector("camera.focus", file.camera.focus)?;
        let normal_of_scene = validate::finite_direction("disk.normal", file.disk.normal)?;
        let animation = Self {
            frames,
            rate,
            position,
            focus: Track::or_still(&focus, focus_of_scene.to_array(), interpolation),
            up,
            fov: Track::or_still(&fov, [file.camera.fov], interpolation),
            inner: file.disk.inner,
            outer: file.disk.outer,
            normal: normal.unwrap_or_else(|| Directions::still(normal_of_scene)),
            picture,
            file: SceneFile {
                animation: table,
                ..file
            },
        };
        validate::disk(animation.inner, animation.outer)?;
        if animation.is_still() {
            animation.frame(1)?;
        }
        Ok(animation)
    }

    /// How many frames there are; they are numbered from 1.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// How fast the frames follow each other.
    pub fn rate(&self) -> Rate {
        self.rate
    }

    /// The size of its frames.
    pub fn image(&self) -> ImageSize {
        self.picture.size
    }

    /// Whether the scene says nothing of an animation: it has one frame then.
    pub fn is_still(&self) -> bool {
        self.file.animation.is_none()
    }

    /// The scene at frame `number`.
    ///
    /// # Errors
    /// [`SceneError::NoFrame`] for a number that is not from 1 to [`Self::frames`]; [`SceneError::InFrame`] for a
    /// camera that stands where none can stand, or does not look anywhere.
    pub fn frame(&self, number: u32) -> Result<Scene, SceneError> {
        if !(1..=self.frames).contains(&number) {
            return Err(SceneError::NoFrame {
                number,
                frames: self.frames,
            });
        }
        let time = f64::from(number);
        let Place {
            position,
            radius,
            up,
        } = self.position.at(time);
        let camera = Camera {
            position,
            focus: DVec3::from_array(self.focus.at(time)),
            up: match &self.up {
                Up::Given(up) => up.at(time),
                Up::OfOrbit => up,
            },
            fov_degrees: self.fov.at(time)[0],
        };
        let disk = Disk {
            inner: self.inner,
            outer: self.outer,
            normal: self.normal.at(time),
        };
        validate::scene(camera, radius, disk, self.picture).map_err(|error| {
            if self.is_still() {
                error
            } else {
                SceneError::InFrame {
                    number,
                    error: Box::new(error),
                }
            }
        })
    }

    /// Checks frame `number` and the way to the next: a camera that is above the disk's matter at one frame and below
    /// at the next has gone through.
    ///
    /// # Errors
    /// Those of [`Self::frame`], and [`SceneError::ThroughMatter`].
    pub fn check(&self, number: u32) -> Result<(), SceneError> {
        self.frame(number)?;
        let (mut before, mut after) = (f64::from(number), f64::from(number) + 1.0);
        let side = |time| cosine(self.position.at(time).position, self.normal.at(time));
        let first = side(before);
        if number == self.frames || first * side(after) >= 0.0 {
            return Ok(());
        }
        for _ in 0..50 {
            let middle = 0.5 * (before + after);
            if first * side(middle) > 0.0 {
                before = middle;
            } else {
                after = middle;
            }
        }
        let radius = self.position.at(after).radius;
        if (self.inner..=self.outer).contains(&radius) {
            return Err(SceneError::ThroughMatter {
                number,
                radius,
                inner: self.inner,
                outer: self.outer,
            });
        }
        Ok(())
    }

    /// The same animation as pictures of another size; the vertical field of view stays.
    ///
    /// # Errors
    /// [`SceneError::ImageSide`] for a size that is not allowed.
    pub fn with_size(mut self, width: u32, height: u32) -> Result<Self, SceneError> {
        (self.file.image.width, self.file.image.height) = (i64::from(width), i64::from(height));
        self.with_picture()
    }

    /// The same animation with its edges right to so many pixels.
    ///
    /// # Errors
    /// [`SceneError::Tolerance`] for a tolerance that is not allowed.
    pub fn with_tolerance(mut self, pixels: f64) -> Result<Self, SceneError> {
        self.file.image.tolerance = pixels;
        self.with_picture()
    }

    /// The same animation with smooth edges or with hard ones.
    ///
    /// # Errors
    /// None that the animation does not have already.
    pub fn with_antialias(mut self, antialias: bool) -> Result<Self, SceneError> {
        self.file.image.antialias = antialias;
        self.with_picture()
    }

    fn with_picture(self) -> Result<Self, SceneError> {
        Ok(Self {
            picture: validate::picture(&self.file.image)?,
            ..self
        })
    }

    /// The animation's TOML form with every key written out that has a value: two animations are the same if theirs are.
    pub fn to_toml(&self) -> String {
        self.file.to_string()
    }
}

/// How many frames an animation has.
fn frames(frames: i64) -> Result<u32, SceneError> {
    u32::try_from(frames)
        .ok()
        .filter(|count| (1..=MAX_FRAMES).contains(count))
        .ok_or(SceneError::Frames { frames })
}

/// Keyframes stand in order, within the animation.
fn check_order(keyframes: &[KeyframeTable], frames: u32) -> Result<(), SceneError> {
    let mut before = 0;
    for keyframe in keyframes {
        let number = keyframe.frame;
        if number < 1 || number > i64::from(frames) {
            return Err(SceneError::KeyframeOutside { number, frames });
        }
        if number <= before {
            return Err(SceneError::KeyframeOrder { number, before });
        }
        if keyframe.is_empty() {
            return Err(SceneError::KeyframeEmpty { number });
        }
        before = number;
    }
    Ok(())
}

/// The keyframes, and what is between them.
struct Keys<'a> {
    keyframes: &'a [KeyframeTable],
    interpolation: Interpolation,
}

impl Keys<'_> {
    /// The values of the keyframes that name a quantity, with their times.
    fn named<const N: usize>(
        &self,
        key: &'static str,
        value: impl Fn(&KeyframeTable) -> Option<[f64; N]>,
    ) -> Result<Vec<(f64, [f64; N])>, SceneError> {
        let named = self
            .keyframes
            .iter()
            .filter_map(|keyframe| Some((keyframe.frame, value(keyframe)?)));
        named
            .map(|(number, value)| {
                for component in value {
                    validate::finite(key, component).map_err(|error| in_keyframe(number, error))?;
                }
                Ok((number as f64, value))
            })
            .collect()
    }

    fn vectors(
        &self,
        key: &'static str,
        value: impl Fn(&KeyframeTable) -> Option<[f64; 3]>,
    ) -> Result<Vec<(f64, [f64; 3])>, SceneError> {
        self.named(key, value)
    }

    fn directions(
        &self,
        key: &'static str,
        value: impl Fn(&KeyframeTable) -> Option<[f64; 3]>,
    ) -> Result<Option<Directions>, SceneError> {
        let named = self.vectors(key, value)?;
        let named: Vec<_> = named
            .into_iter()
            .map(|(time, value)| (time, DVec3::from_array(value)))
            .collect();
        for &(time, value) in &named {
            if value == DVec3::ZERO {
                return Err(in_keyframe(time as i64, SceneError::ZeroDirection { key }));
            }
        }
        if named.is_empty() {
            return Ok(None);
        }
        Directions::new(key, &named, self.interpolation).map(Some)
    }
}

fn in_keyframe(number: i64, error: SceneError) -> SceneError {
    SceneError::InKeyframe {
        number,
        error: Box::new(error),
    }
}

/// The radius of a keyframe's position, where a camera can stand.
fn radius_at(time: f64, position: DVec3) -> Result<f64, SceneError> {
    let radius = norm(position);
    validate::radius(radius).map_err(|error| in_keyframe(time as i64, error))?;
    Ok(radius)
}

#[cfg(test)]
mod tests;
