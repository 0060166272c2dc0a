//! Curves over a small rectangle of the picture: cubics in its pixels, with a bound on what is not.
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
//! s∂θ being that of the centre: with bounds of B over the rectangle, there are bounds of g. The gradient's own change is
//! `−∫₀¹ B (s∂θ·d)(s∂θ + τ d × ∂p/s₀) dτ`.
//!
//! The same seen along a line across: where `a = s₀ + ∂s·d`, `b = s∂θ·d` and `T = b/a`, `s K = a G(T)` with `G(0) = K`,
//! `G′(0) = K_θ` and `G″ = (K + K_θθ)(1 + T²)^{−3/2}`, so that
//!
//! ```text
//! g(d) = g₀ + ∂g·d − ½ (K + K_θθ) b²/a        but for  ½ (b²/a) (|K_θ + K_θθθ| |Δθ| + 3/2 T² |K + K_θθ|)
//! ```
//!
//! and, `1/a` being `(1 − ∂s·d/s₀)/s₀` but for the share `r²/(1 − r)` of it, a cubic in d that is right to `½ ε b²`,
//! `s₀ ε = 4/3 |K_θ + K_θθθ| |Δθ| + 5 r² |K + K_θθ|`.
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
//! `arctan |T| ≤ |b| (1 + r + 4r²/3)/s₀` of theirs while `r ≤ 1/4`, and `s₀³/s³ − 1` is at most `3r + 12r²`; the rest follows by
//! adding and multiplying intervals, each its middle and its radius (Moore, Kearfott & Cloud 2009, *Introduction to
//! Interval Analysis*, §2.2), and from h″ being linear in each cell of the spline.

use super::Edge;
use super::interval::Interval;
use super::picture::{Line, Picture, Spot};
use super::piece::Piece;
use crate::lanes::Real;
use crate::table::spline::Cells;

/// The rays of a rectangle of the picture that meet the disk's plane in one and the same quarter turn; or of several
/// rectangles of the same size, in the same one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Patch<T = f64> {
    /// Its centre.
    spot: Spot<T>,
    /// Pixels from the centre to its sides.
    half: [f64; 2],
    /// r: all bounds are right where it is less than [`WIDEST`],
    spread: T,
    /// and the least of `|D₁ cos θ|`, above 0 where all rays are in the quarter turn.
    least: T,
    /// How far x is from the centre's at most.
    reach: T,
    /// The least and the greatest `z/s − κ_c`.
    heights: [T; 2],
    /// What a value may be off by through rounding, but for what h makes of it.
    rounding: T,
    /// s, at most.
    s_most: T,
    /// `s₀³/s³ − 1`, at most.
    nearer: T,
    /// `|d × ∂p|/s₀` for a pixel's d.
    turned: T,
    /// `x̂` and `1 − x̂`.
    share: Interval<T>,
    complement: Interval<T>,
    /// v².
    turn: Interval<T>,
}

/// One edge over a patch: `line` with the cubic `−½ bend (s∂θ·d)² (1 − ∂s·d/s)`, and what is neither.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Bent<T = f64> {
    /// At the centre.
    pub(crate) line: Line<T>,
    /// By how much the value is off at most, through rounding.
    rounding: T,
    /// B.
    pub(crate) bend: Interval<T>,
    /// ε.
    rest: T,
}

/// Share of its terms by which a value may be off through rounding: some ε of each, with room.
const ROUNDING: f64 = 1e-13;

/// The bounds hold for what is less than this of r.
const WIDEST: f64 = 0.25;

impl Picture<'_> {
    /// The rays of a rectangle of the picture, its sides in pixels from the left and from the top. None where they
    /// are in both quarter turns, or all about the hole's direction or the one away from it.
    pub(crate) fn patch(&self, columns: (f64, f64), rows: (f64, f64)) -> Option<Patch> {
        let (centre, half) = middle(columns, rows);
        let patch = self.patch_about(centre.0, centre.1, half, self.quarter_at(centre));
        (patch.sound(self) == 1).then_some(patch)
    }

    /// Whether a rectangle is better cut into left and right parts than into upper and lower ones: the longer
    /// way about the hole's direction, where all that is curved is.
    pub(crate) fn is_wide(&self, columns: (f64, f64), rows: (f64, f64)) -> bool {
        let (centre, half) = middle(columns, rows);
        let patch = self.patch_about(centre.0, centre.1, half, self.quarter_at(centre));
        if patch.narrow() == 0 {
            return half[0] > half[1];
        }
        let [right, down] = patch.across();
        right.abs() * half[0] > down.abs() * half[1]
    }

    /// Where about a place the rays meet the plane at a quarter turn, D = 0: positive in the first one.
    pub(crate) fn border_about(&self, centre: (f64, f64)) -> Line {
        let [right, down] = self.per_pixel;
        Line {
            value: self.d * self.part(self.ta, centre.0, centre.1),
            per_column: self.d * right.ta,
            per_row: self.d * down.ta,
        }
    }

    /// The rays of rectangles about (column, row), so many pixels to either side, in a quarter turn: see
    /// [`Patch::sound`].
    #[inline(always)]
    pub(crate) fn patch_about<T: Real>(
        &self,
        column: T,
        row: T,
        half: [f64; 2],
        quarter: usize,
    ) -> Patch<T> {
        let spot = self.spot(column, row, quarter);
        let [right, down] = self.per_pixel;
        let span = |right: f64, down: f64| right.abs() * half[0] + down.abs() * half[1];
        let (reach_a, reach_b) = (span(right.ta, down.ta), span(right.tb, down.tb));
        let inverse = spot.inverse;
        let r = inverse * (reach_a * reach_a + reach_b * reach_b).sqrt();
        let [across_right, across_down] = spot.across;
        let across = across_right.abs() * half[0] + across_down.abs() * half[1];
        let angle = inverse * across * (r + r * r * (4.0 / 3.0) + 1.0) + 4.0 * f64::EPSILON;
        let (n, d) = (self.n, self.d.abs());
        let none = r.all(0.0);
        let least = spot.size - angle * d;
        let (share, turn, reach) = if n > 0.0 {
            let nearest = angle * d / (least + n);
            // By which share a quotient may be larger than in the centre.
            let more = nearest + ROUNDING;
            let share = Interval {
                middle: spot.share,
                radius: spot.share * more,
            };
            let turn = Interval {
                middle: spot.turn,
                radius: nearest + spot.turn.abs() * more,
            };
            (share, turn, share.most() * turn.most() * angle + ROUNDING)
        } else {
            let nothing = Interval {
                middle: none,
                radius: none,
            };
            (nothing, nothing, none)
        };
        let (z, s_most) = (span(right.z, down.z), spot.s * (r + 1.0));
        let kappa = spot.z * inverse;
        let height = kappa - spot.critical;
        // κ s₀/s is within the first part of κ, s₀/s within the share r/(1 − r) ≤ r + 4r²/3 of 1.
        let height_reach = (inverse * z + r * kappa.abs()) * (r + r * r * (4.0 / 3.0) + 1.0)
            + (kappa.abs() + spot.critical.abs()) * ROUNDING;
        Patch {
            spot,
            half,
            spread: r,
            least,
            reach,
            heights: [height - height_reach, height + height_reach],
            rounding: (spot.z.abs() + z + s_most * spot.critical.abs()) * ROUNDING,
            s_most,
            nearer: r * 3.0 + r * r * 12.0,
            complement: Interval {
                middle: -(share.middle - 1.0),
                ..share
            },
            turned: inverse * (right.ta * down.tb - right.tb * down.ta).abs(),
            share,
            turn: turn.squared(),
        }
    }
}

/// A rectangle's centre, and how far it reaches to either side.
fn middle(columns: (f64, f64), rows: (f64, f64)) -> ((f64, f64), [f64; 2]) {
    (
        (0.5 * (columns.0 + columns.1), 0.5 * (rows.0 + rows.1)),
        [0.5 * (columns.1 - columns.0), 0.5 * (rows.1 - rows.0)],
    )
}

impl<T: Real> Patch<T> {
    /// Which quarter turn, 0 or 1.
    pub(crate) fn quarter(&self) -> usize {
        self.spot.quarter
    }

    /// A bit for each rectangle: whether all its rays are in the quarter turn, and not all about the hole's direction
    /// or the one away from it.
    #[inline(always)]
    pub(crate) fn sound(&self, picture: &Picture<'_>) -> u32 {
        let narrow = self.narrow();
        if picture.d == 0.0 {
            // On the disk's axis all rays meet the plane at a quarter turn, the first one's end.
            return if self.spot.quarter == 0 { narrow } else { 0 };
        }
        narrow & self.none().less(self.least)
    }

    /// A bit for each rectangle: whether its bounds are right for those of its rays that are in the quarter turn.
    #[inline(always)]
    pub(crate) fn sound_beyond(&self, picture: &Picture<'_>) -> u32 {
        let narrow = self.narrow();
        if picture.n == 0.0 {
            // In the disk's plane x is 0 or 1 all over the quarter turn.
            return narrow;
        }
        narrow & self.spread.all(-0.5 * picture.n).less(self.least)
    }

    /// A bit for each rectangle: whether it is not all about the hole's direction or the one away from it.
    #[inline(always)]
    fn narrow(&self) -> u32 {
        self.spread.less(self.spread.all(WIDEST))
    }

    /// As many zeros as there are rectangles.
    #[inline(always)]
    pub(super) fn none(&self) -> T {
        self.spread.all(0.0)
    }

    /// s∂θ at the centre, for each pixel to the right and downwards.
    pub(crate) fn across(&self) -> [T; 2] {
        self.spot.across
    }

    /// ∂s/s at the centre.
    pub(crate) fn along(&self) -> [T; 2] {
        let [right, down] = self.spot.along;
        [right * self.spot.inverse, down * self.spot.inverse]
    }

    /// Pixels from the centre to the sides.
    pub(crate) fn half(&self) -> [f64; 2] {
        self.half
    }

    /// A bit for each rectangle: whether some ray has the slope of some ray that meets the disk in a piece.
    #[inline(always)]
    pub(super) fn overlaps(&self, piece: &Piece) -> u32 {
        let [least, greatest] = self.heights;
        !(greatest.less(least.all(piece.lowest)) | least.all(piece.highest).less(least))
    }

    /// The cells of a piece of [`Self::quarter`] about the patch.
    #[inline(always)]
    pub(super) fn about(&self, piece: &Piece) -> Cells<T> {
        piece.about(self.spot.x, self.reach)
    }

    /// One edge of the piece, over the patch.
    #[inline(always)]
    pub(super) fn bent(&self, piece: &Piece, edge: Edge, about: &Cells<T>) -> Bent<T> {
        let spot = &self.spot;
        let jet = piece.jet(edge, about);
        let (line, h) = spot.line_of(piece, jet.value, jet.slope);
        let third = Interval::between(jet.third);
        let bend = Interval {
            middle: jet.bend,
            radius: third.most() * self.reach,
        };
        // K + K_θθ in the centre, and its derivative over the patch but for the factor x̂ v.
        let (x, v2) = (spot.share, self.turn.middle);
        let both = self.turn.plus(self.complement);
        let (middle, rate) = if piece.has_pole() {
            let middle = jet.value + self.complement.middle * jet.slope + x * v2 * jet.bend;
            let rate = bend.times(both).scaled(3.0);
            (middle, rate.plus(third.times(self.share.times(self.turn))))
        } else {
            let slope = Interval {
                middle: jet.slope,
                radius: bend.most() * self.reach,
            };
            let twice = self.turn.plus(both);
            let middle =
                jet.value + x * twice.middle * jet.slope * spot.sense + x * x * v2 * jet.bend;
            let first = slope.times(both).scaled(6.0);
            let second = bend.times(self.share.times(twice)).scaled(3.0 * spot.sense);
            let last = third.times(self.share.squared().times(self.turn));
            (middle, first.plus(second).plus(last))
        };
        let middle = middle + spot.critical;
        let (size, r) = (middle.abs(), self.spread);
        let change = rate.most() * self.reach + (size + spot.critical.abs()) * ROUNDING;
        Bent {
            line,
            rounding: self.rounding + self.s_most * h.abs() * ROUNDING,
            bend: Interval {
                middle: middle * spot.inverse,
                radius: spot.inverse * (change * (self.nearer + 1.0) + size * self.nearer),
            },
            rest: spot.inverse * (change * (4.0 / 3.0) + size * r * r * 5.0),
        }
    }

    /// Half the largest square of `s∂θ·d`.
    #[inline(always)]
    fn half_square(&self) -> T {
        let [right, down] = self.spot.across;
        let most = right.abs() * self.half[0] + down.abs() * self.half[1];
        most * most * 0.5
    }

    /// The least and the greatest g of an edge over the patch.
    #[inline(always)]
    pub(super) fn range(&self, bent: &Bent<T>) -> [T; 2] {
        let line = &bent.line;
        let tilt = line.per_column.abs() * self.half[0] + line.per_row.abs() * self.half[1];
        let (bend, square, none) = (bent.bend, self.half_square(), tilt.all(0.0));
        let below = tilt + (bend.radius + bend.middle).larger(none) * square + bent.rounding;
        let above = tilt + (bend.radius - bend.middle).larger(none) * square + bent.rounding;
        [line.value - below, line.value + above]
    }

    /// What of an edge over the patch is not linear, at most.
    #[inline(always)]
    pub(crate) fn bend(&self, bent: &Bent<T>) -> T {
        bent.bend.most() * self.half_square() + bent.rounding
    }

    /// By how much an edge is below its tangent over the patch, on the mean.
    #[inline(always)]
    pub(crate) fn mean_bend(&self, bent: &Bent<T>) -> T {
        let [right, down] = self.spot.across;
        let [columns, rows] = self.half;
        let squares = right * right * (columns * columns) + down * down * (rows * rows);
        bent.bend.middle * squares * (0.5 / 3.0)
    }

    /// What of an edge over the patch is not its cubic, at most.
    #[inline(always)]
    pub(crate) fn doubt(&self, bent: &Bent<T>) -> T {
        bent.rest * self.half_square() + bent.rounding
    }

    /// By how much each part of an edge's gradient is another than in the centre, at most.
    #[inline(always)]
    pub(crate) fn turning(&self, bent: &Bent<T>) -> [T; 2] {
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
    #[inline(always)]
    pub(crate) fn bend_of_pixel(&self, bent: &Bent<T>) -> T {
        let [right, down] = self.spot.across;
        let [columns, rows] = self.half;
        let most = right.abs() + down.abs() + self.turned * (columns + rows);
        bent.bend.most() * most * most * 0.125
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
                    if picture.n == 0.0 && piece.has_pole() {
                        // The plane is where the camera is.
                        continue;
                    }
                    for edge in [Edge::Inner, Edge::Outer] {
                        let bent = patch.bent(piece, edge, &patch.about(piece));
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
                            let [right, down] = patch.along();
                            let cubic = line.value + line.per_column * dx + line.per_row * dy
                                - 0.5
                                    * bent.bend.middle
                                    * turned
                                    * turned
                                    * (1.0 - right * dx - down * dy);
                            let rest = 0.5 * bent.rest * turned * turned + bent.rounding;
                            assert!(
                                (truth - cubic).abs() <= rest || truth == cubic || rest.is_nan(),
                                "{}: {truth} at {at:?}, not {cubic} ± {rest}: {bent:?}",
                                builtin.name()
                            );
                            assert!(rest <= patch.doubt(&bent) || rest.is_nan());
                            let there = picture.spot(at.0, at.1, patch.quarter());
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

    /// What is not linear falls with the square of the side, to a little more than the least there can be; what is not
    /// cubic with its third and fourth power: there are parts of both.
    #[test]
    fn what_is_left_falls_with_the_side() {
        let scene = Scene::builtin("classic").unwrap();
        let view = View::new(&scene);
        let curves = Isoradials::new(&Sight::new(&scene, &view, 1e-3), &Exact);
        let picture = Picture::new(&view, &curves);
        let off = |side: f64| {
            let patch = picture.patch((1500.0, 1500.0 + side), (400.0, 400.0 + side));
            let patch = patch.unwrap();
            let piece = &curves.quarter(patch.quarter())[0];
            let bent = patch.bent(piece, Edge::Outer, &patch.about(piece));
            (patch.doubt(&bent), patch.bend(&bent))
        };
        let (large, small) = (off(16.0), off(8.0));
        let (cubes, squares) = (large.0 / small.0, large.1 / small.1);
        assert!((7.5..17.0).contains(&cubes), "{cubes}");
        assert!((3.5..4.6).contains(&squares), "{squares}");
    }
}
