//! Curves over a small rectangle of the picture: quadratic in its pixels, with a bound on what is not.
//!
//! # Derivation
//! `g = z − s K(θ)`, see [the page before](super::picture). z has no second derivative, and s K(θ), of the first degree
//! in `(t_a, t_b)`, has one in one direction only, across the line to the hole: `(K + K_θθ)/s`. Along the way
//! `p₀ + τ d`, τ from 0 to 1, from the rectangle's centre to another of its places, `s² ∂θ = p₀ × d` stays the same
//! while `1/s³` does not, so that by Taylor's theorem with the remainder as an integral
//!
//! ```text
//! g(d) = g₀ + ∂g·d − ∫₀¹ (1 − τ) B(τ) dτ (s∂θ·d)²          B = (K + K_θθ) s₀²/s³
//! ```
//!
//! s∂θ being that of the centre. If `B` is within ρ of β all over the rectangle, then g is its quadratic part with β/2 in
//! the integral's place, and what is left is less than `ρ/2 (s∂θ·d)²`: it falls with the cube of the rectangle's size.
//! The gradient's own change is `−∫₀¹ B (s∂θ·d)(s∂θ + τ d × ∂p/s₀) dτ`.
//!
//! With `x̂` and v of the page before, and `b = x̂ (2v² + 1 − x̂)`, plus in the first quarter turn, minus in the
//! second:
//!
//! ```text
//! K + K_θθ = κ_c + h ± b h′ + (x̂ v)² h″            where h is kept
//! K + K_θθ = κ_c + f + (1 − x) f′ + x v² f″         where f = x h is
//! ```
//!
//! Within the rectangle, whose places are within r s₀ of its centre's `(t_a, t_b)`, θ, cos θ and sin θ are within
//! `arcsin r ≤ r (1 + r²/4)` of theirs while `r ≤ 1/4`, and `s₀³/s³ − 1` is at most `3r + 12r²`; the rest follows by
//! adding and multiplying intervals, each its middle and its radius (Moore, Kearfott & Cloud 2009, *Introduction to
//! Interval Analysis*, §2.2), and from h″ being linear in each cell of the spline.

use super::Edge;
use super::interval::Interval;
use super::picture::{Line, Picture, Spot};
use super::piece::Piece;

/// The rays of a rectangle of the picture that meet the disk's plane in one and the same quarter turn.
#[derive(Debug, Clone, Copy)]
pub struct Patch {
    /// Its centre.
    spot: Spot,
    /// Pixels from the centre to its sides.
    half: [f64; 2],
    /// How far x is from the centre's at most.
    reach: f64,
    /// `z/s − κ_c`.
    heights: (f64, f64),
    /// What a value may be off by through rounding, but for what h makes of it.
    rounding: f64,
    /// s, at most.
    s_most: f64,
    /// `s₀³/s³ − 1`, at most.
    nearer: f64,
    /// `|d × ∂p|/s₀` for a pixel's d.
    turned: f64,
    /// `x̂` and `1 − x̂`.
    share: Interval,
    complement: Interval,
    /// v².
    turn: Interval,
}

/// One edge over a patch: `line` with `−½ bend (s∂θ·d)²` for its quadratic part, and what is not quadratic.
#[derive(Debug, Clone, Copy, Default)]
pub struct Bent {
    /// At the centre.
    pub line: Line,
    /// By how much the value is off at most, through rounding.
    rounding: f64,
    /// B.
    pub bend: Interval,
}

/// A side of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// `g ≥ 0`.
    Above,
    /// `g < 0`.
    Below,
}

/// Share of its terms by which a value may be off through rounding: some ε of each, with room.
const ROUNDING: f64 = 1e-13;

/// The largest r that the bounds hold for.
const WIDEST: f64 = 0.25;

impl Picture<'_> {
    /// The rays of a rectangle of the picture, its sides in pixels from the left and from the top. None where they
    /// are in both quarter turns, or all about the hole's direction or the one away from it.
    #[inline]
    pub fn patch(&self, columns: (f64, f64), rows: (f64, f64)) -> Option<Patch> {
        self.patch_of(columns, rows, None)
    }

    /// The same of those rays of a rectangle that meet the plane in one of the quarter turns, 0 or 1; with the curves
    /// continued a little beyond it. None too where that is no little way, close to the disk's plane.
    pub fn patch_in_quarter(
        &self,
        columns: (f64, f64),
        rows: (f64, f64),
        quarter: usize,
    ) -> Option<Patch> {
        self.patch_of(columns, rows, Some(quarter))
    }

    /// Where in a rectangle the rays meet the plane at a quarter turn, D = 0: positive in the first one.
    pub fn border(&self, columns: (f64, f64), rows: (f64, f64)) -> Line {
        let (x, y) = (
            self.view.x_at(0.5 * (columns.0 + columns.1)),
            self.view.y_at(0.5 * (rows.0 + rows.1)),
        );
        let [right, down] = self.per_pixel;
        Line {
            value: self.d * self.view.ta().at(x, y),
            per_column: self.d * right.ta,
            per_row: self.d * down.ta,
        }
    }

    #[inline]
    fn patch_of(
        &self,
        columns: (f64, f64),
        rows: (f64, f64),
        wanted: Option<usize>,
    ) -> Option<Patch> {
        let centre = (0.5 * (columns.0 + columns.1), 0.5 * (rows.0 + rows.1));
        let spot = self.spot(centre, wanted)?;
        let half = [0.5 * (columns.1 - columns.0), 0.5 * (rows.1 - rows.0)];
        let [right, down] = self.per_pixel;
        let span = |right: f64, down: f64| right.abs() * half[0] + down.abs() * half[1];
        let (reach_a, reach_b) = (span(right.ta, down.ta), span(right.tb, down.tb));
        let inverse = 1.0 / spot.s;
        let r = (reach_a * reach_a + reach_b * reach_b).sqrt() * inverse;
        if r > WIDEST {
            return None;
        }
        let spread = r * (1.0 + 0.25 * r * r) + 4.0 * f64::EPSILON;
        let (n, d) = (self.n, self.d.abs());
        let least = spot.size - d * spread;
        match wanted {
            None if least <= 0.0 && d > 0.0 => return None,
            // In the disk's plane x is 0 or 1 all over the quarter turn.
            Some(_) if n > 0.0 && least <= -0.5 * n => return None,
            _ => {}
        }
        let (share, turn) = if n > 0.0 {
            let nearest = 1.0 / (n + least);
            // By which share a quotient may be larger than in the centre.
            let more = d * spread * nearest + ROUNDING;
            (
                Interval {
                    middle: spot.share,
                    radius: spot.share * more,
                },
                Interval {
                    middle: spot.turn,
                    radius: d * spread * nearest + spot.turn.abs() * more,
                },
            )
        } else {
            Default::default()
        };
        let (z, s_most) = (span(right.z, down.z), spot.s * (1.0 + r));
        let kappa = spot.z * inverse;
        let height = kappa - spot.critical;
        // κ s₀/s is within the first part of κ, s₀/s within the share r/(1 − r) of 1.
        let height_reach = (z * inverse + r * kappa.abs()) / (1.0 - r)
            + ROUNDING * (kappa.abs() + spot.critical.abs());
        Some(Patch {
            spot,
            half,
            reach: share.most() * turn.most() * spread + if n > 0.0 { ROUNDING } else { 0.0 },
            heights: (height - height_reach, height + height_reach),
            rounding: ROUNDING * (spot.z.abs() + z + s_most * spot.critical.abs()),
            s_most,
            nearer: 3.0 * r + 12.0 * r * r,
            complement: Interval {
                middle: 1.0 - share.middle,
                ..share
            },
            turned: (right.ta * down.tb - right.tb * down.ta).abs() * inverse,
            share,
            turn: turn.squared(),
        })
    }
}

impl Patch {
    /// Which quarter turn, 0 or 1.
    pub fn quarter(&self) -> usize {
        self.spot.quarter
    }

    /// Pixels from the centre to the sides.
    pub fn half(&self) -> [f64; 2] {
        self.half
    }

    /// s∂θ at the centre, for each pixel to the right and downwards.
    pub fn across(&self) -> [f64; 2] {
        self.spot.across
    }

    /// Whether some ray of the patch has the slope of some ray that meets the disk in a piece.
    #[inline]
    pub(super) fn overlaps(&self, piece: &Piece) -> bool {
        !(self.heights.1 < piece.lowest || self.heights.0 > piece.highest)
    }

    /// One edge of one piece of [`Self::quarter`], over the patch.
    #[inline]
    pub(super) fn bent(&self, piece: &Piece, edge: Edge) -> Bent {
        let spot = &self.spot;
        let jet = piece.jet(edge, spot.x, self.reach);
        let (line, h) = spot.line_of(piece, jet.value, jet.slope);
        if h.is_infinite() {
            return Bent {
                line,
                ..Bent::default()
            };
        }
        let third = Interval::between(jet.third);
        let bend = Interval {
            middle: jet.bend,
            radius: third.most() * self.reach,
        };
        // K + K_θθ in the centre, and its derivative over the patch but for the factor x̂ v.
        let (x, v2) = (spot.share, self.turn.middle);
        let (middle, rate) = if piece.has_pole() {
            let middle = jet.value + (1.0 - x) * jet.slope + x * v2 * jet.bend;
            let rate = bend.times(self.turn.plus(self.complement)).scaled(3.0);
            (middle, rate.plus(third.times(self.share.times(self.turn))))
        } else {
            let sign = if spot.quarter == 0 { 1.0 } else { -1.0 };
            let slope = Interval {
                middle: jet.slope,
                radius: bend.most() * self.reach,
            };
            let twice = self.turn.scaled(2.0).plus(self.complement);
            let middle = jet.value + sign * x * twice.middle * jet.slope + x * x * v2 * jet.bend;
            let first = slope.times(self.turn.plus(self.complement)).scaled(6.0);
            let second = bend.times(self.share.times(twice)).scaled(3.0 * sign);
            let last = third.times(self.share.squared().times(self.turn));
            (middle, first.plus(second).plus(last))
        };
        let middle = spot.critical + middle;
        let change = rate.most() * self.reach + ROUNDING * (spot.critical.abs() + middle.abs());
        let inverse = 1.0 / spot.s;
        Bent {
            line,
            rounding: self.rounding + ROUNDING * self.s_most * h.abs(),
            bend: Interval {
                middle: middle * inverse,
                radius: inverse * (change * (1.0 + self.nearer) + middle.abs() * self.nearer),
            },
        }
    }

    /// Half the largest square of `s∂θ·d`.
    #[inline]
    fn half_square(&self) -> f64 {
        let [right, down] = self.spot.across;
        let most = right.abs() * self.half[0] + down.abs() * self.half[1];
        0.5 * most * most
    }

    /// On which side of an edge the whole patch is.
    #[inline]
    pub fn side(&self, bent: &Bent) -> Option<Side> {
        let line = &bent.line;
        let tilt = line.per_column.abs() * self.half[0] + line.per_row.abs() * self.half[1];
        let (bend, square) = (bent.bend, self.half_square());
        let below = tilt + (bend.middle + bend.radius).max(0.0) * square + bent.rounding;
        let above = tilt + (bend.radius - bend.middle).max(0.0) * square + bent.rounding;
        if line.value - below >= 0.0 {
            Some(Side::Above)
        } else if line.value + above < 0.0 {
            Some(Side::Below)
        } else {
            None
        }
    }

    /// What of an edge over the patch is not linear, at most.
    #[inline]
    pub fn bend(&self, bent: &Bent) -> f64 {
        bent.bend.most() * self.half_square() + bent.rounding
    }

    /// What of an edge over the patch is not quadratic, at most.
    #[inline]
    pub fn doubt(&self, bent: &Bent) -> f64 {
        bent.bend.radius * self.half_square() + bent.rounding
    }

    /// By how much each part of an edge's gradient is another than in the centre, at most.
    #[inline]
    pub fn turning(&self, bent: &Bent) -> [f64; 2] {
        let [right, down] = self.spot.across;
        let [columns, rows] = self.half;
        let most = bent.bend.most() * (right.abs() * columns + down.abs() * rows);
        [
            most * (right.abs() + self.turned * rows),
            most * (down.abs() + self.turned * columns),
        ]
    }

    /// By how much an edge is off its tangent over a pixel of the patch, at most, its tangent being that in the pixel's
    /// centre.
    #[inline]
    pub fn bend_of_pixel(&self, bent: &Bent) -> f64 {
        let [right, down] = self.spot.across;
        let [columns, rows] = self.half;
        let most = 0.5 * (right.abs() + down.abs() + self.turned * (columns + rows));
        0.5 * bent.bend.most() * most * most
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isoradial::{Isoradials, Sight, place};
    use crate::orbit::exact::Exact;
    use crate::scene::{Scene, View, builtins};

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
            let picture = Picture::new(&view, &curves);
            let (width, height) = (f64::from(view.width()), f64::from(view.height()));
            let mut looked_at = 0;
            for _ in 0..3000 {
                let side = libm::exp2(random(6.0));
                let (left, top) = (random(width - side), random(height - side));
                let (columns, rows) = ((left, left + side), (top, top + side));
                let Some(patch) = picture.patch(columns, rows) else {
                    continue;
                };
                let across = patch.across();
                for piece in curves.quarter(patch.quarter()) {
                    for edge in [Edge::Inner, Edge::Outer] {
                        let bent = patch.bent(piece, edge);
                        for _ in 0..4 {
                            let (dx, dy) = (random(side) - 0.5 * side, random(side) - 0.5 * side);
                            let at = (left + 0.5 * side + dx, top + 0.5 * side + dy);
                            let truth = g(&view, &curves, piece, edge, at);
                            let (line, turned) = (bent.line, across[0] * dx + across[1] * dy);
                            let middle = line.value + line.per_column * dx + line.per_row * dy
                                - 0.5 * bent.bend.middle * turned * turned;
                            let radius = 0.5 * bent.bend.radius * turned * turned + bent.rounding;
                            assert!(
                                (truth - middle).abs() <= radius
                                    || truth == middle
                                    || radius.is_nan(),
                                "{}: {truth} at {at:?}, not {middle} ± {radius}: {bent:?}",
                                builtin.name()
                            );
                            assert!(radius <= patch.doubt(&bent) || radius.is_nan());
                            let there = picture.spot(at, Some(patch.quarter())).unwrap();
                            let there = there.line(piece, edge);
                            let [columns, rows] = patch.turning(&bent);
                            assert!(
                                (there.per_column - line.per_column).abs()
                                    <= columns + bent.rounding
                                    && (there.per_row - line.per_row).abs() <= rows + bent.rounding
                                    || !columns.is_finite(),
                                "{}: {there:?} at {at:?}, not {line:?} ± {columns} ± {rows}",
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

    /// What is not quadratic falls with the cube of the side, what is not linear with its square, to a few times the
    /// least there can be.
    #[test]
    fn what_is_left_falls_with_the_cube() {
        let scene = Scene::builtin("classic").unwrap();
        let view = View::new(&scene);
        let curves = Isoradials::new(&Sight::new(&scene, &view, 1e-3), &Exact);
        let picture = Picture::new(&view, &curves);
        let off = |side: f64| {
            let patch = picture.patch((1500.0, 1500.0 + side), (400.0, 400.0 + side));
            let patch = patch.unwrap();
            let bent = patch.bent(&curves.quarter(patch.quarter())[0], Edge::Outer);
            (patch.doubt(&bent), patch.bend(&bent))
        };
        let (large, small) = (off(16.0), off(8.0));
        let (cubes, squares) = (large.0 / small.0, large.1 / small.1);
        assert!((7.0..11.0).contains(&cubes), "{cubes}");
        assert!((3.5..4.6).contains(&squares), "{squares}");
    }
}
