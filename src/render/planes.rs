//! Frames of data: planes of numbers.

use super::error::{RenderError, check_buffer, make_room};
use crate::scene::{Layer, LayerSet, Scene, View};

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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// Those of [`Pixels::Grey8`].
    #[default]
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
    /// Whether it shows more of a scene's disk than where it is: its light, or data of the rays that meet it. Before a
    /// sky a disk without light is white everywhere.
    pub fn needs_map(self, scene: &Scene) -> bool {
        match self {
            Self::Grey8 | Self::Grey16 => false,
            Self::Rgb8 | Self::Rgb16 => scene.light().is_some(),
            Self::Layers(layers) => layers.iter().any(|layer| match layer {
                Layer::Coverage | Layer::Order | Layer::Sky | Layer::SkyUv | Layer::Alpha => false,
                Layer::Colour => scene.light().is_some(),
                Layer::Radius
                | Layer::Azimuth
                | Layer::Redshift
                | Layer::EmissionCosine
                | Layer::Temperature => true,
            }),
        }
    }

    /// Whether it shows a scene's sky, or data of it.
    pub fn needs_escape(self, scene: &Scene) -> bool {
        self.shows_directions() || (self.shows_light() && scene.sky().is_some())
    }

    /// Whether it shows the directions in which rays leave.
    pub fn shows_directions(self) -> bool {
        matches!(self, Self::Layers(layers) if layers.has(Layer::Sky) || layers.has(Layer::SkyUv))
    }

    /// Whether it shows light.
    pub fn shows_light(self) -> bool {
        match self {
            Self::Grey8 | Self::Grey16 => false,
            Self::Rgb8 | Self::Rgb16 => true,
            Self::Layers(layers) => layers.has(Layer::Colour),
        }
    }

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

/// The memory of a frame in one form. It is reused: a frame like the one before allocates nothing.
#[derive(Debug, Default)]
pub struct FrameMemory {
    form: Form,
    bytes: Vec<u8>,
    words: Vec<u16>,
    planes: Vec<Plane>,
}

impl FrameMemory {
    /// Memory for frames of a form.
    pub fn new(form: Form) -> Self {
        Self {
            form,
            ..Self::default()
        }
    }

    /// The form of its frames.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Returns the planes of the frame that was drawn last.
    pub fn into_planes(self) -> Vec<Plane> {
        self.planes
    }

    /// The frame that was drawn last.
    pub fn pixels(&self) -> Pixels<'_> {
        match self.form {
            Form::Grey8 => Pixels::Grey8(&self.bytes),
            Form::Rgb8 => Pixels::Rgb8(&self.bytes),
            Form::Grey16 => Pixels::Grey16(&self.words),
            Form::Rgb16 => Pixels::Rgb16(&self.words),
            Form::Layers(_) => Pixels::Planes(&self.planes),
        }
    }

    /// Makes room for a frame of a view. Old content may stay.
    ///
    /// # Errors
    /// [`RenderError::Memory`]
    pub(super) fn target(&mut self, view: &View) -> Result<Target<'_>, RenderError> {
        let width = view.region().width as usize;
        Ok(match self.form {
            Form::Grey8 => {
                make_room(view, 1, &mut self.bytes)?;
                Target::Grey8(&mut self.bytes, width)
            }
            Form::Rgb8 => {
                make_room(view, 3, &mut self.bytes)?;
                Target::Rgb8(&mut self.bytes, 3 * width)
            }
            Form::Grey16 => {
                make_room(view, 1, &mut self.words)?;
                Target::Grey16(&mut self.words, width)
            }
            Form::Rgb16 => {
                make_room(view, 3, &mut self.words)?;
                Target::Rgb16(&mut self.words, 3 * width)
            }
            Form::Layers(layers) => {
                if !layers
                    .iter()
                    .eq(self.planes.iter().map(|plane| plane.layer))
                {
                    let values = Vec::new;
                    let plane = |layer| Plane {
                        layer,
                        values: values(),
                    };
                    self.planes = layers.iter().map(plane).collect();
                }
                for plane in &mut self.planes {
                    make_room(view, plane.layer.channels(), &mut plane.values)?;
                }
                Target::Planes(&mut self.planes, layers)
            }
        })
    }
}

/// Where a frame goes: samples, and how far apart its rows are.
#[derive(Debug)]
pub(super) enum Target<'a> {
    Grey8(&'a mut [u8], usize),
    Rgb8(&'a mut [u8], usize),
    Grey16(&'a mut [u16], usize),
    Rgb16(&'a mut [u16], usize),
    Planes(&'a mut [Plane], LayerSet),
}

impl Target<'_> {
    /// Checks that the frame of a view fits.
    ///
    /// # Errors
    /// [`RenderError::Buffer`]
    pub(super) fn check(&self, view: &View) -> Result<(), RenderError> {
        match self {
            Self::Grey8(samples, stride) => check_buffer(view, 1, samples, *stride),
            Self::Rgb8(samples, stride) => check_buffer(view, 3, samples, *stride),
            Self::Grey16(samples, stride) => check_buffer(view, 1, samples, *stride),
            Self::Rgb16(samples, stride) => check_buffer(view, 3, samples, *stride),
            Self::Planes(..) => Ok(0),
        }
        .map(|_| ())
    }
}
