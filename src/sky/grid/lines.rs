//! The mean of equidistant lines over a footprint.
//!
//! The formulas are in the documentation of the parent module.

use std::f64::consts::PI;
use std::sync::LazyLock;

use super::polygon::{Polygon, dot};

/// Equidistant lines, and a footprint across them. All lengths are in units of the lines' distance.
pub(super) struct Lines {
    /// The footprint's centre, from the nearest line.
    place: f64,
    /// The footprint's two sides.
    along: [f64; 2],
    half_width: f64,
}

impl Lines {
    /// `count` lines around a circle of length 1, one of them at 0.
    pub(super) fn new(place: f64, along: [f64; 2], half_width: f64, count: f64) -> Self {
        Self {
            place: from_nearest_integer(place * count),
            along: along.map(|along| along * count),
            half_width: half_width * count,
        }
    }

    /// Returns the footprint's extent across the lines.
    fn extent(&self) -> f64 {
        self.along[0].abs() + self.along[1].abs()
    }

    /// Returns the share of the footprint that lies in lines.
    pub(super) fn mean(&self) -> f64 {
        /// Thinner footprints would lose digits: G is known to 1e-18 or so, and it is divided by the two widths. The
        /// larger one is a line's width at least, where a footprint meets several edges.
        const THINNEST: f64 = 1e-3;
        let [first, second] = self.along.map(f64::abs);
        let (a, b) = (first.max(second), first.min(second));
        let (x, far) = (self.place, 0.5 * (a + b));
        let r = self.half_width;
        if x.abs() - far >= -r && x.abs() + far <= 1.0 - r {
            return beside_edge(r - x.abs(), (a, b));
        }
        let b = b.max(THINNEST * a);
        let (far, near) = (0.5 * (a + b), 0.5 * (a - b));
        let g = |x: f64| {
            let y = from_nearest_integer(x).abs();
            let inside = (r - y).max(0.0);
            r * y * (1.0 - y) + 0.5 * inside * inside
        };
        let bend = (g(x + far) - g(x + near)) - (g(x - near) - g(x - far));
        (2.0 * r + bend / (a * b)).clamp(0.0, 1.0)
    }

    /// Returns the share of the footprint that lies in lines of both families, whose own means are given. Footprints
    /// wider than half a step count as independent in the two.
    pub(super) fn mean_crossing(&self, mean: f64, other: &Self, other_mean: f64) -> f64 {
        // What is all in lines of one family, or all beside them, needs no polygon.
        let one_decides = mean.min(other_mean) <= 0.0 || mean.max(other_mean) >= 1.0;
        if one_decides || self.extent().max(other.extent()) > 0.5 {
            return mean * other_mean;
        }
        // The footprint as a unit square, and what the nearest two lines leave of it.
        let mut polygon = Polygon::UNIT_SQUARE;
        for lines in [self, other] {
            for side in [1.0, -1.0] {
                let inside = lines.half_width - side * lines.place;
                if inside < 0.5 * lines.extent() {
                    polygon.cut(|point| inside - side * dot(lines.along, point));
                }
            }
        }
        (polygon.area())
            .max(mean + other_mean - 1.0)
            .min(mean.min(other_mean))
    }
}

/// Returns the share of a footprint that lies on the inner side of one edge, its centre `inside` of it. `a` and `b` are
/// the widths of the two uniform variables, the larger one first.
#[inline(always)]
fn beside_edge(inside: f64, (a, b): (f64, f64)) -> f64 {
    let (far, near) = (0.5 * (a + b), 0.5 * (a - b));
    if inside.abs() >= far {
        return if inside >= 0.0 { 1.0 } else { 0.0 };
    }
    if inside.abs() <= near {
        return 0.5 + inside / a;
    }
    let corner = far - inside.abs();
    let beyond = 0.5 * corner * corner / (a * b);
    if inside >= 0.0 { 1.0 - beyond } else { beyond }
}

/// Returns the signed distance from the nearest integer, for numbers up to 2⁵¹.
#[inline(always)]
pub(super) fn from_nearest_integer(x: f64) -> f64 {
    // Numbers of this size have no fraction, so that the sum is rounded.
    const SHIFT: f64 = 1.5 * (1_u64 << 52) as f64;
    x - ((x + SHIFT) - SHIFT)
}

/// The half width of the meridians in units of the whole circle, integrated over v.
///
/// It has the period 1, since it is symmetric about the poles (v = 0 and 1) and about the equator.
#[derive(Debug, Clone)]
pub(super) struct MeridianWidths {
    /// The integral from v = 0 to the start of each cell, and to v = 1.
    integral: [f64; Self::CELLS + 1],
}

/// cos(latitude) in the middle of each cell.
static COSINES: LazyLock<[f64; MeridianWidths::CELLS]> = LazyLock::new(|| {
    core::array::from_fn(|i| libm::sin(PI * MeridianWidths::CELL * (i as f64 + 0.5)))
});

impl MeridianWidths {
    /// The number of cells from v = 0 to 1.
    const CELLS: usize = 1024;
    pub(super) const CELL: f64 = 1.0 / Self::CELLS as f64;

    /// The half width is `at_equator/cos(latitude)`, at most `most`.
    pub(super) fn new(at_equator: f64, most: f64) -> Self {
        let mut integral = [0.0; Self::CELLS + 1];
        let mut sum = 0.0;
        for (to_end, cos_latitude) in integral[1..].iter_mut().zip(COSINES.iter()) {
            sum += Self::CELL * (at_equator / cos_latitude).min(most);
            *to_end = sum;
        }
        Self { integral }
    }

    /// Returns the mean from `v − reach` to `v + reach`; at most over one period.
    pub(super) fn mean_half(&self, v: f64, reach: f64) -> f64 {
        let reach = reach.clamp(0.5 * Self::CELL, 0.5);
        (self.until(v + reach) - self.until(v - reach)) / (2.0 * reach)
    }

    /// Returns the integral from −1 to v, which is −1 or more.
    fn until(&self, v: f64) -> f64 {
        let place = (v + 1.0) * Self::CELLS as f64;
        let cell = place as usize;
        let (periods, i) = (cell / Self::CELLS, cell % Self::CELLS);
        let [start, end] = [self.integral[i], self.integral[i + 1]];
        let whole = periods as f64 * self.integral[Self::CELLS];
        whole + start + (place - cell as f64) * (end - start)
    }
}
