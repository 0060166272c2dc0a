//! Shares of a pixel's square: on one side of a line, and off several orders' bands.

use crate::isoradial::{Line, OpenBand};

/// The share of a square of so many pixels' side on the side `value + per_column dx + per_row dy ≥ 0` of a line, dx and
/// dy from its centre.
///
/// With m and n the larger and the smaller of the two slopes' sizes the smaller part is a triangle, of the area
/// `(½(m + n) − |value|)²/2mn`, where the line cuts off a corner, and a trapezoid, `½ − |value|/m`, where it does not.
fn share_above(line: &Line, side: f64) -> f64 {
    let (value, per_column, per_row) = (
        line.value.middle,
        line.per_column.middle.abs() * side,
        line.per_row.middle.abs() * side,
    );
    let (most, least) = (per_column.max(per_row), per_column.min(per_row));
    let (size, reach) = (value.abs(), 0.5 * (most + least));
    let smaller = if size >= reach {
        0.0
    } else if size >= 0.5 * (most - least) {
        (reach - size) * (reach - size) / (2.0 * most * least)
    } else {
        0.5 - size / most
    };
    if value >= 0.0 { 1.0 - smaller } else { smaller }
}

/// The share of a square of so many pixels' side that lies in any of the bands.
///
/// What lies off a band is beyond its outer edge or within its inner one, never both: off all bands is the sum, over
/// one choice of the two for each band, of convex polygons.
pub(super) fn share_of_union(bands: &[OpenBand], side: f64) -> f64 {
    let off = match bands {
        [band] => {
            let outer = band
                .outer
                .map_or(0.0, |line| 1.0 - share_above(&line, side));
            let inner = band.inner.map_or(0.0, |line| share_above(&line, side));
            outer + inner
        }
        _ => off(&Polygon::square(side), bands) / (side * side),
    };
    (1.0 - off).max(0.0)
}

/// The share of a square of so many pixels' side that is on the positive side of `border` and in any of the bands; with
/// no band, in all of it.
pub(super) fn share_beside(border: &Line, bands: &[OpenBand], side: f64) -> f64 {
    let part = Polygon::square(side).above(border);
    let off = if bands.is_empty() {
        0.0
    } else {
        off(&part, bands)
    };
    ((part.area() - off) / (side * side)).max(0.0)
}

/// The area of a polygon that lies off all bands.
fn off(polygon: &Polygon, bands: &[OpenBand]) -> f64 {
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

/// A convex polygon: a square with some of its corners cut off, each cut by one line more.
#[derive(Debug, Clone, Copy)]
struct Polygon {
    corners: [(f64, f64); MOST],
    count: usize,
}

/// A square's four, and one more for each order's edge.
const MOST: usize = 20;

impl Polygon {
    fn square(side: f64) -> Self {
        let half = 0.5 * side;
        let mut corners = [(0.0, 0.0); MOST];
        corners[..4].copy_from_slice(&[(-half, -half), (half, -half), (half, half), (-half, half)]);
        Self { corners, count: 4 }
    }

    /// The part on the side `g ≥ 0` of a line (Sutherland & Hodgman 1974, *Commun. ACM* 17, 32).
    fn above(&self, line: &Line) -> Self {
        let g = |(x, y): (f64, f64)| {
            line.value.middle + line.per_column.middle * x + line.per_row.middle * y
        };
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

    fn area(&self) -> f64 {
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
    use crate::isoradial::Interval;

    fn line(value: f64, per_column: f64, per_row: f64) -> Line {
        let exactly = |middle| Interval {
            middle,
            radius: 0.0,
        };
        Line {
            value: exactly(value),
            per_column: exactly(per_column),
            per_row: exactly(per_row),
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
    fn shares_are_the_clipped_squares_areas() {
        for line in lines() {
            let (share, area) = (
                share_above(&line, 1.0),
                Polygon::square(1.0).above(&line).area(),
            );
            assert!((share - area).abs() < 1e-14, "{share} and {area}: {line:?}");
        }
        assert_eq!(share_above(&line(0.1, 0.0, 0.0), 1.0), 1.0);
        assert_eq!(share_above(&line(-0.1, 0.0, 0.0), 1.0), 0.0);
    }

    /// Two and three bands against counting the points of a fine grid.
    #[test]
    fn unions_are_what_a_grid_counts() {
        const SIDE: u32 = 200;
        let lines = lines();
        let mut state = 1_u64;
        for count in [1, 2, 3] {
            for _ in 0..60 {
                let bands: Vec<OpenBand> = (0..count)
                    .map(|_| {
                        state = state
                            .wrapping_mul(6_364_136_223_846_793_005)
                            .wrapping_add(1_442_695_040_888_963_407);
                        let outer = lines[(state >> 33) as usize % lines.len()];
                        // The inner edge lies within the outer one.
                        let mut inner = outer;
                        inner.value.middle -= 3.0 * 0.3;
                        match (state >> 20) % 3 {
                            0 => OpenBand::new(Some(outer), None),
                            1 => OpenBand::new(None, Some(inner)),
                            _ => OpenBand::new(Some(outer), Some(inner)),
                        }
                    })
                    .collect();
                let g = |line: &Line, x: f64, y: f64| {
                    line.value.middle + line.per_column.middle * x + line.per_row.middle * y
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
                let share = share_of_union(&bands, 1.0);
                // Each of up to six lines passes through some 300 of the grid's cells, half of which it decides.
                assert!(
                    (share - counted).abs() < 6e-3,
                    "{share} and {counted}: {bands:?}"
                );
            }
        }
    }
}
