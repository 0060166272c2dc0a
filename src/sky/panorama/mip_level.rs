//! A panorama at one of its sizes.

use fearless_simd::prelude::*;
use fearless_simd::{Select, f32x4, f32x8, i32x4};
use rayon::prelude::*;

/// A panorama at one of its sizes: linear light, three floats a texel, rows from the top.
#[derive(Debug)]
pub(super) struct MipLevel {
    height: usize,
    /// One float more than the texels have, so that four can be loaded from where any of them begins.
    values: Vec<f32>,
}

impl MipLevel {
    /// Returns the number of values that a level of this height keeps.
    pub(super) fn length(height: usize) -> usize {
        6 * height * height + 1
    }

    /// Takes the texels and one value more.
    pub(super) fn new(height: usize, values: Vec<f32>) -> Self {
        assert_eq!(values.len(), Self::length(height));
        Self { height, values }
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    /// Width and height.
    pub(super) fn size(&self) -> [f32; 2] {
        [2.0 * self.height as f32, self.height as f32]
    }

    /// Returns the bilinear values at the first N of four places in texels: (0, 0) is the centre of the texel in the
    /// `origin`'s column and row, y grows downwards. Each is the sum of two halves: red, green, blue and a number
    /// without meaning.
    ///
    /// Columns wrap. A row beyond a pole comes back on the other side of the sky, half of the width further on. Places
    /// beyond 2²² have no precision left; they and NaN give some number or NaN.
    #[inline(always)]
    pub(super) fn at<S: Simd, const N: usize>(
        &self,
        simd: S,
        (x, y): (f32x4<S>, f32x4<S>),
        origin: (i32, i32),
    ) -> [f32x8<S>; N] {
        let (column, right) = cells(x);
        let (row, down) = cells(y);
        let (columns, rows) = (2 * self.height as i32, self.height as i32);
        let column = column + origin.0;
        let column = column.simd_lt(0).select(column + columns, column);
        let column = column.simd_ge(columns).select(column - columns, column);
        let row = row + origin.1;
        // Negative where a texel or its neighbours lie outside.
        let outside = column | row | (columns - 2 - column) | (rows - 2 - row);
        let is_inside = outside.simd_ge(0).all_true();
        let stride = 3 * columns as usize;
        let starts = (row * (stride as i32) + column * 3).to_array();
        let (left, right, down) = ((1.0 - right).to_array(), right.to_array(), down.to_array());
        let mut values = [f32x8::splat(simd, 0.0); N];
        // Loops, since the closures of an array's own methods are not inlined.
        if is_inside {
            for (i, value) in values.iter_mut().enumerate() {
                let start = starts[i] as u32 as usize;
                let both = &self.values[start..start + stride + 7];
                let upper = pair(simd, &both[..4], &both[3..7]);
                let lower = pair(simd, &both[stride..stride + 4], &both[stride + 3..]);
                *value = between(simd, (upper, lower), (left[i], right[i], down[i]));
            }
        } else {
            let (column, row) = (column.to_array(), row.to_array());
            for (i, value) in values.iter_mut().enumerate() {
                let [a, b, c, d] = self.texels_outside(column[i], row[i]);
                let (upper, lower) = (pair(simd, &a, &b), pair(simd, &c, &d));
                *value = between(simd, (upper, lower), (left[i], right[i], down[i]));
            }
        }
        values
    }

    /// Returns a texel, its right neighbour, and the two below them.
    #[cold]
    #[inline(never)]
    fn texels_outside(&self, column: i32, row: i32) -> [[f32; 4]; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|offset| self.texel(column, row, offset))
    }

    /// Returns the texel to the right of another one and below it, wherever that is, and one value more.
    fn texel(&self, column: i32, row: i32, (right, down): (i64, i64)) -> [f32; 4] {
        let (width, height) = (2 * self.height as i64, self.height as i64);
        let mut column = i64::from(column) + right;
        let mut row = (i64::from(row) + down).rem_euclid(2 * height);
        if row >= height {
            row = 2 * height - 1 - row;
            column += height;
        }
        let start = (3 * (row * width + column.rem_euclid(width))) as usize;
        core::array::from_fn(|i| self.values[start + i])
    }

    /// Returns the next smaller level, of half the height, rounded down; none below a height of 1.
    ///
    /// A texel is the mean of the part of the picture that it covers. Where the height is odd, this part ends within
    /// texels, and these count by their covered part. So each level has the picture's mean.
    pub(super) fn halved(&self) -> Option<Self> {
        let height = self.height / 2;
        if height == 0 {
            return None;
        }
        let stride = 6 * height;
        let mut values = vec![0.0; Self::length(height)];
        values[..stride * height]
            .par_chunks_exact_mut(stride)
            .enumerate()
            .for_each(|(row, to)| {
                if self.height.is_multiple_of(2) {
                    self.mean_of_pairs(row, to);
                } else {
                    self.mean_of_parts(row, to);
                }
            });
        Some(Self::new(height, values))
    }

    /// Computes a row of the next level where its texels cover 2 × 2 of this one.
    fn mean_of_pairs(&self, row: usize, to: &mut [f32]) {
        let stride = 6 * self.height;
        let (upper, lower) = self.values[2 * row * stride..][..2 * stride].split_at(stride);
        let pairs = upper.chunks_exact(6).zip(lower.chunks_exact(6));
        for (to, (a, b)) in to.chunks_exact_mut(3).zip(pairs) {
            for c in 0..3 {
                to[c] = 0.25 * ((a[c] + a[c + 3]) + (b[c] + b[c + 3]));
            }
        }
    }

    /// Computes a row of the next level where its texels cover a little more than 2 × 2 of this one, 3 × 3 in part.
    fn mean_of_parts(&self, row: usize, to: &mut [f32]) {
        // In units of 1/n of this level's texels, n the next level's number of them, a new texel j begins at j N, and
        // N = 2n + p is odd (rows, p = 1) or twice that (columns, p = 2).
        let parts = |j: usize, n: usize, p: usize| {
            let first = 2 * j + j * p / n;
            let begin = (j * p) % n;
            let all = 2 * n + p;
            let (a, b) = (n - begin, n.min(all - (n - begin)));
            let weights = [a, b, all - a - b].map(|part| part as f32 / all as f32);
            (first, weights)
        };
        let n = self.height / 2;
        let (first_row, down) = parts(row, n, 1);
        for (column, to) in to.chunks_exact_mut(3).enumerate() {
            let (first_column, right) = parts(column, 2 * n, 2);
            for (c, to) in to.iter_mut().enumerate() {
                let mut sum = 0.0;
                for (j, &down) in down.iter().enumerate() {
                    for (i, &right) in right.iter().enumerate() {
                        // A part of size 0 may lie outside.
                        if down > 0.0 && right > 0.0 {
                            let texel = (first_row + j) * 2 * self.height + first_column + i;
                            sum += down * right * self.values[3 * texel + c];
                        }
                    }
                }
                *to = sum;
            }
        }
    }
}

/// Returns two texels, one in each half.
#[inline(always)]
fn pair<S: Simd>(simd: S, left: &[f32], right: &[f32]) -> f32x8<S> {
    f32x4::from_slice(simd, left).combine(f32x4::from_slice(simd, right))
}

/// Returns the halves of the value between two rows of two texels.
#[inline(always)]
fn between<S: Simd>(
    simd: S,
    (upper, lower): (f32x8<S>, f32x8<S>),
    (left, right, down): (f32, f32, f32),
) -> f32x8<S> {
    let share = f32x4::splat(simd, left).combine(f32x4::splat(simd, right));
    (upper + (lower - upper) * down) * share
}

/// Returns the integers below positions, and the distances from these.
#[inline(always)]
fn cells<S: Simd>(position: f32x4<S>) -> (i32x4<S>, f32x4<S>) {
    let below = position.floor();
    (below.to_int(), position - below)
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    /// A level whose texels are all different.
    fn level(height: usize) -> MipLevel {
        let values = (0..MipLevel::length(height)).map(|i| ((i * 7919) % 1009) as f32);
        MipLevel::new(height, values.collect())
    }

    /// Returns the mean of all texels' values of one colour.
    fn mean(level: &MipLevel, colour: usize) -> f64 {
        let texels = level
            .values
            .chunks_exact(3)
            .map(|texel| f64::from(texel[colour]));
        texels.sum::<f64>() / (2 * level.height * level.height) as f64
    }

    #[test]
    fn each_level_keeps_the_mean() {
        for height in [2, 3, 5, 31, 64, 255] {
            let first = level(height);
            let mut last = first.halved();
            while let Some(level) = last {
                for colour in 0..3 {
                    assert!((mean(&level, colour) / mean(&first, colour) - 1.0).abs() < 1e-6);
                }
                last = level.halved();
            }
        }
        assert!(level(1).halved().is_none());
    }

    #[test]
    fn an_odd_height_is_halved_by_parts() {
        // Six columns of three rows become two of one: each new texel covers 3 × 3.
        let mut values = vec![0.0; MipLevel::length(3)];
        for (texel, value) in values.chunks_exact_mut(3).enumerate() {
            value[0] = if texel % 6 < 3 { 1.0 } else { 4.0 };
        }
        let halved = MipLevel::new(3, values).halved().expect("a level");
        assert!((halved.values[0] - 1.0).abs() < 1e-6 && (halved.values[3] - 4.0).abs() < 1e-6);
    }

    #[test]
    fn values_at_and_between_texels() {
        let level = level(4);
        let texel = |column: usize, row: usize| level.values[3 * (8 * row + column)];
        let at = |x: f32, y: f32| {
            let simd = Level::baseline();
            dispatch!(simd, simd => {
                let place = (f32x4::splat(simd, x), f32x4::splat(simd, y));
                let [pair] = level.at::<_, 1>(simd, place, (0, 0));
                let (left, right) = pair.split();
                (left + right).to_array()[0]
            })
        };
        for (column, row) in [(0, 0), (7, 0), (7, 3), (3, 2)] {
            assert_eq!(at(column as f32, row as f32), texel(column, row));
        }
        assert_eq!(at(2.5, 1.0), 0.5 * (texel(2, 1) + texel(3, 1)));
        assert_eq!(at(2.0, 1.25), 0.75 * texel(2, 1) + 0.25 * texel(2, 2));
        // Beyond the left edge, and beyond a pole.
        assert_eq!(at(-0.5, 1.0), 0.5 * (texel(7, 1) + texel(0, 1)));
        assert_eq!(at(8.0, 1.0), texel(0, 1));
        assert_eq!(at(1.0, -1.0), texel(5, 0));
        assert_eq!(at(1.0, 4.0), texel(5, 3));
    }
}
