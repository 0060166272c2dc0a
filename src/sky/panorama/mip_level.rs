//! A panorama at one of its sizes.

use rayon::prelude::*;
use wide::{f32x4, i32x4};

/// A panorama at one of its sizes: linear light, three floats a texel, rows from the top.
#[derive(Debug)]
pub(super) struct MipLevel {
    height: usize,
    stride: usize,
    last_column: u32,
    last_row: u32,
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

#[inline(always)]
fn four(v: &[f32; 7], from: usize) -> f32x4 {
    f32x4::new(v[from..from + 4].try_into().expect("four"))
}

#[inline(always)]
fn blend([a, b, c, d]: [f32x4; 4], right: f32, down: f32) -> f32x4 {
    let (right, down) = (f32x4::splat(right), f32x4::splat(down));
    let upper = a + (b - a) * right;
    let lower = c + (d - c) * right;
    upper + (lower - upper) * down
}

#[inline(always)]
fn cells(position: f32x4) -> (i32x4, f32x4) {
    let shifted = (position - f32x4::splat(0.5)) + f32x4::splat(ROUNDING);
    let below: i32x4 = bytemuck::cast(shifted);
    (below - i32x4::splat(ROUNDING.to_bits() as i32), position - (shifted - f32x4::splat(ROUNDING)))
}

impl MipLevel {
    /// Takes `6 height²` values.
    pub(super) fn new(height: usize, mut values: Vec<f32>) -> Self {
        assert_eq!(values.len(), 6 * height * height);
        values.push(0.0);
        Self { height, stride: 6 * height, last_column: 2 * height as u32 - 1, last_row: height as u32 - 1, values }
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
        let (right, down) = (f32x4::splat(right), f32x4::splat(down));
        let stride = self.stride;
        let start = (row as u32 as usize).wrapping_mul(stride).wrapping_add(3 * (column as u32 as usize));
        let inside = (column as u32) < self.last_column && (row as u32) < self.last_row;
        let [a, b, c, d] = if inside && let Some(window) = self.values.get(start..start + stride + 7) {
            let (top, bottom) = (window.first_chunk::<7>().expect("7"), window.last_chunk::<7>().expect("7"));
            [four(top, 0), four(top, 3), four(bottom, 0), four(bottom, 3)]
        } else {
            self.wrapped(column, row).map(|start| self.texel(start))
        };
        let upper = a + (b - a) * right;
        let lower = c + (d - c) * right;
        upper + (lower - upper) * down
    }

    /// Four.
    #[inline(always)]
    pub(super) fn each_at(&self, x: f32x4, y: f32x4) -> [f32x4; 4] {
        let (column, right) = cells(x);
        let (row, down) = cells(y);
        let (w, h) = (self.last_column as i32 - 1, self.last_row as i32 - 1);
        let outside = column | row | (i32x4::splat(w) - column) | (i32x4::splat(h) - row);
        let (right, down) = (right.to_array(), down.to_array());
        if outside.to_bitmask() == 0 {
            let starts = (row * i32x4::splat(self.stride as i32) + (column + column + column)).to_array();
            std::array::from_fn(|i| {
                let start = starts[i] as u32 as usize;
                if let Some(window) = self.values.get(start..start + self.stride + 7) {
                    let (top, bottom) = (window.first_chunk::<7>().expect("7"), window.last_chunk::<7>().expect("7"));
                    blend([four(top, 0), four(top, 3), four(bottom, 0), four(bottom, 3)], right[i], down[i])
                } else {
                    f32x4::ZERO
                }
            })
        } else {
            let (column, row) = (column.to_array(), row.to_array());
            std::array::from_fn(|i| {
                blend(self.wrapped(column[i], row[i]).map(|start| self.texel(start)), right[i], down[i])
            })
        }
    }

    /// Sum.
    #[inline(always)]
    pub(super) fn line(&self, x: f32, y: f32, sx: f32, sy: f32, n: i32) -> f32x4 {
        let mut sum = f32x4::ZERO;
        let mut i = 0;
        while i + 4 <= n {
            let k = f32x4::new([0.0, 1.0, 2.0, 3.0]) + f32x4::splat(i as f32);
            let [a, b, c, d] = self.each_at(f32x4::splat(x) + k * f32x4::splat(sx), f32x4::splat(y) + k * f32x4::splat(sy));
            sum += (a + b) + (c + d);
            i += 4;
        }
        while i < n {
            let k = i as f32;
            sum += self.at(x + k * sx, y + k * sy);
            i += 1;
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
        values.par_chunks_mut(6 * height).enumerate().for_each(|(row, to)| {
            let rows = &self.values[2 * row * stride..][..2 * stride];
            let (upper, lower) = rows.split_at(stride);
            for (to, (a, b)) in to.chunks_exact_mut(3).zip(upper.chunks_exact(6).zip(lower.chunks_exact(6))) {
                for c in 0..3 {
                    to[c] = 0.25 * ((a[c] + a[c + 3]) + (b[c] + b[c + 3]));
                }
            }
        });
        Some(Self::new(height, values))
    }
}
