//! Colours of 8 or 16 bits, as a display shows them.

use core::marker::PhantomData;
use std::sync::LazyLock;

use super::{Averaging, Colours, Ink, Part, Quantities, Rows, Stretch};
use crate::light::DisplayTransform;
use crate::render::mixture::Mixture;
use crate::render::patch::{Patch, PatchFit};
use crate::render::shader::{PlaceRay, Shader};
use crate::render::tiles::TILE;

/// Nodes a side of a patch.
const NODES: usize = 7;

static FIT: LazyLock<PatchFit<NODES>> = LazyLock::new(PatchFit::new);

/// The last coefficients of an amplitude for colours of 8 bits. The amplitude itself is off by a fifth of it or less:
/// by 1/20 of a code where light rises with its tenth power.
const TOLERANCE: f64 = 1e-4;

/// A colour's code.
pub(in crate::render) trait Code: Copy + Default + Send + Sync + 'static {
    /// How many codes of 8 bits one of these is.
    const FINENESS: f64;

    /// The code of linear light.
    fn displayed(display: &DisplayTransform, light: [f32; 3]) -> [Self; 3];

    /// Sets the codes of amplitudes.
    fn set(pixels: &mut [[Self; 3]], colours: &Colours, amplitudes: &[f32]);
}

impl Code for u8 {
    const FINENESS: f64 = 1.0;

    #[inline(always)]
    fn displayed(display: &DisplayTransform, light: [f32; 3]) -> [Self; 3] {
        display.rgb8(light)
    }

    #[inline(always)]
    fn set(pixels: &mut [[Self; 3]], colours: &Colours, amplitudes: &[f32]) {
        for (pixel, y) in pixels.iter_mut().zip(amplitudes) {
            *pixel = colours.palette.rgb8(*y);
        }
    }
}

impl Code for u16 {
    const FINENESS: f64 = 1.0 / 200.0;

    #[inline(always)]
    fn displayed(display: &DisplayTransform, light: [f32; 3]) -> [Self; 3] {
        display.rgb16(light)
    }

    #[inline(always)]
    fn set(pixels: &mut [[Self; 3]], colours: &Colours, amplitudes: &[f32]) {
        for (pixel, y) in pixels.iter_mut().zip(amplitudes) {
            *pixel = colours.display.rgb16(colours.radiance.rgb(*y));
        }
    }
}

/// Colours as codes of a display.
pub(in crate::render) struct Display<'a, T> {
    colours: &'a Colours,
    averaging: Averaging,
    code: PhantomData<T>,
}

impl<'a, T> Display<'a, T> {
    pub(in crate::render) fn new(colours: &'a Colours, averaging: Averaging) -> Self {
        Self {
            colours,
            averaging,
            code: PhantomData,
        }
    }
}

impl<T: Code> Ink<NODES> for Display<'_, T> {
    type Band<'b> = Rows<'b, T>;

    fn clear(&self, band: &mut Self::Band<'_>, row: usize, (from, to): (usize, usize)) {
        band.colours(row, from, to).fill([T::default(); 3]);
    }

    fn put_light(&self, band: &mut Self::Band<'_>, row: usize, from: usize, light: &[[f32; 3]]) {
        let pixels = band.colours(row, from, from + light.len());
        for (pixel, light) in pixels.iter_mut().zip(light) {
            // Between stars there is nothing, and the band is clear.
            if *light != [0.0; 3] {
                *pixel = T::displayed(&self.colours.display, *light);
            }
        }
    }

    fn hand_over(&self, band: &mut Self::Band<'_>) {
        band.hand_over();
    }

    fn fit(&self) -> &PatchFit<NODES> {
        &FIT
    }

    fn quantities(&self) -> usize {
        usize::from(!self.colours.is_white)
    }

    fn tolerance(&self) -> f64 {
        TOLERANCE * T::FINENESS
    }

    #[inline(always)]
    fn evaluate(
        &self,
        shader: &Shader<'_>,
        _: u32,
        u: f64,
        ray: &PlaceRay,
        values: &mut Quantities,
    ) {
        values[0] = shader.amplitude(u, shader.lambda(ray));
    }

    fn put_stretch(
        &self,
        band: &mut Self::Band<'_>,
        _: &Shader<'_>,
        Stretch {
            row,
            from,
            to,
            place,
            ..
        }: Stretch,
        patch: &Patch<NODES>,
    ) {
        let pixels = band.colours(row, from, to);
        if self.colours.is_white {
            pixels.fill(T::displayed(&self.colours.display, [1.0; 3]));
            return;
        }
        let parts = self.colours.parts(patch, self.averaging);
        if parts > 1 {
            let light = self.colours.of_row((patch, 0), place, to - from, parts);
            for (pixel, light) in pixels.iter_mut().zip(light) {
                *pixel = T::displayed(&self.colours.display, light);
            }
            return;
        }
        let mut amplitudes = [0.0; TILE.0];
        let amplitudes = &mut amplitudes[..to - from];
        patch.row(0, place.1).fill(place.0, amplitudes);
        T::set(pixels, self.colours, amplitudes);
    }

    fn put_pixel(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        order: u32,
        pixel: (usize, usize),
        place: (f64, f64),
    ) {
        if self.averaging == Averaging::Square {
            let whole = [Part { order, share: 1.0 }];
            let mixture = Mixture::new(shader, place);
            self.put_mixture(band, pixel, &whole, &mixture, [0.0; 3]);
            return;
        }
        let ray = shader.ray(place);
        let u = shader.u_on_disk(order, &ray);
        let amplitude = shader.amplitude(u, shader.lambda(&ray));
        let (row, column) = pixel;
        let pixel = band.colours(row, column, column + 1);
        T::set(pixel, self.colours, &[amplitude as f32]);
    }

    fn put_mixture(
        &self,
        band: &mut Self::Band<'_>,
        (row, column): (usize, usize),
        parts: &[Part],
        mixture: &Mixture<'_>,
        beside: [f32; 3],
    ) {
        let light = self.colours.mixed(parts, mixture, beside);
        band.colours(row, column, column + 1)[0] = T::displayed(&self.colours.display, light);
    }
}
