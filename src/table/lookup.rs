//! Swept angles read from a table.

use core::marker::PhantomData;

use super::charts::{CRITICAL_B, CRITICAL_POLE, LOWER_E2, TRAPPED_POLE, UPPER_E2};
use super::interpolation::{Cubic, Interpolation};
use super::logarithm::ln_ratio;
use super::spec::{Axes, Spec};
use super::spline::Scale;
use crate::orbit::invariants::{Family, Orbit, Point, three_u_minus_two};
use crate::orbit::path::SweptAngles;
use wide::f64x2;

/// A table's numbers, ready for lookups: a method like any other (see [`crate::orbit`]).
///
/// A swept angle takes one or two square roots, at most one logarithm (about the critical line only), a division and
/// two interpolations, bicubic ones unless `K` says otherwise.
#[derive(Debug, Clone, Copy)]
pub struct Lookup<'a, K = Cubic> {
    /// A, on the critical chart's orbit axis.
    amplitude: &'a [f64],
    critical: Chart<'a>,
    weak: Chart<'a>,
    trapped: Chart<'a>,
    radial: Chart<'a>,
    /// How the charts are read.
    kernel: PhantomData<K>,
    error: f64,
}

#[derive(Debug, Clone, Copy)]
struct Chart<'a> {
    numbers: &'a [f64],
    width: usize,
    place: Scale,
    orbit: Scale,
}

impl<'a> Chart<'a> {
    /// The first chart of `all`, which are those after it from then on; each axis has `beyond` numbers more than nodes.
    fn take(all: &mut &'a [f64], axes: Axes, beyond: usize) -> Self {
        let width = axes.place.nodes as usize + beyond;
        let (numbers, rest) = all.split_at(width * (axes.orbit.nodes as usize + beyond));
        *all = rest;
        Self {
            numbers,
            width,
            place: Scale::new(axes.place),
            orbit: Scale::new(axes.orbit),
        }
    }

    /// The values at two places of one orbit.
    #[inline(always)]
    fn at<K: Interpolation>(&self, row: &K::Place, places: f64x2) -> f64x2 {
        K::values_2d(
            self.numbers,
            self.width,
            row,
            &K::places(self.place, places),
        )
    }
}

impl<'a, K: Interpolation> Lookup<'a, K> {
    /// The charts within `numbers`, which are exactly as many as `spec` and `kernel` say; `error` is that of their
    /// angles.
    pub(crate) fn new(spec: &Spec, numbers: &'a [f64], error: f64, _kernel: K) -> Self {
        let nodes = spec.critical_axes().orbit.nodes as usize;
        let (amplitude, mut rest) = numbers.split_at(nodes + K::BEYOND);
        let mut take = |axes| Chart::take(&mut rest, axes, K::BEYOND);
        Self {
            amplitude,
            critical: take(spec.critical_axes()),
            weak: take(spec.weak_axes()),
            trapped: take(spec.trapped_axes()),
            radial: take(spec.radial_axes()),
            kernel: PhantomData,
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
            slope / (u - TRAPPED_POLE) * self.trapped.at::<K>(&K::place(self.trapped.orbit, t), u)
        } else {
            slope / (u + e)
                * self
                    .weak
                    .at::<K>(&K::place(self.weak.orbit, t), u * (1.0 / e))
        };
        angles.to_array()
    }

    /// `A`, and at both points the smooth part of J, `|u̇|/(u + 0.28) B`, and the argument of its logarithm, `s + |u̇|`.
    #[inline(always)]
    fn critical_parts(&self, orbit: &Orbit, points: Pair) -> (f64, [f64; 2], [f64; 2]) {
        let Pair { u, slope } = points;
        let row = K::place(self.critical.orbit, orbit.e2.sqrt());
        let gamma = (u + 1.0 / 3.0).sqrt();
        let smooth = slope / (u + CRITICAL_POLE) * self.critical.at::<K>(&row, gamma);
        let s = ((u + u - 1.0) + (u - 1.0)).abs() * (gamma * (1.0 / 3.0));
        (
            K::value(self.amplitude, &row),
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

impl<K: Interpolation> SweptAngles for Lookup<'_, K> {
    /// As measured when the table was made.
    fn error(&self) -> f64 {
        self.error
    }

    #[inline]
    fn direct(&self, orbit: &Orbit, from: Point, to: Point) -> f64 {
        if orbit.e2 > UPPER_E2 {
            let b2 = 1.0 / orbit.e2;
            let row = K::place(self.radial.orbit, b2);
            let [first, second] = self.radial.at::<K>(&row, Pair::new(from, to).u).to_array();
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
