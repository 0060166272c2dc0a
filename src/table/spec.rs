//! What a table is made from: how many nodes each chart has along each axis.

use serde::{Deserialize, Serialize};

use super::charts;
use super::spline::NodeAxis;

/// A table's specification. A table's bytes depend on nothing but its specification and the format's version.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// `draft`, `standard`, `fine`, or another name of 1 to 100 bytes without control characters.
    pub name: String,
    /// The largest error of a swept angle that the table is made for, in radians. It does not include the effect of
    /// rounding the ray's start.
    pub tolerance: f64,
    /// Nodes of `B(γ, e)` about the critical line. The logarithm's factor `A(e)` has as many nodes along e.
    pub critical: ChartNodes,
    /// Nodes of `V(u/e, t)`, for rays that pass at a distance.
    pub weak: ChartNodes,
    /// Nodes of `Z(u, t)`, for rays that never leave the hole's neighbourhood.
    pub trapped: ChartNodes,
    /// Nodes of `H(u, 1/e²)`, for rays aimed close to the hole.
    pub radial: ChartNodes,
}

/// How many nodes one chart has, 6 to 4096 along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChartNodes {
    /// Along the axis of the place on the orbit (γ, u/e or u).
    pub place: u32,
    /// Along the axis of the orbit (e, t or 1/e²).
    pub orbit: u32,
}

/// No table can have a specification.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "no table can have this specification: each axis has 6 to 4096 nodes, the tolerance is a positive number, and the \
     name has 1 to 100 bytes and no control characters"
)]
pub struct SpecError;

/// The two axes of a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axes {
    pub(crate) place: NodeAxis,
    pub(crate) orbit: NodeAxis,
}

impl Axes {
    fn new(nodes: ChartNodes, place: (f64, f64), orbit: (f64, f64)) -> Self {
        Self {
            place: NodeAxis {
                start: place.0,
                end: place.1,
                nodes: nodes.place,
            },
            orbit: NodeAxis {
                start: orbit.0,
                end: orbit.1,
                nodes: nodes.orbit,
            },
        }
    }

    /// Returns how many coefficients the chart has.
    fn coefficients(self) -> usize {
        self.place.coefficients() * self.orbit.coefficients()
    }
}

impl Spec {
    /// The names of the program's own specifications, coarsest first.
    pub const NAMES: [&'static str; 3] = ["draft", "standard", "fine"];

    /// Returns the specification for errors up to 1e-6 radians.
    pub fn draft() -> Self {
        Self::new("draft", 1e-6, [(22, 28), (18, 22), (8, 22), (26, 10)])
    }

    /// Returns the specification for errors up to 1e-9 radians.
    pub fn standard() -> Self {
        let nodes = [(112, 168), (92, 112), (20, 120), (128, 36)];
        Self::new("standard", 1e-9, nodes)
    }

    /// Returns the specification for errors up to 1e-12 radians.
    pub fn fine() -> Self {
        let nodes = [(560, 920), (500, 640), (80, 560), (760, 190)];
        Self::new("fine", 1e-12, nodes)
    }

    /// Returns the specification called by one of [`Spec::NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "draft" => Some(Self::draft()),
            "standard" => Some(Self::standard()),
            "fine" => Some(Self::fine()),
            _ => None,
        }
    }

    /// `nodes` are those of the critical, the weak, the trapped and the radial chart, (place, orbit).
    fn new(name: &str, tolerance: f64, nodes: [(u32, u32); 4]) -> Self {
        let [critical, weak, trapped, radial] =
            nodes.map(|(place, orbit)| ChartNodes { place, orbit });
        Self {
            name: name.into(),
            tolerance,
            critical,
            weak,
            trapped,
            radial,
        }
    }

    /// Returns the specification with `factor` times as many nodes along each axis, or the fewest that an axis may
    /// have.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled =
            |nodes: u32| ((f64::from(nodes) * factor).round() as u32).max(NodeAxis::FEWEST);
        let both = |nodes: ChartNodes| ChartNodes {
            place: scaled(nodes.place),
            orbit: scaled(nodes.orbit),
        };
        Self {
            critical: both(self.critical),
            weak: both(self.weak),
            trapped: both(self.trapped),
            radial: both(self.radial),
            ..self.clone()
        }
    }

    /// The four charts' nodes, in the order in which a table holds the charts.
    fn charts(&self) -> [ChartNodes; 4] {
        [self.critical, self.weak, self.trapped, self.radial]
    }

    /// Returns how many nodes the four charts have together.
    pub fn nodes(&self) -> u64 {
        let nodes = |chart: ChartNodes| u64::from(chart.place) * u64::from(chart.orbit);
        self.charts().into_iter().map(nodes).sum()
    }

    /// Returns how many rows of nodes the four charts have together.
    pub(super) fn rows(&self) -> u64 {
        let rows = |chart: ChartNodes| u64::from(chart.orbit);
        self.charts().into_iter().map(rows).sum()
    }

    pub(crate) fn critical_axes(&self) -> Axes {
        // u from 0 to 1.
        let gamma = ((1.0 / 3.0_f64).sqrt(), (4.0 / 3.0_f64).sqrt());
        Axes::new(
            self.critical,
            gamma,
            (charts::LOWER_E2.sqrt(), charts::UPPER_E2.sqrt()),
        )
    }

    pub(crate) fn weak_axes(&self) -> Axes {
        Axes::new(self.weak, (0.0, charts::WEAK_V), Self::t_range())
    }

    pub(crate) fn trapped_axes(&self) -> Axes {
        Axes::new(self.trapped, (charts::TRAPPED_U, 1.0), Self::t_range())
    }

    /// `t = √(1 − e/e_c)` from e = 0 to the critical chart.
    fn t_range() -> (f64, f64) {
        (
            1.0,
            (1.0 - charts::LOWER_E2.sqrt() * charts::CRITICAL_B).sqrt(),
        )
    }

    pub(crate) fn radial_axes(&self) -> Axes {
        Axes::new(self.radial, (0.0, 1.0), (0.0, 1.0 / charts::UPPER_E2))
    }

    /// Returns how many numbers the table holds: the coefficients of A and of the four charts.
    pub(crate) fn coefficients(&self) -> usize {
        self.critical_axes().orbit.coefficients()
            + [
                self.critical_axes(),
                self.weak_axes(),
                self.trapped_axes(),
                self.radial_axes(),
            ]
            .into_iter()
            .map(Axes::coefficients)
            .sum::<usize>()
    }

    /// Whether a table can have this specification: see [`SpecError`].
    pub(crate) fn is_sound(&self) -> bool {
        let allowed = NodeAxis::FEWEST..=Self::MOST_NODES;
        self.charts()
            .iter()
            .all(|n| allowed.contains(&n.place) && allowed.contains(&n.orbit))
            && self.tolerance > 0.0
            && self.tolerance.is_finite()
            && !self.name.is_empty()
            && self.name.len() <= Self::LONGEST_NAME
            && !self.name.contains(char::is_control)
    }

    /// The longest name, in bytes.
    const LONGEST_NAME: usize = 100;

    /// The most nodes of an axis: the size of such a table is far below any counter's limit.
    const MOST_NODES: u32 = 4096;
}
