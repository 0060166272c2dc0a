//! Edges in pictures that are not flat: fisheyes and equirectangular ones.
//!
//! # Seams
//! Such a picture shows one direction at several places: the left side of an equirectangular picture is its right side,
//! its upper and lower sides are poles, and the rim of a fisheye of 360 degrees is the direction behind the camera. An
//! edge that passes there goes on elsewhere.
//!
//! * Left and right: x is continued beyond the side, and an arc is drawn once for each turn that brings a part of it
//!   into the picture.
//! * A pole: the edge is followed to within rounding. From one end to the other of what is left x may be any, and y is
//!   a side of the picture up to rounding: a level line along it covers nothing, and is left out.
//! * The direction behind the camera: what is left jumps to the other side of the rim. The path is led around, outside
//!   of the rim. Whether it goes to the left or to the right is the same: the difference is a circle around all that is
//!   seen, and the sum along the picture's left side is found from a place within.

use core::f64::consts::{FRAC_PI_2, PI};

use super::arc::EdgeArc;
use super::edge_map::{EdgeMap, Place};
use crate::scene::{self, PixelRay};

/// The path around a fisheye is led this far outside of its rim, in pixels.
const OUTSIDE: f64 = 4.0;

/// Straight parts of that path, for each turn.
const PARTS: f64 = 256.0;

/// A straight line of the sphere is cut at least into parts of this cosine.
const LONGEST_LINE: f64 = 0.99;

impl EdgeMap<'_> {
    /// A direction's parts ahead, right and up.
    #[inline]
    pub(super) fn seen_round(&self, [z, ta, tb]: [f64; 3]) -> [f64; 3] {
        self.view.direction_of(PixelRay { z, ta, tb })
    }

    /// Returns where a direction is seen, x and y.
    #[inline]
    pub(super) fn round_place(&self, seen: [f64; 3]) -> (f64, f64) {
        let lens = self.view.lens();
        let (x, y) = lens.point(seen).unwrap_or_default();
        let per_radian = 1.0 / lens.pixel_side();
        (
            0.5 * self.width + x * per_radian,
            0.5 * self.height - y * per_radian,
        )
    }

    /// Returns how that place moves with the direction.
    #[inline]
    pub(super) fn round_change(&self, seen: [f64; 3], change: [f64; 3]) -> (f64, f64) {
        let lens = self.view.lens();
        let (x, y) = lens.point_change(seen, change);
        let per_radian = 1.0 / lens.pixel_side();
        (x * per_radian, -y * per_radian)
    }

    /// A whole turn, in pixels, of a picture whose sides are one.
    fn turn(&self) -> Option<f64> {
        let is_sphere = self.view.lens().projection() == scene::Projection::Equirectangular;
        is_sphere.then_some(self.width)
    }

    /// The same place, continued from another one: whole turns to its left or right.
    pub(super) fn continued(&self, mut place: Place, other: &Place) -> Place {
        place.x = self.continued_x(place.x, other.x);
        place
    }

    fn continued_x(&self, x: f64, other: f64) -> f64 {
        match self.turn() {
            Some(turn) => x - ((x - other) / turn).round() * turn,
            None => x,
        }
    }

    /// Whether two places are so near that no seam is between them: a quarter of a turn.
    pub(super) fn are_near(&self, from: (f64, f64), to: (f64, f64)) -> bool {
        let quarter = FRAC_PI_2 / self.view.lens().pixel_side();
        (from.0 - to.0).abs().max((from.1 - to.1).abs()) < quarter
    }

    /// Calls `push` with an arc for each turn that may bring it into the picture.
    pub(super) fn in_turns(&self, arc: EdgeArc, mut push: impl FnMut(&EdgeArc)) {
        let Some(turn) = self.turn() else {
            return push(&arc);
        };
        let (left, right) = arc.columns();
        let first = (left / turn).floor() as i32;
        let last = (right / turn).floor() as i32;
        for turns in first..=last {
            push(&arc.moved_right(-f64::from(turns) * turn));
        }
    }

    /// Calls `push` with straight arcs along a line of the sphere between two directions, right to `tolerance` pixels.
    pub(super) fn line(
        &self,
        (a, b): ([f64; 3], [f64; 3]),
        weight: i32,
        tolerance: f64,
        push: &mut impl FnMut(&EdgeArc),
        halvings: u32,
    ) {
        let (a, b) = (unit(a), unit(b));
        let (from, to) = (self.round_place(a), self.round_place(b));
        let to = (self.continued_x(to.0, from.0), to.1);
        let middle = unit(sum(a, b));
        let is_off = |[direction, share]: [[f64; 3]; 2]| {
            let (x, y) = self.round_place(unit(direction));
            let (x, y) = (self.continued_x(x, from.0), y);
            let at = |from: f64, to: f64| from + share[0] * (to - from);
            (x - at(from.0, to.0))
                .abs()
                .max((y - at(from.1, to.1)).abs())
                > tolerance
        };
        let is_short = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > LONGEST_LINE;
        let is_straight = self.are_near(from, to)
            && is_short
            && !is_off([middle, [0.5; 3]])
            && !is_off([sum(a, middle), [0.25; 3]]);
        if is_straight || halvings == 0 {
            if self.are_near(from, to) {
                push_straight(from, to, weight, push);
            } else {
                self.around(from, to, weight, push);
            }
            return;
        }
        self.line((a, middle), weight, tolerance, push, halvings - 1);
        self.line((middle, b), weight, tolerance, push, halvings - 1);
    }

    /// Leads the path around a fisheye, from one place at its rim to another.
    pub(super) fn around(
        &self,
        from: (f64, f64),
        to: (f64, f64),
        weight: i32,
        push: &mut impl FnMut(&EdgeArc),
    ) {
        if self.view.lens().projection() != scene::Projection::Fisheye {
            return;
        }
        let centre = (0.5 * self.width, 0.5 * self.height);
        let angle = |(x, y): (f64, f64)| libm::atan2(y - centre.1, x - centre.0);
        let radius = PI / self.view.lens().pixel_side() + OUTSIDE;
        let (first, last) = (angle(from), angle(to));
        let parts = ((last - first).abs() * (PARTS / (2.0 * PI)))
            .ceil()
            .max(1.0);
        let mut at = from;
        for i in 0..=parts as u32 {
            let (sine, cosine) = libm::sincos(first + (last - first) * f64::from(i) / parts);
            let next = (centre.0 + radius * cosine, centre.1 + radius * sine);
            push_straight(at, next, weight, push);
            at = next;
        }
        push_straight(at, to, weight, push);
    }
}

fn push_straight(from: (f64, f64), to: (f64, f64), weight: i32, push: &mut impl FnMut(&EdgeArc)) {
    if let Some(arc) = EdgeArc::straight(from, to, weight) {
        push(&arc);
    }
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| a[i] + b[i])
}

fn unit(direction: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = direction;
    let length = (a * a + b * b + c * c).sqrt();
    direction.map(|part| part / length)
}
