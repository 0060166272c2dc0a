//! Scenes: the camera, the disk, the sky and the picture's size.
//!
//! A [`Scene`] is read from TOML ([`Scene::load`], [`Scene::from_toml`], [`Scene::builtin`]) or built from values
//! ([`Scene::new`], [`Scene::without_disk`]). It is checked: every number is finite, the camera is outside the horizon
//! and outside the disk's matter and looks somewhere, the disk's orbits are stable. A [`View`] is what a frame computes
//! with, one ray a pixel.
//!
//! ```toml
//! [camera]
//! position = [29.5442, 0.0, 5.2094]  # required; the hole is at the origin; 1 < r ≤ 1e15
//! # or, in its place: radius = 30.0, inclination = 80.0 (from +z), azimuth = 0.0 (from +x; default: 0), in degrees
//! focus    = [0.0, 0.0, 0.0]         # default: the hole
//! up       = [0.0, 0.0, 1.0]         # default: +z; beside angles, where the inclination falls
//! roll     = 0.0                     # default; degrees; positive turns the picture's content clockwise
//! projection = "perspective"         # default; "fisheye" or "equirectangular": see [`Projection`]
//! fov      = 30.0                    # default; vertical field of view, degrees, 0 < fov < 180
//! # or, in its place: fov_horizontal = 51.0
//!
//! [disk]
//! inner  = 3.0                       # default; ≥ 3, the innermost stable circular orbit
//! outer  = 12.0                      # default; > inner
//! normal = [0.0, 0.0, 1.0]           # default: +z
//!
//! [disk.light]                       # default: none, the picture is a mask
//! model = "blackbody"                # required; or "bolometric", grey: all wavelengths together
//! temperature = 7000.0               # of the hottest ring, kelvin; 100 to 1e9; required for black bodies only
//!
//! [sky]                              # default: none, black
//! panorama = "milky-way.exr"         # default: none; a picture of the whole sky: longitude and latitude
//! rotation = [0.0, 0.0, 0.0]         # default; yaw, pitch and roll, degrees: the sky is turned about z, y and x
//! exposure = 0.0                     # default; stops, of the panorama; -100 to 100
//! stars    = "bright-stars.csv"      # default: none; or { count = 20000, seed = 1 }: random ones, up to 10,000,000
//! magnitude_limit = 6.5              # default: none; fainter stars are left out
//! star_exposure = 0.0                # default; stops; at 0 a star of magnitude 0 has the irradiance 1
//! star_radius = 1e-6                 # default; the angular radius of a star, radians; 0 < radius ≤ 0.01
//! shift    = true                    # default; stars show the blue shift of a camera near the hole
//! grid     = 15.0                    # default: none; lines every so many degrees; 1 to 90, divides 180
//!
//! [image]
//! width  = 1920                      # default
//! height = 1080                      # default
//! antialias = true                   # default; false: each pixel is what its centre sees, 255 or 0
//! tolerance = 0.001                  # default; an edge's largest error, in pixels; 0 < tolerance ≤ 1
//! exposure = 0.0                     # default; stops: pictures show light times 2 to this power; -100 to 100
//! tone = "neutral"                   # default; highlights roll off towards white; "none": they are clipped
//! bits = 8                           # default; or 16, of a PNG picture's samples
//! layers = ["radius", "redshift"]    # default: none; the data in .exr and .npz files
//! crop = [640, 360, 320, 180]        # default: all; the part that is drawn: left, top, width, height, in pixels
//! ```
//!
//! A camera at radius r, inclination i and azimuth a is at `r (sin i cos a, sin i sin a, cos i)`. A roll turns it about
//! its viewing direction, right-handed about the backward axis as in most 3D programs: counterclockwise as seen from
//! behind the camera. An [`Override`] gives a key of a file another value.
//!
//! Lengths are in Schwarzschild radii. Directions have any length but zero. The layers are `coverage`, `order`,
//! `radius`, `azimuth`, `redshift`, `emission_cosine`, `temperature`, `colour`, `sky` and `sky_uv` ([`Layer`]);
//! `colour` needs `[disk.light]` or `[sky]`, `temperature` needs black bodies.
//!
//! A scene needs `[disk]` or `[sky]`, or both. An empty `[sky]` is a black one. Pictures of a scene with light or a sky
//! are in colour; before a sky, a disk without light is white. Names of files are relative to the folder of the scene's
//! file, or to the current folder where the scene comes from text. A key that means nothing without another, as
//! `exposure` without `panorama`, is an error.
//!
//! A moving scene has one more table, `[animation]`, which [`animation`] describes; as a [`Scene`] it is its first
//! frame. Light, sky, exposure and tone are those of the whole film.

mod angles;
pub mod animation;
mod builtin;
mod checked;
mod error;
mod file;
mod layers;
mod lens;
mod load;
mod navigator;
mod overrides;
mod projection;
mod sky;
mod validate;
mod values;
mod vector;
mod view;

pub use animation::Animation;
pub use builtin::{Builtin, DEFAULT_SCENE, builtins};
pub use checked::Scene;
pub use error::SceneError;
pub use layers::{Layer, LayerSet};
pub(crate) use lens::Direction;
pub use navigator::Navigator;
pub use overrides::Override;
pub use projection::Projection;
pub use sky::{DEFAULT_STAR_RADIUS, Sky, SkyFile, StarSource, Stars};
pub use validate::{
    FARTHEST_CAMERA, HORIZON_RADIUS, ISCO_RADIUS, MAX_EXPOSURE, MAX_GRID, MAX_IMAGE_SIDE,
    MAX_STAR_COUNT, MAX_STAR_RADIUS, MAX_TEMPERATURE, MAX_TOLERANCE, MIN_GRID, MIN_TEMPERATURE,
    NARROWEST_FOV, WIDEST_DISK,
};
pub use values::{Camera, DEFAULT_TOLERANCE, Disk, ImageSize, Light, Region, Tone};
pub use view::{PixelRay, View};
