//! The means of a panorama over pixels that lie side by side.
//!
//! A pixel's value at its corner serves four pixels. So each takes its centre and its four corners for about two taps
//! instead of four:
//!
//! ```text
//! mean = (1 − 4 w) centre + w (the sum of the corners)
//! ```
//!
//! Corners lie at `± a/2 ± b/2`, and give the second moments `4 w J Jᵀ/4`. With `w = 1/12` these are the footprint's
//! `J Jᵀ/12`; what the [level](super::filter) gives is taken from it. Pixels whose footprints are long, and so would
//! need more taps, have the filter's means.

use fearless_simd::f32x4;
use fearless_simd::prelude::*;

use super::Panorama;
use super::filter::{Moments, Pair, folded, given_to_taps, scale};

/// The most columns of a lattice.
pub(crate) const COLUMNS: usize = 128;
/// Pixels that are computed side by side.
pub(crate) const LANES: usize = 4;
/// Columns of pixels that share a level.
const BLOCK: usize = 32;
const BLOCKS: usize = COLUMNS / BLOCK;

/// The greatest squared length of a footprint, in texels of its level: corners are then up to 2.1 texels apart.
const LONGEST: f32 = 9.0;
/// A level is taken from this share of the size on at which it has the footprint's second moments. It is then wider
/// than the footprint by 15 % at most, which changes a mean less than corners that are farther apart.
const EARLIER: f32 = 0.75;
/// A footprint is nearly a square where the squares of its axes differ by less than this share of their sum, squared.
const SQUARE: f32 = 0.25;

/// Places along a row, less an origin: u and v. There are more of them than columns, so that the last lanes have some.
pub(crate) type PlaceRow = [[f32; COLUMNS + 1 + LANES]; 2];

/// Colours along a row: red, green, blue and a number without meaning.
pub(crate) type ColourRow = [[f32; 4]; COLUMNS + LANES];

/// The places of a row of pixels: their upper corners, their centres, and their lower corners. Corner i is the left one
/// of pixel i.
pub(crate) struct PixelRow<'a> {
    pub(crate) above: &'a PlaceRow,
    pub(crate) centres: &'a PlaceRow,
    pub(crate) below: &'a PlaceRow,
}

/// Pixels side by side, row after row.
pub(crate) struct Lattice<'a> {
    panorama: &'a Panorama,
    /// Places are relative to it.
    origin: [f64; 2],
    columns: usize,
    blocks: [Block; BLOCKS],
    /// The colours at the last row's lower corners, block by block.
    above: [[[f32; 4]; BLOCK + LANES]; BLOCKS],
}

/// Columns that share a level.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    level: usize,
    /// Its pixels are long: each has taps of its own.
    is_long: bool,
    /// The last row's lower corners have colours.
    has_above: bool,
}

impl<'a> Lattice<'a> {
    /// A lattice of so many columns, with a row of its pixels from near its middle.
    pub(crate) fn new(
        panorama: &'a Panorama,
        origin: [f64; 2],
        columns: usize,
        middle: &PixelRow<'_>,
    ) -> Self {
        let mut blocks = [Block::default(); BLOCKS];
        for (i, block) in blocks[..columns.div_ceil(BLOCK)].iter_mut().enumerate() {
            let (from, to) = (BLOCK * i, columns.min(BLOCK * (i + 1)));
            let [a, b] = middle.sides(from.midpoint(to), panorama.size);
            *block = Block::of(a, b, panorama.levels());
        }
        Self {
            panorama,
            origin,
            columns,
            blocks,
            above: [[[0.0; 4]; BLOCK + LANES]; BLOCKS],
        }
    }

    /// Computes the means of a row of pixels. `goes_on` tells that it lies below the row before.
    #[inline(always)]
    pub(crate) fn row<S: Simd>(
        &mut self,
        simd: S,
        places: &PixelRow<'_>,
        goes_on: bool,
        means: &mut ColourRow,
    ) {
        for i in 0..self.columns.div_ceil(BLOCK) {
            let (from, to) = (BLOCK * i, self.columns.min(BLOCK * (i + 1)));
            self.blocks[i].has_above &= goes_on;
            self.row_of_block(simd, places, i, (from, to), means);
        }
    }

    #[inline(always)]
    fn row_of_block<S: Simd>(
        &mut self,
        simd: S,
        places: &PixelRow<'_>,
        i: usize,
        (from, to): (usize, usize),
        means: &mut ColourRow,
    ) {
        let block = self.blocks[i];
        if block.is_long {
            for at in (from..to).step_by(LANES) {
                self.long(simd, places, at, u32::MAX, means);
            }
            return;
        }
        let (mut weights, mut longer) = ([0.0; BLOCK], 0_u32);
        let most = f32x4::splat(simd, LONGEST * block.size2());
        let squareness = if block.level == 0 { f32::MAX } else { SQUARE };
        let scale = scale((block.level as i32).simd_into(simd));
        let mut has_weight = false;
        for at in (from..to).step_by(LANES) {
            let moments = places.moments(simd, at, self.panorama.size);
            let (trace, difference2) = (moments.xx + moments.yy, moments.difference2());
            let mean = 0.5 * trace;
            let left = (most - mean).max(0.0);
            let is_long =
                difference2.simd_gt(left * left) | difference2.simd_gt(squareness * mean * mean);
            let weight = given_to_taps(scale, trace) * (1.0 / 12.0);
            has_weight |= weight.simd_gt(0.0).any_true();
            weight.store_slice(&mut weights[at - from..][..LANES]);
            longer |= (is_long.to_bitmask() as u32) << (at - from);
        }
        self.sample(simd, block, places.centres, (from, to), &mut means[from..]);
        if has_weight {
            if !block.has_above {
                let mut above = [[0.0; 4]; BLOCK + LANES];
                self.sample(simd, block, places.above, (from, to + 1), &mut above);
                self.above[i] = above;
            }
            let mut below = [[0.0; 4]; BLOCK + LANES];
            self.sample(simd, block, places.below, (from, to + 1), &mut below);
            let above = &self.above[i];
            for (i, (mean, weight)) in means[from..to].iter_mut().zip(weights).enumerate() {
                let upper = colour(simd, &above[i]) + colour(simd, &above[i + 1]);
                let lower = colour(simd, &below[i]) + colour(simd, &below[i + 1]);
                let centre = colour(simd, mean) * (1.0 - 4.0 * weight);
                *mean = (centre + (upper + lower) * weight).to_array();
            }
            self.above[i] = below;
        }
        self.blocks[i].has_above = has_weight;
        while longer != 0 {
            let group = longer.trailing_zeros() as usize / LANES;
            let lanes = longer >> (LANES * group) & 15;
            longer &= !(15 << (LANES * group));
            self.long(simd, places, from + LANES * group, lanes, means);
        }
    }

    /// Computes the values at places of a row.
    #[inline(always)]
    fn sample<S: Simd>(
        &self,
        simd: S,
        block: Block,
        places: &PlaceRow,
        (from, to): (usize, usize),
        values: &mut [[f32; 4]],
    ) {
        let level = &self.panorama.levels[block.level];
        let size = level.size();
        let x = self.origin[0] * f64::from(size[0]) - 0.5;
        let y = (1.0 - self.origin[1]) * f64::from(size[1]) - 0.5;
        let (column, row) = (x.floor(), y.floor());
        let (right, down) = ((x - column) as f32, (y - row) as f32);
        let [u, v] = places;
        for (at, values) in (from..to)
            .step_by(LANES)
            .zip(values.chunks_exact_mut(LANES))
        {
            let x = four(simd, u, at) * size[0] + right;
            let y = down - four(simd, v, at) * size[1];
            let pairs = level.at::<S, LANES>(simd, (x, y), (column as i32, row as i32));
            for (value, pair) in values.iter_mut().zip(pairs) {
                *value = folded(pair);
            }
        }
    }

    /// Computes the means of some of the pixels from one on, each with taps of its own.
    #[inline(always)]
    fn long<S: Simd>(
        &self,
        simd: S,
        places: &PixelRow<'_>,
        at: usize,
        lanes: u32,
        means: &mut ColourRow,
    ) {
        let found: [[f32; 4]; LANES] = simd.vectorize(
            #[inline(always)]
            || {
                let [a, b] = places.sides_of(simd, at, [1.0; 2]);
                let u = four(simd, &places.centres[0], at) + self.origin[0] as f32;
                let v = four(simd, &places.centres[1], at) + self.origin[1] as f32;
                self.panorama.means(simd, [u, v], a, b, lanes)
            },
        );
        for (i, mean) in found.into_iter().enumerate() {
            if lanes >> i & 1 == 1 {
                means[at + i] = mean;
            }
        }
    }
}

impl Block {
    /// The block whose middle pixel has these sides, in texels; there are so many levels.
    fn of(a: [f32; 2], b: [f32; 2], levels: usize) -> Self {
        let (xx, yy) = (a[0] * a[0] + b[0] * b[0], a[1] * a[1] + b[1] * b[1]);
        let xy = a[0] * a[1] + b[0] * b[1];
        let (mean, difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let radius = (difference * difference + xy * xy).sqrt();
        let minor = (mean - radius).max(0.0);
        let mut block = Self::default();
        while block.level + 1 < levels && minor / 3.0 + 1.0 >= EARLIER * 4.0 * block.size2() {
            block.level += 1;
        }
        let is_square = block.level == 0 || radius * radius <= SQUARE * mean * mean;
        block.is_long = !is_square || mean + radius > LONGEST * block.size2();
        block
    }

    /// The square of a texel's size, in texels of the first level.
    fn size2(self) -> f32 {
        (1_u64 << (2 * self.level)) as f32
    }
}

impl PixelRow<'_> {
    /// Returns the sides of a pixel's footprint, times a size: its changes of place to the right and down.
    pub(crate) fn sides(&self, at: usize, size: [f32; 2]) -> [[f32; 2]; 2] {
        let corner = |row: &PlaceRow, i: usize| [row[0][at + i], row[1][at + i]];
        let (a, b) = (corner(self.above, 0), corner(self.above, 1));
        let (c, d) = (corner(self.below, 0), corner(self.below, 1));
        let along =
            |of: fn([f32; 4]) -> f32| [0, 1].map(|i| 0.5 * size[i] * of([a[i], b[i], c[i], d[i]]));
        [
            along(|[a, b, c, d]| (b - a) + (d - c)),
            along(|[a, b, c, d]| (c - a) + (d - b)),
        ]
    }

    /// Returns the sides of four pixels.
    #[inline(always)]
    fn sides_of<S: Simd>(&self, simd: S, at: usize, size: [f32; 2]) -> [Pair<S>; 2] {
        let (ax, bx) = self.side(simd, at, 0, size[0]);
        let (ay, by) = self.side(simd, at, 1, size[1]);
        [[ax, ay], [bx, by]]
    }

    /// Returns one component of the sides of four pixels.
    #[inline(always)]
    fn side<S: Simd>(&self, simd: S, at: usize, i: usize, size: f32) -> (f32x4<S>, f32x4<S>) {
        let (a, b) = (
            four(simd, &self.above[i], at),
            four(simd, &self.above[i], at + 1),
        );
        let (c, d) = (
            four(simd, &self.below[i], at),
            four(simd, &self.below[i], at + 1),
        );
        let half = 0.5 * size;
        (((b - a) + (d - c)) * half, ((c - a) + (d - b)) * half)
    }

    /// Returns the moments of four pixels' footprints, times a size.
    #[inline(always)]
    fn moments<S: Simd>(&self, simd: S, at: usize, size: [f32; 2]) -> Moments<S> {
        let [a, b] = self.sides_of(simd, at, size);
        Moments::of(a, b)
    }
}

/// Returns four numbers of a row.
#[inline(always)]
fn four<S: Simd>(simd: S, row: &[f32], at: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &row[at..at + LANES])
}

/// Returns a colour.
#[inline(always)]
fn colour<S: Simd>(simd: S, colour: &[f32; 4]) -> f32x4<S> {
    f32x4::load_array_ref(simd, colour)
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::super::simd::level;
    use super::*;

    /// Rows of a map that turns by `angle` and has pixels of `size` texels, wider by `stretch` in one direction.
    struct Map {
        size: f32,
        stretch: f32,
        angle: f32,
    }

    impl Map {
        fn row(&self, height: f32, (x, y): (f32, f32)) -> PlaceRow {
            let (sine, cosine) = (libm::sinf(self.angle), libm::cosf(self.angle));
            let at = |i: usize| {
                let (x, y) = (self.stretch * self.size * (x + i as f32), self.size * y);
                [
                    (cosine * x - sine * y) / (2.0 * height),
                    (sine * x + cosine * y) / height,
                ]
            };
            [0, 1].map(|q| core::array::from_fn(|i| at(i)[q]))
        }

        /// Returns the means of some rows of 100 pixels.
        fn means(&self, level: Level, panorama: &Panorama, rows: usize) -> Vec<ColourRow> {
            let height = panorama.height() as f32;
            let rows_of = |y: f32| {
                [(0.0, y), (0.5, y + 0.5), (0.0, y + 1.0)].map(|place| self.row(height, place))
            };
            let [above, centres, below] = rows_of(0.0);
            let middle = PixelRow {
                above: &above,
                centres: &centres,
                below: &below,
            };
            let mut lattice = Lattice::new(panorama, ORIGIN, 100, &middle);
            let mut found = Vec::new();
            for row in 0..rows {
                let [above, centres, below] = rows_of(row as f32);
                let places = PixelRow {
                    above: &above,
                    centres: &centres,
                    below: &below,
                };
                let mut means = [[0.0; 4]; COLUMNS + LANES];
                dispatch!(level, simd => lattice.row(simd, &places, row > 0, &mut means));
                found.push(means);
            }
            found
        }
    }

    const ORIGIN: [f64; 2] = [0.98, 0.4];

    fn textured(height: usize) -> Panorama {
        let value = |i: usize| ((i * 7919) % 1009) as f32 / 1009.0;
        Panorama::from_linear(height, (0..6 * height * height).map(value).collect())
    }

    /// Maps of all kinds: magnified, about a texel, nearly squares of many, and long.
    fn maps() -> impl Iterator<Item = Map> {
        let sizes = [0.01, 0.7, 1.1, 1.9, 2.8, 5.0, 17.0];
        sizes.into_iter().flat_map(|size| {
            [(1.0, 0.0), (1.2, 0.7), (2.5, 1.9), (9.0, 0.4)].map(|(stretch, angle)| Map {
                size,
                stretch,
                angle,
            })
        })
    }

    #[test]
    fn all_instructions_give_the_same_bits() {
        let panorama = textured(256);
        for map in maps() {
            let [best, least] =
                [level(), Level::baseline()].map(|level| map.means(level, &panorama, 3));
            for (best, least) in best.iter().zip(&least) {
                for (best, least) in best[..100].iter().zip(&least[..100]) {
                    assert_eq!(best[..3], least[..3]);
                }
            }
        }
    }

    #[test]
    fn rows_that_go_on_are_those_computed_alone() {
        let panorama = textured(256);
        let height = panorama.height() as f32;
        for map in maps() {
            let rows = map.means(level(), &panorama, 3);
            let of = |place| map.row(height, place);
            let (above, centres, below) = (of((0.0, 2.0)), of((0.5, 2.5)), of((0.0, 3.0)));
            let places = PixelRow {
                above: &above,
                centres: &centres,
                below: &below,
            };
            let [above, centres, below] = [(0.0, 0.0), (0.5, 0.5), (0.0, 1.0)].map(of);
            let middle = PixelRow {
                above: &above,
                centres: &centres,
                below: &below,
            };
            let mut lattice = Lattice::new(&panorama, ORIGIN, 100, &middle);
            let mut means = [[0.0; 4]; COLUMNS + LANES];
            dispatch!(level(), simd => lattice.row(simd, &places, false, &mut means));
            for (alone, last) in means[..100].iter().zip(&rows[2][..100]) {
                assert_eq!(alone[..3], last[..3]);
            }
        }
    }

    #[test]
    fn a_uniform_panorama_has_uniform_means() {
        let panorama = Panorama::from_linear(300, vec![0.3; 6 * 300 * 300]);
        for map in maps() {
            for means in map.means(level(), &panorama, 2) {
                let worst = means[..100].iter().flat_map(|mean| &mean[..3]);
                assert!(worst.fold(0.0_f32, |worst, c| worst.max((c - 0.3).abs())) < 3e-7);
            }
        }
    }

    /// A pattern whose variation a kernel dampens by what its second moments tell.
    #[test]
    fn pixels_have_the_second_moments_of_their_footprints() {
        let height = 512;
        // A wave of 60 texels along a row, between ½ and 1½.
        let value = |i: usize| {
            let x = ((i / 3) % (2 * height)) as f64 * core::f64::consts::TAU / 64.0;
            (1.0 + 0.5 * libm::cos(x)) as f32
        };
        let panorama = Panorama::from_linear(height, (0..6 * height * height).map(value).collect());
        for (size, stretch) in [
            (1.317, 1.0),
            (1.937, 1.0),
            (2.311, 1.0),
            (3.313, 1.0),
            (5.459, 1.0),
            (1.937, 1.5),
        ] {
            let map = Map {
                size,
                stretch,
                angle: 0.0,
            };
            let means = map.means(level(), &panorama, 2);
            let length = f64::from(size * stretch);
            let k = core::f64::consts::TAU / 64.0;
            // A box of this length over bilinear texels, to the second moment.
            let wanted = 0.5 * (1.0 - k * k * (length * length / 12.0 + 1.0 / 6.0) / 2.0);
            let (mut sum, mut of_one) = (0.0, 0.0);
            for (i, mean) in means[1][..100].iter().enumerate() {
                let x = ORIGIN[0] * 2.0 * height as f64 - 0.5 + length * (i as f64 + 0.5);
                let wave = libm::cos(k * x);
                sum += (f64::from(mean[0]) - 1.0) * wave;
                of_one += wave * wave;
            }
            let found = sum / of_one;
            assert!(
                (found - wanted).abs() < 1e-4,
                "{size} {stretch}: {found}, not {wanted}"
            );
        }
    }
}
