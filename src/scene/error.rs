//! Why a scene is refused.

use std::path::PathBuf;

use super::animation::MAX_FRAMES;
use super::builtin::builtins;
use super::validate::{
    FARTHEST_CAMERA, ISCO_RADIUS, MAX_IMAGE_SIDE, MAX_TOLERANCE, NARROWEST_FOV, WIDEST_DISK,
};

/// Why a scene is refused: what is wrong, what is allowed, and why.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The text is no scene: no TOML, or a key is missing, unknown or of the wrong type.
    #[error("{message}")]
    Toml {
        /// The parser's message with line and column.
        message: String,
    },
    /// A number is infinite or not a number.
    #[error("{key} holds {value:?}: every number of a scene must be finite, between keyframes too")]
    NotFinite {
        /// The key, with its table.
        key: &'static str,
        /// The number.
        value: f64,
    },
    /// Nothing says where the camera is.
    #[error(
        "camera.position is missing: it says where the camera is, unless [animation] has an orbit or keyframes with a position"
    )]
    NoPosition,
    /// An orbit and keyframes both say where the camera is.
    #[error(
        "animation.orbit says where the camera is, and keyframes with a position say it again: leave out one of them"
    )]
    OrbitAndPosition,
    /// The number of frames is not allowed.
    #[error(
        "animation.frames = {frames} is not allowed: an animation has 1 to {MAX_FRAMES} frames"
    )]
    Frames {
        /// What was asked for.
        frames: i64,
    },
    /// The frames' rate is not allowed.
    #[error(
        "animation.fps = {fps:?} is not allowed: it is from 0.001 to 1000 frames a second; 24 is the default"
    )]
    Fps {
        /// What was asked for.
        fps: f64,
    },
    /// A keyframe is none of the animation's frames.
    #[error("a keyframe has frame = {number}: the animation has frames 1 to {frames}")]
    KeyframeOutside {
        /// The keyframe's number.
        number: i64,
        /// How many frames there are.
        frames: u32,
    },
    /// Keyframes do not follow one another.
    #[error(
        "the keyframe at frame {number} comes after the one at frame {before}: each keyframe's frame must be above the one before"
    )]
    KeyframeOrder {
        /// The keyframe's number.
        number: i64,
        /// That of the keyframe before it in the file.
        before: i64,
    },
    /// A keyframe names nothing.
    #[error(
        "the keyframe at frame {number} says nothing: give it a position, focus, up, fov or normal"
    )]
    KeyframeEmpty {
        /// The keyframe's number.
        number: i64,
    },
    /// Something is wrong in a keyframe.
    #[error("the keyframe at frame {number}: {error}")]
    InKeyframe {
        /// The keyframe's number.
        number: i64,
        /// What is wrong.
        error: Box<SceneError>,
    },
    /// Between two directions there is no shortest way.
    #[error(
        "the keyframes at frames {first} and {second} have {key} in opposite directions, so that no way between them is the shortest: add a keyframe that says which way"
    )]
    Opposite {
        /// The key.
        key: &'static str,
        /// The earlier keyframe's number.
        first: u32,
        /// The later keyframe's number.
        second: u32,
    },
    /// Something is wrong at one frame.
    #[error("frame {number}: {error}")]
    InFrame {
        /// The frame's number.
        number: u32,
        /// What is wrong.
        error: Box<SceneError>,
    },
    /// The camera goes through the disk.
    #[error(
        "frame {number}: on the way to the next frame the camera goes through the disk's matter, at radius {radius:.6} (disk.inner = {inner:?}, disk.outer = {outer:?}): lead it past the disk"
    )]
    ThroughMatter {
        /// The last frame before.
        number: u32,
        /// The radius at which it does.
        radius: f64,
        /// The disk's inner edge.
        inner: f64,
        /// The disk's outer edge.
        outer: f64,
    },
    /// The animation has no such frame.
    #[error("there is no frame {number}: the frames are 1 to {frames}")]
    NoFrame {
        /// What was asked for.
        number: u32,
        /// How many frames there are.
        frames: u32,
    },
    /// A direction is the zero vector.
    #[error(
        "{key} is the zero vector, which points nowhere: give a direction, of any length but zero"
    )]
    ZeroDirection {
        /// The key, with its table.
        key: &'static str,
    },
    /// The camera stands at or inside the horizon.
    #[error(
        "camera.position is at radius {radius:?}, not outside the horizon: a camera can stand still only at a radius above 1 (the Schwarzschild radius)"
    )]
    InsideHorizon {
        /// The camera's radius.
        radius: f64,
    },
    /// The camera stands too far away.
    #[error(
        "camera.position is at radius {radius:?}: the farthest allowed is {FARTHEST_CAMERA:e}, since double precision knows a farther place only to a tenth of a Schwarzschild radius or worse"
    )]
    TooFar {
        /// The camera's radius.
        radius: f64,
    },
    /// The camera stands in the disk.
    #[error(
        "camera.position is in the disk's matter (in its plane, at radius {radius:?}, between disk.inner = {inner:?} and disk.outer = {outer:?}) and would see nothing else: move it off the plane or out of the disk"
    )]
    InMatter {
        /// The camera's radius.
        radius: f64,
        /// The disk's inner edge.
        inner: f64,
        /// The disk's outer edge.
        outer: f64,
    },
    /// The camera looks at the point where it stands.
    #[error(
        "camera.focus is camera.position, or cannot be told apart from it in double precision: the camera needs another point to look at"
    )]
    NoView,
    /// The picture's upward direction is not defined.
    #[error(
        "camera.up is parallel to the view from camera.position to camera.focus, so it says nothing of which way is up in the picture: give another direction"
    )]
    UpAlongView,
    /// The field of view is no angle that a flat picture can have.
    #[error(
        "camera.fov = {fov:?} is not allowed: a flat picture's vertical field of view is above 0 ({NARROWEST_FOV:e} at least) and below 180 degrees"
    )]
    Fov {
        /// The field of view, in degrees.
        fov: f64,
    },
    /// The disk reaches below the innermost stable circular orbit.
    #[error(
        "disk.inner = {inner:?} is below {ISCO_RADIUS:?}: no stable circular orbit exists inside 3 Schwarzschild radii (the ISCO), so no disk does"
    )]
    InnerBelowIsco {
        /// The inner edge's radius.
        inner: f64,
    },
    /// The disk has no width.
    #[error(
        "disk.outer = {outer:?} is not above disk.inner = {inner:?}: the disk lies between the two and needs a width"
    )]
    NoWidth {
        /// The inner edge's radius.
        inner: f64,
        /// The outer edge's radius.
        outer: f64,
    },
    /// The disk reaches too far.
    #[error(
        "disk.outer = {outer:?} is not allowed: at most {WIDEST_DISK:e}, since the squares of farther places leave double precision"
    )]
    TooWide {
        /// The outer edge's radius.
        outer: f64,
    },
    /// A side of the picture is not allowed.
    #[error(
        "{key} = {value} is not allowed: a picture's side has 1 to {MAX_IMAGE_SIDE} pixels, so that it fits common image formats"
    )]
    ImageSide {
        /// The key, with its table.
        key: &'static str,
        /// The number of pixels.
        value: i64,
    },
    /// The edges' tolerance is not allowed.
    #[error(
        "image.tolerance = {tolerance:?} is not allowed: it is what an edge may be off by, above 0 and at most {MAX_TOLERANCE} pixel; 0.001 is the default"
    )]
    Tolerance {
        /// What was asked for, in pixels.
        tolerance: f64,
    },
    /// Neither a built-in scene nor a file has that name.
    #[error(
        "{} is neither a built-in scene ({}) nor a file that exists: `darkness scene` describes the built-in ones, `darkness scene NAME` prints one to start from",
        path.display(),
        builtins().iter().map(super::Builtin::name).collect::<Vec<_>>().join(", ")
    )]
    Unknown {
        /// What was asked for.
        path: PathBuf,
    },
    /// A scene's file cannot be read.
    #[error("scene file {} cannot be read: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// A file holds no valid scene.
    #[error("scene file {}: {error}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong in it.
        error: Box<SceneError>,
    },
}
