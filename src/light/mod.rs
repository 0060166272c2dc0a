//! Light: what a ray that meets the disk shows.

mod sight;

pub use sight::Sight;
