//! A part of the disk's outline as a cubic over a column or a row coordinate.
//!
//! Where an edge is steep, it is a function x(y); where it is flat, y(x). Over a short part that function is Hermite's
//! cubic: the one with the edge's own places and slopes at both ends.
//!
//! # How far the cubic may be off the edge
//! Let v(u) be the edge, over a part of length L, and t ∈ [0, 1] the share of it. The quintic that has the edge's value
//! and slope at both ends and at a place near the middle differs from the edge by `max|v⁽⁶⁾| t²(t − ½)²(1 − t)² L⁶/6!`,
//! at most `3.3e-6 max|v⁽⁶⁾| L⁶`. Where that can be left out, the cubic's error is the difference of two polynomials of
//! degree five and three that agree at both ends, `t²(1 − t)² (α + β(2t − 1))`:
//!
//! * α is the error at the place over `t²(1 − t)²` there, and `t²(1 − t)² ≤ 1/16`;
//! * β is 8 times L times the error of the slope in the middle, and `t²(1 − t)² |2t − 1|` is at most
//!   `0.2² √(1/5) = 0.0179`, where `(t − ½)² = 1/20`.
//!
//! So the cubic is off by no more than `α/16` and `8 · 0.0179 = 0.143` times L times the error of the slope.
//!
//! The edge is analytic, and a part turns by a quarter of a right angle at most, so that its sixth derivative is small.
//! The splines that stand for it are right to a fraction of the tolerance, but their third derivative jumps from node
//! to node. So the bound is no proof: of 670,000 arcs of random scenes the greatest error was 1.13 times the tolerance,
//! and frames with hard edges ask each pixel that is within twice the tolerance.

use super::edge_map::Place;

/// The greatest slope of an arc against its main coordinate.
const STEEPEST: f64 = 2.0;

/// The share of the slope's error that counts: see the [module's page](self).
const SLOPE_SHARE: f64 = 0.15;

/// A cubic over one of the picture's coordinates, u: `v = v₀ + d (s₀ + d (c₂ + d c₃))`, `d = u − u₀`. In pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeArc {
    /// Whether u is the row coordinate y and v the column coordinate x. Otherwise u is x and v is y.
    pub(super) steep: bool,
    /// How much more of the disk is to the right of the arc than to its left, where u rises: 1 or −1.
    pub(super) weight: i32,
    /// Where u begins and ends; it rises.
    pub(super) u: (f64, f64),
    /// Where v begins and ends.
    pub(super) v: (f64, f64),
    /// Least and greatest v: of the cubic's Bézier points, between which it lies.
    hull: (f64, f64),
    slope: f64,
    c2: f64,
    c3: f64,
}

impl EdgeArc {
    /// Returns the arc from one place on an edge to another, or none if it may be off by more than `tolerance` pixels.
    /// `middle` is a place on the edge between the two. `weight` is [`EdgeArc::weight`] for the edge walked from `from`
    /// to `to`.
    pub(super) fn new(
        from: &Place,
        middle: &Place,
        to: &Place,
        weight: i32,
        tolerance: f64,
    ) -> Option<Self> {
        let (across, down) = (to.x - from.x, to.y - from.y);
        let steep = down.abs() >= across.abs();
        let main = |place: &Place| {
            if steep {
                (place.y, place.x, place.dy, place.dx)
            } else {
                (place.x, place.y, place.dx, place.dy)
            }
        };
        let (u0, v0, du0, dv0) = main(from);
        let (u1, v1, du1, dv1) = main(to);
        let (um, vm, dum, dvm) = main(middle);
        let (length, rise) = (u1 - u0, v1 - v0);
        // β may rise or fall on the way.
        let advances = |du: f64, dv: f64| du * dum > 0.0 && dv.abs() <= STEEPEST * du.abs();
        if !(advances(du0, dv0) && advances(dum, dvm) && advances(du1, dv1)) {
            return None;
        }
        let (s0, sm, s1) = (dv0 / du0, dvm / dum, dv1 / du1);
        let chord = rise / length;
        let c2 = (3.0 * chord - 2.0 * s0 - s1) / length;
        let c3 = (s0 + s1 - 2.0 * chord) / (length * length);
        let d = um - u0;
        let share = d / length;
        let off = v0 + d * (s0 + d * (c2 + d * c3)) - vm;
        let off_slope = s0 + d * (2.0 * c2 + d * 3.0 * c3) - sm;
        let bump = share * (1.0 - share);
        let error = off.abs() / (16.0 * bump * bump) + SLOPE_SHARE * (length * off_slope).abs();
        if !(error <= tolerance && (0.25..=0.75).contains(&share)) {
            return None;
        }
        Some(Self::cubic(steep, (u0, u1), (v0, v1), (s0, s1), weight))
    }

    /// Returns the straight arc between two points (x, y), or none if they are one point.
    pub(super) fn straight(from: (f64, f64), to: (f64, f64), weight: i32) -> Option<Self> {
        let (across, down) = (to.0 - from.0, to.1 - from.1);
        let steep = down.abs() >= across.abs();
        let (u, v) = if steep {
            ((from.1, to.1), (from.0, to.0))
        } else {
            ((from.0, to.0), (from.1, to.1))
        };
        let slope = (v.1 - v.0) / (u.1 - u.0);
        slope
            .is_finite()
            .then(|| Self::cubic(steep, u, v, (slope, slope), weight))
    }

    fn cubic(steep: bool, u: (f64, f64), v: (f64, f64), slopes: (f64, f64), weight: i32) -> Self {
        // An edge that is walked the other way has the disk on its other side.
        let (u, v, slopes, weight) = if u.0 <= u.1 {
            (u, v, slopes, weight)
        } else {
            ((u.1, u.0), (v.1, v.0), (slopes.1, slopes.0), -weight)
        };
        let length = u.1 - u.0;
        let chord = (v.1 - v.0) / length;
        let inner = (v.0 + length * slopes.0 / 3.0, v.1 - length * slopes.1 / 3.0);
        Self {
            steep,
            weight,
            u,
            v,
            hull: (
                v.0.min(v.1).min(inner.0.min(inner.1)),
                v.0.max(v.1).max(inner.0.max(inner.1)),
            ),
            slope: slopes.0,
            c2: (3.0 * chord - 2.0 * slopes.0 - slopes.1) / length,
            c3: (slopes.0 + slopes.1 - 2.0 * chord) / (length * length),
        }
    }

    /// The same arc, so many pixels farther right.
    pub(super) fn moved_right(mut self, pixels: f64) -> Self {
        let moved = |(first, last): (f64, f64)| (first + pixels, last + pixels);
        if self.steep {
            self.v = moved(self.v);
            self.hull = moved(self.hull);
        } else {
            self.u = moved(self.u);
        }
        self
    }

    /// Returns v at u.
    #[inline]
    pub(super) fn at(&self, u: f64) -> f64 {
        let d = u - self.u.0;
        self.v.0 + d * (self.slope + d * (self.c2 + d * self.c3))
    }

    /// Returns how far the arc may be off its chord over a part of some length: `max|v″| length²/8`.
    pub(super) fn off_chord(&self, length: f64) -> f64 {
        let (first, last) = (
            2.0 * self.c2,
            2.0 * self.c2 + 6.0 * self.c3 * (self.u.1 - self.u.0),
        );
        first.abs().max(last.abs()) * length * length / 8.0
    }

    /// Returns the arc's four Bézier points (x, y), in the direction in which the disk is on the left as seen in the
    /// picture.
    #[cfg(feature = "figure")]
    pub(super) fn bezier(&self) -> [(f64, f64); 4] {
        let third = (self.u.1 - self.u.0) / 3.0;
        let end_slope = self.slope + 3.0 * third * (2.0 * self.c2 + 9.0 * third * self.c3);
        let points = [
            (self.u.0, self.v.0),
            (self.u.0 + third, self.v.0 + third * self.slope),
            (self.u.1 - third, self.v.1 - third * end_slope),
            (self.u.1, self.v.1),
        ];
        let mut points = points.map(|(u, v)| if self.steep { (v, u) } else { (u, v) });
        if self.weight < 0 {
            points.reverse();
        }
        points
    }

    /// The least and the greatest y.
    pub(super) fn rows(&self) -> (f64, f64) {
        if self.steep { self.u } else { self.hull }
    }

    /// The least and the greatest x.
    pub(super) fn columns(&self) -> (f64, f64) {
        if self.steep { self.hull } else { self.u }
    }

    /// The points (x, y) at which it begins and ends.
    pub(super) fn ends(&self) -> [(f64, f64); 2] {
        let (first, last) = ((self.u.0, self.v.0), (self.u.1, self.v.1));
        if self.steep {
            [(first.1, first.0), (last.1, last.0)]
        } else {
            [first, last]
        }
    }
}
