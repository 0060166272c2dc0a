//! The first panel: what one swept angle costs, and how wrong it is.
//!
//! The rays are those of cameras everywhere. Camera radii are spread evenly in log r over 1.05 … 1000, directions
//! over the sphere, disk radii in log r over 3 … 30, by an additive sequence that fills the cube evenly and is the
//! same on every machine; of these the rays that cross their disk radius are kept. The question is the angle swept
//! until they first do. Every method answers it for the same rays and is charged for no more: the integrators stop
//! there.
//!
//! # The exact method's own error
//! The others are wrong by their difference from the exact method. Its own point shows how far it is from itself: the
//! integral over the whole stretch against the sum of the integrals over two parts of it, which is of the size of its
//! rounding errors. (That it is the right function, not only a consistent one, is for `tests/swept_angles.rs` to say,
//! which compares it with references of 60 digits.)

use std::time::Duration;

use rayon::prelude::*;

use super::halves::in_two_parts;
use super::interleaved::{Contender, rounds};
use super::methods::{Contestant, Method, Question, Tables};
use super::{Effort, Measurement, Panel, Quantiles, Time};
use crate::orbit::exact::Exact;
use crate::orbit::integrate::Scheme;
use crate::orbit::invariants::Orbit;
use crate::orbit::{Orbits, Ray};

/// Where the cameras are.
const CAMERA_RADII: (f64, f64) = (1.05, 1000.0);

/// Where the disk's edges are.
const DISK_RADII: (f64, f64) = (3.0, 30.0);

/// A ray that starts closer than this to the radius it is to cross asks nothing.
const APART: f64 = 1e-6;

/// The error that the baseline is to have.
const BASELINE_ERROR: f64 = 1e-6;

/// What is measured of one swept angle.
#[derive(Debug)]
pub struct Rays {
    /// Every method at every setting.
    pub points: Vec<Measurement>,
    /// The step with which RK4's 99th percentile is 1e-6.
    pub baseline_step: f64,
    /// How many rays.
    pub count: usize,
}

impl Rays {
    /// Measures; `progress` is told which share is done.
    pub fn measure(tables: &Tables, effort: Effort, progress: &dyn Fn(f64)) -> Self {
        let (count, repetitions) = match effort {
            Effort::Quick => (1024, 11),
            Effort::Full => (4096, 15),
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
                    time: Some(Time {
                        nanoseconds: times.median(i) * 1e9 / questions.len() as f64,
                        ratio_to_rk4: times.ratio(i, 0),
                    }),
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

/// Every method at every setting; first the baseline.
fn contestants(tables: &Tables, effort: Effort, baseline_step: f64) -> Vec<Contestant<'_>> {
    let (euler, rk4, adaptive): (&[f64], &[f64], &[f64]) = match effort {
        Effort::Quick => (
            &[0.1, 0.01, 1e-3],
            &[0.5, 0.2, 0.05, 0.01],
            &[1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13],
        ),
        Effort::Full => (
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

/// `count` rays that cross their radius: those of the sequence of powers of 1/g, g⁴ = g + 1, which fills the cube
/// evenly (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
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
            // The part of the direction towards the hole is spread evenly over −1 … 1.
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

fn truth(question: &Question) -> f64 {
    let first = Exact.first_crossing(question.ray, question.radius);
    first.ok().flatten().unwrap_or(f64::NAN)
}

/// The exact answer, in two parts.
fn parts(question: &Question) -> Option<f64> {
    let orbit = Orbit::new(question.ray);
    let to = orbit.point_at(1.0 / question.radius)?;
    let straight = orbit.inward == (to.u > orbit.start.u);
    Some(in_two_parts(&orbit, to, !straight))
}

/// How wrong the answers are; those that are missing are not among them.
fn errors(contestant: &Contestant<'_>, questions: &[Question], truths: &[f64]) -> Vec<f64> {
    questions
        .par_iter()
        .zip(truths)
        .filter_map(|(question, truth)| {
            let angle = if contestant.method == Method::Exact {
                parts(question)?
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

/// The step with which RK4's 99th percentile is [`BASELINE_ERROR`] or up to 3 % less: bisected in log h.
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
    // Four digits of it, downwards, are enough to repeat it with.
    (low * 1e5).floor() / 1e5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::invariants::Family;

    #[test]
    fn the_rays_are_of_all_kinds_and_cross_their_radii() {
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
    fn two_parts_make_the_whole() {
        for question in questions(512) {
            let (whole, parts) = (truth(&question), parts(&question).unwrap());
            assert!(
                (whole - parts).abs() < 1e-10,
                "{question:?}: {whole} and {parts}"
            );
        }
    }

    #[test]
    fn the_baseline_is_right_to_its_error() {
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
