//! The mean of a panorama over a pixel's footprint.
//!
//! A footprint is a parallelogram in texels, J its matrix. The filter adds equal taps, each a bilinear value of one
//! level, that have the footprint's second moments `J Jᵀ/12`. Of these, the level itself gives a part: against a
//! bilinear value of the first level, one of level l is wider by the moments `(4ˡ − 1)/4` in all directions, in texels
//! of the first level (¼ = 1/12 of the box that made the texels + 1/6 of the interpolation). The taps give the rest:
//! `M = (J Jᵀ/12 + ¼)/4ˡ − ¼` in texels of the level, which is 0 for a square footprint of √3 texels there, and the
//! level is the smallest one whose M is nowhere negative. So the filter's width has no jumps where the level changes.
//!
//! * Up to about one texel one tap does, which takes 5 ns.
//! * A footprint of up to two texels, or nearly a square, takes four taps at `± a ± b`, along its own sides: 30 ns.
//! * A longer one takes a row of taps, or two rows, along the longer axis of M: 55 ns for 10 × 1 texels, at most 32
//!   taps and 170 ns.

use wide::{f32x4, i32x4};

use super::Panorama;

/// Up to this sum of a footprint's two sides' squares, in texels, one tap does: a square of 0.87 texels.
const ONE_TAP: f32 = 1.5;
/// From this sum on the taps have the footprint's second moments, and before it a growing part of them, so that no edge
/// shows where one tap ends: a square of 1.22 texels.
const FULL_WIDTH: f32 = 3.0;
/// Up to this sum four taps do, whatever the footprint's shape: a square of two texels.
const FOUR_TAPS: f32 = 8.0;
/// Up to this squared width and height the four taps lie within 3 × 3 texels.
const SMALL: f32 = 3.0;
/// Of so small a footprint the correlation of width and height is left out up to this share.
const UPRIGHT: f32 = 0.2;
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

/// Footprints, one a lane, in texels of the first level.
struct Footprints {
    /// The centres, 0 at the first texel's centre; y grows downwards.
    x: f32x4,
    y: f32x4,
    /// The two sides; the second component grows upwards.
    a: [f32x4; 2],
    b: [f32x4; 2],
    /// The diagonal of J Jᵀ.
    xx: f32x4,
    yy: f32x4,
    /// How much narrower a texel is than high, squared: about cos² of the latitude.
    narrow: f32x4,
}

/// Where the taps of footprints are, one a lane, in texels of the level; the second component grows downwards.
struct Taps {
    level: i32x4,
    /// From one tap to the next along the footprint.
    along: [f32x4; 2],
    /// From the middle to each of two rows.
    across: [f32x4; 2],
    /// Whether there are two rows: a mask.
    two_rows: f32x4,
    /// The number of groups of four taps.
    groups: i32x4,
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
    #[inline(always)]
    pub fn mean(&self, place: [f32; 2], along_x: [f32; 2], along_y: [f32; 2]) -> [f32; 3] {
        let [place, along_x, along_y] =
            [place, along_x, along_y].map(|pair| pair.map(f32x4::splat));
        self.first_means::<1>(place, along_x, along_y)[0]
    }

    /// Returns four means, in about half of the time that [`mean`](Self::mean) takes for each, and with the same bits.
    #[inline(always)]
    pub fn means(
        &self,
        place: [f32x4; 2],
        along_x: [f32x4; 2],
        along_y: [f32x4; 2],
    ) -> [[f32; 3]; 4] {
        self.first_means::<4>(place, along_x, along_y)
    }

    /// Returns the means of the first N lanes.
    #[inline(always)]
    fn first_means<const N: usize>(
        &self,
        [u, v]: [f32x4; 2],
        [ax, ay]: [f32x4; 2],
        [bx, by]: [f32x4; 2],
    ) -> [[f32; 3]; N] {
        let [width, height] = self.size.map(f32x4::splat);
        let (half, one) = (f32x4::splat(0.5), f32x4::splat(1.0));
        let (x, y) = (u * width - half, (one - v) * height - half);
        let (a, b) = ([ax * width, ay * height], [bx * width, by * height]);
        let xx = a[0] * a[0] + b[0] * b[0];
        let yy = a[1] * a[1] + b[1] * b[1];
        let one = (xx + yy).simd_le(f32x4::splat(ONE_TAP));
        let is_small = !one & is_small([a, b], [xx, yy]);
        let means: [f32x4; N] = if one.all() {
            self.levels[0].each_at(x, y)
        } else if is_small.all() {
            self.levels[0].each_about(x, y, spread(xx, xx + yy), spread(yy, xx + yy))
        } else {
            // cos(latitude) = sin(πv), by a parabola.
            let cos = f32x4::splat(4.0) * v * (one - v);
            // Beyond a pole it is not, and taps are as far apart as anywhere.
            let narrow = (cos * cos).min(one);
            self.means_of_larger(&Footprints {
                x,
                y,
                a,
                b,
                xx,
                yy,
                narrow,
            })
        };
        let mut colours = [[0.0; 3]; N];
        for (colour, mean) in colours.iter_mut().zip(means) {
            let [red, green, blue, _] = mean.to_array();
            *colour = [red, green, blue];
        }
        colours
    }

    /// Returns the means of the first N lanes, of which some need more than one tap.
    #[inline(never)]
    fn means_of_larger<const N: usize>(&self, footprints: &Footprints) -> [f32x4; N] {
        let &Footprints { x, y, xx, yy, .. } = footprints;
        let trace = xx + yy;
        let one = trace.simd_le(f32x4::splat(ONE_TAP)).to_bitmask();
        let is_small = is_small([footprints.a, footprints.b], [xx, yy]).to_bitmask();
        let (taps, compact) = self.compact_taps(footprints);
        let taps = if compact.all() {
            taps
        } else {
            taps.or_where_not(compact, &self.long_taps(footprints))
        };
        let (scale, half) = (scale(taps.level), f32x4::splat(0.5));
        let (small_x, small_y) = ((x + half) * scale - half, (y + half) * scale - half);
        let mut means = [f32x4::ZERO; N];
        for (i, mean) in means.iter_mut().enumerate() {
            let lane = |lanes: f32x4| f32x4::splat(lanes.to_array()[i]);
            if one >> i & 1 == 1 {
                [*mean] = self.levels[0].each_at(lane(x), lane(y));
                continue;
            }
            if is_small >> i & 1 == 1 {
                let (across, down) = (spread(xx, trace), spread(yy, trace));
                [*mean] = self.levels[0].each_about(lane(x), lane(y), lane(across), lane(down));
                continue;
            }
            let level = &self.levels[taps.level.to_array()[i] as usize];
            let groups = taps.groups.to_array()[i];
            // Four taps: their steps along and across.
            let two_rows = taps.two_rows.to_array()[i].to_bits() != 0;
            let (along, across, advance) = if two_rows {
                ([-0.5, 0.5, -0.5, 0.5], [-1.0, -1.0, 1.0, 1.0], 2.0)
            } else {
                ([-1.5, -0.5, 0.5, 1.5], [0.0; 4], 4.0)
            };
            let across = f32x4::new(across);
            let x = lane(small_x) + across * lane(taps.across[0]);
            let y = lane(small_y) + across * lane(taps.across[1]);
            let [dx, dy] = taps.along.map(lane);
            let start = -0.5 * advance * (groups - 1) as f32;
            let mut along = f32x4::new(along) + f32x4::splat(start);
            let mut sum = f32x4::ZERO;
            for _ in 0..groups {
                sum += level.sum_at(x + along * dx, y + along * dy);
                along += f32x4::splat(advance);
            }
            *mean = sum * f32x4::splat(0.25 / groups as f32);
        }
        means
    }

    /// Returns four taps for each footprint, and which footprints these suit: a mask.
    #[inline(always)]
    fn compact_taps(&self, footprints: &Footprints) -> (Taps, f32x4) {
        let &Footprints { a, b, xx, yy, .. } = footprints;
        let s = f32x4::splat;
        let (mean, difference) = (s(0.5) * (xx + yy), s(0.5) * (xx - yy));
        let xy = a[0] * a[1] + b[0] * b[1];
        let square = (difference * difference + xy * xy).simd_lt(s(SQUARE) * mean * mean);
        let level = self.level(mean * s(1.0 / 3.0) + s(1.0));
        let scale = scale(level);
        // M as if the footprint were a square: its share of J Jᵀ/12 is this factor, squared.
        let given = s(3.0) / (scale * scale) - s(3.0);
        let part = (xx + yy - s(ONE_TAP)) * s(1.0 / (FULL_WIDTH - ONE_TAP));
        let part = part.max(s(0.0)).min(s(1.0));
        let factor = ((s(1.0) - given / mean).max(s(0.0)) * part).sqrt() * scale;
        // ± a/√12 ± b/√12 have the second moments J Jᵀ/12.
        let (step, offset) = (factor * s(2.0 * 0.288_675_13), factor * s(0.288_675_13));
        let taps = Taps {
            level,
            along: [a[0] * step, -a[1] * step],
            across: [b[0] * offset, -b[1] * offset],
            two_rows: f32x4::splat(f32::from_bits(u32::MAX)),
            groups: i32x4::splat(1),
        };
        (taps, square | (xx + yy).simd_le(s(FOUR_TAPS)))
    }

    /// Returns taps in one or two rows along the longer axis of each footprint.
    #[inline(always)]
    fn long_taps(&self, footprints: &Footprints) -> Taps {
        let &Footprints {
            a,
            b,
            xx,
            yy,
            narrow,
            ..
        } = footprints;
        let s = f32x4::splat;
        // The eigenvalues of J Jᵀ; the smaller one by the determinant, since a difference would lose its digits.
        let xy = -(a[0] * a[1] + b[0] * b[1]);
        let difference = s(0.5) * (xx - yy);
        let radius = (difference * difference + xy * xy).sqrt();
        let major = s(0.5) * (xx + yy) + radius;
        let area = a[0] * b[1] - a[1] * b[0];
        let minor = area * area / major;
        // Near the poles texels are narrow, and their neighbours alike: there the taps may be further apart.
        let length = (xx * narrow + yy) * s(4.0 / (LONGEST * LONGEST));
        let level = self.level((minor * s(1.0 / 3.0) + s(1.0)).max(length));
        let scale = scale(level);
        // 12 M.
        let moments = |of: f32x4| ((of + s(3.0)) * (scale * scale) - s(3.0)).max(s(0.0));
        let (major, minor) = (moments(major), moments(minor));
        let two_rows = minor.simd_gt(s(TWO_ROWS));
        let a_row = two_rows.bitselect(s(2.0), s(4.0));
        let groups = (major.sqrt() * s(DENSITY) / a_row).min(s(MOST_GROUPS as f32));
        let groups = (groups.trunc_int() + i32x4::splat(1))
            .max(i32x4::splat(1))
            .min(i32x4::splat(MOST_GROUPS));
        let taps = f32x4::from_i32x4(groups) * a_row;
        // The longer axis, times the root of `size`. Of n taps the second moment is (n² − 1)/12.
        let larger = radius + difference.abs();
        let wide = difference.simd_gt(s(0.0));
        let axis = [wide.bitselect(larger, xy), wide.bitselect(xy, larger)];
        let size = s(2.0) * radius * larger;
        let step = (major / (size * (taps * taps - s(1.0)))).sqrt();
        let offset = (minor / (size * s(12.0))).sqrt();
        Taps {
            level,
            along: axis.map(|along| along * step),
            across: [-axis[1] * offset, axis[0] * offset],
            two_rows,
            groups,
        }
    }

    /// Returns the greatest l with `4ˡ ≤ size`, within the levels there are.
    #[inline(always)]
    fn level(&self, size: f32x4) -> i32x4 {
        let bits: i32x4 = bytemuck::cast(size);
        let binary: i32x4 = (bits >> 23) - i32x4::splat(127);
        let level: i32x4 = binary >> 1;
        level
            .max(i32x4::splat(0))
            .min(i32x4::splat(self.levels.len() as i32 - 1))
    }
}

/// Tells which footprints' taps lie within 3 × 3 texels: a mask.
#[inline(always)]
fn is_small([a, b]: [[f32x4; 2]; 2], [xx, yy]: [f32x4; 2]) -> f32x4 {
    let s = f32x4::splat;
    let xy = a[0] * a[1] + b[0] * b[1];
    let is_upright = xy.abs().simd_le(s(UPRIGHT) * (xx + yy));
    xx.simd_le(s(SMALL)) & yy.simd_le(s(SMALL)) & is_upright
}

/// Returns how far taps are from the middle along an axis, in texels of the first level, for a squared extent of the
/// footprint along it; `all` is the sum of both.
#[inline(always)]
fn spread(extent: f32x4, all: f32x4) -> f32x4 {
    let s = f32x4::splat;
    let part = (all - s(ONE_TAP)) * s(1.0 / (FULL_WIDTH - ONE_TAP));
    (part.max(s(0.0)).min(s(1.0)) * extent * s(1.0 / 12.0)).sqrt()
}

/// Returns 2⁻ˡ.
#[inline(always)]
fn scale(level: i32x4) -> f32x4 {
    bytemuck::cast((i32x4::splat(127) - level) << 23)
}

impl Taps {
    /// Takes other taps for the lanes whose mask is not set.
    #[inline(always)]
    fn or_where_not(&self, mask: f32x4, other: &Self) -> Self {
        let mix = |of: f32x4, other: f32x4| mask.bitselect(of, other);
        let mix_integers = |of: i32x4, other: i32x4| -> i32x4 {
            bytemuck::cast(mix(bytemuck::cast(of), bytemuck::cast(other)))
        };
        Self {
            level: mix_integers(self.level, other.level),
            along: [
                mix(self.along[0], other.along[0]),
                mix(self.along[1], other.along[1]),
            ],
            across: [
                mix(self.across[0], other.across[0]),
                mix(self.across[1], other.across[1]),
            ],
            two_rows: mix(self.two_rows, other.two_rows),
            groups: mix_integers(self.groups, other.groups),
        }
    }
}
