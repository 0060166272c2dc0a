//! What a measured point consists of, and what measuring needs: how thoroughly to measure, how to report progress, what
//! can go wrong.

use core::fmt;

use crate::render::RenderError;
use crate::scene::SceneError;
use crate::table::SpecError;

/// How thoroughly to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChartEffort {
    /// Takes seconds: fewer rays, settings and repetitions.
    Quick,
    /// Takes minutes.
    Full,
}

/// Receives the name of the current step and the share of all work that is done, from 0 to 1.
pub type ChartProgress<'a> = dyn Fn(&'static str, f64) + Sync + 'a;

/// Why measuring failed.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    /// A table could not be generated.
    #[error(transparent)]
    Table(#[from] SpecError),
    /// The thread on which times are taken could not be started.
    #[error("the thread to measure on cannot be started ({0})")]
    Threads(String),
    /// A frame could not be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The scene has no disk.
    #[error(
        "the chart measures frames of a disk, and the scene has none; choose a scene with the table [disk]"
    )]
    NoDisk,
    /// The scene has no form that can be measured.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// A panel of the figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Panel {
    /// Time and error of one swept angle.
    Rays,
    /// Error near the critical ray.
    Critical,
    /// Time and error of a scene's frame.
    Scene,
    /// Time and error of a lit frame.
    Light,
}

/// A method that computes what happens to a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ComparedMethod {
    /// Euler's method with equal steps.
    Euler,
    /// The classical Runge–Kutta method with equal steps.
    Rk4,
    /// DOP853 with steps that a tolerance controls.
    Adaptive,
    /// Elliptic integrals.
    Exact,
    /// The draft table.
    TableDraft,
    /// The standard table.
    TableStandard,
    /// The fine table.
    TableFine,
    /// Tables with the standard table's number of nodes along each axis, times a factor.
    TableScaled,
}

impl ComparedMethod {
    /// All methods, in the order of the figure.
    pub const ALL: [Self; 8] = [
        Self::Euler,
        Self::Rk4,
        Self::Adaptive,
        Self::Exact,
        Self::TableScaled,
        Self::TableDraft,
        Self::TableStandard,
        Self::TableFine,
    ];

    /// Returns the method's name in the CSV file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Euler => "euler",
            Self::Rk4 => "rk4",
            Self::Adaptive => "adaptive",
            Self::Exact => "exact",
            Self::TableDraft => "table-draft",
            Self::TableStandard => "table-standard",
            Self::TableFine => "table-fine",
            Self::TableScaled => "table-scaled",
        }
    }
}

impl fmt::Display for ComparedMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One measured point, which is one row of the CSV file.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// The panel that the point belongs to.
    pub panel: Panel,
    /// The method measured.
    pub method: ComparedMethod,
    /// The method's settings: `name=value`, separated by spaces.
    pub setting: String,
    /// The cost, if it was measured.
    pub time: Option<Time>,
    /// The errors, if there are any answers.
    pub error: Option<Quantiles>,
    /// The number of answers that are missing or wrong in kind.
    pub failures: u64,
    /// The number of answers asked for.
    pub count: u64,
}

/// The cost of an answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Time {
    /// Nanoseconds per ray; in panels [`Scene`](Panel::Scene) and [`Light`](Panel::Light), per pixel. This is RK4's
    /// median time divided by the ratio below, because a drift of the machine's speed between rounds hardly changes
    /// ratios.
    pub nanoseconds: f64,
    /// The median over the rounds of RK4's time divided by this time. RK4 takes the
    /// [step](super::rays::RayPanel::baseline_step) at which the 99th percentile of its error is 1e-6.
    pub ratio_to_rk4: f64,
}

impl Time {
    /// Creates the cost of an answer from RK4's time in nanoseconds and the ratio of RK4's time to this one.
    pub(super) fn new(rk4_nanoseconds: f64, ratio_to_rk4: f64) -> Self {
        let nanoseconds = rk4_nanoseconds / ratio_to_rk4;
        Self {
            nanoseconds,
            ratio_to_rk4,
        }
    }
}

/// Quantiles of the errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantiles {
    /// The median.
    pub p50: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The largest error.
    pub max: f64,
}

impl Quantiles {
    /// Computes the quantiles of `errors`, none of which may be NaN. Returns `None` for an empty list.
    pub fn of(mut errors: Vec<f64>) -> Option<Self> {
        errors.sort_by(f64::total_cmp);
        let max = *errors.last()?;
        // The smallest error that at least this share of all errors do not exceed.
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
            Self::Light => "light",
        })
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
