//! Frames of data: planes of numbers.

use crate::scene::Layer;

/// One layer of a frame: [`Layer::channels`] numbers for each pixel, side by side, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// What the numbers are.
    pub layer: Layer,
    /// The numbers.
    pub values: Vec<f32>,
}

/// A frame's pixels, row by row from the top, in the form that a file holds.
#[derive(Debug, Clone, Copy)]
pub enum Pixels<'a> {
    /// One byte a pixel.
    Grey8(&'a [u8]),
    /// Red, green and blue, one byte each.
    Rgb8(&'a [u8]),
    /// One number a pixel, 0 to 65535.
    Grey16(&'a [u16]),
    /// Red, green and blue, 0 to 65535.
    Rgb16(&'a [u16]),
    /// Layers of data.
    Planes(&'a [Plane]),
}
