//! A panorama at one of its sizes.

use rayon::prelude::*;
use wide::f32x4;

/// A panorama at one of its sizes: linear light, three floats a texel, rows from the top.
#[derive(Debug)]
pub(super) struct MipLevel {
    height: usize,
    /// One float more than the texels have, so that four can be loaded from where any of them begins.
    values: Vec<f32>,
}

/// Adding and subtracting it rounds a number below 2²² to the nearest integer.
const ROUNDING: f32 = 12_582_912.0;

/// Returns the integer below a position and the distance from it, in [0, 1]. An integer may be the end of the interval
/// below it.
#[inline(always)]
fn cell(position: f32) -> (i32, f32) {
    let shifted = (position - 0.5) + ROUNDING;
    let below = (shifted.to_bits() as i32).wrapping_sub(ROUNDING.to_bits() as i32);
    (below, position - (shifted - ROUNDING))
}

impl MipLevel {
    /// Takes `6 height²` values.
    pub(super) fn new(height: usize, mut values: Vec<f32>) -> Self {
        assert_eq!(values.len(), 6 * height * height);
        values.push(0.0);
        Self { height, values }
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    pub(super) fn width(&self) -> usize {
        2 * self.height
    }

    pub(super) fn bytes(&self) -> u64 {
        size_of_val(self.values.as_slice()) as u64
    }

    /// Returns the bilinear value at a place in texels, 0 at the centre of the first one; y grows downwards. The fourth
    /// value means nothing.
    #[inline(always)]
    pub(super) fn at(&self, x: f32, y: f32) -> f32x4 {
        let (column, right) = cell(x);
        let (row, down) = cell(y);
        let stride = 6 * self.height;
        let inside = (column as u32 as usize) < 2 * self.height - 1
            && (row as u32 as usize) < self.height - 1;
        let starts = if inside {
            let start = row as usize * stride + 3 * column as usize;
            [start, start + 3, start + stride, start + stride + 3]
        } else {
            self.wrapped(column, row)
        };
        let [a, b, c, d] = starts.map(|start| self.texel(start));
        let (right, down) = (f32x4::splat(right), f32x4::splat(down));
        let upper = a + (b - a) * right;
        let lower = c + (d - c) * right;
        upper + (lower - upper) * down
    }

    /// Sum.
    #[inline(always)]
    pub(super) fn line(&self, x: f32, y: f32, sx: f32, sy: f32, n: i32) -> f32x4 {
        let mut sum = f32x4::ZERO;
        for i in 0..n {
            let i = i as f32;
            sum += self.at(x + i * sx, y + i * sy);
        }
        sum
    }

    #[inline(always)]
    fn texel(&self, start: usize) -> f32x4 {
        let four: [f32; 4] = self.values[start..start + 4].try_into().expect("four");
        f32x4::new(four)
    }

    /// Returns where four neighbouring texels begin, of which some lie beyond an edge.
    #[cold]
    #[inline(never)]
    fn wrapped(&self, column: i32, row: i32) -> [usize; 4] {
        let start = |column: i64, row: i64| {
            let (height, width) = (self.height as i64, 2 * self.height as i64);
            let row = row.rem_euclid(2 * height);
            // Beyond a pole the rows come back on the other side of the sky.
            let (row, column) = if row < height {
                (row, column)
            } else {
                (2 * height - 1 - row, column + height)
            };
            (3 * (row * width + column.rem_euclid(width))) as usize
        };
        let (column, row) = (i64::from(column), i64::from(row));
        [
            start(column, row),
            start(column + 1, row),
            start(column, row + 1),
            start(column + 1, row + 1),
        ]
    }

    /// Returns the next smaller size; none below a height of 1.
    pub(super) fn halved(&self) -> Option<Self> {
        let height = self.height / 2;
        if height == 0 {
            return None;
        }
        let stride = 6 * self.height;
        let mut values = Vec::with_capacity(6 * height * height + 1);
        values.resize(6 * height * height, 0.0);
        values
            .par_chunks_mut(6 * height)
            .enumerate()
            .for_each(|(row, to)| {
                let rows = &self.values[2 * row * stride..][..2 * stride];
                let (upper, lower) = rows.split_at(stride);
                for (to, (a, b)) in to
                    .chunks_exact_mut(3)
                    .zip(upper.chunks_exact(6).zip(lower.chunks_exact(6)))
                {
                    for c in 0..3 {
                        to[c] = 0.25 * ((a[c] + a[c + 3]) + (b[c] + b[c + 3]));
                    }
                }
            });
        Some(Self::new(height, values))
    }
}
