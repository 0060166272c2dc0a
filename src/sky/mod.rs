//! The sky: what a ray shows that neither meets the disk nor falls into the hole.

pub mod grid;
pub mod stars;
