//! The sky: what a ray shows that neither meets the disk nor falls into the hole.

mod error;
pub mod grid;
mod orientation;
mod panorama;
mod source;
pub mod stars;

pub use error::{PanoramaProblem, SkyError};
pub use grid::Grid;
pub use orientation::{Orientation, direction, place};
pub use panorama::Panorama;
pub(crate) use panorama::{lattice, simd};
pub use source::{DEFAULT_MEMORY, SkySource};
pub use stars::{BadRows, Star, StarColours, StarField};
