//! What fills the sky: a panorama, and a grid before it.

use wide::f32x4;

use super::shader::SkyShader;
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
    pub(super) fn mean(&self, place: [f32; 2], along_x: [f32; 2], along_y: [f32; 2]) -> [f32; 3] {
        let light = self
            .panorama
            .map_or([0.0; 3], |panorama| panorama.mean(place, along_x, along_y));
        self.with_grid(light, place, along_x, along_y)
    }

    /// Returns four means.
    #[inline]
    pub(super) fn means(
        &self,
        place: [f32x4; 2],
        along_x: [f32x4; 2],
        along_y: [f32x4; 2],
    ) -> [[f32; 3]; 4] {
        let mut means = self.panorama.map_or([[0.0; 3]; 4], |panorama| {
            panorama.means(place, along_x, along_y)
        });
        if self.grid.is_some() {
            let pairs = [place, along_x, along_y].map(|pair| pair.map(f32x4::to_array));
            for (i, mean) in means.iter_mut().enumerate() {
                let [place, along_x, along_y] = pairs.map(|pair| pair.map(|lanes| lanes[i]));
                *mean = self.with_grid(*mean, place, along_x, along_y);
            }
        }
        means
    }

    /// Draws the grid over light.
    fn with_grid(
        &self,
        light: [f32; 3],
        place: [f32; 2],
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
