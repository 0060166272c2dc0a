//! Edges at one place of a picture: on which side of each edge's curve its ray is, and how that changes from pixel to
//! pixel.
//!
//! # Derivation
//! A ray is on an edge's curve where `g = z − κ s = 0`, `κ = κ_c + h(x)`; g > 0 on the curve's side of the hole. z and
//! the transverse parts `t_a`, `t_b` are affine in the picture's coordinates. In the plane of `(t_a, t_b)`, with polar
//! coordinates s and θ, κ depends on θ alone, and with a derivative along either coordinate of the picture written `∂`,
//!
//! ```text
//! ∂s  = cos θ ∂t_a + sin θ ∂t_b                     along
//! s∂θ = cos θ ∂t_b − sin θ ∂t_a                     across
//! ∂g  = ∂z − κ ∂s − κ_θ s∂θ
//! ```
//!
//! The axis is `x̂ = N/(N + |D|)`, `N = |n·p̂| s`, `D = D₁ t_a`: `x = x̂` in the first quarter turn, `x = 1 − x̂` in
//! the second. In both of them `x_θ = x̂ v` with `v = D₁ sin θ/(|n·p̂| + |D₁ cos θ|)`. Where h is kept, `κ_θ = x̂ v h′`;
//! where `f = x h` is, `κ_θ = v (f′ − h)`.

use super::piece::Piece;
use super::{Edge, Isoradials};
use crate::lanes::Real;
use crate::scene::{Affine, View};

/// The rays of a picture, in pixels from its left and its top.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Picture<'a> {
    pub(super) curves: &'a Isoradials,
    view: &'a View,
    z: Affine,
    pub(super) ta: Affine,
    tb: Affine,
    /// Twice the column and the row of the picture's centre.
    middle: [f64; 2],
    /// `|n·p̂|`.
    pub(super) n: f64,
    /// D₁, D over `t_a`.
    pub(super) d: f64,
    /// What changes for each pixel to the right, and for each one downwards.
    pub(super) per_pixel: [Change; 2],
}

/// The change of a ray's parts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    pub(super) z: f64,
    pub(super) ta: f64,
    pub(super) tb: f64,
}

/// One ray of a picture, and how rays change from pixel to pixel about it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot<T = f64> {
    /// In which quarter turn it meets the disk's plane, 0 or 1.
    pub(super) quarter: usize,
    /// 1 in the first quarter turn, −1 in the second: the sign of dx/dx̂.
    pub(super) sense: f64,
    pub(super) z: T,
    /// `z − κ_c s`.
    pub(super) excess: T,
    pub(super) s: T,
    /// 1/s.
    pub(super) inverse: T,
    pub(super) x: T,
    /// `|D₁ cos θ|`; less than 0 beyond the quarter turn's end.
    pub(super) size: T,
    /// x̂.
    pub(super) share: T,
    /// v.
    pub(super) turn: T,
    /// `∂s`, for each pixel to the right and downwards.
    pub(super) along: [T; 2],
    /// `s∂θ`.
    pub(super) across: [T; 2],
    pub(super) critical: f64,
    slope: [f64; 2],
}

/// `g` of one edge about a place: its value there, and its gradient.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Line<T = f64> {
    /// At the place.
    pub(crate) value: T,
    /// For each pixel to the right.
    pub(crate) per_column: T,
    /// For each pixel downwards.
    pub(crate) per_row: T,
}

impl<'a> Picture<'a> {
    /// The rays of a view that the curves were drawn for.
    pub(crate) fn new(view: &'a View, curves: &'a Isoradials) -> Self {
        let middle = [f64::from(view.width()), f64::from(view.height())];
        Self::with_parts(view, curves, [view.z(), view.ta(), view.tb()], middle)
    }

    fn with_parts(
        view: &'a View,
        curves: &'a Isoradials,
        parts: [Affine; 3],
        middle: [f64; 2],
    ) -> Self {
        let pixel = view.pixel_side();
        let [z, ta, tb] = parts;
        Self {
            curves,
            view,
            z,
            ta,
            tb,
            middle,
            n: view.n_p().abs(),
            d: view.plane_slope(),
            // Rows count downwards, Y upwards.
            per_pixel: [
                Change {
                    z: z.per_x * pixel,
                    ta: ta.per_x * pixel,
                    tb: tb.per_x * pixel,
                },
                Change {
                    z: -z.per_y * pixel,
                    ta: -ta.per_y * pixel,
                    tb: -tb.per_y * pixel,
                },
            ],
        }
    }

    /// The same rays in a picture turned about its centre, from where columns and rows count, so that the line between
    /// the quarter turns lies along a row; and the cosine and the sine of the angle it is turned by.
    pub(crate) fn turned(&self) -> (Self, [f64; 2]) {
        let [right, down] = self.per_pixel;
        let steepest = (right.ta * right.ta + down.ta * down.ta).sqrt();
        let [cosine, sine] = if steepest > 0.0 {
            [down.ta / steepest, -right.ta / steepest]
        } else {
            [1.0, 0.0]
        };
        let turned = |part: Affine| Affine {
            at_centre: part.at_centre,
            per_x: part.per_x * cosine - part.per_y * sine,
            per_y: part.per_x * sine + part.per_y * cosine,
        };
        let parts = [self.z, self.ta, self.tb].map(turned);
        let picture = Self::with_parts(self.view, self.curves, parts, [0.0; 2]);
        (picture, [cosine, sine])
    }

    /// The curves.
    pub(crate) fn curves(&self) -> &'a Isoradials {
        self.curves
    }

    /// The view.
    pub(crate) fn view(&self) -> &'a View {
        self.view
    }

    /// The quarter turn in which the ray at a place meets the disk's plane.
    #[inline]
    pub(crate) fn quarter_at(&self, (column, row): (f64, f64)) -> usize {
        let ta = self.part(self.ta, column, row);
        usize::from(self.d * ta < 0.0)
    }

    #[inline(always)]
    pub(super) fn part<T: Real>(&self, affine: Affine, column: T, row: T) -> T {
        let x = (column * 2.0 - self.middle[0]) * (0.5 * self.view.pixel_side());
        let y = -(row * 2.0 - self.middle[1]) * (0.5 * self.view.pixel_side());
        x * affine.per_x + affine.at_centre + y * affine.per_y
    }

    /// The ray at a place, and its curves in one of the quarter turns, or their continuation if that is not its own.
    /// All that a ray straight at the hole or away from it has of s is 0.
    #[inline(always)]
    pub(crate) fn spot<T: Real>(&self, column: T, row: T, quarter: usize) -> Spot<T> {
        let (z, ta, tb) = (
            self.part(self.z, column, row),
            self.part(self.ta, column, row),
            self.part(self.tb, column, row),
        );
        let s = (ta * ta + tb * tb).sqrt();
        let inverse = s.all(1.0) / s;
        let (ca, cb) = (ta * inverse, tb * inverse);
        let (n, d) = (self.n, self.d);
        let size = ca * if quarter == 0 { d } else { -d };
        let (share, turn) = if n > 0.0 {
            let inverse = s.all(1.0) / (size + n);
            (inverse * n, cb * d * inverse)
        } else {
            (s.all(0.0), s.all(0.0))
        };
        let critical = self.curves.critical();
        let [right, down] = self.per_pixel;
        Spot {
            quarter,
            sense: if quarter == 0 { 1.0 } else { -1.0 },
            z,
            excess: z - s * critical,
            s,
            inverse,
            x: if quarter == 0 {
                share
            } else {
                s.all(1.0) - share
            },
            size,
            share,
            turn,
            along: [ca * right.ta + cb * right.tb, ca * down.ta + cb * down.tb],
            across: [ca * right.tb - cb * right.ta, ca * down.tb - cb * down.ta],
            critical,
            slope: [right.z, down.z],
        }
    }
}

impl<T: Real> Spot<T> {
    /// One edge of one piece of this ray's quarter turn.
    #[inline(always)]
    pub(super) fn line(&self, piece: &Piece, edge: Edge) -> Line<T> {
        let [kept, slope] = piece.value_and_slope(edge, self.x);
        self.line_of(piece, kept, slope).0
    }

    /// The same, and h, from what is kept of the curve there and its slope.
    #[inline(always)]
    pub(super) fn line_of(&self, piece: &Piece, kept: T, slope: T) -> (Line<T>, T) {
        let (h, turning) = if piece.has_pole() {
            let h = kept / self.x;
            (h, self.turn * (slope - h))
        } else {
            (kept, self.share * self.turn * slope)
        };
        let kappa = h + self.critical;
        let ([along_columns, along_rows], [across_columns, across_rows]) =
            (self.along, self.across);
        let line = Line {
            value: self.excess - self.s * h,
            per_column: -(kappa * along_columns - self.slope[0]) - turning * across_columns,
            per_row: -(kappa * along_rows - self.slope[1]) - turning * across_rows,
        };
        (line, h)
    }
}

impl Line {
    /// `−g`.
    #[must_use]
    pub(crate) fn opposite(&self) -> Self {
        Self {
            value: -self.value,
            per_column: -self.per_column,
            per_row: -self.per_row,
        }
    }
}
