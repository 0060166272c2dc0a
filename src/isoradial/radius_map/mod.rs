//! The map of a camera radius: at which radius each ray meets the disk.
//!
//! # Derivation
//! At one camera radius the inverse radius u at which a ray meets the disk's plane depends on its slope κ and on the
//! angle φ = φ₁ + kπ alone. The map holds it for each order k and quarter turn, as a function of the curves' axis x and
//! of
//!
//! ```text
//! τ = (κ − κ_outer(x))/(κ_inner(x) − κ_outer(x))
//! ```
//!
//! so that τ is 0 on the outer edge and 1 on the inner one. In flat space u is linear in κ at fixed φ, and so in τ.
//!
//! # Polynomials
//! u is analytic in both variables, so a polynomial in x and τ carries it: the error falls by a factor with each
//! degree. (A bicubic spline takes 50 times as many nodes for 5e-8.) In x the factor is at most 1 + √2, since φ has its
//! singularities at x = (1 ± i)/2. The edges that define τ are polynomials in x too, through points of the curves.
//! They need not be right: u is computed for the rays that they lead to. That keeps τ analytic.
//!
//! Nodes are Chebyshev's, ends included. The degrees follow from the coefficients along a few lines: from the first
//! degree on that leaves less than half a unit in the last place of a float of 32 bits. The error is measured at places
//! between the nodes.
//!
//! The map goes a little beyond both edges, so that whoever interpolates it in the picture need not stop there.

mod build;

use core::f64::consts::{FRAC_PI_2, PI};

use self::build::{MOST, PieceRays};
use super::isoradials::Isoradials;
use super::quarter_curves::QuarterCurves;
use super::quarter_turn::x_of_crossing;
use crate::orbit::invariants::Orbit;
use crate::orbit::path::{SweptAngles, point_at_angle};

/// Where each ray of one camera radius meets the disk.
#[derive(Debug, Clone, Default)]
pub struct RadiusMap {
    /// For each of the two quarter turns, the pieces of its orders, lowest first.
    quarters: [Vec<RadiusPiece>; 2],
}

/// The map of one order over one quarter turn.
#[derive(Debug, Clone)]
struct RadiusPiece {
    order: u32,
    /// By rising x.
    sections: Vec<RadiusSection>,
}

/// The map of one order over a part of the axis.
#[derive(Debug, Clone)]
pub(crate) struct RadiusSection {
    pole: bool,
    x: Span,
    tau: Span,
    degrees: (usize, usize),
    /// Four polynomials of x after four, each by its powers, the highest first: the outer edge, the inner edge, and the
    /// factors of u's powers of τ, the lowest first.
    powers: Vec<[f64; 4]>,
    error: f64,
}

/// An interval that is mapped onto −1 to 1.
#[derive(Debug, Clone, Copy)]
struct Span {
    from: f64,
    to: f64,
    per_unit: f64,
}

impl Span {
    fn new(from: f64, to: f64) -> Self {
        Self {
            from,
            to,
            per_unit: 2.0 / (to - from),
        }
    }

    /// From −1 to 1 at the ends.
    #[inline(always)]
    fn share(self, place: f64) -> f64 {
        (place - self.from) * self.per_unit - 1.0
    }

    fn at(self, share: f64) -> f64 {
        if share >= 1.0 {
            self.to
        } else {
            self.from + 0.5 * (1.0 + share) * (self.to - self.from)
        }
    }

    fn holds(self, place: f64) -> bool {
        place >= self.from && place <= self.to
    }
}

/// The fours of the longest row.
const FOURS: usize = (MOST + 3).div_ceil(4);

/// The map of one order at one x.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RadiusColumn<'a> {
    section: &'a RadiusSection,
    x: f64,
    /// h, or `x h`, on the outer edge.
    outer: f64,
    /// τ for each unit of it.
    per_unit: f64,
    values: [[f64; 4]; FOURS],
}

/// Where a ray meets the disk's plane: a quarter turn of the angle about the hole, and x within it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlaneMeeting {
    /// The quarter turn, 0 or 1.
    pub(crate) quarter: usize,
    pub(crate) x: f64,
}

impl PlaneMeeting {
    /// Where a ray with `tan φ₁ = n/d` meets the plane.
    #[inline]
    pub(crate) fn new(n: f64, d: f64) -> Self {
        Self {
            quarter: usize::from(d < 0.0),
            x: x_of_crossing(n, d),
        }
    }
}

impl RadiusMap {
    /// Builds the map of curves, by the method that they were built by. Where no polynomial of a reasonable degree
    /// follows u, the map has a gap.
    pub fn new(curves: &Isoradials, angles: &impl SweptAngles) -> Self {
        let piece = |quarter: usize, piece: &QuarterCurves| RadiusPiece {
            order: piece.order,
            sections: PieceRays::new(curves, (quarter, piece), angles).sections(),
        };
        Self {
            quarters: [0, 1].map(|quarter| {
                let pieces = curves.quarter(quarter).iter();
                pieces.map(|curves| piece(quarter, curves)).collect()
            }),
        }
    }

    /// Returns the largest relative error of u that was measured between nodes.
    pub fn error(&self) -> f64 {
        let sections = self.sections();
        sections.fold(0.0, |error, section| error.max(section.error))
    }

    /// Returns the number of nodes of all sections.
    pub fn nodes(&self) -> usize {
        let sections = self.sections();
        sections
            .map(|section| (section.degrees.0 + 1) * (section.degrees.1 + 1))
            .sum()
    }

    /// Returns the number of bytes that a frame reads of it.
    pub fn bytes(&self) -> usize {
        let sections = self.sections();
        sections.map(|section| size_of_val(&*section.powers)).sum()
    }

    fn sections(&self) -> impl Iterator<Item = &RadiusSection> {
        let pieces = self.quarters.iter().flatten();
        pieces.flat_map(|piece| &piece.sections)
    }

    /// Returns the map of an order about a place; `None` in a gap.
    #[inline]
    pub(crate) fn section(&self, order: u32, place: PlaneMeeting) -> Option<&RadiusSection> {
        let mut pieces = self.quarters[place.quarter].iter();
        let piece = pieces.find(|piece| piece.order == order)?;
        let mut sections = piece.sections.iter();
        sections.find(|section| section.x.holds(place.x))
    }
}

impl RadiusSection {
    /// Returns the map at one x.
    #[inline(always)]
    pub(crate) fn column(&self, x: f64) -> RadiusColumn<'_> {
        let share = self.x.share(x);
        let mut values = [[0.0; 4]; FOURS];
        let groups = self.powers.chunks_exact(self.degrees.0 + 1);
        for (value, powers) in values.iter_mut().zip(groups) {
            let mut sum = [0.0; 4];
            for power in powers {
                for i in 0..4 {
                    sum[i] = sum[i] * share + power[i];
                }
            }
            *value = sum;
        }
        RadiusColumn {
            section: self,
            x,
            outer: values[0][0],
            per_unit: if self.pole { x } else { 1.0 } / (values[0][1] - values[0][0]),
            values,
        }
    }
}

impl RadiusColumn<'_> {
    /// Returns τ of a ray with `κ − κ_c = h`.
    #[inline(always)]
    pub(crate) fn tau(&self, h: f64) -> f64 {
        let outer = if self.section.pole {
            self.outer / self.x
        } else {
            self.outer
        };
        (h - outer) * self.per_unit
    }

    /// Returns the inverse radius at τ.
    #[inline(always)]
    pub(crate) fn u(&self, tau: f64) -> f64 {
        let section = self.section;
        let share = section.tau.share(tau);
        let powers = &self.values.as_flattened()[2..section.degrees.1 + 3];
        powers.iter().rev().fold(0.0, |u, power| u * share + power)
    }

    /// Returns the nearest τ that the map has. The edges of the map are only near the disk's.
    #[inline]
    pub(crate) fn clamped(&self, tau: f64) -> f64 {
        tau.clamp(self.section.tau.from, self.section.tau.to)
    }

    /// Returns whether the map goes as far as this.
    #[inline]
    pub(crate) fn holds(&self, tau: f64) -> bool {
        self.section.tau.holds(tau)
    }
}

impl Isoradials {
    /// Returns the inverse radius at which the ray with `κ − κ_c = h` meets the disk's plane in an order, by the
    /// method itself: for the gaps of a map. `None` where it ends before.
    pub(crate) fn u_in_gap(
        &self,
        order: u32,
        h: f64,
        meets: PlaneMeeting,
        angles: &impl SweptAngles,
    ) -> Option<f64> {
        let start = f64::from(order) * PI + meets.quarter as f64 * FRAC_PI_2;
        let angle = start + libm::atan2(meets.x, 1.0 - meets.x);
        point_at_angle(angles, &self.orbit(h), angle, None).map(|(u, _)| u)
    }

    /// The orbit with `κ = κ_c + h`.
    fn orbit(&self, h: f64) -> Orbit {
        let spec = self.spec();
        let critical = spec.slope_scale * self.critical();
        let excess = spec.slope_scale * h;
        Orbit::with_delta(
            spec.u0,
            critical + excess,
            excess * (2.0 * critical + excess),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isoradial::CurveSpec;
    use crate::orbit::exact::Exact;
    use crate::scene::{Scene, View};

    #[test]
    fn maps_of_built_in_scenes_have_no_gaps_and_few_nodes() {
        for name in ["classic", "face-on", "close-up", "inside", "photon-ring"] {
            let scene = Scene::builtin(name).unwrap();
            let view = View::new(&scene);
            let spec = CurveSpec::new(&scene, &view, scene.tolerance());
            let curves = Isoradials::new(&spec, &Exact);
            let map = RadiusMap::new(&curves, &Exact);
            assert!(
                map.error() > 0.0 && map.error() <= 2.0 * build::TOLERANCE,
                "{name}"
            );
            assert!(
                (100..2500).contains(&map.nodes()),
                "{name}: {}",
                map.nodes()
            );
            for quarter in 0..2 {
                for piece in curves.quarter(quarter) {
                    let (from, to) = piece.range();
                    for i in 0..=50 {
                        let x = from + (to - from) * f64::from(i) / 50.0;
                        let place = PlaneMeeting { quarter, x };
                        let section = map.section(piece.order, place);
                        let u = section.map(|section| section.column(x).u(0.5));
                        let (outer, inner) = curves.u_edges();
                        assert!(
                            u.is_some_and(|u| u > outer && u < inner),
                            "{name} {x} {u:?}"
                        );
                    }
                }
            }
        }
    }
}
