//! The chart: what every method's answer costs and how wrong it is, measured where the program runs.
//!
//! | panel | what is asked | against |
//! |---|---|---|
//! | [`rays`] | the angle to a ray's first crossing of one radius | the time it takes |
//! | [`critical`] | fate and angle to the end | the ray's distance from the critical one |
//! | [`scene`] | where the disk's edges are in a scene's frame | the time a frame takes |
//!
//! The truth is the exact method's throughout; how exact that is, is measured too, by answering in two parts what it
//! answers in one. All times are medians of [interleaved] repetitions on one thread.

pub mod critical;
mod csv;
pub mod draw;
mod halves;
pub mod interleaved;
mod machine;
pub mod methods;
mod pareto;
pub mod rays;
pub mod scene;

use core::fmt;

pub use csv::write_csv;
pub use machine::machine;
use methods::{Method, Tables};

use crate::render::RenderError;
use crate::scene::Scene;
use crate::table::SpecError;

/// How much is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Some seconds: fewer rays, settings and repetitions.
    Quick,
    /// Some minutes.
    Full,
}

/// Told how far the work has come: what is being done, and the share of the whole that is.
pub type Progress<'a> = dyn Fn(&'static str, f64) + Sync + 'a;

/// Why nothing could be measured.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    /// A table to measure with cannot be made.
    #[error(transparent)]
    Table(#[from] SpecError),
    /// The thread that times are taken on.
    #[error("the thread to measure on cannot be started ({0})")]
    Threads(String),
    /// A frame that cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A part of the chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Panel {
    /// Time and error of one swept angle.
    Rays,
    /// Error about the critical ray.
    Critical,
    /// Time and error of a scene's frame.
    Scene,
}

/// One measured point: a row of the CSV.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Where it belongs.
    pub panel: Panel,
    /// What was measured.
    pub method: Method,
    /// With which settings, as words `name=value`.
    pub setting: String,
    /// What it costs, where that was measured.
    pub time: Option<Time>,
    /// How wrong the answers are, where there are any.
    pub error: Option<Quantiles>,
    /// Answers that are wrong in kind, or were not given.
    pub failures: u64,
    /// How many answers were asked for.
    pub count: u64,
}

/// What an answer costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Time {
    /// Nanoseconds for each ray (for each pixel, in a frame).
    pub nanoseconds: f64,
    /// How many times as fast it is as RK4 in the [step](rays::Rays::baseline_step) that makes its 99th percentile
    /// 1e-6.
    pub ratio_to_rk4: f64,
}

/// How wrong answers are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantiles {
    /// The median.
    pub p50: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

impl Quantiles {
    /// Of `errors`, none of which is NaN; `None` where there are none.
    pub fn of(mut errors: Vec<f64>) -> Option<Self> {
        errors.sort_by(f64::total_cmp);
        let max = *errors.last()?;
        // The smallest value that no more than this share of all exceed.
        let at = |share: f64| {
            let rank = (share * errors.len() as f64).ceil() as usize;
            errors.get(rank.max(1) - 1).copied().unwrap_or(max)
        };
        Some(Self {
            p50: at(0.5),
            p99: at(0.99),
            max,
        })
    }
}

impl fmt::Display for Panel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rays => "rays",
            Self::Critical => "critical",
            Self::Scene => "scene",
        })
    }
}

/// All that is measured.
#[derive(Debug)]
pub struct Chart {
    /// The first panel.
    pub rays: rays::Rays,
    /// The second.
    pub critical: critical::Critical,
    /// The third.
    pub frame: scene::Frame,
}

impl Chart {
    /// Measures everything, on the scene called `name` in the third panel.
    ///
    /// # Errors
    /// [`ChartError`]
    pub fn measure(
        scene: &Scene,
        name: String,
        effort: Effort,
        progress: &Progress<'_>,
    ) -> Result<Self, ChartError> {
        progress("making tables", 0.0);
        let tables = Tables::new(effort)?;
        let rays = rays::Rays::measure(&tables, effort, &|share| {
            progress("timing rays", 0.05 + 0.4 * share);
        });
        let critical = critical::Critical::measure(&tables, effort, &|share| {
            progress("near-critical rays", 0.45 + 0.05 * share);
        });
        let step = rays.baseline_step;
        let frame = scene::Frame::measure(scene, name, &tables, step, effort, &|share| {
            progress("frames", 0.5 + 0.5 * share);
        })?;
        Ok(Self {
            rays,
            critical,
            frame,
        })
    }

    /// All measured points, panel after panel.
    pub fn measurements(&self) -> impl Iterator<Item = &Measurement> {
        self.rays
            .points
            .iter()
            .chain(self.critical.points.iter().map(|point| &point.measurement))
            .chain(self.frame.points.iter().flat_map(|point| {
                let orders = point.orders.iter().filter(|order| order.count > 0);
                orders.chain([&point.pixels])
            }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_occur() {
        let hundred = Quantiles::of((1..=100).rev().map(f64::from).collect()).unwrap();
        assert_eq!((hundred.p50, hundred.p99, hundred.max), (50.0, 99.0, 100.0));
        let one = Quantiles::of(vec![2.0]).unwrap();
        assert_eq!((one.p50, one.p99, one.max), (2.0, 2.0, 2.0));
        assert_eq!(Quantiles::of(Vec::new()), None);
    }
}
