//! Swept angles read from a table.

use wide::f64x2;

use super::charts::{CRITICAL_B, CRITICAL_POLE, LOWER_E2, TRAPPED_POLE, UPPER_E2};
use super::logarithm::ln_ratio;
use super::spec::{Axes, Spec};
use super::spline::{self, Scale, Stencil};
use crate::orbit::invariants::{Family, Orbit, OrbitPoint, three_u_minus_two};
use crate::orbit::path::{FixedRadiiAngles, SweptAngles};

/// A table's numbers, ready for lookups. Like every method it implements [`Orbits`](crate::orbit::Orbits).
///
/// A swept angle takes one or two square roots, at most one logarithm (about the critical line only), a division and
/// two bicubic interpolations, which are computed side by side. (With pairs of plain numbers in place of `f64x2` a
/// swept angle takes 15 % longer about the critical ray and 9 % longer close to radial: `cargo bench --bench rays`.)
#[derive(Debug, Clone, Copy)]
pub struct Lookup<'a> {
    /// Coefficients of A, on the critical chart's orbit axis.
    amplitude: &'a [f64],
    critical: ChartSpline<'a>,
    weak: ChartSpline<'a>,
    trapped: ChartSpline<'a>,
    radial: ChartSpline<'a>,
    error: f64,
}

/// The bicubic spline of one chart's function.
#[derive(Debug, Clone, Copy)]
struct ChartSpline<'a> {
    /// Row by row, `width` coefficients each.
    coefficients: &'a [f64],
    width: usize,
    place: Scale,
    orbit: Scale,
}

impl<'a> ChartSpline<'a> {
    /// Takes the first chart's coefficients off `rest`.
    fn take(rest: &mut &'a [f64], axes: Axes) -> Self {
        let width = axes.place.coefficients();
        let (coefficients, after) = rest.split_at(width * axes.orbit.coefficients());
        *rest = after;
        Self {
            coefficients,
            width,
            place: Scale::new(axes.place),
            orbit: Scale::new(axes.orbit),
        }
    }

    /// Returns the coefficients along the orbit's axis at one place.
    fn column(&self, place: f64) -> Vec<f64> {
        let place = self.place.stencil(place);
        let rows = self.coefficients.chunks_exact(self.width);
        rows.map(|row| spline::value(row, &place)).collect()
    }

    /// Returns the values at two places of one orbit.
    #[inline(always)]
    fn at(&self, row: &Stencil, places: f64x2) -> f64x2 {
        let places = self.place.stencils(places);
        spline::values_2d(self.coefficients, self.width, row, &places)
    }
}

impl<'a> Lookup<'a> {
    /// `numbers` are as many as [`Spec::coefficients`] says, and `error` is the error of their angles.
    pub(crate) fn new(spec: &Spec, numbers: &'a [f64], error: f64) -> Self {
        let (amplitude, mut rest) = numbers.split_at(spec.critical_axes().orbit.coefficients());
        let mut take = |axes| ChartSpline::take(&mut rest, axes);
        Self {
            amplitude,
            critical: take(spec.critical_axes()),
            weak: take(spec.weak_axes()),
            trapped: take(spec.trapped_axes()),
            radial: take(spec.radial_axes()),
            error,
        }
    }

    /// Returns the angles from both points to the turning point, for e² below the critical chart.
    #[inline(always)]
    fn angles_to_turning_point(&self, orbit: &Orbit, points: PointPair) -> [f64; 2] {
        let PointPair { u, slope } = points;
        let e = orbit.e2.sqrt();
        let t = (1.0 - e * CRITICAL_B).sqrt();
        let angles = if orbit.family == Family::Trapped {
            slope / (u - TRAPPED_POLE) * self.trapped.at(&self.trapped.orbit.stencil(t), u)
        } else {
            slope / (u + e) * self.weak.at(&self.weak.orbit.stencil(t), u * (1.0 / e))
        };
        angles.to_array()
    }

    /// Reads the critical chart at two points of an orbit.
    #[inline(always)]
    fn critical_parts(&self, orbit: &Orbit, points: PointPair) -> CriticalParts {
        let row = self.critical.orbit.stencil(orbit.e2.sqrt());
        let PointPair { u, slope } = points;
        let (gamma, s) = gamma_and_s(u);
        CriticalParts {
            amplitude: spline::value(self.amplitude, &row),
            smooth: slope / (u + CRITICAL_POLE) * self.critical.at(&row, gamma),
            arguments: s + slope,
        }
    }

    /// Returns [`SweptAngles::direct`]. `critical` reads the critical chart, where it is needed.
    #[inline(always)]
    fn direct_from(
        &self,
        orbit: &Orbit,
        from: OrbitPoint,
        to: OrbitPoint,
        critical: impl FnOnce(PointPair) -> CriticalParts,
    ) -> f64 {
        let points = PointPair::new(from, to);
        if orbit.e2 > UPPER_E2 {
            let b2 = 1.0 / orbit.e2;
            let row = self.radial.orbit.stencil(b2);
            let [first, second] = self.radial.at(&row, points.u).to_array();
            return (second - first).abs() * b2.sqrt();
        }
        if orbit.e2 < LOWER_E2 {
            let [first, second] = self.angles_to_turning_point(orbit, points);
            return (first - second).abs();
        }
        let parts = critical(points);
        let (smooth, arguments) = (parts.smooth.to_array(), parts.arguments.to_array());
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
        (sign * parts.amplitude * logarithm + (smooth[1] - smooth[0])).abs()
    }

    /// Returns [`SweptAngles::around`]. `critical` reads the critical chart, where it is needed.
    #[inline(always)]
    fn around_from(
        &self,
        orbit: &Orbit,
        from: OrbitPoint,
        to: OrbitPoint,
        critical: impl FnOnce(PointPair) -> CriticalParts,
    ) -> f64 {
        let points = PointPair::new(from, to);
        if orbit.e2 < LOWER_E2 {
            let [first, second] = self.angles_to_turning_point(orbit, points);
            return first + second;
        }
        let parts = critical(points);
        let (smooth, arguments) = (parts.smooth.to_array(), parts.arguments.to_array());
        let logarithms = parts.amplitude * ln_ratio(arguments[0] * arguments[1], -orbit.delta);
        let smooth = smooth[0] + smooth[1];
        let angle = if orbit.family == Family::Trapped {
            logarithms + smooth
        } else {
            logarithms - smooth
        };
        // From turning point to turning point the two terms cancel, up to their rounding.
        angle.max(0.0)
    }
}

/// The critical chart's functions at two points of an orbit.
struct CriticalParts {
    /// `A`.
    amplitude: f64,
    /// The smooth part of J, `|u̇|/(u + 0.28) B`.
    smooth: f64x2,
    /// The argument of its logarithm, `s + |u̇|`.
    arguments: f64x2,
}

/// Returns γ and s at two inverse radii.
#[inline(always)]
fn gamma_and_s(u: f64x2) -> (f64x2, f64x2) {
    let gamma = (u + 1.0 / 3.0).sqrt();
    let s = ((u + u - 1.0) + (u - 1.0)).abs() * (gamma * (1.0 / 3.0));
    (gamma, s)
}

/// Two points of an orbit, side by side.
#[derive(Debug, Clone, Copy)]
struct PointPair {
    u: f64x2,
    slope: f64x2,
}

impl PointPair {
    #[inline(always)]
    fn new(from: OrbitPoint, to: OrbitPoint) -> Self {
        Self {
            u: f64x2::new([from.u, to.u]),
            slope: f64x2::new([from.slope, to.slope]),
        }
    }
}

impl SweptAngles for Lookup<'_> {
    /// Returns the error measured when the table was made.
    fn error(&self) -> f64 {
        self.error
    }

    #[inline]
    fn direct(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64 {
        self.direct_from(orbit, from, to, |points| self.critical_parts(orbit, points))
    }

    #[inline]
    fn around(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64 {
        self.around_from(orbit, from, to, |points| self.critical_parts(orbit, points))
    }

    /// Interpolates the critical chart along its place axis, once for both radii. Of all charts it is the one in
    /// which a fixed radius is a column, and the one that holds most of the orbits that curves are made of.
    fn between(&self, from: f64, to: f64) -> impl FixedRadiiAngles {
        let (gamma, s) = gamma_and_s(f64x2::new([from, to]));
        let [from, to] = [(from, gamma.to_array()[0]), (to, gamma.to_array()[1])];
        FixedRadiiLookup {
            lookup: *self,
            columns: [from, to].map(|(u, gamma)| {
                let mut column = self.critical.column(gamma);
                for b in &mut column {
                    *b /= u + CRITICAL_POLE;
                }
                column
            }),
            s,
        }
    }
}

/// Angles between two radii: the table's, up to rounding.
struct FixedRadiiLookup<'a> {
    lookup: Lookup<'a>,
    /// `B/(u + 0.28)` at both radii, on the critical chart's orbit axis.
    columns: [Vec<f64>; 2],
    /// s at both radii.
    s: f64x2,
}

impl FixedRadiiLookup<'_> {
    #[inline(always)]
    fn critical_parts(&self, orbit: &Orbit, slope: f64x2) -> CriticalParts {
        let row = self.lookup.critical.orbit.stencil(orbit.e2.sqrt());
        let [first, second] = &self.columns;
        CriticalParts {
            amplitude: spline::value(self.lookup.amplitude, &row),
            smooth: slope * f64x2::new([spline::value(first, &row), spline::value(second, &row)]),
            arguments: self.s + slope,
        }
    }
}

impl FixedRadiiAngles for FixedRadiiLookup<'_> {
    #[inline]
    fn direct(&self, orbit: &Orbit, to: OrbitPoint) -> f64 {
        self.lookup.direct_from(orbit, orbit.start, to, |points| {
            self.critical_parts(orbit, points.slope)
        })
    }

    #[inline]
    fn around(&self, orbit: &Orbit, to: OrbitPoint) -> f64 {
        self.lookup.around_from(orbit, orbit.start, to, |points| {
            self.critical_parts(orbit, points.slope)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::Ray;
    use crate::orbit::path::turns;
    use crate::table::{Spec, Table};

    /// Both sum the same sixteen numbers, in another order and with as many roundings: 16 ε of their size for each of
    /// two ends, and as much for the factors.
    const ROUNDING: f64 = 64.0 * f64::EPSILON;

    #[test]
    fn angles_between_fixed_radii_are_the_tables_angles() {
        let table = Table::generate(&Spec::draft()).unwrap();
        let lookup = table.lookup();
        let mut branches = [0; 2];
        for (from, to) in [
            (0.03, 0.3),
            (0.3, 0.1),
            (0.7, 0.2),
            (0.9, 0.95),
            (1e-9, 0.6),
        ] {
            let between = lookup.between(from, to);
            for i in -200..200 {
                let ray = Ray::new(from, 0.003 * (f64::from(i) + 0.5)).unwrap();
                let orbit = Orbit::new(ray);
                let Some(point) = orbit.point_at(to) else {
                    continue;
                };
                let mut agree = |branch: usize, got: f64, known: f64| {
                    branches[branch] += 1;
                    assert!(
                        (got - known).abs() <= ROUNDING * known.max(1.0),
                        "{got}, not {known}: {orbit:?} to {to}"
                    );
                };
                let known = lookup.direct(&orbit, orbit.start, point);
                agree(0, between.direct(&orbit, point), known);
                if turns(&orbit) {
                    let known = lookup.around(&orbit, orbit.start, point);
                    agree(1, between.around(&orbit, point), known);
                }
            }
        }
        assert!(branches.iter().all(|&count| count > 100), "{branches:?}");
    }
}
