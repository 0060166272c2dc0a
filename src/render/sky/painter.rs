//! Paints the light of the sky into a band.

use std::sync::LazyLock;

use fearless_simd::{Simd, dispatch};

use super::backdrop::Backdrop;
use super::shader::{SkyShader, outward, place_change};
use crate::render::patch::{Misfit, Patch, PatchFit};
use crate::render::shadow;
use crate::render::tiles::{Rectangle, Run, TILE, TileRow, Tiled, paint_runs};
use crate::sky::lattice::{COLUMNS, LANES, PixelRow, PlaceRow};
use crate::sky::place;
use crate::sky::simd::level;

/// Nodes a side of a patch.
const NODES: usize = 7;

static FIT: LazyLock<PatchFit<NODES>> = LazyLock::new(PatchFit::new);

/// Pixels whose rays' swept angles differ by more than this are drawn one by one: the footprint bends within them.
const BENT: f64 = 0.25;

/// A pixel is cut into this many parts for each radian by which the swept angle changes within it.
const PARTS_PER_RADIAN: f64 = 3.0;

/// A pixel is cut into at most so many parts along one axis.
const MOST_PARTS: f64 = 6.0;

/// A place may be off by this share of a detail, and by this share of a footprint.
const OF_DETAIL: f64 = 0.004;
const OF_FOOTPRINT: f64 = 0.02;

/// Paints the sky of one view.
pub(super) struct SkyPainter<'a> {
    shader: SkyShader<'a>,
    backdrop: &'a Backdrop<'a>,
}

impl<'a> SkyPainter<'a> {
    /// The shader's directions come in the axes of the backdrop.
    pub(super) fn new(shader: SkyShader<'a>, backdrop: &'a Backdrop<'a>) -> Self {
        Self { shader, backdrop }
    }

    /// Paints pixels of a band: runs, sorted by rows. `light` holds the band's pixels, row by row.
    pub(super) fn paint(&self, band: TileRow, runs: &[Run], light: &mut [[f32; 3]]) {
        let mut tiles = SkyTiles {
            painter: self,
            band,
            light,
        };
        paint_runs(&mut tiles, band, runs);
    }

    /// Returns the mean light of a pixel, its centre at a place of the picture. What the shadow covers is black.
    pub(super) fn pixel(&self, (x, y): (f64, f64)) -> [f32; 3] {
        let (view, curve) = (self.shader.view, self.shader.curve);
        let seen = 1.0 - shadow::share(view, curve.critical(), (x, y));
        if seen <= 0.0 {
            return [0.0; 3];
        }
        let point = (view.x_at(x), view.y_at(y));
        let ray = view.ray_at(point.0, point.1);
        let (across, down) = outward(view, point, (ray, ray.transverse()));
        let length = (across * across + down * down).sqrt();
        let (across, down) = if length > 0.0 {
            (across / length, down / length)
        } else {
            (1.0, 0.0)
        };
        let (parts_out, parts_around) = self.parts((x, y), (across, down));
        let mean = |part: (f64, f64)| {
            let sight = self.shader.at(part)?;
            let footprint = self.shader.footprint(&sight);
            let out = footprint.along_x * across + footprint.along_y * down;
            let around = footprint.along_y * across - footprint.along_x * down;
            let (u, v) = place(sight.direction);
            Some(self.backdrop.mean(
                [u, v],
                place_change(sight.direction, out / parts_out as f64),
                place_change(sight.direction, around / parts_around as f64),
            ))
        };
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        let offset = |i: usize, parts: usize| (i as f64 + 0.5) / parts as f64 - 0.5;
        for i in 0..parts_out {
            let out = offset(i, parts_out);
            for j in 0..parts_around {
                let around = offset(j, parts_around);
                let Some(mean) = mean((
                    x + out * across - around * down,
                    y + out * down + around * across,
                )) else {
                    continue;
                };
                for (sum, c) in sum.iter_mut().zip(mean) {
                    *sum += c;
                }
                count += 1.0;
            }
        }
        if count == 0.0 {
            // The sky is seen in the corner farthest from the shadow alone.
            let corner = (x + 0.5_f64.copysign(across), y + 0.5_f64.copysign(down));
            (sum, count) = (mean(corner).unwrap_or_default(), 1.0);
        }
        let share = seen as f32 / count;
        sum.map(|c| c * share)
    }

    /// Returns into how many parts a pixel is cut, outwards from the hole (a unit vector in the picture) and around it.
    fn parts(&self, centre: (f64, f64), (across, down): (f64, f64)) -> (usize, usize) {
        let Some(sight) = self.shader.at(centre) else {
            return (MOST_PARTS as usize, 1);
        };
        // Less a little: where pixels are symmetric about the hole the number is whole, but for rounding.
        let whole = |parts: f64| (parts - 1e-6).ceil().clamp(1.0, MOST_PARTS) as usize;
        let swept = self.shader.swept_per_pixel(&sight);
        let parts_out = whole(PARTS_PER_RADIAN * swept);
        let footprint = self.shader.footprint(&sight);
        let out = footprint.along_x * across + footprint.along_y * down;
        let around = footprint.along_y * across - footprint.along_x * down;
        let size = (out.length() / parts_out as f64).max(around.length());
        let direction = sight.direction;
        let to_pole2 = direction.x * direction.x + direction.y * direction.y;
        let pole = whole(PARTS_PER_RADIAN * size / to_pole2.max(1e-300).sqrt());
        (parts_out.max(pole), pole)
    }
}

/// The sky, tile by tile.
struct SkyTiles<'p, 'a, 'm> {
    painter: &'p SkyPainter<'a>,
    band: TileRow,
    light: &'m mut [[f32; 3]],
}

impl Tiled<NODES> for SkyTiles<'_, '_, '_> {
    fn is_empty(&self, bounds: Rectangle) -> bool {
        self.painter.shader.is_in_shadow(bounds, self.band)
    }

    fn fit(&mut self, bounds: Rectangle, patch: &mut Patch<NODES>) -> Result<(), Misfit> {
        let shader = &self.painter.shader;
        bounds.check_angle(shader.view)?;
        let corners = bounds.centres(self.band);
        let middle = (
            0.5 * (corners.0.0 + corners.1.0),
            0.5 * (corners.0.1 + corners.1.1),
        );
        let sight = shader.at(middle).ok_or(Misfit::NoValue)?;
        let footprint = shader.footprint(&sight);
        let size = footprint.along_x.length().max(footprint.along_y.length());
        let detail = self.painter.backdrop.detail();
        let allowed = (OF_DETAIL * detail).min(OF_FOOTPRINT * size / core::f64::consts::TAU);
        let mut first = None;
        let evaluate = |at, values: &mut [f64; _]| {
            let Some(sight) = shader.at(at) else {
                return false;
            };
            if shader.swept_per_pixel(&sight) > BENT {
                return false;
            }
            let (u, v) = place(sight.direction);
            let first = *first.get_or_insert(u);
            values[0] = u - (u - first + 0.5).floor();
            values[1] = v;
            true
        };
        FIT.fit(patch, corners, 2, |_| allowed, evaluate)
    }

    fn put_patch(&mut self, bounds: Rectangle, runs: &[Run], patch: &Patch<NODES>) {
        dispatch!(level(), simd => self.put_rows(simd, bounds, runs, patch));
    }

    fn put_pixel(&mut self, row: usize, column: usize) {
        let place = self.band.centre(column, row);
        self.light[row * self.band.width + column] = self.painter.pixel(place);
    }
}

impl SkyTiles<'_, '_, '_> {
    /// Paints the runs within a rectangle from its patch.
    #[inline(always)]
    fn put_rows<S: Simd>(
        &mut self,
        simd: S,
        bounds: Rectangle,
        runs: &[Run],
        patch: &Patch<NODES>,
    ) {
        let (first, last) = bounds.columns;
        let columns = last - first;
        let left = (self.band.left + first) as f64;
        let origin = [patch.middle(0), patch.middle(1)];
        let (mut above, mut centres, mut below) = (NO_PLACES, NO_PLACES, NO_PLACES);
        let middle = (self.band.top + bounds.rows.0.midpoint(bounds.rows.1)) as f64;
        fill_places(patch, origin, (left, middle), &mut above, columns + 1);
        fill_places(patch, origin, (left, middle + 1.0), &mut below, columns + 1);
        let pixels = PixelRow {
            above: &above,
            centres: &centres,
            below: &below,
        };
        let mut filler = self.painter.backdrop.filler(origin, columns, &pixels);
        let mut means = [[0.0; 4]; COLUMNS + LANES];
        let mut done = None;
        let mut runs = bounds.clip(runs).peekable();
        while let Some(&(row, _)) = runs.peek() {
            let y = (self.band.top + row) as f64;
            let goes_on = done.is_some_and(|done| done + 1 == row);
            if goes_on {
                core::mem::swap(&mut above, &mut below);
            } else {
                fill_places(patch, origin, (left, y), &mut above, columns + 1);
            }
            fill_places(patch, origin, (left + 0.5, y + 0.5), &mut centres, columns);
            fill_places(patch, origin, (left, y + 1.0), &mut below, columns + 1);
            let pixels = PixelRow {
                above: &above,
                centres: &centres,
                below: &below,
            };
            filler.row(simd, &pixels, goes_on, &mut means);
            while let Some((_, (from, to))) = runs.next_if(|(of_row, _)| *of_row == row) {
                let light = &mut self.light[row * self.band.width..][from..to];
                for (light, mean) in light.iter_mut().zip(&means[from - first..]) {
                    *light = [mean[0], mean[1], mean[2]];
                }
            }
            done = Some(row);
        }
    }
}

/// A row of places that is to be filled.
const NO_PLACES: PlaceRow = [[0.0; COLUMNS + 1 + LANES]; 2];

/// A lattice is as wide as a tile.
const _: () = assert!(COLUMNS == TILE.0);

/// Computes places from one on, a pixel apart, less an origin.
#[inline(always)]
fn fill_places(
    patch: &Patch<NODES>,
    origin: [f64; 2],
    (x, y): (f64, f64),
    places: &mut PlaceRow,
    count: usize,
) {
    for (quantity, places) in places.iter_mut().enumerate() {
        let row = patch.row(quantity, y).less(origin[quantity]);
        row.fill(x, &mut places[..count]);
    }
}
