//! **darkness** renders what a black hole does to the light of its accretion disk.

pub mod orbit;
pub mod output;
pub mod scene;
pub mod table;
