//! Curves of constant redshift and flux: roots along isoradial curves, put into order.
//!
//! # How they are found
//! A place of the disk has two coordinates: `q = ln(r/r_inner)/ln(r_outer/r_inner)` from 0 to 1, and the azimuth s of
//! [`DiskImage`]. The quantity is computed at the nodes of a grid over both. Where two neighbouring nodes lie on two
//! sides of the level, the edge between them has a root, which is found to rounding. Each cell joins the roots of its
//! four edges by pairs (where all four have one, the value in the cell's middle tells which). So the roots become
//! chains: closed ones, or ones that end at the disk's edges.
//!
//! Between two roots A and B of a cell the curve is `A + t (B − A)`, moved along the chord's normal to the root there.
//! So every point of the curve is exact, and the [`Pen`] takes as many as it needs.

use core::f64::consts::TAU;
use std::collections::BTreeMap;

use kurbo::{Point, Vec2};
use rayon::prelude::*;

use super::disk_image::{DiskImage, SeenPlace};
use super::pen::Pen;

/// The cells of the grid from the inner to the outer radius.
const RINGS: usize = 64;

/// The cells of the grid around the disk.
const SECTORS: usize = 128;

/// The grid begins here, so that no node lies on the line that halves the picture, where curves may run along the grid.
const OFFSET: f64 = 0.5;

/// The most steps of a root.
const STEPS: u32 = 64;

/// A root is found when a secant's step is at most this share of a cell. Its error is then far smaller, down to that of
/// the values, whose rounding moves a root by about 1e-11 of a cell.
const CLOSE: f64 = 1e-9;

/// What is seen of the disk at the nodes of a grid, in the image of one order.
pub(super) struct LevelGrid<'a> {
    image: &'a DiskImage<'a>,
    inner: f64,
    /// `ln(r_outer/r_inner)`.
    log_width: f64,
    /// Ring by ring, from the inner edge to the outer one.
    nodes: Vec<SeenPlace>,
}

/// The curve of one level.
struct LevelCurve<'a> {
    grid: &'a LevelGrid<'a>,
    quantity: fn(&SeenPlace) -> f64,
    level: f64,
    /// How much greater than the level the quantity is at the nodes.
    excess: Vec<f64>,
}

/// An edge of the grid: from node (ring, sector) to the next ring, or to the next sector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct GridEdge {
    ring: usize,
    sector: usize,
    radial: bool,
}

/// A part of the curve within one cell: two edges, and their roots in units of cells, the second sector beside the
/// first even where the azimuth starts again.
#[derive(Debug, Clone, Copy)]
struct CellPart {
    edges: [GridEdge; 2],
    roots: [Point; 2],
}

impl<'a> LevelGrid<'a> {
    /// Follows the rays of all nodes of the disk between two radii.
    pub(super) fn new(image: &'a DiskImage<'a>, (inner, outer): (f64, f64)) -> Self {
        let mut grid = Self {
            image,
            inner,
            log_width: libm::log(outer / inner),
            nodes: Vec::new(),
        };
        let node = |node: usize| {
            let (ring, sector) = (node / SECTORS, node % SECTORS);
            grid.see(Point::new(ring as f64, sector as f64))
        };
        let nodes = (0..(RINGS + 1) * SECTORS).into_par_iter().map(node);
        grid.nodes = nodes.collect();
        grid
    }

    /// Draws the curve on which a quantity has a value.
    pub(super) fn draw(&self, quantity: fn(&SeenPlace) -> f64, level: f64, pen: &mut Pen) {
        let excess = self.nodes.iter().map(|seen| quantity(seen) - level);
        let curve = LevelCurve {
            grid: self,
            quantity,
            level,
            excess: excess.collect(),
        };
        curve.draw(pen);
    }

    /// Returns what is seen of a place in units of cells.
    fn see(&self, place: Point) -> SeenPlace {
        let radius = self.inner * libm::exp(self.log_width * place.x / RINGS as f64);
        let s = TAU * (place.y + OFFSET) / SECTORS as f64;
        self.image.see(1.0 / radius, s)
    }
}

impl LevelCurve<'_> {
    /// Draws the curve: chains of parts that share roots.
    fn draw(&self, pen: &mut Pen) {
        let mut parts: Vec<Option<CellPart>> = self.parts().into_iter().map(Some).collect();
        let mut at_edge: BTreeMap<GridEdge, Vec<usize>> = BTreeMap::new();
        for (i, part) in parts.iter().enumerate() {
            for edge in part.iter().flat_map(|part| part.edges) {
                at_edge.entry(edge).or_default().push(i);
            }
        }
        // Chains that end at the disk's edges come first: what is left is closed.
        let ends = at_edge.iter().filter(|(_, parts)| parts.len() == 1);
        let ends: Vec<GridEdge> = ends.map(|(&edge, _)| edge).collect();
        let all: Vec<GridEdge> = at_edge.keys().copied().collect();
        for first in ends.into_iter().chain(all) {
            let mut edge = first;
            while let Some(&i) = at_edge[&edge].iter().find(|&&i| parts[i].is_some())
                && let Some(CellPart { edges, mut roots }) = parts[i].take()
            {
                if edges[0] != edge {
                    roots.reverse();
                }
                edge = if edges[0] == edge { edges[1] } else { edges[0] };
                self.draw_part(roots, pen);
            }
            pen.lift();
        }
    }

    /// Draws a curve between two roots of a cell.
    fn draw_part(&self, [a, b]: [Point; 2], pen: &mut Pen) {
        let chord = b - a;
        if chord == Vec2::ZERO {
            return;
        }
        let normal = Vec2::new(-chord.y, chord.x) / chord.hypot();
        let curve = |t: f64| {
            let base = a + t * chord;
            let excess = |step: f64| self.excess_at(base + step * normal);
            let root = if t == 0.0 || t == 1.0 {
                Some(0.0)
            } else {
                near_root(excess)
            };
            self.grid.image.point(&self.grid.see(base + root? * normal))
        };
        pen.draw(&curve, 0.0, 1.0);
    }

    /// Returns the parts of the curve, cell by cell.
    fn parts(&self) -> Vec<CellPart> {
        let mut parts = Vec::new();
        for ring in 0..RINGS {
            for sector in 0..SECTORS {
                self.cell(ring, sector, &mut parts);
            }
        }
        parts
    }

    /// Adds the parts of one cell.
    fn cell(&self, ring: usize, sector: usize, parts: &mut Vec<CellPart>) {
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let values =
            corners.map(|(r, s)| self.excess[(ring + r) * SECTORS + (sector + s) % SECTORS]);
        let edge = |ring: usize, sector: usize, radial: bool| GridEdge {
            ring,
            sector: sector % SECTORS,
            radial,
        };
        let edges = [
            edge(ring, sector, true),
            edge(ring + 1, sector, false),
            edge(ring, sector + 1, true),
            edge(ring, sector, false),
        ];
        let crossed = |i: usize| (values[i] > 0.0) != (values[(i + 1) % 4] > 0.0);
        let crossed: Vec<usize> = (0..4).filter(|&i| crossed(i)).collect();
        let mut join = |i: usize, j: usize| {
            let root = |i: usize| {
                let corner = |i: usize| {
                    let (r, s) = corners[i % 4];
                    Point::new((ring + r) as f64, (sector + s) as f64)
                };
                // Both cells of an edge find its root from the same end.
                let (from, to) = if i < 2 { (i, i + 1) } else { (i + 1, i) };
                let (a, b) = (corner(from), corner(to));
                let share = bracketed_root(
                    |share| self.excess_at(a.lerp(b, share)),
                    (values[from % 4], values[to % 4]),
                );
                a.lerp(b, share)
            };
            parts.push(CellPart {
                edges: [edges[i], edges[j]],
                roots: [root(i), root(j)],
            });
        };
        match crossed[..] {
            [i, j] => join(i, j),
            [0, 1, 2, 3] => {
                let middle = Point::new(ring as f64 + 0.5, sector as f64 + 0.5);
                if (self.excess_at(middle) > 0.0) == (values[0] > 0.0) {
                    join(0, 1);
                    join(2, 3);
                } else {
                    join(3, 0);
                    join(1, 2);
                }
            }
            _ => {}
        }
    }

    /// Returns how much greater than the level the quantity is at a place in units of cells.
    fn excess_at(&self, place: Point) -> f64 {
        (self.quantity)(&self.grid.see(place)) - self.level
    }
}

/// Returns the root of a function between 0 and 1, where its values are `ends`, of different signs: the secant's, with
/// the value of an end that stays halved (the Illinois method).
fn bracketed_root(f: impl Fn(f64) -> f64, ends: (f64, f64)) -> f64 {
    let ((mut a, mut f_a), (mut b, mut f_b)) = ((0.0, ends.0), (1.0, ends.1));
    let mut x = f64::NAN;
    for _ in 0..STEPS {
        let last = x;
        x = (a * f_b - b * f_a) / (f_b - f_a);
        let value = f(x);
        if value == 0.0 || (x - last).abs() <= CLOSE {
            break;
        }
        if (value > 0.0) == (f_b > 0.0) {
            (b, f_b) = (x, value);
            f_a *= 0.5;
        } else {
            (a, f_a) = (x, value);
            f_b *= 0.5;
        }
    }
    x
}

/// Returns the root of a function near 0, by secants; `None` if there is none within one cell.
fn near_root(f: impl Fn(f64) -> f64) -> Option<f64> {
    let (mut a, mut f_a) = (0.0, f(0.0));
    let (mut b, mut f_b) = (1e-6, f(1e-6));
    for _ in 0..STEPS {
        if f_a == f_b {
            return (f_b == 0.0).then_some(b);
        }
        let next = b - f_b * (b - a) / (f_b - f_a);
        if next.is_nan() || next.abs() > 1.0 {
            return None;
        }
        if (next - b).abs() <= CLOSE {
            return Some(next);
        }
        (a, f_a) = (b, f_b);
        (b, f_b) = (next, f(next));
    }
    Some(b)
}
