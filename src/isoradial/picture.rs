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
use crate::scene::View;

/// The rays of a picture, in pixels from its left and its top.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    pub(super) view: &'a View,
    pub(super) curves: &'a Isoradials,
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
pub struct Spot {
    /// In which quarter turn it meets the disk's plane, 0 or 1.
    pub(super) quarter: usize,
    pub(super) z: f64,
    /// `z − κ_c s`.
    pub(super) excess: f64,
    pub(super) s: f64,
    pub(super) x: f64,
    /// `|D₁ cos θ|`; less than 0 beyond the quarter turn's end.
    pub(super) size: f64,
    /// x̂.
    pub(super) share: f64,
    /// v.
    pub(super) turn: f64,
    /// `∂s`, for each pixel to the right and downwards.
    pub(super) along: [f64; 2],
    /// `s∂θ`.
    pub(super) across: [f64; 2],
    pub(super) critical: f64,
    slope: [f64; 2],
}

/// `g` of one edge about a place: its value there, and its gradient.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Line {
    /// At the place.
    pub value: f64,
    /// For each pixel to the right.
    pub per_column: f64,
    /// For each pixel downwards.
    pub per_row: f64,
}

impl<'a> Picture<'a> {
    /// The rays of a view that the curves were drawn for.
    pub fn new(view: &'a View, curves: &'a Isoradials) -> Self {
        let pixel = view.pixel_side();
        let (z, ta, tb) = (view.z(), view.ta(), view.tb());
        Self {
            view,
            curves,
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

    /// The ray at a place; in `quarter`, if that is given, or where its curves' continuation would have it. None for a
    /// ray straight at the hole or away from it.
    #[inline]
    pub(super) fn spot(&self, (column, row): (f64, f64), quarter: Option<usize>) -> Option<Spot> {
        let (x, y) = (self.view.x_at(column), self.view.y_at(row));
        let ray = self.view.ray_at(x, y);
        let s = ray.transverse();
        if s <= 0.0 {
            return None;
        }
        let inverse = 1.0 / s;
        let (ca, cb) = (ray.ta * inverse, ray.tb * inverse);
        let (n, d) = (self.n, self.d);
        let quarter = quarter.unwrap_or(usize::from(d * ca < 0.0));
        let size = d * if quarter == 0 { ca } else { -ca };
        let (share, turn) = if n > 0.0 {
            let inverse = 1.0 / (n + size);
            (n * inverse, d * cb * inverse)
        } else {
            // The camera stands in the disk's plane: x is 0 or 1 all over the quarter turn.
            (0.0, 0.0)
        };
        let critical = self.curves.critical();
        let [right, down] = self.per_pixel;
        let along = |change: Change| ca * change.ta + cb * change.tb;
        let across = |change: Change| ca * change.tb - cb * change.ta;
        Some(Spot {
            quarter,
            z: ray.z,
            excess: ray.z - critical * s,
            s,
            x: if quarter == 0 { share } else { 1.0 - share },
            size,
            share,
            turn,
            along: [along(right), along(down)],
            across: [across(right), across(down)],
            critical,
            slope: [right.z, down.z],
        })
    }
}

impl Spot {
    /// One edge of one piece of this ray's quarter turn.
    #[inline]
    pub(super) fn line(&self, piece: &Piece, edge: Edge) -> Line {
        let (kept, slope) = piece.value_and_slope(edge, self.x);
        self.line_of(piece, kept, slope).0
    }

    /// The same, and h, from what is kept of the curve there and its slope.
    #[inline]
    pub(super) fn line_of(&self, piece: &Piece, kept: f64, slope: f64) -> (Line, f64) {
        let (h, turning) = if piece.has_pole() {
            let h = kept / self.x;
            (h, self.turn * (slope - h))
        } else {
            (kept, self.share * self.turn * slope)
        };
        if h.is_infinite() {
            // The camera stands in the disk's plane: at φ = 0 the ray is on one side of every curve, whatever it is.
            let line = Line {
                value: -h,
                ..Line::default()
            };
            return (line, h);
        }
        let kappa = self.critical + h;
        let gradient = |i: usize| self.slope[i] - kappa * self.along[i] - turning * self.across[i];
        let line = Line {
            value: self.excess - self.s * h,
            per_column: gradient(0),
            per_row: gradient(1),
        };
        (line, h)
    }
}

impl Line {
    /// `−g`.
    #[must_use]
    pub fn opposite(&self) -> Self {
        Self {
            value: -self.value,
            per_column: -self.per_column,
            per_row: -self.per_row,
        }
    }
}
