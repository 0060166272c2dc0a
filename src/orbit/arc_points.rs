//! Points of a ray's path, equally spaced along its arc.
//!
//! The path is drawn in the flat plane of the polar coordinates (r, φ), where
//! `ds = √(dr² + r² dφ²) = √(u² + w²)/u² dφ`, `w = du/dφ`. A turning point (periapsis or apoapsis) splits it into two
//! legs. Each leg is marched inward, from its outer end, in steps of at most a quarter of the radius and a quarter of a
//! radian. Gauss's rule gives the length of a step. Marching finds where along the path a point lies, to some 1e-12 of
//! the length.
//!
//! The point itself is exact: elliptic integrals give its radius at its angle, or, where the path is more radial than
//! tangential, its angle at its radius. Of the two it is the better conditioned one.

use super::elliptic::turning_u;
use super::events::Fate;
use super::exact::Exact;
use super::invariants::{Orbit, OrbitPoint};
use super::path::{Branch, SweptAngles, ahead, point_at_angle, turns};
use super::ray::{MIN_U, OrbitError, Ray, STRAIGHT};
use super::taylor::{LONGEST_STEP, PhasePoint};

/// A point of a ray's path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArcPoint {
    /// The angle φ swept from the start, in radians.
    pub angle: f64,
    /// Inverse radius.
    pub u: f64,
}

impl ArcPoint {
    /// Returns the radius, in Schwarzschild radii.
    pub fn radius(self) -> f64 {
        1.0 / self.u
    }
}

/// Returns `count` points of the path of `ray`, at least 3, from its start until it falls in (r = 1) or goes outward
/// through the radius `farthest`. The first and the last point are the ends of that path.
///
/// The points are equally spaced in arc length in the flat plane (r, φ). The turning point, where there is one ahead,
/// is one of them: the points are equally spaced before it and after it, and the two spacings differ by at most the
/// share that makes both numbers whole.
///
/// # Errors
/// [`OrbitError::Radius`] for a `farthest` that is not above 1 or is beyond 1e100, [`OrbitError::NotThrough`] where
/// the ray escapes and does not go outward through `farthest`.
pub fn arc_points(ray: Ray, count: usize, farthest: f64) -> Result<Vec<ArcPoint>, OrbitError> {
    if !(farthest > 1.0 && farthest <= 1.0 / MIN_U) {
        return Err(OrbitError::Radius { radius: farthest });
    }
    let orbit = Orbit::new(ray);
    let end = match orbit.fate() {
        Fate::Capture => orbit.end(),
        Fate::Escape => orbit
            .point_at(1.0 / farthest)
            .filter(|end| turns(&orbit) || ahead(&orbit, end.u))
            .ok_or(OrbitError::NotThrough { radius: farthest })?,
    };
    let intervals = count.max(3) - 1;
    if orbit.start.slope >= STRAIGHT {
        return Ok(straight_points(&orbit, end, intervals));
    }
    let legs = legs(&orbit, end);
    let length: f64 = legs.iter().map(Leg::length).sum();
    let mut points = vec![ArcPoint {
        angle: 0.0,
        u: orbit.start.u,
    }];
    let mut left = intervals;
    for (k, leg) in legs.iter().enumerate() {
        let share = if k + 1 == legs.len() {
            left
        } else {
            let share = (intervals as f64 * leg.length() / length).round() as usize;
            share.clamp(1, intervals - 1)
        };
        left -= share;
        let branch = if k == 0 {
            Branch::Direct
        } else {
            Branch::Around
        };
        points.extend((1..share).map(|j| {
            let (angle, point) = leg.at(j as f64 / share as f64, orbit.delta);
            let exact = exact_point(&orbit, branch, angle, point);
            // Rounding leads past the ends of a leg whose ends are neighbours.
            let (least, greatest) = (leg.first.u.min(leg.last.u), leg.first.u.max(leg.last.u));
            ArcPoint {
                u: exact.u.clamp(least, greatest),
                ..exact
            }
        }));
        points.push(leg.last);
    }
    Ok(points)
}

/// Returns the points of a ray that is straight to the last bit: the arc is the radius.
fn straight_points(orbit: &Orbit, end: OrbitPoint, intervals: usize) -> Vec<ArcPoint> {
    let (from, to) = (1.0 / orbit.start.u, 1.0 / end.u);
    let point = |k| {
        let u = match k {
            0 => orbit.start.u,
            _ if k == intervals => end.u,
            _ => 1.0 / (from + (to - from) * (k as f64 / intervals as f64)),
        };
        let slope = orbit.start.slope;
        ArcPoint {
            angle: Exact.direct(orbit, orbit.start, OrbitPoint { u, slope }),
            u,
        }
    };
    (0..=intervals).map(point).collect()
}

/// Makes a marched point exact.
fn exact_point(orbit: &Orbit, branch: Branch, angle: f64, point: PhasePoint) -> ArcPoint {
    let marched = ArcPoint { angle, u: point.u };
    if branch == Branch::Direct && orbit.inward && angle <= LONGEST_STEP {
        // Marched from the start itself, it is exact. The swept angle would be a difference of long ones.
        return marched;
    }
    if point.w.abs() <= point.u {
        let found = point_at_angle(&Exact, orbit, angle, Some((point.u, branch)));
        return found.map_or(marched, |(u, _)| ArcPoint { angle, u });
    }
    let reached = orbit.point_at(point.u);
    reached.map_or(marched, |to| ArcPoint {
        angle: match branch {
            Branch::Direct => Exact.direct(orbit, orbit.start, to),
            Branch::Around => Exact.around(orbit, orbit.start, to),
        },
        u: point.u,
    })
}

/// Returns the path's parts before and after the turning point, or its only part.
fn legs(orbit: &Orbit, end: OrbitPoint) -> Vec<Leg> {
    let phase = |point: OrbitPoint| PhasePoint::new(point.u, point.slope);
    let first = ArcPoint {
        angle: 0.0,
        u: orbit.start.u,
    };
    if !turns(orbit) {
        let angle = Exact.direct(orbit, orbit.start, end);
        let outer = phase(if orbit.inward { orbit.start } else { end });
        let last = ArcPoint { angle, u: end.u };
        return vec![Leg::new(
            outer,
            orbit.inward,
            angle,
            first,
            last,
            orbit.delta,
        )];
    }
    let turning = PhasePoint::turning(orbit);
    let before = 0.5 * Exact.around(orbit, orbit.start, orbit.start);
    let after = 0.5 * Exact.around(orbit, end, end);
    let middle = ArcPoint {
        angle: before,
        u: turning_u(orbit),
    };
    let last = ArcPoint {
        angle: Exact.around(orbit, orbit.start, end),
        u: end.u,
    };
    // A path over a periapsis comes in and goes out; one over an apoapsis goes out and comes in.
    let [outer, other] = if orbit.inward {
        [phase(orbit.start), phase(end)]
    } else {
        [turning, turning]
    };
    vec![
        Leg::new(outer, orbit.inward, before, first, middle, orbit.delta),
        Leg::new(other, !orbit.inward, after, middle, last, orbit.delta),
    ]
}

/// A part of a path on which the radius only falls or only grows, marched inward from its outer end.
#[derive(Debug)]
struct Leg {
    /// Whether the ray goes inward.
    inward: bool,
    first: ArcPoint,
    last: ArcPoint,
    steps: Vec<Step>,
}

/// A step of the march.
#[derive(Debug, Clone, Copy)]
struct Step {
    from: PhasePoint,
    /// The angle from the leg's outer end to `from`.
    offset: f64,
    /// The angle of the step.
    angle: f64,
    /// The length of the path from the leg's outer end to the end of the step.
    length: f64,
}

impl Leg {
    /// Marches from `outer` over `angle`.
    fn new(
        outer: PhasePoint,
        inward: bool,
        angle: f64,
        first: ArcPoint,
        last: ArcPoint,
        delta: f64,
    ) -> Self {
        let mut steps = Vec::new();
        let (mut from, mut offset, mut length) = (outer, 0.0, 0.0);
        loop {
            let left = angle - offset;
            let longest = LONGEST_STEP * from.u / libm::hypot(from.u, from.w);
            let step = longest.min(left);
            length += arc(from, step, delta);
            steps.push(Step {
                from,
                offset,
                angle: step,
                length,
            });
            let next = from.advanced(step, delta);
            let Some(next) = next.filter(|_| step < left) else {
                break;
            };
            from = next;
            offset += step;
        }
        Self {
            inward,
            first,
            last,
            steps,
        }
    }

    fn length(&self) -> f64 {
        self.steps.last().map_or(0.0, |step| step.length)
    }

    /// Returns the angle and the point at a share of the leg's length, counted from its first point.
    fn at(&self, share: f64, delta: f64) -> (f64, PhasePoint) {
        let share = if self.inward { share } else { 1.0 - share };
        let length = share * self.length();
        let k = self.steps.partition_point(|step| step.length < length);
        let k = k.min(self.steps.len() - 1);
        let step = self.steps[k];
        let before = k.checked_sub(1).map_or(0.0, |k| self.steps[k].length);
        let angle = step.angle_at(length - before, step.length - before, delta);
        let point = step.from.advanced(angle, delta).unwrap_or(step.from);
        let offset = step.offset + angle;
        let angle = if self.inward {
            self.first.angle + offset
        } else {
            self.last.angle - offset
        };
        (angle, point)
    }
}

impl Step {
    /// Returns the angle at `length` from the start of a step that is `whole` long, by Newton's method. The share of
    /// the angle is a first guess within a quarter, so that five iterations give all digits.
    fn angle_at(self, length: f64, whole: f64, delta: f64) -> f64 {
        let mut angle = self.angle * (length / whole);
        for _ in 0..5 {
            let point = self.from.advanced(angle, delta).unwrap_or(self.from);
            let excess = arc(self.from, angle, delta) - length;
            angle = (angle - excess / speed(point)).clamp(0.0, self.angle);
        }
        angle
    }
}

/// Computes `ds/dφ = √(u² + w²)/u²`.
fn speed(point: PhasePoint) -> f64 {
    libm::hypot(1.0, point.w / point.u) / point.u
}

/// Nodes and weights of Gauss's rule with 8 points on (−1, 1), for one sign (DLMF 3.5.29).
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Computes the length of the path from `from` over `angle`, by Gauss's rule.
fn arc(from: PhasePoint, angle: f64, delta: f64) -> f64 {
    let at = |node: f64| {
        let point = from.advanced(0.5 * angle * (1.0 + node), delta);
        speed(point.unwrap_or(from))
    };
    let sum: f64 = GAUSS
        .iter()
        .map(|&(node, weight)| weight * (at(-node) + at(node)))
        .sum();
    0.5 * angle * sum
}
