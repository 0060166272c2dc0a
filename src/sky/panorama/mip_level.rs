//! A panorama at one of its sizes.

use rayon::prelude::*;
use wide::{f32x4, i32x4};

/// A panorama at one of its sizes: linear light, three floats a texel, rows from the top.
#[derive(Debug)]
pub(super) struct MipLevel {
    height: usize,
    /// One float more than the texels have, so that four can be loaded from where any of them begins.
    values: Vec<f32>,
}

/// Adding and subtracting it rounds a number below 2²² to the nearest integer.
const ROUNDING: f32 = 12_582_912.0;

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

    /// Returns the sum of the bilinear values at four places, which [`each_at`](Self::each_at) describes.
    #[inline(always)]
    pub(super) fn sum_at(&self, x: f32x4, y: f32x4) -> f32x4 {
        let [a, b, c, d] = self.each_at::<4>(x, y);
        (a + b) + (c + d)
    }

    /// Returns the bilinear values at the first N of four places in texels: (0, 0) is the centre of the first texel, y
    /// grows downwards. Each is red, green, blue and a number without meaning.
    ///
    /// Columns wrap. A row beyond a pole comes back on the other side of the sky, half of the width further on. Places
    /// beyond 2²² have no precision left; they and NaN give some number or NaN.
    #[inline(always)]
    pub(super) fn each_at<const N: usize>(&self, x: f32x4, y: f32x4) -> [f32x4; N] {
        let (column, right) = cells(x);
        let (row, down) = cells(y);
        let (columns, rows) = (2 * self.height as i32, self.height as i32);
        // Negative where a texel or its neighbours lie outside.
        let inside =
            column | row | (i32x4::splat(columns - 2) - column) | (i32x4::splat(rows - 2) - row);
        let (right, down) = (right.to_array(), down.to_array());
        let mut values = [f32x4::ZERO; N];
        if inside.to_bitmask() == 0 {
            let stride = 3 * columns as usize;
            let starts = row * i32x4::splat(stride as i32) + (column + column + column);
            for (i, value) in values.iter_mut().enumerate() {
                let start = starts.to_array()[i] as u32 as usize;
                let both = &self.values[start..start + stride + 7];
                let texels = [0, 3, stride, stride + 3].map(|texel| four(both, texel));
                *value = bilinear(texels, right[i], down[i]);
            }
        } else {
            for (i, value) in values.iter_mut().enumerate() {
                let texels = self.texels_outside(column.to_array()[i], row.to_array()[i]);
                *value = bilinear(texels, right[i], down[i]);
            }
        }
        values
    }

    /// Returns for the first N of four places the mean of the bilinear values at the four places `± across` and
    /// `± down` from there, each at most half a texel.
    #[inline(always)]
    pub(super) fn each_about<const N: usize>(
        &self,
        x: f32x4,
        y: f32x4,
        across: f32x4,
        down: f32x4,
    ) -> [f32x4; N] {
        let half = f32x4::splat(0.5);
        // The texel before the one whose centre is nearest.
        let (column, right) = cells(x - half);
        let (row, below) = cells(y - half);
        let (columns, rows) = (2 * self.height as i32, self.height as i32);
        let inside =
            column | row | (i32x4::splat(columns - 3) - column) | (i32x4::splat(rows - 3) - row);
        let [left, middle, right] = three_weights(right - half, across);
        let [above, level, below] = three_weights(below - half, down);
        let weigh = |i: usize, rows: [[f32x4; 3]; 3]| {
            let lane = |weights: f32x4| f32x4::splat(weights.to_array()[i]);
            let (left, middle, right) = (lane(left), lane(middle), lane(right));
            let [upper, own, lower] = rows.map(|[a, b, c]| (left * a + middle * b) + right * c);
            (lane(above) * upper + lane(level) * own) + lane(below) * lower
        };
        let stride = 3 * columns as usize;
        let starts = row * i32x4::splat(stride as i32) + (column + column + column);
        let mut values = [f32x4::ZERO; N];
        if inside.to_bitmask() == 0 {
            for (i, value) in values.iter_mut().enumerate() {
                let start = starts.to_array()[i] as u32 as usize;
                let texels = &self.values[start..start + 2 * stride + 10];
                let rows = [0, stride, 2 * stride];
                let three = |row: usize| [row, row + 3, row + 6].map(|texel| four(texels, texel));
                *value = weigh(i, rows.map(three));
            }
        } else {
            for (i, value) in values.iter_mut().enumerate() {
                let (column, row) = (column.to_array()[i], row.to_array()[i]);
                *value = weigh(i, self.three_by_three_outside(column, row));
            }
        }
        values
    }

    /// Returns 3 × 3 texels, some of which may lie outside.
    #[cold]
    #[inline(never)]
    fn three_by_three_outside(&self, column: i32, row: i32) -> [[f32x4; 3]; 3] {
        [0, 1, 2].map(|down| [0, 1, 2].map(|right| self.texel(column, row, (right, down))))
    }

    /// Returns a texel, its right neighbour, and the two below them.
    #[cold]
    #[inline(never)]
    fn texels_outside(&self, column: i32, row: i32) -> [f32x4; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|offset| self.texel(column, row, offset))
    }

    /// Returns the texel to the right of another one and below it, wherever that is.
    fn texel(&self, column: i32, row: i32, (right, down): (i64, i64)) -> f32x4 {
        let (width, height) = (2 * self.height as i64, self.height as i64);
        let mut column = i64::from(column) + right;
        let mut row = (i64::from(row) + down).rem_euclid(2 * height);
        if row >= height {
            row = 2 * height - 1 - row;
            column += height;
        }
        let start = (3 * (row * width + column.rem_euclid(width))) as usize;
        four(&self.values, start)
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

/// Returns the integers below positions, and the distances from these, in [0, 1]. For an integer this may also be the
/// one below it and a distance of 1.
#[inline(always)]
fn cells(position: f32x4) -> (i32x4, f32x4) {
    let rounding = f32x4::splat(ROUNDING);
    let shifted = (position - f32x4::splat(0.5)) + rounding;
    let below: i32x4 = bytemuck::cast(shifted);
    (
        below - i32x4::splat(ROUNDING.to_bits() as i32),
        position - (shifted - rounding),
    )
}

/// Loads a texel and one value more.
#[inline(always)]
fn four(values: &[f32], start: usize) -> f32x4 {
    let four: [f32; 4] = values[start..start + 4].try_into().expect("four values");
    f32x4::new(four)
}

/// Returns the value between a texel, its right neighbour, and the two below them.
#[inline(always)]
fn bilinear([a, b, c, d]: [f32x4; 4], right: f32, down: f32) -> f32x4 {
    let (right, down) = (f32x4::splat(right), f32x4::splat(down));
    let upper = a + (b - a) * right;
    let lower = c + (d - c) * right;
    upper + (lower - upper) * down
}

/// Returns the weights of three neighbours in the mean of two linear interpolations, `spread` before and after a place
/// that is `off` from the middle one; both are at most ½.
#[inline(always)]
fn three_weights(off: f32x4, spread: f32x4) -> [f32x4; 3] {
    let (half, zero) = (f32x4::splat(0.5), f32x4::splat(0.0));
    let (first, last) = (off - spread, off + spread);
    let before = half * ((-first).max(zero) + (-last).max(zero));
    let after = half * (first.max(zero) + last.max(zero));
    [before, f32x4::splat(1.0) - before - after, after]
}

#[cfg(test)]
mod tests {
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
        let at =
            |x: f32, y: f32| level.each_at::<1>(f32x4::splat(x), f32x4::splat(y))[0].to_array()[0];
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
