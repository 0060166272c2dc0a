//! Light: what a ray that meets the disk shows.

pub mod flux;
mod sight;

pub use sight::Sight;
