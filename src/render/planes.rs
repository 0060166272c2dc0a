//! Frames of data: planes of numbers.

use crate::scene::{Layer, LayerSet};

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

/// The form in which a frame's pixels are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Those of [`Pixels::Grey8`].
    Grey8,
    /// Those of [`Pixels::Rgb8`].
    Rgb8,
    /// Those of [`Pixels::Grey16`].
    Grey16,
    /// Those of [`Pixels::Rgb16`].
    Rgb16,
    /// Those of [`Pixels::Planes`]: a plane for each layer, in the set's order.
    Layers(LayerSet),
}

impl Form {
    /// The bytes of a pixel.
    pub fn bytes(self) -> usize {
        match self {
            Self::Grey8 => 1,
            Self::Grey16 => 2,
            Self::Rgb8 => 3,
            Self::Rgb16 => 6,
            Self::Layers(layers) => {
                let channels: usize = layers.iter().map(Layer::channels).sum();
                channels * size_of::<f32>()
            }
        }
    }
}
