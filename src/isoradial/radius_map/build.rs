//! Builds the sections of a map of a camera radius.

use core::cell::Cell;
use core::f64::consts::{FRAC_PI_2, PI};

use super::{RadiusSection, Span};
use crate::isoradial::chebyshev::Chebyshev;
use crate::isoradial::edge::Edge;
use crate::isoradial::isoradials::Isoradials;
use crate::isoradial::quarter_curves::QuarterCurves;
use crate::orbit::path::{Branch, SweptAngles, point_at_angle};

/// The largest relative error of u that is aimed at: half a unit in the last place of a float of 32 bits.
pub(super) const TOLERANCE: f64 = 3e-8;

/// The same as a multiple of the error of the method's angles: more nodes do not reduce what that does to u.
const PER_ANGLE: f64 = 8.0;

/// The degree of the lines that tell the degrees.
pub(super) const MOST: usize = 14;

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

/// The rays that meet the disk at one order in one quarter turn.
pub(super) struct PieceRays<'a, A> {
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

impl<'a, A: SweptAngles> PieceRays<'a, A> {
    /// Prepares the curves of an order in a quarter turn.
    pub(super) fn new(
        curves: &'a Isoradials,
        (quarter, piece): (usize, &'a QuarterCurves),
        angles: &'a A,
    ) -> Self {
        Self {
            curves,
            piece,
            angles,
            start: f64::from(piece.order) * PI + quarter as f64 * FRAC_PI_2,
            branch: Cell::new(Branch::Direct),
        }
    }

    /// The sections of the whole axis.
    pub(super) fn sections(&self) -> Vec<RadiusSection> {
        let (u_outer, u_inner) = self.curves.u_edges();
        let beyond = |room: f64| (room / self.wide()).clamp(0.0, MARGIN);
        let tau = Span::new(
            -beyond(u_outer * (1.0 - OUTERMOST_SHARE)),
            1.0 + beyond(INNERMOST_U - u_inner),
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
        let (u_outer, u_inner) = self.curves.u_edges();
        u_inner - u_outer
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
        let tolerance = 0.25 * self.tolerance() * self.curves.u_edges().0;
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
    fn at<'b>(&'b self, frame: &Frame, x_share: f64) -> Rays<'b, A> {
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
        // At the pole, and everywhere in flat space.
        let flat = self.of.curves.u_edges().0 + tau * self.of.wide();
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
