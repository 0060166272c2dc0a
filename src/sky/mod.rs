//! The sky: what a ray that escapes sees.

mod error;
mod orientation;
mod panorama;

pub use error::{PanoramaProblem, SkyError};
pub use orientation::{Orientation, direction, place};
pub use panorama::Panorama;
