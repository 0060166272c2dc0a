//! The second panel: the error of a ray's total angle, as the ray comes closer to the critical one.
//!
//! The critical ray winds around the photon sphere for ever. A nearby ray winds by about ln(1/distance), where
//! `distance = |27e²/4 − 1|`, and then escapes or is captured. Meanwhile an error grows as e^φ. Methods therefore fail
//! here first: in the angle, and close enough in the ray's fate.
//!
//! Rays towards the photon sphere start at several radii, for each half decade of the distance and for each fate. Not
//! every slope is a double. Of the neighbouring doubles the one whose distance is closest is taken, and its actual
//! distance is reported.
//!
//! # The effect of rounding the ray
//! A slope stored as a double is exact to ε/2. The grey line is `ε |∂angle/∂ln dudphi|`, the largest over the rays: the
//! change of the angle when the last digit of the slope changes. A method that steps through rounded states cannot stay
//! below it. A method that computes e² − 4/27 from the two given numbers, as accurately as they are given, can: it
//! answers for exactly these numbers.

use rayon::prelude::*;

use super::exact_self_check::angle_in_two_parts;
use super::measurement::{ChartEffort, ComparedMethod, Measurement, Panel, Quantiles};
use super::methods::{Contestant, Tables};
use crate::orbit::exact::Exact;
use crate::orbit::integrate::Scheme;
use crate::orbit::invariants::{CRITICAL_E2, Family, Orbit, critical_slope, three_u_minus_two};
use crate::orbit::path::SweptAngles;
use crate::orbit::{EventKind, Fate, Ray};

/// The radii at which rays start.
const START_RADII: [f64; 5] = [1000.0, 30.0, 6.0, 2.0, 1.2];

/// The closest distance is 10 to minus this: a few units in the last place of e².
const CLOSEST_DECADE: i32 = 15;

/// The fates that a ray near the critical one may have.
const FATES: [Fate; 2] = [Fate::Escape, Fate::Capture];

/// The measurements near the critical ray.
#[derive(Debug)]
pub struct CriticalPanel {
    /// Every method at every distance.
    pub points: Vec<CriticalPoint>,
    /// The change of the angle, in radians, when the last digit of the ray's slope changes.
    pub rounding: Vec<(CriticalDistance, f64)>,
}

/// One method at one distance.
#[derive(Debug)]
pub struct CriticalPoint {
    /// The distance.
    pub distance: CriticalDistance,
    /// The errors there.
    pub measurement: Measurement,
}

/// A distance from the critical ray, on one side of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalDistance {
    /// The fate of the rays.
    pub fate: Fate,
    /// `|27e²/4 − 1|`, the geometric mean over the rays.
    pub value: f64,
}

/// The rays at one distance, one from each start radius.
struct RaysAtDistance {
    distance: CriticalDistance,
    rays: Vec<(Ray, Orbit)>,
}

impl CriticalPanel {
    /// Measures all methods. `progress` receives the share that is done, from 0 to 1.
    pub fn measure(tables: &Tables, effort: ChartEffort, progress: &dyn Fn(f64)) -> Self {
        let steps = match effort {
            ChartEffort::Quick => 1,
            ChartEffort::Full => 2,
        };
        let exponents = (0..=CLOSEST_DECADE * steps).map(|k| -f64::from(k) / f64::from(steps));
        let distances: Vec<_> = exponents
            .map(|exponent| libm::pow(10.0, exponent))
            .flat_map(|distance| FATES.map(|fate| (fate, distance)))
            .filter_map(|(fate, distance)| RaysAtDistance::new(fate, distance))
            .collect();
        let mut contestants = vec![
            Contestant::fixed(Scheme::Euler, 1e-3),
            Contestant::fixed(Scheme::Rk4, 0.05),
            Contestant::fixed(Scheme::Rk4, 0.01),
            Contestant::adaptive(1e-9),
        ];
        contestants.extend(tables.files());
        contestants.push(Contestant::exact());
        let mut points = Vec::new();
        for (i, contestant) in contestants.iter().enumerate() {
            points.par_extend(distances.par_iter().map(|rays| rays.measure(contestant)));
            progress((i + 1) as f64 / contestants.len() as f64);
        }
        let rounding = distances
            .iter()
            .map(|rays| (rays.distance, rays.rounding()));
        Self {
            points,
            rounding: rounding.collect(),
        }
    }
}

impl RaysAtDistance {
    /// Finds the rays. Returns `None` if no ray with this fate is that far from the critical one.
    fn new(fate: Fate, distance: f64) -> Option<Self> {
        let rays: Vec<_> = START_RADII
            .iter()
            .filter_map(|radius| closest_ray(1.0 / radius, fate, distance))
            .collect();
        let logarithms = rays
            .iter()
            .map(|(_, orbit)| libm::log(orbit.delta.abs() / CRITICAL_E2));
        let mean = logarithms.sum::<f64>() / rays.len() as f64;
        (!rays.is_empty()).then(|| Self {
            distance: CriticalDistance {
                fate,
                value: libm::exp(mean),
            },
            rays,
        })
    }

    /// Computes the errors of one method.
    fn measure(&self, contestant: &Contestant<'_>) -> CriticalPoint {
        let errors = self.rays.iter().filter_map(|(ray, orbit)| {
            let angle = if contestant.method == ComparedMethod::Exact {
                angle_in_two_parts(orbit, orbit.end(), orbit.family != Family::Monotone)
            } else {
                let events = contestant.orbits.follow(*ray, &[]).ok()?;
                let end = events.last()?;
                (end.kind == EventKind::End(orbit.fate())).then_some(end.angle)?
            };
            Some((angle - Exact.to_end(orbit)).abs())
        });
        let errors: Vec<f64> = errors.collect();
        let CriticalDistance { fate, value } = self.distance;
        let side = match fate {
            Fate::Escape => "escape",
            Fate::Capture => "capture",
        };
        let setting = format!("{} distance={value:.0e} side={side}", contestant.setting);
        CriticalPoint {
            distance: self.distance,
            measurement: Measurement {
                panel: Panel::Critical,
                method: contestant.method,
                setting: setting.trim_start().to_owned(),
                time: None,
                failures: (self.rays.len() - errors.len()) as u64,
                count: self.rays.len() as u64,
                error: Quantiles::of(errors),
            },
        }
    }

    /// Computes `ε |∂angle/∂ln dudphi|`, the largest over the rays, from differences of 2 % in Δ, with w the slope and
    /// `dΔ = 2 w² d ln w`.
    fn rounding(&self) -> f64 {
        const SHARE: f64 = 0.01;
        let sensitivity = self.rays.iter().map(|(ray, orbit)| {
            let (w2, delta) = (ray.dudphi() * ray.dudphi(), orbit.delta);
            let beside = |share: f64| {
                let changed = delta * (1.0 + share);
                let slope = (w2 + delta * share).sqrt().copysign(ray.dudphi());
                Exact.to_end(&Orbit::with_delta(ray.u(), slope, changed))
            };
            let change = (beside(SHARE) - beside(-SHARE)).abs();
            change * w2 / (SHARE * delta.abs())
        });
        f64::EPSILON * sensitivity.fold(0.0, f64::max)
    }
}

/// Finds the ray from inverse radius `u` towards the photon sphere whose distance from the critical ray is closest to
/// `distance`. Only doubles near the exact slope are tried.
fn closest_ray(u: f64, fate: Fate, distance: f64) -> Option<(Ray, Orbit)> {
    let inward = three_u_minus_two(u) < 0.0;
    // A ray crosses the photon sphere if its e² is above the critical value.
    let crosses = (fate == Fate::Capture) == inward;
    let delta = CRITICAL_E2 * if crosses { distance } else { -distance };
    let s = critical_slope(u);
    let slope = (s * s + delta).sqrt();
    // Rounding moves s and the root by a few units in the last place.
    let neighbours = (-32_i64..=32).filter_map(|step| {
        let slope = f64::from_bits(slope.to_bits().checked_add_signed(step)?);
        let ray = Ray::new(u, if inward { slope } else { -slope }).ok()?;
        let orbit = Orbit::new(ray);
        let off = libm::log(orbit.delta / delta).abs();
        (orbit.fate() == fate && off < 1.0).then_some((off, ray, orbit))
    });
    let closest = neighbours.min_by(|a, b| a.0.total_cmp(&b.0));
    closest.map(|(_, ray, orbit)| (ray, orbit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_have_the_distance_and_the_fate_asked_for() {
        for fate in FATES {
            for exponent in 1..=15 {
                let distance = libm::pow(10.0, -f64::from(exponent));
                let rays = RaysAtDistance::new(fate, distance).unwrap();
                assert_eq!(rays.rays.len(), START_RADII.len(), "{fate:?} {distance:e}");
                for (ray, orbit) in rays.rays {
                    let found = orbit.delta.abs() / CRITICAL_E2;
                    // Neighbouring doubles for the slope are 1e-16 to 4e-16 apart in e².
                    let allowed = 1e-9 + 4e-16 / distance;
                    assert!(
                        (found / distance - 1.0).abs() < allowed,
                        "{ray:?}: {found:e} for {distance:e}"
                    );
                    assert_eq!(orbit.fate(), fate);
                }
            }
        }
    }

    #[test]
    fn the_effect_of_rounding_is_inverse_to_the_distance() {
        let at = |distance| {
            RaysAtDistance::new(Fate::Capture, distance)
                .unwrap()
                .rounding()
        };
        let ratio = at(1e-10) / at(1e-8);
        assert!((ratio - 100.0).abs() < 1.0, "{ratio}");
        // A captured ray's angle is −ln Δ plus a smooth part, `dΔ = 2 w² d ln w`, and far out w² is near 4/27.
        let expected = 2.0 * f64::EPSILON * 1e8;
        assert!((at(1e-8) / expected - 1.0).abs() < 0.1, "{:e}", at(1e-8));
    }
}
