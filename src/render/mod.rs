//! Frames: white where a pixel's centre sees the disk at any order, black elsewhere.

pub mod mask;
pub mod pixelwise;
pub mod png;
