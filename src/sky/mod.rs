//! The sky: what a ray that escapes sees.

mod orientation;
mod panorama;

pub use orientation::{Orientation, direction, place};
pub use panorama::Panorama;
