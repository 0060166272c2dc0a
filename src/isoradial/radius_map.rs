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
//! degree on that leaves less than [`TOLERANCE`]. The error is measured at places between the nodes.
//!
//! The map goes a little beyond both edges, so that whoever interpolates it in the picture need not stop there.

use core::cell::Cell;
use core::f64::consts::{FRAC_PI_2, PI};

use super::chebyshev::Chebyshev;
use super::edge::Edge;
use super::isoradials::Isoradials;
use super::quarter_curves::QuarterCurves;
use super::quarter_turn::x_of_crossing;
use crate::orbit::invariants::Orbit;
use crate::orbit::path::{Branch, SweptAngles, point_at_angle};

/// The largest relative error of u that is aimed at: half a unit in the last place of a float of 32 bits.
const TOLERANCE: f64 = 3e-8;

/// The same as a multiple of the error of the method's angles: more nodes do not reduce what that does to u.
const PER_ANGLE: f64 = 8.0;

/// The degree of the lines that tell the degrees.
const MOST: usize = 14;

/// The least degree.
const LEAST: usize = 3;

/// A longer part of the axis is halved first. The singularities at x = (1 ± i)/2 leave no more than a factor of 4.2 a
/// degree to an interval of this length.
const LONGEST: f64 = 0.5;

/// The shortest part of the axis that is halved.
const SHORTEST: f64 = 1.0 / 512.0;

/// A section that is off by more than this multiple of what is aimed at is not used.
const WORST: f64 = 16.0;

/// How far the map goes beyond an edge, as a share of the way between the edges.
const MARGIN: f64 = 0.125;

/// Beyond the inner edge it goes no farther in than to about this inverse radius: the photon sphere is at 2/3.
const INNERMOST_U: f64 = 0.6;

/// Beyond the outer edge u falls to no less than about this share of the edge's.
const OUTERMOST_SHARE: f64 = 0.5;

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
        let piece = |quarter: usize, piece: &QuarterCurves| {
            let rays = PieceRays {
                curves,
                piece,
                angles,
                start: f64::from(piece.order) * PI + quarter as f64 * FRAC_PI_2,
                branch: Cell::new(Branch::Direct),
            };
            RadiusPiece {
                order: piece.order,
                sections: rays.sections(),
            }
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

/// The rays that meet the disk at one order in one quarter turn.
struct PieceRays<'a, A> {
    curves: &'a Isoradials,
    piece: &'a QuarterCurves,
    angles: &'a A,
    /// The angle at x = 0.
    start: f64,
    /// The branch of the ray before: a guess of the next one's.
    branch: Cell<Branch>,
}

/// The interval of τ, and the edges as polynomials of x: Chebyshev's coefficients.
struct Frame {
    x: Span,
    tau: Span,
    edges: [Vec<f64>; 2],
}

impl<A: SweptAngles> PieceRays<'_, A> {
    /// The sections of the whole axis.
    fn sections(&self) -> Vec<RadiusSection> {
        let spec = self.curves.spec();
        let beyond = |room: f64| (room / self.wide()).clamp(0.0, MARGIN);
        let tau = Span::new(
            -beyond(spec.u_outer * (1.0 - OUTERMOST_SHARE)),
            1.0 + beyond(INNERMOST_U - spec.u_inner),
        );
        let mut sections = Vec::new();
        let lines = Chebyshev::new(MOST);
        let (from, to) = self.piece.range();
        self.add((from, to), tau, &lines, &mut sections);
        sections
    }

    /// Adds the sections of a part of the axis.
    fn add(&self, x: (f64, f64), tau: Span, lines: &Chebyshev, sections: &mut Vec<RadiusSection>) {
        let halve = |sections: &mut Vec<RadiusSection>| {
            let middle = 0.5 * (x.0 + x.1);
            self.add((x.0, middle), tau, lines, sections);
            self.add((middle, x.1), tau, lines, sections);
        };
        if x.1 - x.0 > LONGEST {
            halve(sections);
            return;
        }
        // Beyond an edge some rays may end before they meet the plane.
        let found = [tau, Span::new(0.0, 1.0)].into_iter().find_map(|tau| {
            let frame = self.frame(Span::new(x.0, x.1), tau, lines);
            let degrees = self.degrees(&frame, lines)?;
            let is_resolved = degrees.0.max(degrees.1) < MOST;
            self.on(&frame, degrees)
                .filter(|section| is_resolved || section.error <= self.tolerance())
        });
        match found {
            Some(section) if section.error <= WORST * self.tolerance() => sections.push(section),
            _ if x.1 - x.0 > SHORTEST => halve(sections),
            _ => {}
        }
    }

    /// The largest relative error of u that is aimed at.
    fn tolerance(&self) -> f64 {
        TOLERANCE.max(PER_ANGLE * self.angles.error())
    }

    /// How much greater u is on the inner edge than on the outer one.
    fn wide(&self) -> f64 {
        let spec = self.curves.spec();
        spec.u_inner - spec.u_outer
    }

    /// The edges through points of the curves. They need not be right, only near.
    fn frame(&self, x: Span, tau: Span, lines: &Chebyshev) -> Frame {
        let mut edges = [Edge::Outer, Edge::Inner].map(|edge| {
            let kept = lines
                .nodes()
                .map(|share| self.piece.value_and_slope(edge, x.at(share))[0]);
            lines.coefficients(&kept.collect::<Vec<_>>())
        });
        let degree = edges_degree(&edges);
        for edge in &mut edges {
            edge.truncate(degree + 1);
        }
        Frame { x, tau, edges }
    }

    /// The degrees along x and τ, from lines along either.
    fn degrees(&self, frame: &Frame, lines: &Chebyshev) -> Option<(usize, usize)> {
        let tolerance = 0.25 * self.tolerance() * self.curves.spec().u_outer;
        let degree = |values: &[f64]| degree_of(&lines.coefficients(values), tolerance);
        let mut degrees = (frame.edges[0].len() - 1, LEAST);
        let columns: Vec<_> = lines.nodes().map(|share| self.at(frame, share)).collect();
        let mut values = vec![f64::NAN; MOST + 1];
        for across in [-1.0, 1.0] {
            let mut guess = f64::NAN;
            for (value, rays) in values.iter_mut().zip(&columns) {
                guess = rays.u(across, guess)?;
                *value = guess;
            }
            degrees.0 = degrees.0.max(degree(&values));
            let rays = self.at(frame, across);
            for (value, share) in values.iter_mut().zip(lines.nodes()) {
                guess = rays.u(share, guess)?;
                *value = guess;
            }
            degrees.1 = degrees.1.max(degree(&values));
        }
        Some(degrees)
    }

    /// Builds the map of these degrees along x and τ.
    fn on(&self, frame: &Frame, degrees: (usize, usize)) -> Option<RadiusSection> {
        let (along_x, along_tau) = (Chebyshev::new(degrees.0), Chebyshev::new(degrees.1));
        let mut guesses = vec![f64::NAN; degrees.1 + 1];
        let rows: Option<Vec<Vec<f64>>> = along_x
            .nodes()
            .map(|x| {
                let rays = self.at(frame, x);
                for (u, tau) in guesses.iter_mut().zip(along_tau.nodes()) {
                    *u = rays.u(tau, *u)?;
                }
                Some(Chebyshev::powers(&along_tau.coefficients(&guesses)))
            })
            .collect();
        let rows = rows?;
        let groups = (degrees.1 + 3).div_ceil(4);
        let mut section = RadiusSection {
            pole: self.piece.has_pole(),
            x: frame.x,
            tau: frame.tau,
            degrees,
            powers: vec![[0.0; 4]; groups * (degrees.0 + 1)],
            error: 0.0,
        };
        let mut set = |column: usize, coefficients: &[f64]| {
            let powers = Chebyshev::powers(coefficients);
            for (i, power) in powers.iter().rev().enumerate() {
                section.powers[column / 4 * (degrees.0 + 1) + i][column % 4] = *power;
            }
        };
        for (column, edge) in frame.edges.iter().enumerate() {
            let mut edge = edge.clone();
            edge.resize(degrees.0 + 1, 0.0);
            set(column, &edge);
        }
        for j in 0..=degrees.1 {
            let column: Vec<f64> = rows.iter().map(|row| row[j]).collect();
            set(2 + j, &along_x.coefficients(&column));
        }
        // Places between nodes, spread by the plastic number's powers (Roberts 2018).
        for i in 0..8 {
            let spread = |share: f64| 2.0 * (0.5 + f64::from(i) * share).fract() - 1.0;
            let (x, tau) = (
                spread(0.754_877_666_246_692_8),
                spread(0.569_840_290_998_053_3),
            );
            let truth = self.at(frame, x).u(tau, f64::NAN)?;
            let place = frame.tau.at(tau);
            let error = section.column(frame.x.at(x)).u(place) / truth - 1.0;
            section.error = section.error.max(error.abs());
        }
        Some(section)
    }

    /// The rays at a share of x.
    fn at<'a>(&'a self, frame: &Frame, x_share: f64) -> Rays<'a, A> {
        let x = frame.x.at(x_share);
        Rays {
            of: self,
            x,
            edges: [0, 1].map(|edge| Chebyshev::sum(&frame.edges[edge], x_share)),
            tau: frame.tau,
            angle: self.start + libm::atan2(x, 1.0 - x),
        }
    }
}

/// The rays of a piece at one x.
struct Rays<'a, A> {
    of: &'a PieceRays<'a, A>,
    x: f64,
    /// h, or `x h`, on the outer and on the inner edge.
    edges: [f64; 2],
    tau: Span,
    angle: f64,
}

impl<A: SweptAngles> Rays<'_, A> {
    /// Returns u at a share of τ, from a guess of it or from NaN; `None` where the ray does not meet the plane.
    fn u(&self, tau_share: f64, guess: f64) -> Option<f64> {
        let tau = self.tau.at(tau_share);
        let spec = self.of.curves.spec();
        // At the pole, and everywhere in flat space.
        let flat = spec.u_outer + tau * self.of.wide();
        let pole = self.of.piece.has_pole();
        if pole && self.x <= 0.0 {
            return Some(flat);
        }
        let [outer, inner] = self.edges;
        let stored = outer + tau * (inner - outer);
        let h = if pole { stored / self.x } else { stored };
        let orbit = self.of.curves.orbit(h);
        let guess = if guess.is_nan() { flat } else { guess };
        let guess = Some((guess, self.of.branch.get()));
        let (u, branch) = point_at_angle(self.of.angles, &orbit, self.angle, guess)?;
        self.of.branch.set(branch);
        Some(u)
    }
}

/// The last degree whose coefficient is above `tolerance`.
fn degree_of(coefficients: &[f64], tolerance: f64) -> usize {
    let last = coefficients.iter().rposition(|c| c.abs() > tolerance);
    last.unwrap_or(0).max(LEAST)
}

/// The degree of the edges: what is left is a thousandth of the way between them.
fn edges_degree([outer, inner]: &[Vec<f64>; 2]) -> usize {
    let wide: Vec<f64> = outer
        .iter()
        .zip(inner)
        .map(|(outer, inner)| inner - outer)
        .collect();
    let tolerance = 1e-3 * wide[0].abs();
    degree_of(outer, tolerance).max(degree_of(inner, tolerance))
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
                map.error() > 0.0 && map.error() <= 2.0 * TOLERANCE,
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
