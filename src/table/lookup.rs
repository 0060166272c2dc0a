//! Swept angles read from a table.

use super::charts::{CRITICAL_B, CRITICAL_POLE, LOWER_E2, TRAPPED_POLE, UPPER_E2};
use super::logarithm::ln_ratio;
use super::spec::{Axes, Spec};
use super::spline::{Scale, Stencil, value, values_2d};
use crate::orbit::invariants::{Family, Orbit, Point, three_u_minus_two};
use crate::orbit::path::SweptAngles;
use wide::f64x2;

/// A table's numbers, ready for lookups: a method like any other (see [`crate::orbit`]).
///
/// A swept angle takes one or two square roots, at most one logarithm (about the critical line only), a division and
/// two bicubic interpolations.
#[derive(Debug, Clone, Copy)]
pub struct Lookup<'a> {
    /// A, on the critical chart's orbit axis.
    amplitude: &'a [f64],
    critical: Chart<'a>,
    weak: Chart<'a>,
    trapped: Chart<'a>,
    radial: Chart<'a>,
    error: f64,
}

#[derive(Debug, Clone, Copy)]
struct Chart<'a> {
    coefficients: &'a [f64],
    width: usize,
    place: Scale,
    orbit: Scale,
}

impl<'a> Chart<'a> {
    fn take(numbers: &mut &'a [f64], axes: Axes) -> Self {
        let (coefficients, rest) = numbers.split_at(axes.coefficients());
        *numbers = rest;
        Self {
            coefficients,
            width: axes.place.coefficients(),
            place: Scale::new(axes.place),
            orbit: Scale::new(axes.orbit),
        }
    }

    /// The values at two places of one orbit.
    #[inline(always)]
    fn at(&self, rows: &Stencil, places: f64x2) -> f64x2 {
        values_2d(
            self.coefficients,
            self.width,
            rows,
            &self.place.stencils(places),
        )
    }
}

impl<'a> Lookup<'a> {
    /// The charts within `numbers`, which are exactly as many as `spec` says; `error` is that of their angles.
    pub(crate) fn new(spec: &Spec, mut numbers: &'a [f64], error: f64) -> Self {
        let (amplitude, rest) = numbers.split_at(spec.critical_axes().orbit.coefficients());
        numbers = rest;
        Self {
            amplitude,
            critical: Chart::take(&mut numbers, spec.critical_axes()),
            weak: Chart::take(&mut numbers, spec.weak_axes()),
            trapped: Chart::take(&mut numbers, spec.trapped_axes()),
            radial: Chart::take(&mut numbers, spec.radial_axes()),
            error,
        }
    }

    /// The angles from both points to the turning point, where e² is small.
    #[inline(always)]
    fn angles_to_turning_point(&self, orbit: &Orbit, points: Pair) -> [f64; 2] {
        let Pair { u, slope } = points;
        let e = orbit.e2.sqrt();
        let t = (1.0 - e * CRITICAL_B).sqrt();
        let angles = if orbit.family == Family::Trapped {
            slope / (u - TRAPPED_POLE) * self.trapped.at(&self.trapped.orbit.stencil(t), u)
        } else {
            slope / (u + e) * self.weak.at(&self.weak.orbit.stencil(t), u * (1.0 / e))
        };
        angles.to_array()
    }

    /// `A`, and at both points the smooth part of J, `|u̇|/(u + 0.28) B`, and the argument of its logarithm, `s + |u̇|`.
    #[inline(always)]
    fn critical_parts(&self, orbit: &Orbit, points: Pair) -> (f64, [f64; 2], [f64; 2]) {
        let Pair { u, slope } = points;
        let rows = self.critical.orbit.stencil(orbit.e2.sqrt());
        let gamma = (u + 1.0 / 3.0).sqrt();
        let smooth = slope / (u + CRITICAL_POLE) * self.critical.at(&rows, gamma);
        let s = ((u + u - 1.0) + (u - 1.0)).abs() * (gamma * (1.0 / 3.0));
        (
            value(self.amplitude, &rows),
            smooth.to_array(),
            (s + slope).to_array(),
        )
    }
}

/// Two points of an orbit, side by side.
#[derive(Debug, Clone, Copy)]
struct Pair {
    u: f64x2,
    slope: f64x2,
}

impl Pair {
    #[inline(always)]
    fn new(from: Point, to: Point) -> Self {
        Self {
            u: f64x2::new([from.u, to.u]),
            slope: f64x2::new([from.slope, to.slope]),
        }
    }
}

impl SweptAngles for Lookup<'_> {
    /// As measured when the table was made.
    fn error(&self) -> f64 {
        self.error
    }

    #[inline]
    fn direct(&self, orbit: &Orbit, from: Point, to: Point) -> f64 {
        if orbit.e2 > UPPER_E2 {
            let b2 = 1.0 / orbit.e2;
            let rows = self.radial.orbit.stencil(b2);
            let [first, second] = self.radial.at(&rows, Pair::new(from, to).u).to_array();
            return (second - first).abs() * b2.sqrt();
        }
        if orbit.e2 < LOWER_E2 {
            let [first, second] = self.angles_to_turning_point(orbit, Pair::new(from, to));
            return (first - second).abs();
        }
        let (amplitude, smooth, arguments) = self.critical_parts(orbit, Pair::new(from, to));
        let (inside0, inside1) = (
            three_u_minus_two(from.u) > 0.0,
            three_u_minus_two(to.u) > 0.0,
        );
        // On one side of the photon sphere √|Δ| cancels between the logarithms; across it (Δ > 0) they add up.
        let logarithm = if inside0 == inside1 {
            ln_ratio(arguments[1], arguments[0])
        } else {
            ln_ratio(arguments[0] * arguments[1], orbit.delta)
        };
        let sign = if inside1 { 1.0 } else { -1.0 };
        (sign * amplitude * logarithm + (smooth[1] - smooth[0])).abs()
    }

    #[inline]
    fn around(&self, orbit: &Orbit, from: Point, to: Point) -> f64 {
        if orbit.e2 < LOWER_E2 {
            let [first, second] = self.angles_to_turning_point(orbit, Pair::new(from, to));
            return first + second;
        }
        let (amplitude, smooth, arguments) = self.critical_parts(orbit, Pair::new(from, to));
        let logarithms = amplitude * ln_ratio(arguments[0] * arguments[1], -orbit.delta);
        let smooth = smooth[0] + smooth[1];
        let angle = if orbit.family == Family::Trapped {
            logarithms + smooth
        } else {
            logarithms - smooth
        };
        // From turning point to turning point it is 0, but for the rounding of two terms that cancel.
        angle.max(0.0)
    }
}
