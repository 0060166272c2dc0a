//! Paints the light of the sky into a band.

use std::sync::LazyLock;

use wide::f32x4;

use super::backdrop::Backdrop;
use super::shader::{SkyShader, outward, place_change};
use crate::render::patch::{Misfit, Patch, PatchFit};
use crate::render::shadow;
use crate::render::tiles::{Rectangle, Run, TILE, Tiled, paint_runs};
use crate::sky::place;

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

    /// Paints pixels of a band, which begins at row `top` of the picture and has `rows` rows: runs, sorted by rows.
    /// `light` holds the band's pixels, row by row.
    pub(super) fn paint(&self, (top, rows): (usize, usize), runs: &[Run], light: &mut [[f32; 3]]) {
        let width = self.shader.view.width() as usize;
        let mut tiles = SkyTiles {
            painter: self,
            top,
            width,
            light,
        };
        paint_runs(&mut tiles, width, rows, runs);
    }

    /// Returns the mean light of a pixel, its centre at a place of the picture. What the shadow covers is black.
    pub(super) fn pixel(&self, (x, y): (f64, f64)) -> [f32; 3] {
        let (view, curve) = (self.shader.view, self.shader.curve);
        let seen = 1.0 - shadow::share(view, curve.critical(), (x, y));
        if seen <= 0.0 {
            return [0.0; 3];
        }
        let ray = view.ray_at(view.x_at(x), view.y_at(y));
        let (across, down) = outward(view, ray, ray.transverse());
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
                [u as f32, v as f32],
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
        let whole = |parts: f64| parts.ceil().clamp(1.0, MOST_PARTS) as usize;
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
    top: usize,
    width: usize,
    light: &'m mut [[f32; 3]],
}

/// Pixels that are filtered side by side.
const LANES: usize = 4;

/// A row of places: one on either side more than a tile has columns, and those of unused lanes.
type Places = [[f32; TILE.0 + 2 + LANES]; 2];

impl Tiled<NODES> for SkyTiles<'_, '_, '_> {
    fn is_empty(&self, bounds: Rectangle) -> bool {
        self.painter.shader.is_in_shadow(bounds, self.top)
    }

    fn fit(&mut self, bounds: Rectangle, patch: &mut Patch<NODES>) -> Result<(), Misfit> {
        let shader = &self.painter.shader;
        let corners = bounds.centres(self.top);
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
        let (first, last) = bounds.columns;
        let count = last - first + 2;
        let fill = |row: f64, places: &mut Places| {
            for (quantity, places) in places.iter_mut().enumerate() {
                let row = patch.row(quantity, row + 0.5);
                row.fill(first as f64 - 0.5, &mut places[..count]);
            }
        };
        let top = (self.top + bounds.rows.0) as f64;
        // Three rows in turn: the one above, this one, the one below.
        let mut places: [Places; 3] = [[[0.5; TILE.0 + 2 + LANES]; 2]; 3];
        fill(top - 1.0, &mut places[0]);
        fill(top, &mut places[1]);
        let mut runs = bounds.clip(runs).peekable();
        for (i, row) in (bounds.rows.0..bounds.rows.1).enumerate() {
            fill((self.top + row + 1) as f64, &mut places[(i + 2) % 3]);
            let [above, here, below] = [0, 1, 2].map(|after| &places[(i + after) % 3]);
            while let Some((_, (from, to))) = runs.next_if(|(of_row, _)| *of_row == row) {
                let pixels = &mut self.light[row * self.width..][from..to];
                for (group, pixels) in pixels.chunks_mut(LANES).enumerate() {
                    // In the last group the lanes beyond the run are not used.
                    let i = from + LANES * group - first + 1;
                    let lanes = |row: &Places, q: usize, i: usize| {
                        f32x4::new(core::array::from_fn(|lane| row[q][i + lane]))
                    };
                    let place = [0, 1].map(|q| lanes(here, q, i));
                    let half = f32x4::splat(0.5);
                    let along_x =
                        [0, 1].map(|q| half * (lanes(here, q, i + 1) - lanes(here, q, i - 1)));
                    let along_y = [0, 1].map(|q| half * (lanes(below, q, i) - lanes(above, q, i)));
                    let means = self.painter.backdrop.means(place, along_x, along_y);
                    for (pixel, mean) in pixels.iter_mut().zip(means) {
                        *pixel = mean;
                    }
                }
            }
        }
    }

    fn put_pixel(&mut self, row: usize, column: usize) {
        let place = (column as f64 + 0.5, (self.top + row) as f64 + 0.5);
        self.light[row * self.width + column] = self.painter.pixel(place);
    }
}
