//! A grid on the sky that shows what the hole does to it: meridians, parallels, and the points before and behind it.
//!
//! Lines lie at every `step` degrees of longitude and latitude and are 0.3° wide on the sky, so that their width in a
//! picture shows the magnification. A meridian is `0.3°/cos(latitude)` wide in longitude, but never more than half a
//! step: towards the poles the meridians cover half of the sky at most. A disc of 2° radius marks the point behind the
//! hole (orange), another the point before it, on the camera's side (blue).
//!
//! # The mean over a pixel
//! A pixel's footprint is a parallelogram in longitude and latitude. A coordinate across the lines, in units of their
//! distance, is spread over it as the sum of two uniform variables of the widths a and b. With p the periodic pulse of
//! half width r at the integers, and `G'' = p − 2r`,
//!
//! ```text
//! mean = 2r + (G(x + (a + b)/2) − G(x + (a − b)/2) − G(x − (a − b)/2) + G(x − (a + b)/2)) / (a b)
//! G(x) = r y (1 − y) + ½ max(r − y, 0)²,    y the distance of x from the nearest integer
//! ```
//!
//! This is exact for lines of constant width. It tends to the share 2r in wide footprints. Where a footprint meets one
//! edge at most, the mean is the share on its inner side, to all digits however small the footprint is. Meridians take
//! their mean width over the footprint. Where lines cross, the part of the footprint in both is a polygon; its part in
//! a disc is the sum of four triangles and sectors.

use std::f64::consts::PI;

use glam::DVec3;

mod lines;
mod mark;
mod polygon;
#[cfg(test)]
mod tests;

use lines::{Lines, MeridianWidths, from_nearest_integer};
use mark::{Mark, RADIUS};

/// The lines' width, in degrees.
const WIDTH: f64 = 0.3;

/// Half of the parallels' width, in units of v.
const PARALLEL_HALF_WIDTH: f64 = 0.5 * WIDTH / 180.0;

/// Half of a meridian's width at the equator, in units of u.
const EQUATOR_HALF_WIDTH: f64 = 0.5 * WIDTH / 360.0;

/// The most that the meridians cover of any parallel.
const MOST_MERIDIANS: f64 = 0.5;

/// Linear colours of Rec. 709.
const LINE: [f64; 3] = [0.25, 0.25, 0.25];
/// The equator and the meridian of longitude 0.
const AXIS: [f64; 3] = [0.8, 0.8, 0.8];
const BEHIND: [f64; 3] = [1.0, 0.35, 0.05];
const BEFORE: [f64; 3] = [0.1, 0.35, 1.0];

/// A pixel's extent counts as at most so many times around the sky: where the hole's shadow begins it has no bound.
const WIDEST: f32 = 8.0;

/// The grid and its marks.
#[derive(Debug, Clone)]
pub struct Grid {
    /// The number of parallels from pole to pole.
    parallels: f64,
    /// The number of meridians around the sky.
    meridians: f64,
    meridian_widths: MeridianWidths,
    marks: [Mark; 2],
}

impl Grid {
    /// A grid with lines every `step` degrees, which divides 180, and with marks in the unit directions of the points
    /// before and behind the hole. Directions are those of the sky: right ascension 0 is +x, declination 90° is +z.
    pub fn new(step: f64, before: DVec3, behind: DVec3) -> Self {
        Self {
            parallels: 180.0 / step,
            meridians: 360.0 / step,
            meridian_widths: MeridianWidths::new(
                EQUATOR_HALF_WIDTH,
                0.5 * MOST_MERIDIANS * step / 360.0,
            ),
            marks: [Mark::new(behind, BEHIND), Mark::new(before, BEFORE)],
        }
    }

    /// Returns the grid's mean over a pixel: premultiplied linear red, green and blue, and opacity.
    ///
    /// `place` is the pixel's centre in the sky, `u = ½ − longitude/360°` and `v = ½ + latitude/180°`; `along_x` and
    /// `along_y` are its changes to the next pixel in the picture's row and column. Where v is beyond 0 or 1 the place
    /// lies beyond the pole.
    #[inline]
    pub fn mean(&self, place: [f64; 2], along_x: [f32; 2], along_y: [f32; 2]) -> [f32; 4] {
        #[expect(clippy::manual_clamp, reason = "what is not a number becomes a bound")]
        let bounded = |along: f32| f64::from(along.max(-WIDEST).min(WIDEST));
        let [mut u, mut v] = place;
        let along_u = [bounded(along_x[0]), bounded(along_y[0])];
        let mut along_v = [bounded(along_x[1]), bounded(along_y[1])];
        if !(0.0..=1.0).contains(&v) {
            v = if v > 1.0 { 2.0 - v } else { -v };
            u += 0.5;
            along_v = [-along_v[0], -along_v[1]];
        }
        let u_reach = 0.5 * (along_u[0].abs() + along_u[1].abs());
        let v_reach = 0.5 * (along_v[0].abs() + along_v[1].abs());

        let misses_lines =
            self.misses_parallels(v, v_reach) && self.misses_meridians(u, u_reach, v, v_reach);
        let mut colour = if misses_lines {
            [0.0; 4]
        } else {
            self.lines([u, v], along_u, along_v, v_reach)
        };
        for mark in &self.marks {
            if (v - mark.v).abs() < v_reach + RADIUS / 180.0 {
                mark.paint_over(&mut colour, [u, v], along_u, along_v);
            }
        }
        [
            colour[0] as f32,
            colour[1] as f32,
            colour[2] as f32,
            colour[3] as f32,
        ]
    }

    /// Returns whether a footprint that reaches so far from v surely meets no parallel.
    #[inline(always)]
    fn misses_parallels(&self, v: f64, v_reach: f64) -> bool {
        let distance = from_nearest_integer((v - 0.5) * self.parallels).abs();
        let reach = (v_reach + PARALLEL_HALF_WIDTH) * self.parallels;
        distance >= reach && distance + reach <= 1.0
    }

    /// Returns whether a footprint that reaches so far from u and v surely meets no meridian.
    #[inline(always)]
    fn misses_meridians(&self, u: f64, u_reach: f64, v: f64, v_reach: f64) -> bool {
        let distance = from_nearest_integer((u - 0.5) * self.meridians).abs();
        let reach = u_reach * self.meridians;
        let latitude = ((v - 0.5).abs() + v_reach + MeridianWidths::CELL).min(0.5);
        // cos(πx) ≥ π/4 (1 − 4x²) for |x| ≤ ½.
        let cos_latitude = 0.25 * PI * (1.0 - 4.0 * latitude * latitude);
        (distance - reach) * cos_latitude >= EQUATOR_HALF_WIDTH * self.meridians
            && distance + reach <= 1.0 - 0.5 * MOST_MERIDIANS
    }

    /// Returns the mean without the marks.
    #[inline(never)]
    fn lines(
        &self,
        [u, v]: [f64; 2],
        along_u: [f64; 2],
        along_v: [f64; 2],
        v_reach: f64,
    ) -> [f64; 4] {
        let meridian_half_width = self.meridian_widths.mean_half(v, v_reach);
        let along_parallels = |count| Lines::new(v - 0.5, along_v, PARALLEL_HALF_WIDTH, count);
        let along_meridians = |count| Lines::new(u - 0.5, along_u, meridian_half_width, count);
        let (parallels, meridians) = (
            along_parallels(self.parallels),
            along_meridians(self.meridians),
        );
        let (parallel, meridian) = (parallels.mean(), meridians.mean());
        let all = parallel + meridian - parallels.mean_crossing(parallel, &meridians, meridian);
        let (equator, prime) = (along_parallels(1.0).mean(), along_meridians(1.0).mean());
        let axes = (equator + prime - equator * prime).min(all);
        let colour = |i: usize| LINE[i] * (all - axes) + AXIS[i] * axes;
        [colour(0), colour(1), colour(2), all]
    }
}
