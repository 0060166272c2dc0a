//! Moving scenes: a [`Scene`] for each frame.
//!
//! ```toml
//! [animation]
//! frames = 240                            # required
//! first = 1                               # default; the first frame's number, which may be 0 or negative
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
//! At radius r, inclination i and azimuth a the camera is at `r (sin i cos a, sin i sin a, cos i)`. Unless the scene
//! sets `up`, it is `−∂position/∂i`, which is defined at the poles too. The first frame is at `from`, the last at
//! `to`. An orbit of whole turns is different: its frames are evenly spaced, and the last is one step before the
//! first, so that the film can loop.
//!
//! # Keyframes
//! Each quantity is interpolated between the keyframes that set it. It is constant before the first and after the last
//! of them. A quantity that no keyframe sets has the scene's own value. A position moves as a radius and a direction
//! (`direction.rs`): between two keyframes it never comes closer to the hole than the nearer of them.
//!
//! # Smooth and linear
//! A linear quantity changes by the same amount each frame. A smooth one has a continuous first derivative, stays
//! within the values of the keyframes on either side (`track.rs`), and is at rest at its first and last keyframe.

mod direction;
mod orbit;
mod position;
mod rate;
mod settings;
mod track;

use glam::DVec3;

use super::checked::Scene;
use super::error::SceneError;
use super::file::{AnimationTable, Interpolation, KeyframeTable, SceneFile};
use super::projection::Projection;
use super::validate;
use super::values::{Camera, Disk, ImageSettings};
use super::vector::cosine;
use direction::Directions;
use orbit::{CameraPlace, OrbitPath};
use position::Position;
pub use rate::Rate;
use track::Track;

/// The most frames of an animation.
pub const MAX_FRAMES: u32 = 100_000_000;

/// The largest number of an animation's first frame; the smallest is its opposite.
pub const MAX_FIRST: i64 = 1_000_000_000;

/// A scene for each frame. Frames are numbered from [`Self::first`] on; a still scene is an animation of one frame, 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    file: SceneFile,
    first: i64,
    frames: u32,
    rate: Rate,
    position: Position,
    focus: Track<3>,
    up: Up,
    fov: Track<1>,
    disk: Option<MovingDisk>,
    settings: ImageSettings,
}

/// A disk whose axis may turn.
#[derive(Debug, Clone, PartialEq)]
struct MovingDisk {
    inner: f64,
    outer: f64,
    normal: Directions,
}

impl MovingDisk {
    /// The disk at a time.
    fn at(&self, time: f64) -> Disk {
        Disk {
            inner: self.inner,
            outer: self.outer,
            normal: self.normal.at(time),
        }
    }
}

/// What is up in the picture.
#[derive(Debug, Clone, PartialEq)]
enum Up {
    Given(Directions),
    /// `−∂position/∂inclination`.
    OfOrbit,
}

impl Animation {
    /// Checks a scene's file.
    ///
    /// # Errors
    /// [`SceneError`] for what is wrong with every frame; in a still scene, for all that is wrong.
    pub(super) fn new(mut file: SceneFile) -> Result<Self, SceneError> {
        let settings = file.settings()?;
        let has_angles = file.camera.normalise(settings.size)?;
        let table = file.animation.take();
        let (first, frames, rate) = match &table {
            Some(table) => {
                let frames = frames(table.frames)?;
                (first(table.first)?, frames, Rate::new(table.fps)?)
            }
            None => (1, 1, Rate::default()),
        };
        let last = first + i64::from(frames) - 1;
        let interpolation = table
            .as_ref()
            .map_or(Interpolation::Linear, |table| table.interpolation);
        let keyframes: &[KeyframeTable] = table.as_ref().map_or(&[], |table| &table.keyframe);
        check_order(keyframes, first, last)?;
        let orbit = table.as_ref().and_then(|table| table.orbit.as_ref());
        let orbit = orbit.map(|orbit| OrbitPath::new(orbit, first, last, interpolation));
        let orbit = orbit.transpose()?;

        let keys = Keyframes {
            keyframes,
            interpolation,
        };
        let position = keys.vectors("animation.keyframe.position", |keyframe| keyframe.position)?;
        if has_angles && (orbit.is_some() || !position.is_empty()) {
            return Err(SceneError::toml(
                "camera.radius, inclination and azimuth mean nothing where the animation moves the camera; remove them",
            ));
        }
        let position = camera_path(orbit, &position, file.camera.position(), interpolation)?;
        let focus = keys.vectors("animation.keyframe.focus", |keyframe| keyframe.focus)?;
        let up = keys.directions("animation.keyframe.up", |keyframe| keyframe.up)?;
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
        let fov = keys.named("animation.keyframe.fov", |keyframe| {
            keyframe.fov.map(|fov| [fov])
        })?;
        if !fov.is_empty() && file.camera.projection == Projection::Equirectangular {
            return Err(SceneError::toml(
                "animation.keyframe.fov has no meaning for an equirectangular picture, which shows the whole sphere; \
                 remove it from all keyframes",
            ));
        }
        let normal = keys.directions("animation.keyframe.normal", |keyframe| keyframe.normal)?;
        let focus_of_scene = validate::finite_vector("camera.focus", file.camera.focus)?;
        let disk = match &file.disk {
            Some(disk) => {
                let still = validate::finite_direction("disk.normal", disk.normal)?;
                Some(MovingDisk {
                    inner: disk.inner,
                    outer: disk.outer,
                    normal: normal.unwrap_or_else(|| Directions::still(still)),
                })
            }
            None if file.sky.is_none() => return Err(SceneError::Empty),
            None if normal.is_some() => {
                return Err(SceneError::toml(
                    "animation.keyframe.normal turns a disk, and the scene has none; add the table [disk], or remove \
                     the key from all keyframes",
                ));
            }
            None => None,
        };
        let animation = Self {
            first,
            frames,
            rate,
            position,
            focus: Track::or_still(&focus, focus_of_scene.to_array(), interpolation),
            up,
            fov: Track::or_still(&fov, [file.camera.fov.degrees()], interpolation),
            disk,
            settings,
            file: SceneFile {
                animation: table,
                ..file
            },
        };
        if let Some(disk) = &animation.disk {
            validate::edges(disk.inner, disk.outer)?;
        }
        if animation.is_still() {
            animation.first_frame()?;
        }
        Ok(animation)
    }

    /// The number of frames.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// The first frame's number.
    pub fn first(&self) -> i64 {
        self.first
    }

    /// The last frame's number.
    pub fn last(&self) -> i64 {
        self.first + i64::from(self.frames) - 1
    }

    /// The scene of the first frame.
    ///
    /// # Errors
    /// Those of [`Self::frame`].
    pub fn first_frame(&self) -> Result<Scene, SceneError> {
        self.frame(self.first)
    }

    /// The frame rate.
    pub fn rate(&self) -> Rate {
        self.rate
    }

    /// Whether the scene has no `[animation]`: it has one frame then.
    pub fn is_still(&self) -> bool {
        self.file.animation.is_none()
    }

    /// Whether anything moves. Without it all frames are equal.
    pub fn moves(&self) -> bool {
        self.frames > 1
            && self
                .file
                .animation
                .as_ref()
                .is_some_and(AnimationTable::moves)
    }

    /// Whether `camera.position` is given and has no effect, since keyframes set the position.
    pub fn ignores_position(&self) -> bool {
        let table = self.file.animation.as_ref();
        let is_set =
            table.is_some_and(|table| table.keyframe.iter().any(|key| key.position.is_some()));
        is_set && self.file.camera.position().is_some()
    }

    /// The scene of frame `number`.
    ///
    /// # Errors
    /// [`SceneError::NoFrame`] for a number outside [`Self::first`] to [`Self::last`]; [`SceneError::InFrame`] for a
    /// camera that is inside the horizon or the disk, or that looks nowhere.
    pub fn frame(&self, number: i64) -> Result<Scene, SceneError> {
        let (first, last) = (self.first, self.last());
        if !(first..=last).contains(&number) {
            return Err(SceneError::NoFrame {
                number,
                first,
                last,
            });
        }
        let time = number as f64;
        let CameraPlace {
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
            projection: self.file.camera.projection,
        };
        let disk = self.disk.as_ref().map(|disk| disk.at(time));
        let (light, sky) = (self.file.light(), self.file.sky.clone());
        let scene = Scene::at_radius(camera, radius, disk, light, sky, self.settings);
        match scene {
            Ok(scene) => Ok(scene.rolled(self.file.camera.roll)),
            Err(error) if self.is_still() => Err(error),
            Err(error) => Err(error.in_frame(number)),
        }
    }

    /// Checks frame `number`, and that the camera does not pass through the disk on its way to the next frame.
    ///
    /// # Errors
    /// Those of [`Self::frame`], and [`SceneError::InFrame`] for a camera that passes through the disk.
    pub fn check(&self, number: i64) -> Result<Scene, SceneError> {
        let scene = self.frame(number)?;
        let Some(disk) = &self.disk else {
            return Ok(scene);
        };
        let (mut before, mut after) = (number as f64, number as f64 + 1.0);
        let side = |time| cosine(self.position.at(time).position, disk.normal.at(time));
        let first = side(before);
        if number == self.last() || first * side(after) >= 0.0 {
            return Ok(scene);
        }
        for _ in 0..50 {
            let middle = 0.5 * (before + after);
            if first * side(middle) > 0.0 {
                before = middle;
            } else {
                after = middle;
            }
        }
        let CameraPlace {
            position, radius, ..
        } = self.position.at(after);
        if (disk.inner..=disk.outer).contains(&radius) {
            let reason = format!(
                "on the way to the next frame the camera passes through the disk's matter, at radius {radius:.6} \
                 between disk.inner = {:?} and disk.outer = {:?}; lead it past the disk",
                disk.inner, disk.outer
            );
            let error = SceneError::value("camera.position", position.to_array(), reason);
            return Err(error.in_frame(number));
        }
        Ok(scene)
    }

    /// The animation's TOML form, with every key that has a value. Two animations are the same if their forms are.
    pub fn to_toml(&self) -> String {
        self.file.to_string()
    }
}

/// Chooses the camera's path: an orbit, through keyframes, or at one place.
fn camera_path(
    orbit: Option<OrbitPath>,
    keyframes: &[(f64, [f64; 3])],
    place: Option<[f64; 3]>,
    interpolation: Interpolation,
) -> Result<Position, SceneError> {
    let problem = match (orbit, keyframes, place) {
        (Some(orbit), [], None) => return Ok(Position::Orbit(orbit)),
        (None, [_, ..], _) => return Position::new(keyframes, interpolation),
        (None, [], Some(position)) => return Position::still(position),
        (Some(_), [_, ..], _) => {
            "animation.orbit and keyframes both set the camera's position; remove one of them"
        }
        (Some(_), [], Some(_)) => {
            "camera.position means nothing beside animation.orbit, which moves the camera; remove one of them"
        }
        (None, [], None) => {
            "camera.position is missing; give it, or camera.radius, inclination and azimuth. Only an animation with \
             an orbit or with positions in its keyframes can leave it out"
        }
    };
    Err(SceneError::toml(problem))
}

/// Checks the number of frames.
fn frames(frames: i64) -> Result<u32, SceneError> {
    u32::try_from(frames)
        .ok()
        .filter(|count| (1..=MAX_FRAMES).contains(count))
        .ok_or_else(|| {
            let reason = format!("an animation has 1 to {MAX_FRAMES} frames");
            SceneError::value("animation.frames", frames, reason)
        })
}

/// Checks the number of the first frame.
fn first(first: i64) -> Result<i64, SceneError> {
    let reason = format!("the first frame's number is -{MAX_FIRST} to {MAX_FIRST}");
    let is_allowed = (-MAX_FIRST..=MAX_FIRST).contains(&first);
    SceneError::check(is_allowed, "animation.first", first, reason)?;
    Ok(first)
}

/// Checks that keyframes are in order and within the animation, and that each sets something.
fn check_order(keyframes: &[KeyframeTable], first: i64, last: i64) -> Result<(), SceneError> {
    let mut before = None;
    for keyframe in keyframes {
        let number = keyframe.frame;
        let wrong = |reason| SceneError::value("animation.keyframe.frame", number, reason);
        if !(first..=last).contains(&number) {
            return Err(wrong(format!("the animation has frames {first} to {last}")));
        }
        if let Some(before) = before.filter(|&before| number <= before) {
            let reason = format!("it must be above frame {before}, the keyframe before it");
            return Err(wrong(reason));
        }
        if keyframe.is_empty() {
            let error = "the keyframe sets nothing; give it a position, focus, up, fov or normal";
            return Err(SceneError::toml(error).in_frame(number));
        }
        before = Some(number);
    }
    Ok(())
}

/// The keyframes, and how values change between them.
struct Keyframes<'a> {
    keyframes: &'a [KeyframeTable],
    interpolation: Interpolation,
}

impl Keyframes<'_> {
    /// The values of a quantity in the keyframes that set it, with their times. `key` is its name in errors.
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
                    validate::finite(key, component).map_err(|error| error.in_frame(number))?;
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
        let checked = named.into_iter().map(|(time, value)| {
            let direction = validate::finite_direction(key, value);
            Ok((
                time,
                direction.map_err(|error| error.in_frame(time as i64))?,
            ))
        });
        let named: Vec<_> = checked.collect::<Result<_, SceneError>>()?;
        if named.is_empty() {
            return Ok(None);
        }
        Directions::new(key, &named, self.interpolation).map(Some)
    }
}

#[cfg(test)]
mod tests;
