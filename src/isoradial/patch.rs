//! Curves over a small rectangle of the picture: linear in its pixels, with a bound on what is not.
//!
//! # Derivation
//! A ray is on an edge's curve where `g = z − κ s = 0`, `κ = κ_c + h(x)`; g > 0 on the curve's side of the hole. z and
//! the transverse parts `t_a`, `t_b` are affine in the picture's coordinates; with `(c_a, c_b) = (t_a, t_b)/s` and a
//! derivative along either coordinate written `∂`,
//!
//! ```text
//! ∂s = c_a ∂t_a + c_b ∂t_b
//! ∂c_a = c_b (c_b ∂t_a − c_a ∂t_b)/s
//! ∂x = −|n_p| D₁/(|n_p| + |D₁ c_a|)² ∂c_a          N = |n_p| s, D = D₁ c_a s
//! ∂g = ∂z − κ ∂s − s h′ ∂x
//! ```
//!
//! In the third line both quarter turns are alike: `x = N/(N + D)` and `|D|/(N + |D|)`. Over a rectangle whose t lie
//! within ρ of the one at its centre, `c_a` and `c_b` are within `ρ/(s − ρ)` of theirs; the rest follows by adding and
//! multiplying intervals, each its middle and its radius. By the mean value theorem g is then its value at the centre
//! plus the gradient's interval times the way from there: an interval whose width beyond the linear part falls with
//! the square of the rectangle's size (Moore, Kearfott & Cloud 2009, *Introduction to Interval Analysis*, §6.4).

use super::piece::Piece;
use super::{Edge, Isoradials};
use crate::scene::{Affine, View};

/// The rays of a rectangle of the picture that meet the disk's plane in one and the same quarter turn.
#[derive(Debug, Clone, Copy)]
pub struct Patch {
    /// Which quarter turn, 0 or 1.
    quarter: usize,
    /// At the centre: `z`, `z − κ_c s`, s, x.
    z: f64,
    excess: f64,
    s: f64,
    x: f64,
    /// How far x is from the centre's at most.
    reach: f64,
    /// Of z, along columns and rows.
    slope: [f64; 2],
    /// `∂s`.
    along: [Interval; 2],
    /// `−s ∂x`.
    turning: [Interval; 2],
}

/// `g` of one edge over a patch: `value + per_column dx + per_row dy`, each with an error of its own; dx and dy in
/// pixels from the centre.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// At the centre.
    pub value: Interval,
    /// For each pixel to the right.
    pub per_column: Interval,
    /// For each pixel downwards.
    pub per_row: Interval,
}

/// A side of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// `g ≥ 0`.
    Above,
    /// `g < 0`.
    Below,
}

/// The numbers within `radius` of `middle`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Interval {
    /// Its middle.
    pub middle: f64,
    /// Half its width.
    pub radius: f64,
}

/// Share of its terms by which a value may be off through rounding: some ε of each, with room.
const ROUNDING: f64 = 1e-13;

impl Interval {
    fn times(self, other: Self) -> Self {
        let (a, b) = (self.middle.abs(), other.middle.abs());
        Self {
            middle: self.middle * other.middle,
            radius: a * other.radius + self.radius * (b + other.radius),
        }
    }

    /// The largest size of a number in it.
    pub fn most(self) -> f64 {
        self.middle.abs() + self.radius
    }
}

impl Patch {
    /// The rays of a rectangle of the picture, its sides in pixels from the left and from the top. None where they
    /// are in both quarter turns, or all about the hole's direction or the one away from it.
    #[inline]
    pub fn new(
        view: &View,
        curves: &Isoradials,
        columns: (f64, f64),
        rows: (f64, f64),
    ) -> Option<Self> {
        Self::of(view, curves, columns, rows, None)
    }

    /// The same of those rays of a rectangle that meet the plane in one of the quarter turns, 0 or 1; with the curves
    /// continued a little beyond it. None too where that is no little way, close to the disk's plane.
    pub fn in_quarter(
        view: &View,
        curves: &Isoradials,
        columns: (f64, f64),
        rows: (f64, f64),
        quarter: usize,
    ) -> Option<Self> {
        Self::of(view, curves, columns, rows, Some(quarter))
    }

    /// Where in a rectangle the rays meet the plane at a quarter turn, D = 0: positive in the first one.
    pub fn border(view: &View, columns: (f64, f64), rows: (f64, f64)) -> Line {
        let (x, y) = (
            view.x_at(0.5 * (columns.0 + columns.1)),
            view.y_at(0.5 * (rows.0 + rows.1)),
        );
        let exactly = |middle| Interval {
            middle,
            radius: 0.0,
        };
        let (d, pixel) = (view.plane_slope(), view.pixel_side());
        Line {
            value: exactly(d * view.ta().at(x, y)),
            per_column: exactly(d * view.ta().per_x * pixel),
            per_row: exactly(-d * view.ta().per_y * pixel),
        }
    }

    #[inline]
    fn of(
        view: &View,
        curves: &Isoradials,
        columns: (f64, f64),
        rows: (f64, f64),
        wanted: Option<usize>,
    ) -> Option<Self> {
        let (z, ta, tb) = (view.z(), view.ta(), view.tb());
        let (x, y) = (
            view.x_at(0.5 * (columns.0 + columns.1)),
            view.y_at(0.5 * (rows.0 + rows.1)),
        );
        let pixel = view.pixel_side();
        let (half_x, half_y) = (
            0.5 * pixel * (columns.1 - columns.0),
            0.5 * pixel * (rows.1 - rows.0),
        );
        let reach = |affine: Affine| (affine.per_x * half_x).abs() + (affine.per_y * half_y).abs();
        let (z_centre, a, b) = (z.at(x, y), ta.at(x, y), tb.at(x, y));
        let s = (a * a + b * b).sqrt();
        let (reach_a, reach_b) = (reach(ta), reach(tb));
        let radius = (reach_a * reach_a + reach_b * reach_b).sqrt();
        if radius >= 0.5 * s {
            return None;
        }
        let inverse = 1.0 / s;
        let spread = radius / (s - radius) + 4.0 * f64::EPSILON;
        let (ca, cb) = (
            Interval {
                middle: a * inverse,
                radius: spread,
            },
            Interval {
                middle: b * inverse,
                radius: spread,
            },
        );
        let (n, d) = (view.n_p().abs(), view.plane_slope());
        // |D|/s, less than 0 beyond the quarter turn's end.
        let quarter = wanted.unwrap_or(usize::from(d * ca.middle < 0.0));
        let size = d * if quarter == 0 { ca.middle } else { -ca.middle };
        let least = size - d.abs() * spread;
        let near = match wanted {
            None if least <= 0.0 && d != 0.0 => return None,
            None => n + least.max(0.0),
            // In the plane x is 0 or 1 all over the quarter turn.
            Some(_) if n == 0.0 => d.abs(),
            Some(_) => n + least,
        };
        if near <= 0.5 * n || near == 0.0 {
            return None;
        }
        let far = n + (size + d.abs() * spread).min(d.abs());
        let middle = if n == 0.0 { size.abs() } else { n + size };
        let share = if quarter == 0 {
            n / middle
        } else {
            1.0 - n / middle
        };
        // N D₁/(N + |D|)² between its ends; x changes by it times the change of c_a.
        let factor = n * d;
        let (most, less) = (factor / (near * near), factor / (far * far));
        let factor = Interval {
            middle: 0.5 * (most + less),
            radius: 0.5 * (most - less).abs() + ROUNDING * most.abs(),
        };
        let derivatives = |per_a: f64, per_b: f64| {
            let along = Interval {
                middle: ca.middle * per_a + cb.middle * per_b,
                radius: spread * (per_a.abs() + per_b.abs()),
            };
            let across = Interval {
                middle: cb.middle * per_a - ca.middle * per_b,
                radius: spread * (per_a.abs() + per_b.abs()),
            };
            (along, factor.times(cb).times(across))
        };
        // Rows count downwards, Y upwards.
        let (along_x, turning_x) = derivatives(ta.per_x * pixel, tb.per_x * pixel);
        let (along_y, turning_y) = derivatives(-ta.per_y * pixel, -tb.per_y * pixel);
        Some(Self {
            quarter,
            z: z_centre,
            excess: z_centre - curves.critical() * s,
            s,
            x: share,
            reach: if n > 0.0 {
                factor.most() * spread + ROUNDING
            } else {
                0.0
            },
            slope: [z.per_x * pixel, -z.per_y * pixel],
            along: [along_x, along_y],
            turning: [turning_x, turning_y],
        })
    }

    /// Which quarter turn, 0 or 1.
    pub fn quarter(&self) -> usize {
        self.quarter
    }

    /// One edge of one piece of [`Self::quarter`], over the patch.
    #[inline]
    pub(super) fn line(&self, piece: &Piece, edge: Edge, critical: f64) -> Line {
        let (h, slope) = piece.height_and_slope(edge, self.x, self.reach);
        if h.middle.is_infinite() {
            // The camera stands in the disk's plane: at φ = 0 the ray is on one side of every curve, whatever it is.
            return Line {
                value: Interval {
                    middle: -h.middle,
                    radius: 0.0,
                },
                per_column: Interval::default(),
                per_row: Interval::default(),
            };
        }
        let kappa = Interval {
            middle: critical + h.middle,
            radius: h.radius,
        };
        let gradient = |i: usize| {
            let (turned, turning) = (kappa.times(self.along[i]), slope.times(self.turning[i]));
            Interval {
                middle: self.slope[i] - turned.middle + turning.middle,
                radius: turned.radius + turning.radius,
            }
        };
        let terms = self.z.abs() + self.s * (critical.abs() + h.middle.abs());
        Line {
            value: Interval {
                middle: self.excess - self.s * h.middle,
                radius: ROUNDING * terms,
            },
            per_column: gradient(0),
            per_row: gradient(1),
        }
    }
}

impl Line {
    /// `−g`.
    #[must_use]
    pub fn opposite(&self) -> Self {
        let opposite = |interval: Interval| Interval {
            middle: -interval.middle,
            ..interval
        };
        Self {
            value: opposite(self.value),
            per_column: opposite(self.per_column),
            per_row: opposite(self.per_row),
        }
    }

    /// On which side of the edge the whole patch is, `half` so many pixels to either side of its centre.
    #[inline]
    pub fn side(&self, half: (f64, f64)) -> Option<Side> {
        let radius =
            self.value.radius + self.per_column.most() * half.0 + self.per_row.most() * half.1;
        if self.value.middle - radius >= 0.0 {
            Some(Side::Above)
        } else if self.value.middle + radius < 0.0 {
            Some(Side::Below)
        } else {
            None
        }
    }
}

impl Piece {
    /// h and h′ within `reach` of x.
    #[inline]
    pub(super) fn height_and_slope(&self, edge: Edge, x: f64, reach: f64) -> (Interval, Interval) {
        let (value, slope, bend) = self.jet(edge, x, reach);
        let slope = Interval {
            middle: slope,
            radius: bend * reach,
        };
        let value = Interval {
            middle: value,
            radius: slope.most() * reach,
        };
        if !self.has_pole() {
            return (value, slope);
        }
        // h = f/x, h′ = (f′ − h)/x.
        let least = x - reach;
        if least <= 0.0 {
            let unknown = Interval {
                middle: value.middle / x,
                radius: f64::INFINITY,
            };
            return (unknown, unknown);
        }
        let inverse = Interval {
            middle: 1.0 / x,
            radius: reach / (x * least),
        };
        let height = value.times(inverse);
        let rise = Interval {
            middle: slope.middle - height.middle,
            radius: slope.radius + height.radius,
        };
        let slope = rise.times(inverse);
        // By the mean value theorem, where the quotient of the two intervals forgets what f and x have in common.
        let height = Interval {
            middle: height.middle,
            radius: height.radius.min(slope.most() * reach),
        };
        (height, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isoradial::{Sight, place};
    use crate::orbit::exact::Exact;
    use crate::scene::{Scene, builtins};

    /// g of an edge at a place of the picture, as [`Isoradials::meets`] has it.
    fn g(view: &View, curves: &Isoradials, piece: &Piece, edge: Edge, at: (f64, f64)) -> f64 {
        let ray = view.ray_at(view.x_at(at.0), view.y_at(at.1));
        let s = ray.transverse();
        let x = place(view.n_p().abs() * s, view.plane_slope() * ray.ta);
        ray.z - curves.critical() * s - s * piece.height(edge, x)
    }

    /// Every edge of every order over rectangles of all sizes and places: g is within the line's bounds, which are
    /// nowhere so wide that they would say nothing.
    #[test]
    fn lines_hold_the_edges() {
        let mut state = 1_u64;
        let mut random = |range: f64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            range * ((state >> 11) as f64 / (1_u64 << 53) as f64)
        };
        for builtin in builtins() {
            let scene = Scene::builtin(builtin.name()).unwrap();
            let view = View::new(&scene);
            let curves = Isoradials::new(&Sight::new(&scene, &view, 1e-3), &Exact);
            let (width, height) = (f64::from(view.width()), f64::from(view.height()));
            let mut looked_at = 0;
            for _ in 0..3000 {
                let side = libm::exp2(random(6.0));
                let (left, top) = (random(width - side), random(height - side));
                let (columns, rows) = ((left, left + side), (top, top + side));
                let Some(patch) = Patch::new(&view, &curves, columns, rows) else {
                    continue;
                };
                for piece in curves.quarter(patch.quarter()) {
                    for edge in [Edge::Inner, Edge::Outer] {
                        let line = patch.line(piece, edge, curves.critical());
                        for _ in 0..4 {
                            let (dx, dy) = (random(side) - 0.5 * side, random(side) - 0.5 * side);
                            let at = (left + 0.5 * side + dx, top + 0.5 * side + dy);
                            let truth = g(&view, &curves, piece, edge, at);
                            let middle = line.value.middle
                                + line.per_column.middle * dx
                                + line.per_row.middle * dy;
                            let radius = line.value.radius
                                + line.per_column.radius * dx.abs()
                                + line.per_row.radius * dy.abs();
                            assert!(
                                (truth - middle).abs() <= radius
                                    || truth == middle
                                    || radius.is_nan(),
                                "{}: {truth} at {at:?}, not {middle} ± {radius}: {line:?}",
                                builtin.name()
                            );
                            looked_at += usize::from(radius.is_finite() && truth.is_finite());
                        }
                    }
                }
            }
            assert!(looked_at > 10_000, "{}: {looked_at}", builtin.name());
        }
    }

    /// The part that is not linear falls with the square of the side.
    #[test]
    fn what_is_not_linear_falls_with_the_square() {
        let scene = Scene::builtin("classic").unwrap();
        let view = View::new(&scene);
        let curves = Isoradials::new(&Sight::new(&scene, &view, 1e-3), &Exact);
        let bend = |side: f64| {
            let patch = Patch::new(
                &view,
                &curves,
                (1500.0, 1500.0 + side),
                (400.0, 400.0 + side),
            );
            let patch = patch.unwrap();
            let line = patch.line(
                &curves.quarter(patch.quarter())[0],
                Edge::Outer,
                curves.critical(),
            );
            (line.per_column.radius + line.per_row.radius) * 0.5 * side
        };
        let ratio = bend(16.0) / bend(8.0);
        assert!((3.5..4.6).contains(&ratio), "{ratio}");
    }
}
