//! What is painted, into which memory: colours as bytes or words, or planes of data.

mod colours;
mod data;
mod directions;
mod display;
mod rows;

pub(super) use colours::{Averaging, Colours, SharedColours};
pub(super) use data::{Data, PlaneRows};
pub(super) use display::Display;
pub(super) use rows::Rows;

use super::mixture::Mixture;
use super::patch::{Patch, PatchFit};
use super::shader::{PlaceRay, Shader};
use super::sky::SkyShader;
use super::tiles::{Run, TileRow};
use crate::light::{Sight, flux};

/// The most quantities that are interpolated.
pub(super) const MOST_QUANTITIES: usize = 5;

/// Quantities, in the ink's order.
pub(super) type Quantities = [f64; MOST_QUANTITIES];

/// An order's share of a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) order: u32,
    pub(super) share: f32,
}

/// Pixels of one row of a band, side by side, that an order covers wholly.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub(super) order: u32,
    pub(super) row: usize,
    pub(super) from: usize,
    pub(super) to: usize,
    /// The centre of the first one, in pixels from the picture's left and its top.
    pub(super) place: (f64, f64),
}

/// Paints pixels of one kind. What is smooth over the picture is interpolated with N nodes a side.
pub(super) trait Ink<const N: usize>: Sync {
    /// The memory of a band of rows.
    type Band<'b>: Send;

    /// Fills pixels of a row, from one column to before another one, with what is seen where there is no disk.
    fn clear(&self, band: &mut Self::Band<'_>, row: usize, columns: (usize, usize));

    /// Paints the light of what is seen beside the disk, into pixels of a row from a column on.
    fn put_light(&self, band: &mut Self::Band<'_>, row: usize, from: usize, light: &[[f32; 3]]);

    /// Whether directions in the sky are among what is painted.
    fn needs_directions(&self) -> bool {
        false
    }

    /// Paints the directions in which the rays of pixels leave: of runs of a band.
    fn put_directions(
        &self,
        band: &mut Self::Band<'_>,
        sky: &SkyShader<'_>,
        place: TileRow,
        runs: &[Run],
    ) {
        let _ = (band, sky, place, runs);
    }

    /// Adds to a band what is seen beside the disk.
    fn finish(&self, band: &mut Self::Band<'_>, shader: &Shader<'_>, place: TileRow) {
        let _ = (band, shader, place);
    }

    /// Hands over the pixels of a finished band that are drawn.
    fn hand_over(&self, band: &mut Self::Band<'_>);

    /// What fits patches.
    fn fit(&self) -> &PatchFit<N>;

    /// How many quantities are interpolated, at most [`MOST_QUANTITIES`].
    fn quantities(&self) -> usize;

    /// How far they may be off, as a share of their size.
    fn tolerance(&self) -> f64;

    /// The quantity that is an angle, if there is one.
    fn angle(&self) -> Option<usize> {
        None
    }

    /// Computes the quantities of a ray that meets the disk at u.
    fn evaluate(
        &self,
        shader: &Shader<'_>,
        order: u32,
        u: f64,
        ray: &PlaceRay,
        values: &mut Quantities,
    );

    /// Paints a stretch from a patch.
    fn put_stretch(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        stretch: Stretch,
        patch: &Patch<N>,
    );

    /// Paints one pixel, wholly covered, with its centre at a place of the picture.
    fn put_pixel(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        order: u32,
        pixel: (usize, usize),
        place: (f64, f64),
    );

    /// Paints a pixel that is covered in part, with the light that is seen beside the disk.
    fn put_mixture(
        &self,
        band: &mut Self::Band<'_>,
        pixel: (usize, usize),
        parts: &[Part],
        mixture: &Mixture<'_>,
        beside: [f32; 3],
    );
}

/// The amplitude of what a ray sees.
pub(super) fn amplitude(sight: &Sight) -> f64 {
    sight.redshift * sight.redshift * flux::signed_root(sight.u)
}
