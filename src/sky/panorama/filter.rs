//! The mean of a panorama over a pixel's footprint.
//!
//! A footprint is a parallelogram in texels, J its matrix. The filter adds equal taps, each a bilinear value of one
//! level, that have the footprint's second moments `J Jᵀ/12`. Of these, the level itself gives a part: against a
//! bilinear value of the first level, one of level l is wider by the moments `(4ˡ − 1)/4` in all directions, in texels
//! of the first level (¼ = 1/12 of the box that made the texels + 1/6 of the interpolation). The taps give the rest:
//! `M = (J Jᵀ/12 + ¼)/4ˡ − ¼` in texels of the level, which is 0 for a square footprint of √3 texels there, and the
//! level is the smallest one whose M is nowhere negative. So the filter's width has no jumps where the level changes.
//!
//! * Up to about one texel one tap does.
//! * A footprint of up to two texels, or nearly a square, takes four taps at `± a ± b`, along its own sides.
//! * A longer one takes a row of taps, or two rows, along the longer axis of M: at most 32 taps.
//!
//! A [lattice](super::lattice) of pixels shares its taps, and needs this filter for long footprints alone.

use fearless_simd::prelude::*;
use fearless_simd::{Select, dispatch, f32x4, f32x8, i32x4, mask32x4};

use super::Panorama;
use super::simd::level;

/// Up to this sum of a footprint's two sides' squares, in texels, one tap does: a square of 0.87 texels.
pub(super) const ONE_TAP: f32 = 1.5;
/// From this sum on the taps have the footprint's second moments, and before it a growing part of them, so that no edge
/// shows where one tap ends: a square of 1.22 texels.
pub(super) const FULL_WIDTH: f32 = 3.0;
/// Up to this sum four taps do, whatever the footprint's shape: a square of two texels.
const FOUR_TAPS: f32 = 8.0;
/// Nearly a square: the squares of the axes differ by less than this share of their sum, squared.
const SQUARE: f32 = 0.02;
/// Of this length, in texels of the level and squared, a footprint takes two rows of taps.
const TWO_ROWS: f32 = 1.0;
/// Taps per texel along a footprint.
const DENSITY: f32 = 0.65;
/// The most groups of four taps.
const MOST_GROUPS: i32 = 8;
/// The longest footprint in texels of its level. The taps are then two texels apart in one row, four in each of two.
const LONGEST: f32 = 64.0;

/// A place, or a change of it from one pixel to the next: u and v, four pixels side by side.
pub(super) type Pair<S> = [f32x4<S>; 2];

/// Footprints, one a lane, in texels of the first level.
struct Footprints<S: Simd> {
    /// The two sides; the second component grows upwards.
    a: Pair<S>,
    b: Pair<S>,
    moments: Moments<S>,
    /// How much narrower a texel is than high, squared: about cos² of the latitude.
    narrow: f32x4<S>,
}

/// J Jᵀ of footprints.
pub(super) struct Moments<S: Simd> {
    pub(super) xx: f32x4<S>,
    pub(super) yy: f32x4<S>,
    pub(super) xy: f32x4<S>,
}

/// Where the taps of footprints are, one a lane, in texels of the level; the second component grows downwards.
struct Taps<S: Simd> {
    level: i32x4<S>,
    /// From one tap to the next along the footprint.
    along: Pair<S>,
    /// From the middle to each of two rows.
    across: Pair<S>,
    two_rows: mask32x4<S>,
    /// The number of groups of four taps.
    groups: i32x4<S>,
}

impl Panorama {
    /// Returns the mean over the parallelogram `place + s along_x + t along_y`, s and t in [−½, ½], of the bilinear
    /// texels: red, green and blue.
    ///
    /// A place is `(u, v)` as in [`place`](crate::sky::place), and texel i of a row has its centre at
    /// `u = (i + ½)/width`. u wraps, and beyond v = 0 or 1 the sky goes on across the pole, at u + ½. With |u| and |v|
    /// up to 10 the place is right to 0.02 texels of the largest panoramas; numbers that are not finite give some
    /// colour or NaN.
    ///
    /// Against the exact mean the error is 0.4 % of full scale (rms) for noise whose amplitude falls as 1/frequency. A
    /// uniform panorama gives its colour to 1e-6.
    pub fn mean(&self, place: [f32; 2], along_x: [f32; 2], along_y: [f32; 2]) -> [f32; 3] {
        dispatch!(level(), simd => self.mean_with(simd, [place, along_x, along_y]))
    }

    #[inline(always)]
    fn mean_with<S: Simd>(&self, simd: S, pairs: [[f32; 2]; 3]) -> [f32; 3] {
        let [[u, v], [ax, ay], [bx, by]] = pairs;
        let place = [f32x4::splat(simd, u), f32x4::splat(simd, v)];
        let along_x = [f32x4::splat(simd, ax), f32x4::splat(simd, ay)];
        let along_y = [f32x4::splat(simd, bx), f32x4::splat(simd, by)];
        let [mean] = self.means(simd, place, along_x, along_y, 1);
        [mean[0], mean[1], mean[2]]
    }

    /// Returns the means of the first N lanes, those whose bits are set in `lanes`: red, green, blue and a number
    /// without meaning.
    #[inline(always)]
    pub(super) fn means<S: Simd, const N: usize>(
        &self,
        simd: S,
        [u, v]: Pair<S>,
        along_x: Pair<S>,
        along_y: Pair<S>,
        lanes: u32,
    ) -> [[f32; 4]; N] {
        let [width, height] = self.size;
        let a = [along_x[0] * width, along_x[1] * height];
        let b = [along_y[0] * width, along_y[1] * height];
        // cos(latitude) = sin(πv), by a parabola.
        let cos = 4.0 * v * (1.0 - v);
        let footprints = Footprints {
            a,
            b,
            moments: Moments::of(a, b),
            // Beyond a pole it is not, and taps are as far apart as anywhere.
            narrow: (cos * cos).min(1.0),
        };
        let Moments { xx, yy, .. } = footprints.moments;
        let one = (xx + yy).simd_le(ONE_TAP).to_bitmask() as u32;
        let (taps, compact) = self.compact_taps(simd, &footprints);
        let taps = if compact.all_true() {
            taps
        } else {
            taps.or_where_not(compact, &self.long_taps(simd, &footprints))
        };
        let (u, up) = (u.to_array(), v.to_array());
        let (levels, groups) = (taps.level.to_array(), taps.groups.to_array());
        let two_rows = taps.two_rows.to_bitmask() as u32;
        let (along_x, along_y) = (taps.along[0].to_array(), taps.along[1].to_array());
        let (across_x, across_y) = (taps.across[0].to_array(), taps.across[1].to_array());
        let mut means = [[0.0; 4]; N];
        // A loop, since the closures of an array's own methods are not inlined.
        for (i, mean) in means.iter_mut().enumerate() {
            if lanes >> i & 1 == 0 {
                continue;
            }
            let is_one = one >> i & 1 == 1;
            let level = &self.levels[if is_one { 0 } else { levels[i] as usize }];
            let [width, height] = level.size();
            let (x, y) = (u[i] * width - 0.5, (1.0 - up[i]) * height - 0.5);
            if is_one {
                let place = (f32x4::splat(simd, x), f32x4::splat(simd, y));
                let [pair] = level.at(simd, place, (0, 0));
                *mean = folded(pair);
                continue;
            }
            // Four taps: their steps along and across.
            let (along, across, advance) = if two_rows >> i & 1 == 1 {
                ([-0.5, 0.5, -0.5, 0.5], [-1.0, -1.0, 1.0, 1.0], 2.0)
            } else {
                ([-1.5, -0.5, 0.5, 1.5], [0.0; 4], 4.0)
            };
            let across = f32x4::load_array(simd, across);
            let (x, y) = (x + across * across_x[i], y + across * across_y[i]);
            let start = -0.5 * advance * (groups[i] - 1) as f32;
            let mut along = f32x4::load_array(simd, along) + start;
            let mut sum = f32x8::splat(simd, 0.0);
            for _ in 0..groups[i] {
                let places = (x + along * along_x[i], y + along * along_y[i]);
                let [a, b, c, d] = level.at(simd, places, (0, 0));
                sum += (a + b) + (c + d);
                along += advance;
            }
            *mean = folded(sum * (0.25 / groups[i] as f32));
        }
        means
    }

    /// Returns four taps for each footprint, and which footprints these suit.
    #[inline(always)]
    fn compact_taps<S: Simd>(&self, simd: S, footprints: &Footprints<S>) -> (Taps<S>, mask32x4<S>) {
        let &Footprints {
            a, b, ref moments, ..
        } = footprints;
        let trace = moments.xx + moments.yy;
        let mean = 0.5 * trace;
        let square = moments.difference2().simd_lt(SQUARE * mean * mean);
        let level = self.level(mean * (1.0 / 3.0) + 1.0);
        let scale = scale(level);
        let factor = given_to_taps(scale, trace).sqrt() * scale;
        // ± a/√12 ± b/√12 have the second moments J Jᵀ/12.
        let (step, offset) = (factor * (2.0 * 0.288_675_13), factor * 0.288_675_13);
        let taps = Taps {
            level,
            along: [a[0] * step, -a[1] * step],
            across: [b[0] * offset, -b[1] * offset],
            two_rows: mask32x4::splat(simd, true),
            groups: i32x4::splat(simd, 1),
        };
        (taps, square | trace.simd_le(FOUR_TAPS))
    }

    /// Returns taps in one or two rows along the longer axis of each footprint.
    #[inline(always)]
    fn long_taps<S: Simd>(&self, simd: S, footprints: &Footprints<S>) -> Taps<S> {
        let &Footprints {
            a,
            b,
            narrow,
            ref moments,
            ..
        } = footprints;
        let &Moments { xx, yy, .. } = moments;
        // The eigenvalues of J Jᵀ; the smaller one by the determinant, since a difference would lose its digits.
        let xy = -moments.xy;
        let difference = 0.5 * (xx - yy);
        let radius = moments.difference2().sqrt();
        let major = 0.5 * (xx + yy) + radius;
        let area = a[0] * b[1] - a[1] * b[0];
        let minor = area * area / major;
        // Near the poles texels are narrow, and their neighbours alike: there the taps may be further apart.
        let length = (xx * narrow + yy) * (4.0 / (LONGEST * LONGEST));
        let level = self.level((minor * (1.0 / 3.0) + 1.0).max(length));
        let scale = scale(level);
        // 12 M.
        let of_level = scale * scale;
        let major = ((major + 3.0) * of_level - 3.0).max(0.0);
        let minor = ((minor + 3.0) * of_level - 3.0).max(0.0);
        let two_rows = minor.simd_gt(TWO_ROWS);
        let a_row = two_rows.select(f32x4::splat(simd, 2.0), f32x4::splat(simd, 4.0));
        let groups = (major.sqrt() * DENSITY / a_row).min(MOST_GROUPS as f32);
        let groups = (groups.to_int::<i32x4<S>>() + 1).max(1).min(MOST_GROUPS);
        let taps = groups.to_float::<f32x4<S>>() * a_row;
        // The longer axis, times the root of `size`. Of n taps the second moment is (n² − 1)/12.
        let larger = radius + difference.abs();
        let wide = difference.simd_gt(0.0);
        let axis = [wide.select(larger, xy), wide.select(xy, larger)];
        let size = 2.0 * radius * larger;
        let step = (major / (size * (taps * taps - 1.0))).sqrt();
        let offset = (minor / (size * 12.0)).sqrt();
        Taps {
            level,
            along: [axis[0] * step, axis[1] * step],
            across: [-axis[1] * offset, axis[0] * offset],
            two_rows,
            groups,
        }
    }

    /// Returns the greatest l with `4ˡ ≤ size`, within the levels there are.
    #[inline(always)]
    pub(super) fn level<S: Simd>(&self, size: f32x4<S>) -> i32x4<S> {
        let bits: i32x4<S> = size.bitcast();
        let level = ((bits >> 23) - 127) >> 1;
        level.max(0).min(self.levels.len() as i32 - 1)
    }
}

impl<S: Simd> Moments<S> {
    /// The moments of the parallelograms with these sides.
    #[inline(always)]
    pub(super) fn of(a: Pair<S>, b: Pair<S>) -> Self {
        Self {
            xx: a[0] * a[0] + b[0] * b[0],
            yy: a[1] * a[1] + b[1] * b[1],
            xy: a[0] * a[1] + b[0] * b[1],
        }
    }

    /// Returns the square of half the difference of the axes' squares.
    #[inline(always)]
    pub(super) fn difference2(&self) -> f32x4<S> {
        let difference = 0.5 * (self.xx - self.yy);
        difference * difference + self.xy * self.xy
    }
}

/// Returns the share of J Jᵀ/12 that taps have to give to a footprint with this trace of J Jᵀ, as if it were a square,
/// at the level of this scale.
#[inline(always)]
pub(super) fn given_to_taps<S: Simd>(scale: f32x4<S>, trace: f32x4<S>) -> f32x4<S> {
    let by_level = 3.0 / (scale * scale) - 3.0;
    let part = ((trace - ONE_TAP) * (1.0 / (FULL_WIDTH - ONE_TAP)))
        .max(0.0)
        .min(1.0);
    (1.0 - 2.0 * by_level / trace.max(ONE_TAP)).max(0.0) * part
}

/// Returns the sum of the two halves of a value.
#[inline(always)]
pub(super) fn folded<S: Simd>(pair: f32x8<S>) -> [f32; 4] {
    let (left, right) = pair.split();
    (left + right).to_array()
}

/// Returns 2⁻ˡ.
#[inline(always)]
pub(super) fn scale<S: Simd>(level: i32x4<S>) -> f32x4<S> {
    ((127 - level) << 23).bitcast()
}

impl<S: Simd> Taps<S> {
    /// Takes other taps for the lanes whose mask is not set.
    #[inline(always)]
    fn or_where_not(&self, mask: mask32x4<S>, other: &Self) -> Self {
        Self {
            level: mask.select(self.level, other.level),
            along: select(mask, &self.along, &other.along),
            across: select(mask, &self.across, &other.across),
            two_rows: mask.select(self.two_rows, other.two_rows),
            groups: mask.select(self.groups, other.groups),
        }
    }
}

#[inline(always)]
fn select<S: Simd>(mask: mask32x4<S>, of: &Pair<S>, other: &Pair<S>) -> Pair<S> {
    [mask.select(of[0], other[0]), mask.select(of[1], other[1])]
}
