//! What a table is made of: how many nodes each chart has along each axis.

use serde::{Deserialize, Serialize};

use super::charts;
use super::spline::Axis;

/// A table's specification. The three that come with the program stand in `tables/*.toml`; a table's bytes depend on
/// its specification and on the format's version alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// `draft`, `standard` or `fine`, or another name of 1 to 100 bytes without control characters.
    pub name: String,
    /// The largest error of a swept angle that the table promises, in radians, beyond what rounding of the ray's
    /// start does.
    pub tolerance: f64,
    /// Nodes of `B(γ, e)`, and along e of the logarithm's factor `A(e)`: about the critical line.
    pub critical: Nodes,
    /// Nodes of `V(u/e, t)`: rays that pass at a distance.
    pub weak: Nodes,
    /// Nodes of `Z(u, t)`: rays that never leave the hole's neighbourhood.
    pub trapped: Nodes,
    /// Nodes of `H(u, 1/e²)`: rays aimed close to the hole.
    pub radial: Nodes,
}

/// Nodes of one chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Nodes {
    /// Along the axis of the place on the orbit (γ, u/e or u).
    pub place: u32,
    /// Along the axis of the orbit (e, t or 1/e²).
    pub orbit: u32,
}

/// The two axes of a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axes {
    pub(crate) place: Axis,
    pub(crate) orbit: Axis,
}

impl Axes {
    fn new(nodes: Nodes, place: (f64, f64), orbit: (f64, f64)) -> Self {
        Self {
            place: Axis {
                start: place.0,
                end: place.1,
                nodes: nodes.place,
            },
            orbit: Axis {
                start: orbit.0,
                end: orbit.1,
                nodes: nodes.orbit,
            },
        }
    }

    /// How many coefficients the chart has.
    fn coefficients(self) -> usize {
        self.place.coefficients() * self.orbit.coefficients()
    }
}

impl Spec {
    /// The specifications that come with the program, coarsest first.
    pub const NAMES: [&'static str; 3] = ["draft", "standard", "fine"];

    /// The specification of one of [`Spec::NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        let text = match name {
            "draft" => include_str!("../../tables/draft.toml"),
            "standard" => include_str!("../../tables/standard.toml"),
            "fine" => include_str!("../../tables/fine.toml"),
            _ => return None,
        };
        toml::from_str(text).ok()
    }

    /// The specification with `factor` times as many nodes along every axis, or as few as an axis may have.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |nodes: u32| ((f64::from(nodes) * factor).round() as u32).max(Axis::FEWEST);
        let both = |nodes: Nodes| Nodes {
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

    /// How many nodes the four charts have together.
    pub fn nodes(&self) -> u64 {
        [self.critical, self.weak, self.trapped, self.radial]
            .iter()
            .map(|chart| u64::from(chart.place) * u64::from(chart.orbit))
            .sum()
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

    /// How many numbers the table holds: the charts' coefficients, one after the other.
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

    /// Whether every axis has as many nodes as a spline needs, and no more than a table may have; and whether its name is one
    /// that can be told.
    pub(crate) fn is_sound(&self) -> bool {
        let allowed = Axis::FEWEST..=Self::MOST;
        [self.critical, self.weak, self.trapped, self.radial]
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

    /// The most nodes an axis may have: the sizes of a table of them still fit any counter.
    const MOST: u32 = 4096;
}
