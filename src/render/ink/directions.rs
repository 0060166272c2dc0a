//! Layers of directions in the sky.

use std::sync::LazyLock;

use super::PlaneRows;
use crate::render::patch::{Misfit, Patch, PatchFit};
use crate::render::sky::{SkyShader, SkySight};
use crate::render::tiles::{Rectangle, Run, TILE, TileRow, Tiled, paint_runs};
use crate::scene::Layer;
use crate::sky::place;

/// Nodes a side of a patch.
const NODES: usize = 9;

static FIT: LazyLock<PatchFit<NODES>> = LazyLock::new(PatchFit::new);

/// How far a direction's component, or a place, may be off: a fraction of a float's last unit.
const TOLERANCE: f64 = 1e-8;

/// Paints the directions of runs of a band.
pub(super) fn paint_directions(
    band: &mut PlaneRows<'_>,
    sky: &SkyShader<'_>,
    place: TileRow,
    runs: &[Run],
) {
    let mut tiles = DirectionTiles { place, sky, band };
    paint_runs(&mut tiles, place, runs);
}

/// Directions, tile by tile.
struct DirectionTiles<'s, 'b, 'm> {
    place: TileRow,
    sky: &'s SkyShader<'s>,
    band: &'m mut PlaneRows<'b>,
}

/// The components of the direction in the scene's axes, and its place.
fn quantities(sky: &SkyShader<'_>, sight: &SkySight) -> [f64; 5] {
    let [x, y, z] = sky.in_scene(sight.direction).to_array();
    let (u, v) = place(sight.direction);
    [x, y, z, u, v]
}

/// Sets the pixels of the layers from a column on, by their values.
fn set(
    band: &mut PlaneRows<'_>,
    first: usize,
    count: usize,
    mut values: impl FnMut(usize, &mut [f32]),
) {
    let mut row = [0.0; TILE.0];
    let row = &mut row[..count];
    for (layer, plane) in band.iter() {
        let quantities = match layer {
            Layer::Sky => 0..3,
            Layer::SkyUv => 3..5,
            _ => continue,
        };
        let channels = layer.channels();
        for (channel, quantity) in quantities.enumerate() {
            values(quantity, row);
            let pixels = plane[first * channels..].chunks_exact_mut(channels);
            for (pixel, value) in pixels.zip(&*row) {
                pixel[channel] = *value;
            }
        }
    }
}

/// Sets one pixel of the layers.
pub(super) fn set_direction(
    band: &mut PlaneRows<'_>,
    pixel: usize,
    sky: &SkyShader<'_>,
    sight: &SkySight,
) {
    let values = quantities(sky, sight);
    set(band, pixel, 1, |quantity, value| {
        value[0] = values[quantity] as f32;
    });
}

/// A longitude as a float within 0 and 1.
fn wrapped(u: f32) -> f32 {
    let u = u - u.floor();
    if u < 1.0 { u } else { 0.0 }
}

impl Tiled<NODES> for DirectionTiles<'_, '_, '_> {
    fn is_empty(&self, bounds: Rectangle) -> bool {
        self.sky.is_in_shadow(bounds, self.place)
    }

    fn fit(&mut self, bounds: Rectangle, patch: &mut Patch<NODES>) -> Result<(), Misfit> {
        let sky = self.sky;
        bounds.check_angle(sky.view())?;
        let mut first = None;
        let evaluate = |at, values: &mut [f64; _]| {
            let Some(sight) = sky.at(at) else {
                return false;
            };
            *values = quantities(sky, &sight);
            let first = *first.get_or_insert(values[3]);
            values[3] -= (values[3] - first + 0.5).floor();
            true
        };
        let corners = bounds.centres(self.place);
        FIT.fit(patch, corners, 5, |_| TOLERANCE, evaluate)
    }

    fn put_patch(&mut self, bounds: Rectangle, runs: &[Run], patch: &Patch<NODES>) {
        for (row, (from, to)) in bounds.clip(runs) {
            let (x, y) = self.place.centre(from, row);
            let first = row * self.place.width + from;
            set(self.band, first, to - from, |quantity, values| {
                patch.row(quantity, y).fill(x, values);
                if quantity == 3 {
                    for u in values {
                        *u = wrapped(*u);
                    }
                }
            });
        }
    }

    fn put_pixel(&mut self, row: usize, column: usize) {
        if let Some(sight) = self.sky.at(self.place.centre(column, row)) {
            let pixel = row * self.place.width + column;
            set_direction(self.band, pixel, self.sky, &sight);
        }
    }
}
