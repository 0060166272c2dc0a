//! Shares of a pixel, or of a rectangle that is a part of it: on one side of a line, and off several orders' bands.

use crate::isoradial::{Band, Line, MOST_BANDS};
use crate::lanes::Real;

/// The share of a rectangle of such sides, in pixels, on the side `value + per_column dx + per_row dy ≥ 0` of a line, dx and
/// dy from its centre.
///
/// With m and n the larger and the smaller of the two slopes' sizes the smaller part is a triangle, of the area
/// `(½(m + n) − |value|)²/2mn`, where the line cuts off a corner, and a trapezoid, `½ − |value|/m`, where it does not.
#[inline(always)]
fn share_above<T: Real>(line: &Line<T>, sides: [f64; 2]) -> T {
    let (value, per_column, per_row) = (
        line.value,
        line.per_column.abs() * sides[0],
        line.per_row.abs() * sides[1],
    );
    let (most, least) = (per_column.larger(per_row), per_column.smaller(per_row));
    let (size, reach) = (value.abs(), (most + least) * 0.5);
    let (none, all) = (value.all(0.0), value.all(1.0));
    let corner = (reach - size) * (reach - size) / (most * 2.0 * least);
    let trapezoid = -(size / most - 0.5);
    let across = size.if_less((most - least) * 0.5, trapezoid, corner);
    let smaller = size.if_less(reach, across, none);
    value.if_less(none, smaller, all - smaller)
}

/// The share of a rectangle of such sides, in pixels, that lies in a band, or a little less than none of it through
/// rounding; `like` is any number.
#[inline(always)]
pub(super) fn share_of_band<T: Real>(band: &Band<T>, sides: [f64; 2], like: T) -> T {
    let (none, all) = (like.all(0.0), like.all(1.0));
    let (mut outer, mut inner) = (none, none);
    if let Some(line) = &band.outer {
        outer = all - share_above(line, sides);
    }
    if let Some(line) = &band.inner {
        inner = share_above(line, sides);
    }
    all - (outer + inner)
}

/// The share of a rectangle of such sides, in pixels, that lies in any of the bands.
///
/// What lies off a band is beyond its outer edge or within its inner one, never both: off all bands is the sum, over
/// one choice of the two for each band, of convex polygons.
pub(super) fn share_of_union(bands: &[Band], sides: [f64; 2]) -> f64 {
    let mut partial = [Band::default(); MOST_BANDS];
    let mut count = 0;
    let (mut share, mut sum): (f64, f64) = (0.0, 0.0);
    for band in bands {
        let of_band = share_of_band(band, sides, 0.0);
        if of_band > 0.0 {
            share = share.max(of_band);
            sum += of_band;
            partial[count] = *band;
            count += 1;
        }
    }
    let partial = &partial[..count];
    if count <= 1 || share >= 1.0 {
        return share;
    }
    let is_apart = |(i, a): (usize, &Band)| partial[..i].iter().all(|b| apart(a, b, sides) != 0);
    if partial.iter().enumerate().all(is_apart) {
        return sum;
    }
    (1.0 - off(&Polygon::rectangle(sides), partial) / (sides[0] * sides[1])).max(0.0)
}

/// A bit for each pixel: whether two bands have nothing in common in its square, for where `g ≤ 0` at the inner edge of
/// one is `g < 0` at the other's outer edge.
#[inline(always)]
pub(super) fn apart<T: Real>(a: &Band<T>, b: &Band<T>, sides: [f64; 2]) -> u32 {
    within(a.inner, b.outer, sides) | within(b.inner, a.outer, sides)
}

#[inline(always)]
fn within<T: Real>(inner: Option<Line<T>>, outer: Option<Line<T>>, sides: [f64; 2]) -> u32 {
    let (Some(inner), Some(outer)) = (inner, outer) else {
        return 0;
    };
    let reach = (outer.per_column - inner.per_column).abs() * (0.5 * sides[0])
        + (outer.per_row - inner.per_row).abs() * (0.5 * sides[1]);
    let most = outer.value - inner.value + reach;
    most.less(most.all(0.0))
}

/// The area of a polygon that lies off all bands.
pub(super) fn off(polygon: &Polygon, bands: &[Band]) -> f64 {
    let Some((band, others)) = bands.split_first() else {
        return polygon.area();
    };
    let beyond = |line: Line| {
        let part = polygon.above(&line);
        if part.count == 0 {
            0.0
        } else {
            off(&part, others)
        }
    };
    band.outer.map_or(0.0, |line| beyond(line.opposite())) + band.inner.map_or(0.0, beyond)
}

/// A convex polygon: a rectangle with some of its corners cut off, each cut by one line more.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polygon {
    corners: [(f64, f64); MOST],
    count: usize,
}

/// A rectangle's four, and one more for each order's edge.
const MOST: usize = 20;

impl Polygon {
    pub(super) fn rectangle([wide, high]: [f64; 2]) -> Self {
        let (x, y) = (0.5 * wide, 0.5 * high);
        let mut corners = [(0.0, 0.0); MOST];
        corners[..4].copy_from_slice(&[(-x, -y), (x, -y), (x, y), (-x, y)]);
        Self { corners, count: 4 }
    }

    /// The same in coordinates that are turned by an angle.
    pub(super) fn turned(mut self, cosine: f64, sine: f64) -> Self {
        for (x, y) in &mut self.corners[..self.count] {
            (*x, *y) = (*x * cosine + *y * sine, *y * cosine - *x * sine);
        }
        self
    }

    /// Whether it is less than a triangle.
    pub(super) fn is_empty(&self) -> bool {
        self.count < 3
    }

    /// Its least and greatest x, and y.
    pub(super) fn extent(&self) -> [(f64, f64); 2] {
        let (x, y) = self.corners[0];
        let corners = self.corners[1..self.count].iter();
        corners.fold([(x, x), (y, y)], |[columns, rows], &(x, y)| {
            [
                (columns.0.min(x), columns.1.max(x)),
                (rows.0.min(y), rows.1.max(y)),
            ]
        })
    }

    /// A place within.
    pub(super) fn middle(&self) -> (f64, f64) {
        let corners = &self.corners[..self.count];
        let share = 1.0 / self.count as f64;
        corners.iter().fold((0.0, 0.0), |(x, y), corner| {
            (x + share * corner.0, y + share * corner.1)
        })
    }

    /// The part on the side `g ≥ 0` of a line (Sutherland & Hodgman 1974, *Commun. ACM* 17, 32).
    pub(super) fn above(&self, line: &Line) -> Self {
        let g = |(x, y): (f64, f64)| line.value + line.per_column * x + line.per_row * y;
        let mut part = Self {
            corners: [(0.0, 0.0); MOST],
            count: 0,
        };
        let mut push = |corner| {
            if part.count < MOST {
                part.corners[part.count] = corner;
                part.count += 1;
            }
        };
        for i in 0..self.count {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (at_a, at_b) = (g(a), g(b));
            if at_a >= 0.0 {
                push(a);
            }
            if (at_a >= 0.0) != (at_b >= 0.0) {
                let t = at_a / (at_a - at_b);
                push((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)));
            }
        }
        part
    }

    pub(super) fn area(&self) -> f64 {
        let twice: f64 = (0..self.count)
            .map(|i| {
                let (a, b) = (self.corners[i], self.corners[(i + 1) % self.count]);
                a.0 * b.1 - a.1 * b.0
            })
            .sum();
        0.5 * twice
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(value: f64, per_column: f64, per_row: f64) -> Line {
        Line {
            value,
            per_column,
            per_row,
        }
    }

    /// Lines in all directions and at all distances, some along the square's sides and through its corners.
    fn lines() -> Vec<Line> {
        let mut lines = Vec::new();
        for i in 0..32 {
            let (sine, cosine) = libm::sincos(f64::from(i) * core::f64::consts::PI / 16.0);
            for j in -8..=8 {
                lines.push(line(3.0 * 0.1 * f64::from(j), 3.0 * cosine, 3.0 * sine));
            }
        }
        lines
    }

    #[test]
    fn shares_are_the_clipped_rectangles_areas() {
        for sides in [[1.0, 1.0], [0.25, 1.0], [1.0, 1.0 / 64.0]] {
            for line in lines() {
                let share = share_above(&line, sides);
                let area = Polygon::rectangle(sides).above(&line).area() / (sides[0] * sides[1]);
                assert!((share - area).abs() < 1e-13, "{share} and {area}: {line:?}");
            }
        }
        assert_eq!(share_above(&line(0.1, 0.0, 0.0), [1.0; 2]), 1.0);
        assert_eq!(share_above(&line(-0.1, 0.0, 0.0), [1.0; 2]), 0.0);
    }

    /// Two and three bands against counting the points of a fine grid.
    #[test]
    fn unions_are_what_a_grid_counts() {
        const SIDE: u32 = 200;
        let lines = lines();
        let mut state = 1_u64;
        for count in [1, 2, 3] {
            for _ in 0..60 {
                let bands: Vec<Band> = (0..count)
                    .map(|_| {
                        state = state
                            .wrapping_mul(6_364_136_223_846_793_005)
                            .wrapping_add(1_442_695_040_888_963_407);
                        let outer = lines[(state >> 33) as usize % lines.len()];
                        // The inner edge lies within the outer one.
                        let mut inner = outer;
                        inner.value -= 3.0 * 0.3;
                        match (state >> 20) % 3 {
                            0 => Band {
                                outer: Some(outer),
                                inner: None,
                            },
                            1 => Band {
                                outer: None,
                                inner: Some(inner),
                            },
                            _ => Band {
                                outer: Some(outer),
                                inner: Some(inner),
                            },
                        }
                    })
                    .collect();
                let g = |line: &Line, x: f64, y: f64| {
                    line.value + line.per_column * x + line.per_row * y
                };
                let inside = |x: f64, y: f64| {
                    bands.iter().any(|band| {
                        band.outer.is_none_or(|line| g(&line, x, y) >= 0.0)
                            && band.inner.is_none_or(|line| g(&line, x, y) <= 0.0)
                    })
                };
                let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE) - 0.5;
                let hits = (0..SIDE * SIDE)
                    .filter(|k| inside(place(k % SIDE), place(k / SIDE)))
                    .count();
                let counted = hits as f64 / f64::from(SIDE * SIDE);
                let share = share_of_union(&bands, [1.0; 2]);
                // Each of up to six lines passes through some 300 of the grid's cells, half of which it decides.
                assert!(
                    (share - counted).abs() < 6e-3,
                    "{share} and {counted}: {bands:?}"
                );
            }
        }
    }
}
