//! Scenes: the camera, the disk and the picture's size.
//!
//! A [`Scene`] is read from TOML ([`Scene::load`], [`Scene::from_toml`], [`Scene::builtin`]) or built from values
//! ([`Scene::new`]). It is checked: every number is finite, the camera is outside the horizon and outside the disk's
//! matter and looks somewhere, the disk's orbits are stable. A [`View`] is what a frame computes with, one ray a pixel.
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
//! tolerance = 0.001                  # default; an edge's largest error, in pixels; 0 < tolerance ≤ 1
//! ```
//!
//! Lengths are in Schwarzschild radii. Directions have any length but zero. A moving scene has one more table,
//! `[animation]`, which [`animation`] describes; as a [`Scene`] it is its first frame.

pub mod animation;
mod builtin;
mod checked;
mod error;
mod file;
mod layers;
mod load;
mod validate;
mod values;
mod vector;
mod view;

pub use animation::Animation;
pub use builtin::{Builtin, DEFAULT_SCENE, builtins};
pub use checked::Scene;
pub use error::SceneError;
pub use layers::{Layer, LayerSet};
pub use validate::{
    FARTHEST_CAMERA, HORIZON_RADIUS, ISCO_RADIUS, MAX_IMAGE_SIDE, MAX_TOLERANCE, NARROWEST_FOV,
    WIDEST_DISK,
};
pub use values::{Camera, DEFAULT_TOLERANCE, Disk, ImageSize, Light, Tone};
pub use view::{Affine, PixelRay, View};
