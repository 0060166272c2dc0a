//! **darkness** renders what a black hole does to the light of its accretion disk.

#[cfg(feature = "chart")]
pub mod chart;
#[cfg(feature = "cli")]
pub mod cli;
pub mod isoradial;
pub mod orbit;
pub mod output;
mod quotation;
pub mod render;
pub mod scene;
pub mod table;
