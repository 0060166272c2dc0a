//! The first panel: the time and the error of one swept angle.
//!
//! The question is the angle swept until a ray first crosses a given radius. The rays are those of cameras everywhere:
//! camera radii evenly in log r over 1.05 … 1000, directions evenly over the sphere, disk radii evenly in log r over
//! 3 … 30. A low-discrepancy sequence, the same on every machine, chooses them. Rays that do not cross their radius are
//! left out. Every method answers for the same rays, and integrators stop at the crossing.
//!
//! # The exact method's own error
//! The error of every other method is its difference from the exact method. For the exact method itself it is the
//! difference between one integral and the sum of two over the same range, which is about its rounding error. (That it
//! computes the right function, not merely a consistent one, is tested in `tests/swept_angles.rs` against references of
//! 60 digits.)

use std::time::Duration;

use rayon::prelude::*;

use super::exact_self_check::angle_in_two_parts;
use super::interleaved::{Contender, rounds};
use super::measurement::{ChartEffort, ComparedMethod, Measurement, Panel, Quantiles, Time};
use super::methods::{Contestant, Question, Tables};
use crate::orbit::exact::Exact;
use crate::orbit::integrate::Scheme;
use crate::orbit::invariants::Orbit;
use crate::orbit::{Orbits, Ray};

/// The range of camera radii.
const CAMERA_RADII: (f64, f64) = (1.05, 1000.0);

/// The range of radii to be crossed.
const DISK_RADII: (f64, f64) = (3.0, 30.0);

/// Rays that start closer than this, relatively, to the radius to be crossed are left out.
const APART: f64 = 1e-6;

/// The 99th percentile of the baseline's error, in radians.
const BASELINE_ERROR: f64 = 1e-6;

/// The measurements of one swept angle.
#[derive(Debug)]
pub struct RayPanel {
    /// Every method at every setting.
    pub points: Vec<Measurement>,
    /// The step at which the 99th percentile of RK4's error is 1e-6.
    pub baseline_step: f64,
    /// The number of rays.
    pub count: usize,
}

impl RayPanel {
    /// Measures all methods. `progress` receives the share that is done, from 0 to 1.
    pub fn measure(tables: &Tables, effort: ChartEffort, progress: &dyn Fn(f64)) -> Self {
        let (count, repetitions) = match effort {
            ChartEffort::Quick => (1024, 11),
            ChartEffort::Full => (4096, 15),
        };
        let questions = questions(count);
        let truths: Vec<f64> = questions.par_iter().map(truth).collect();
        let baseline_step = baseline_step(&questions, &truths);
        let contestants = contestants(tables, effort, baseline_step);

        let mut contenders: Vec<_> = contestants
            .iter()
            .map(|contestant| Contender {
                name: &contestant.setting,
                run: Box::new(|| contestant.orbits.sum(&questions)),
            })
            .collect();
        let mut done = 0.0;
        let times = rounds(
            &mut contenders,
            repetitions,
            (Duration::from_millis(2), Duration::from_secs(90)),
            &mut || {
                done += 1.0;
                progress(done / (repetitions + 1) as f64);
            },
        );
        let points = contestants
            .iter()
            .enumerate()
            .map(|(i, contestant)| {
                let errors = errors(contestant, &questions, &truths);
                Measurement {
                    panel: Panel::Rays,
                    method: contestant.method,
                    setting: contestant.setting.clone(),
                    time: Some(Time::new(
                        times.median(0) * 1e9 / questions.len() as f64,
                        times.ratio(i, 0),
                    )),
                    failures: (questions.len() - errors.len()) as u64,
                    count: questions.len() as u64,
                    error: Quantiles::of(errors),
                }
            })
            .collect();
        Self {
            points,
            baseline_step,
            count: questions.len(),
        }
    }
}

/// Lists every method at every setting, the baseline first.
fn contestants(tables: &Tables, effort: ChartEffort, baseline_step: f64) -> Vec<Contestant<'_>> {
    let (euler, rk4, adaptive): (&[f64], &[f64], &[f64]) = match effort {
        ChartEffort::Quick => (
            &[0.1, 0.01, 1e-3],
            &[0.5, 0.2, 0.05, 0.01],
            &[1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13],
        ),
        ChartEffort::Full => (
            &[0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4],
            &[0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3],
            &[
                1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13,
            ],
        ),
    };
    let mut all = vec![Contestant::fixed(Scheme::Rk4, baseline_step)];
    all.extend(euler.iter().map(|&h| Contestant::fixed(Scheme::Euler, h)));
    all.extend(rk4.iter().map(|&h| Contestant::fixed(Scheme::Rk4, h)));
    all.extend(adaptive.iter().map(|&t| Contestant::adaptive(t)));
    all.extend(tables.files());
    all.extend(tables.scaled());
    all.push(Contestant::exact());
    all
}

/// Returns `count` rays that cross their radius. They follow the additive sequence with steps 1/g, 1/g², 1/g³, where
/// g⁴ = g + 1 (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
fn questions(count: usize) -> Vec<Question> {
    const STEPS: [f64; 3] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_3,
        0.549_700_477_901_970_1,
    ];
    let between = |(least, greatest): (f64, f64), x: f64| {
        let (least, greatest) = (libm::log(least), libm::log(greatest));
        libm::exp(least + (greatest - least) * x)
    };
    (1_u32..)
        .filter_map(|k| {
            let [x, y, z] = STEPS.map(|step| {
                let at = 0.5 + f64::from(k) * step;
                at - at.floor()
            });
            let u0 = 1.0 / between(CAMERA_RADII, x);
            let radius = between(DISK_RADII, z);
            // Directions spread evenly over the sphere have their component towards the hole spread evenly over −1 … 1.
            let inward = 2.0 * y - 1.0;
            let kappa = inward / ((1.0 - inward) * (1.0 + inward)).sqrt();
            let ray = Ray::new(u0, u0 * (1.0 - u0).sqrt() * kappa).ok()?;
            let apart = (radius * u0 - 1.0).abs() > APART;
            let crosses = Exact.first_crossing(ray, radius).ok()?.is_some();
            (apart && crosses).then_some(Question { ray, radius })
        })
        .take(count)
        .collect()
}

/// Computes the exact answer.
fn truth(question: &Question) -> f64 {
    let first = Exact.first_crossing(question.ray, question.radius);
    first.ok().flatten().unwrap_or(f64::NAN)
}

/// Computes the exact answer as a sum of two integrals.
fn truth_in_two_parts(question: &Question) -> Option<f64> {
    let orbit = Orbit::new(question.ray);
    let to = orbit.point_at(1.0 / question.radius)?;
    let straight = orbit.inward == (to.u > orbit.start.u);
    Some(angle_in_two_parts(&orbit, to, !straight))
}

/// Computes the errors of the answers. Missing answers are skipped.
fn errors(contestant: &Contestant<'_>, questions: &[Question], truths: &[f64]) -> Vec<f64> {
    questions
        .par_iter()
        .zip(truths)
        .filter_map(|(question, truth)| {
            let angle = if contestant.method == ComparedMethod::Exact {
                truth_in_two_parts(question)?
            } else {
                let orbits = &contestant.orbits;
                orbits
                    .first_crossing(question.ray, question.radius)
                    .ok()??
            };
            Some((angle - truth).abs())
        })
        .collect()
}

/// Finds, by bisection in log h, a step at which the 99th percentile of RK4's error is 97 % to 100 % of
/// [`BASELINE_ERROR`].
fn baseline_step(questions: &[Question], truths: &[f64]) -> f64 {
    let p99 = |h: f64| {
        let errors = errors(&Contestant::fixed(Scheme::Rk4, h), questions, truths);
        Quantiles::of(errors).map_or(f64::INFINITY, |quantiles| quantiles.p99)
    };
    let (mut low, mut high): (f64, f64) = (1e-3, 0.5);
    for _ in 0..40 {
        let middle = (low * high).sqrt();
        let error = p99(middle);
        if error > BASELINE_ERROR {
            high = middle;
        } else {
            low = middle;
            if error > 0.97 * BASELINE_ERROR {
                break;
            }
        }
    }
    // Rounds down, so that the printed step repeats the measurement.
    (low * 1e5).floor() / 1e5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::invariants::Family;

    #[test]
    fn rays_of_both_families_cross_their_radii() {
        let questions = questions(1024);
        assert_eq!(questions.len(), 1024);
        let orbits = questions.iter().map(|question| Orbit::new(question.ray));
        let of = |family: Family| {
            orbits
                .clone()
                .filter(|orbit| orbit.family == family)
                .count()
        };
        let kinds = [Family::Monotone, Family::Scattered].map(of);
        assert!(kinds.iter().all(|&count| count > 100), "{kinds:?}");
        assert!(questions.iter().all(|question| truth(question) > 0.0));
    }

    #[test]
    fn two_parts_sum_to_the_whole() {
        for question in questions(512) {
            let (whole, parts) = (truth(&question), truth_in_two_parts(&question).unwrap());
            assert!(
                (whole - parts).abs() < 1e-10,
                "{question:?}: {whole} and {parts}"
            );
        }
    }

    #[test]
    fn the_baseline_has_its_error() {
        let questions = questions(256);
        let truths: Vec<f64> = questions.iter().map(truth).collect();
        let h = baseline_step(&questions, &truths);
        let p99 = |h| {
            let errors = errors(&Contestant::fixed(Scheme::Rk4, h), &questions, &truths);
            Quantiles::of(errors).unwrap().p99
        };
        assert!(p99(h) <= BASELINE_ERROR, "h = {h}: {}", p99(h));
        assert!(p99(1.1 * h) > BASELINE_ERROR, "h = {h}: {}", p99(1.1 * h));
    }
}
