//! What fills the sky: a panorama, and a grid before it.

use fearless_simd::Simd;

use super::shader::SkyShader;
use crate::sky::lattice::{ColourRow, Lattice, PixelRow};
use crate::sky::{Grid, Panorama, SkySource};

/// What fills the sky of one frame.
pub(in crate::render) struct Backdrop<'a> {
    panorama: Option<&'a Panorama>,
    grid: Option<Grid>,
}

/// The size of a detail of a grid, as a share of a turn.
const GRID_DETAIL: f64 = 1e-4;

impl<'a> Backdrop<'a> {
    /// What a source has; `None` where that is nothing.
    pub(super) fn new(source: &'a SkySource, shader: &SkyShader<'_>) -> Option<Self> {
        let outward = shader.axes()[0];
        let grid = source.grid().map(|step| Grid::new(step, outward, -outward));
        let backdrop = Self {
            panorama: source.panorama(),
            grid,
        };
        (backdrop.panorama.is_some() || backdrop.grid.is_some()).then_some(backdrop)
    }

    /// The size of its details, as a share of a turn.
    pub(super) fn detail(&self) -> f64 {
        match self.panorama {
            Some(panorama) => 1.0 / panorama.width() as f64,
            None => GRID_DETAIL,
        }
    }

    /// Returns the mean light over a parallelogram about a place.
    pub(super) fn mean(&self, place: [f64; 2], along_x: [f32; 2], along_y: [f32; 2]) -> [f32; 3] {
        let light = self.panorama.map_or([0.0; 3], |panorama| {
            panorama.mean(place.map(|c| c as f32), along_x, along_y)
        });
        self.with_grid(light, place, along_x, along_y)
    }

    /// Returns what computes the means of pixels side by side, as a [`Lattice`] does.
    pub(super) fn filler(
        &self,
        origin: [f64; 2],
        columns: usize,
        middle: &PixelRow<'_>,
    ) -> Filler<'_> {
        let lattice = |panorama| Lattice::new(panorama, origin, columns, middle);
        Filler {
            backdrop: self,
            origin,
            columns,
            lattice: self.panorama.map(lattice),
        }
    }

    /// Draws the grid over light.
    fn with_grid(
        &self,
        light: [f32; 3],
        place: [f64; 2],
        along_x: [f32; 2],
        along_y: [f32; 2],
    ) -> [f32; 3] {
        let Some(grid) = &self.grid else {
            return light;
        };
        let [red, green, blue, opacity] = grid.mean(place, along_x, along_y);
        let over = |grid: f32, light: f32| grid + (1.0 - opacity) * light;
        [
            over(red, light[0]),
            over(green, light[1]),
            over(blue, light[2]),
        ]
    }
}

/// Computes the mean light of pixels side by side, row after row.
pub(super) struct Filler<'a> {
    backdrop: &'a Backdrop<'a>,
    origin: [f64; 2],
    columns: usize,
    lattice: Option<Lattice<'a>>,
}

impl Filler<'_> {
    /// Computes the means of a row of pixels. `goes_on` tells that it lies below the row before.
    #[inline(always)]
    pub(super) fn row<S: Simd>(
        &mut self,
        simd: S,
        places: &PixelRow<'_>,
        goes_on: bool,
        means: &mut ColourRow,
    ) {
        match &mut self.lattice {
            Some(lattice) => lattice.row(simd, places, goes_on, means),
            None => means[..self.columns].fill([0.0; 4]),
        }
        if self.backdrop.grid.is_none() {
            return;
        }
        for (i, mean) in means[..self.columns].iter_mut().enumerate() {
            let [along_x, along_y] = places.sides(i, [1.0; 2]);
            let place = [0, 1].map(|q| self.origin[q] + f64::from(places.centres[q][i]));
            let [red, green, blue, _] = *mean;
            let light = self
                .backdrop
                .with_grid([red, green, blue], place, along_x, along_y);
            *mean = [light[0], light[1], light[2], 0.0];
        }
    }
}
