//! Swept angles read from a table.

use super::charts::{CRITICAL_B, LOWER_E2, UPPER_E2};
use super::logarithm::ln_ratio;
use super::spec::{Axes, Spec};
use super::spline::{Scale, Stencil, value, value_2d};
use crate::orbit::invariants::{Family, Orbit, Point, three_u_minus_two};
use crate::orbit::path::SweptAngles;

/// A table's numbers, ready for lookups: a method like any other (see [`crate::orbit`]).
///
/// A swept angle takes one or two square roots, at most one logarithm (about the critical line only), a division and two
/// bicubic interpolations.
#[derive(Debug, Clone, Copy)]
pub struct Lookup<'a> {
    /// A, on the critical chart's orbit axis.
    amplitude: &'a [f64],
    critical: Chart<'a>,
    weak: Chart<'a>,
    trapped: Chart<'a>,
    radial: Chart<'a>,
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

    #[inline(always)]
    fn at(&self, rows: &Stencil, place: f64) -> f64 {
        value_2d(
            self.coefficients,
            self.width,
            rows,
            &self.place.stencil(place),
        )
    }
}

impl<'a> Lookup<'a> {
    /// The charts within `numbers`, which are exactly as many as `spec` says.
    pub(crate) fn new(spec: &Spec, mut numbers: &'a [f64]) -> Self {
        let (amplitude, rest) = numbers.split_at(spec.critical_axes().orbit.coefficients());
        numbers = rest;
        Self {
            amplitude,
            critical: Chart::take(&mut numbers, spec.critical_axes()),
            weak: Chart::take(&mut numbers, spec.weak_axes()),
            trapped: Chart::take(&mut numbers, spec.trapped_axes()),
            radial: Chart::take(&mut numbers, spec.radial_axes()),
        }
    }

    /// The angles from both points to the turning point, where e² is small.
    #[inline(always)]
    fn angles_to_turning_point(&self, orbit: &Orbit, from: Point, to: Point) -> (f64, f64) {
        let e = orbit.e2.sqrt();
        let t = (1.0 - e * CRITICAL_B).sqrt();
        if orbit.family == Family::Trapped {
            let rows = self.trapped.orbit.stencil(t);
            let angle = |point: Point| point.slope * self.trapped.at(&rows, point.u);
            (angle(from), angle(to))
        } else {
            let rows = self.weak.orbit.stencil(t);
            let b = 1.0 / e;
            let angle =
                |point: Point| point.slope / (e + point.u) * self.weak.at(&rows, point.u * b);
            (angle(from), angle(to))
        }
    }

    /// `A`, and at both points the smooth part of J, `(|u̇|/γ²) B`, and the argument of its logarithm, `s + |u̇|`.
    #[inline(always)]
    fn critical_parts(&self, orbit: &Orbit, from: Point, to: Point) -> (f64, [(f64, f64); 2]) {
        let rows = self.critical.orbit.stencil(orbit.e2.sqrt());
        let part = |point: Point| {
            let gamma2 = point.u + 1.0 / 3.0;
            let gamma = gamma2.sqrt();
            let s = three_u_minus_two(point.u).abs() * (1.0 / 3.0) * gamma;
            (
                point.slope / gamma2 * self.critical.at(&rows, gamma),
                s + point.slope,
            )
        };
        (value(self.amplitude, &rows), [part(from), part(to)])
    }
}

impl SweptAngles for Lookup<'_> {
    #[inline]
    fn direct(&self, orbit: &Orbit, from: Point, to: Point) -> f64 {
        if orbit.e2 > UPPER_E2 {
            let b2 = 1.0 / orbit.e2;
            let rows = self.radial.orbit.stencil(b2);
            return (self.radial.at(&rows, to.u) - self.radial.at(&rows, from.u)).abs() * b2.sqrt();
        }
        if orbit.e2 < LOWER_E2 {
            let (first, second) = self.angles_to_turning_point(orbit, from, to);
            return (first - second).abs();
        }
        let (amplitude, [(smooth0, arg0), (smooth1, arg1)]) = self.critical_parts(orbit, from, to);
        let (inside0, inside1) = (
            three_u_minus_two(from.u) > 0.0,
            three_u_minus_two(to.u) > 0.0,
        );
        // On one side of the photon sphere √|Δ| cancels between the logarithms; across it (Δ > 0) they add up.
        let logarithm = if inside0 == inside1 {
            ln_ratio(arg1, arg0)
        } else {
            ln_ratio(arg0 * arg1, orbit.delta)
        };
        let sign = if inside1 { 1.0 } else { -1.0 };
        (sign * amplitude * logarithm + (smooth1 - smooth0)).abs()
    }

    #[inline]
    fn around(&self, orbit: &Orbit, from: Point, to: Point) -> f64 {
        if orbit.e2 < LOWER_E2 {
            let (first, second) = self.angles_to_turning_point(orbit, from, to);
            return first + second;
        }
        let (amplitude, [(smooth0, arg0), (smooth1, arg1)]) = self.critical_parts(orbit, from, to);
        let logarithms = amplitude * ln_ratio(arg0 * arg1, -orbit.delta);
        let smooth = smooth0 + smooth1;
        if orbit.family == Family::Trapped {
            logarithms + smooth
        } else {
            logarithms - smooth
        }
    }
}
