//! Light: what a ray that meets the disk shows.

mod redshift;
mod sight;

pub use redshift::{AngularMomentum, SightGeometry, emission_cosine, redshift};
pub use sight::Sight;
