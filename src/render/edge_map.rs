//! From a curve's points to places in the picture.
//!
//! # Derivation
//! A ray's direction in the basis (towards the hole, â, b̂) is `(κ, cos α, sin α)`, α its azimuth about the hole. The
//! camera's own directions f, right and up are at right angles, and the [`View`] has their parts in that basis. So the
//! place at which the direction is seen is, with one matrix and one division,
//!
//! ```text
//! (w, w x, w y) = M (κ, cos α, sin α)
//! ```
//!
//! x and y in pixels from the picture's left and top. w > 0 ahead of the camera. Pictures that are not flat need no
//! matrix: `round.rs` has what differs there.
//!
//! # The azimuth within a quarter turn
//! φ₁ = π/2 is met where cos α = 0. Each half turn of α about that border has one quarter turn of φ₁ on either side.
//! The azimuth is kept as sine and cosine of the angle β from the border: that is exact also where the camera is nearly
//! in the disk's plane, and all of a quarter turn happens beside the border. With `N = |n·p̂|` and `D = D₁ sin β`,
//!
//! ```text
//! x̂ = N/(N + D),   dx̂/dβ = −x̂ D₁ cos β/(N + D)
//! ```
//!
//! and x, the curves' axis, is x̂ in the first quarter turn and 1 − x̂ in the second.

use crate::isoradial::{Boundary, Isoradials};
use crate::scene::{self, View};

/// Sine and cosine of β, from 0 to a right angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Azimuth {
    pub(super) sine: f64,
    pub(super) cosine: f64,
}

impl Azimuth {
    /// On the border between the quarter turns.
    pub(super) const BORDER: Self = Self {
        sine: 0.0,
        cosine: 1.0,
    };

    /// A right angle from there.
    pub(super) const FARTHEST: Self = Self {
        sine: 1.0,
        cosine: 0.0,
    };

    fn from_sine(sine: f64) -> Self {
        if sine < 1.0 {
            Self {
                sine,
                cosine: ((1.0 - sine) * (1.0 + sine)).sqrt(),
            }
        } else {
            Self::FARTHEST
        }
    }

    /// Halfway between two.
    pub(super) fn between(self, other: Self) -> Self {
        let (sine, cosine) = (self.sine + other.sine, self.cosine + other.cosine);
        let length = (sine * sine + cosine * cosine).sqrt();
        Self {
            sine: sine / length,
            cosine: cosine / length,
        }
    }

    /// The cosine of the angle between two.
    pub(super) fn cosine_to(self, other: Self) -> f64 {
        self.sine * other.sine + self.cosine * other.cosine
    }
}

/// One of the four parts of a view: a quarter turn of φ₁ on one side of the line from the hole along â.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quadrant {
    /// The quarter turn, 0 or 1.
    pub(super) quarter: usize,
    /// The sign of cos α.
    along: f64,
    /// The sign of sin α.
    pub(super) across: f64,
}

impl Quadrant {
    /// `(κ, cos α, sin α)`.
    pub(super) fn direction(self, azimuth: Azimuth, kappa: f64) -> [f64; 3] {
        [
            kappa,
            self.along * azimuth.sine,
            self.across * azimuth.cosine,
        ]
    }
}

/// A curve's point in the picture, and how it moves with β.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) azimuth: Azimuth,
    /// The curves' axis.
    pub(super) axis: f64,
    pub(super) kappa: f64,
    /// `(w, w x, w y)` in a flat picture, else the direction's parts ahead, right and up.
    pub(super) seen: [f64; 3],
    pub(super) x: f64,
    pub(super) y: f64,
    /// dx/dβ.
    pub(super) dx: f64,
    /// dy/dβ.
    pub(super) dy: f64,
}

/// A view, as curves are drawn in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeMap<'a> {
    pub(super) view: &'a View,
    pub(super) curves: &'a Isoradials,
    /// M, row by row, of a flat picture.
    matrix: [[f64; 3]; 3],
    pub(super) is_flat: bool,
    /// `|n·p̂|`.
    n: f64,
    /// D₁, and its size.
    plane_slope: f64,
    d: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// Returns M of the [module's page](self), row by row.
fn picture_matrix(view: &View) -> [[f64; 3]; 3] {
    let (width, height) = (f64::from(view.width()), f64::from(view.height()));
    let part = |i: usize| view.parts().map(|part| part[i]);
    let (w, right, up) = (part(0), part(1), part(2));
    let side = view.pixel_side();
    [
        w,
        core::array::from_fn(|i| right[i] / side + 0.5 * width * w[i]),
        core::array::from_fn(|i| 0.5 * height * w[i] - up[i] / side),
    ]
}

impl<'a> EdgeMap<'a> {
    pub(super) fn new(view: &'a View, curves: &'a Isoradials) -> Self {
        let (width, height) = (f64::from(view.width()), f64::from(view.height()));
        Self {
            view,
            curves,
            matrix: picture_matrix(view),
            is_flat: view.lens().projection() == scene::Projection::Perspective,
            n: view.n_p().abs(),
            plane_slope: view.plane_slope(),
            d: view.plane_slope().abs(),
            width,
            height,
        }
    }

    /// The two quarters of a half turn about the border at `sin α = across`. Seen from the disk's axis φ₁ is a right
    /// angle all round, which is the end of the first quarter turn.
    pub(super) fn quadrants(&self, across: f64) -> [Quadrant; 2] {
        [1.0, -1.0].map(|along| Quadrant {
            quarter: usize::from(self.plane_slope * along < 0.0),
            along,
            across,
        })
    }

    /// Returns whether a boundary is at the camera itself. In the disk's plane φ is 0 for the direct image over the
    /// first quarter turn: these rays meet the plane where they start.
    pub(super) fn is_at_the_camera(&self, quadrant: Quadrant, boundary: &Boundary) -> bool {
        self.n == 0.0 && self.curves.quarter(quadrant.quarter)[boundary.piece].has_pole()
    }

    /// The least and the greatest x of a quarter turn that any azimuth has: of the border and of the farthest.
    pub(super) fn reach(&self, quarter: usize) -> (f64, f64) {
        let farthest = |part: f64| part / (self.n + self.d);
        match quarter {
            0 if self.n == 0.0 => (0.0, 0.0),
            0 => (farthest(self.n), 1.0),
            _ if self.n == 0.0 => (1.0, 1.0),
            _ => (0.0, farthest(self.d)),
        }
    }

    /// x and dx/dβ over cos β, at sin β.
    #[inline]
    fn axis_at(&self, quarter: usize, sine: f64) -> (f64, f64) {
        if self.n == 0.0 {
            return (if quarter == 0 { 0.0 } else { 1.0 }, 0.0);
        }
        let d = self.d * sine;
        let inverse = 1.0 / (self.n + d);
        let share = self.n * inverse;
        if quarter == 0 {
            (share, -share * self.d * inverse)
        } else {
            (d * inverse, share * self.d * inverse)
        }
    }

    /// The azimuth at which a quarter turn has x.
    pub(super) fn azimuth_at(&self, quarter: usize, x: f64) -> Azimuth {
        let (over, under) = if quarter == 0 {
            (1.0 - x, x)
        } else {
            (x, 1.0 - x)
        };
        let sine = self.n * over / (under * self.d);
        if sine > 0.0 {
            Azimuth::from_sine(sine)
        } else {
            Azimuth::BORDER
        }
    }

    /// A curve's point.
    #[inline]
    pub(super) fn place(&self, quadrant: Quadrant, boundary: &Boundary, azimuth: Azimuth) -> Place {
        let piece = &self.curves.quarter(quadrant.quarter)[boundary.piece];
        let (axis, turn) = self.axis_at(quadrant.quarter, azimuth.sine);
        let [kept, slope] = piece.value_and_slope(boundary.edge, axis);
        let (h, h_slope) = if piece.has_pole() {
            let h = kept / axis;
            (h, (slope - h) / axis)
        } else {
            (kept, slope)
        };
        let kappa = self.curves.critical() + h;
        let direction = quadrant.direction(azimuth, kappa);
        let change = [
            h_slope * turn * azimuth.cosine,
            quadrant.along * azimuth.cosine,
            -quadrant.across * azimuth.sine,
        ];
        if !self.is_flat {
            let (seen, change) = (self.seen_round(direction), self.seen_round(change));
            let (x, y) = self.round_place(seen);
            let (dx, dy) = self.round_change(seen, change);
            return Place {
                azimuth,
                axis,
                kappa,
                seen,
                x,
                y,
                dx,
                dy,
            };
        }
        let seen = self.apply(direction);
        let [dw, dwx, dwy] = self.apply(change);
        let inverse = 1.0 / seen[0];
        let (x, y) = (seen[1] * inverse, seen[2] * inverse);
        Place {
            azimuth,
            axis,
            kappa,
            seen,
            x,
            y,
            dx: (dwx - x * dw) * inverse,
            dy: (dwy - y * dw) * inverse,
        }
    }

    /// `(w, w x, w y)` of a direction.
    #[inline]
    pub(super) fn apply(&self, [k, a, b]: [f64; 3]) -> [f64; 3] {
        self.matrix.map(|row| row[0] * k + row[1] * a + row[2] * b)
    }

    /// How much more of κ is to the right than to the left of a curve that is walked downwards, as β grows: 1 or −1.
    ///
    /// With `P = M (κ, cos α, sin α)` the place moves with β and κ so that its rotation from the one to the other is
    /// that of `det (P, P_β, P_κ) = det M (cos α sin′α − sin α cos′α) = −det M sgn(cos α) sgn(sin α)`.
    pub(super) fn handedness(&self, quadrant: Quadrant) -> i32 {
        let [a, b, c] = self.matrix;
        let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
        let determinant = a[0] * minor(1, 2) - a[1] * minor(0, 2) + a[2] * minor(0, 1);
        // det (P, P_β, P_κ) has rows (w, wx, wy): positive where the turn from β to κ is from x to y.
        let turn = -determinant * quadrant.along * quadrant.across;
        if turn > 0.0 { -1 } else { 1 }
    }

    /// Returns, for each side of the picture, a linear form of `(κ, cos α, sin α)` that is negative beyond it, ahead of
    /// the camera and behind it.
    pub(super) fn sides(&self) -> [[f64; 3]; 4] {
        let [w, x, y] = self.matrix;
        [
            x,
            core::array::from_fn(|i| self.width * w[i] - x[i]),
            y,
            core::array::from_fn(|i| self.height * w[i] - y[i]),
        ]
    }
}
