//! Tiles whose edges are quadratic to a small share of a pixel: which of their pixels are white, which are black, and
//! which are to be asked.
//!
//! In each pixel's centre an edge's quadratic is compared with what it may be off by there, and with how far the pixel
//! looks to either side. In single precision, many pixels side by side: its rounding is part of the doubt.

use super::coverage::STRAIGHT;
use super::mask::WHITE;
use crate::isoradial::{Bent, Edge, OpenEdges, Patch};

/// How many pixels stand side by side.
const LANES: usize = 16;

/// The edges of a tile, ready for its pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    edges: [Quadratic; MOST],
    count: usize,
    /// Pixels from the centre to the sides.
    half: [f32; 2],
}

/// More edges than these are not drawn together.
const MOST: usize = 24;

/// One edge, as a multiple of what it may be off by: positive within the band.
#[derive(Debug, Clone, Copy, Default)]
struct Quadratic {
    /// Whether it is another order's than the one before it.
    first: bool,
    value: f32,
    per_column: f32,
    per_row: f32,
    columns: f32,
    both: f32,
    rows: f32,
}

/// Whether every open edge of a patch is its tangent, to so many pixels.
pub(super) fn is_straight(patch: &Patch, edges: &OpenEdges, pixels: f64) -> bool {
    edges
        .edges()
        .iter()
        .all(|open| patch.bend(&open.bent) <= pixels * steepness(&open.bent, [0.0; 2]))
}

/// The larger part of an edge's gradient, its length but for a factor of √2, less than what is given.
fn steepness(bent: &Bent, less: [f64; 2]) -> f64 {
    let line = &bent.line;
    (line.per_column.abs() - less[0]).max(line.per_row.abs() - less[1])
}

impl Leaf {
    /// The edges that are open over a tile, for pixels that look so far to either side; none where they are off their
    /// quadratics by more than `doubt` pixels, or off their tangents in pixels that look about themselves.
    pub(super) fn new(patch: &Patch, edges: &OpenEdges, reach: f64, doubt: f64) -> Option<Self> {
        /// Of what an edge may be off its tangent in a pixel by the pixel's own bounds. A tile's are wider than these.
        const SURELY_STRAIGHT: f64 = 0.9 * STRAIGHT;
        /// The share of its terms by which a quadratic is off in single precision: its nine roundings, with room.
        const ROUNDING: f64 = 1.0 / 1_048_576.0;
        let [half_columns, half_rows] = patch.half();
        let [right, down] = patch.across();
        let mut leaf = Self {
            edges: [Quadratic::default(); MOST],
            count: 0,
            half: [half_columns as f32, half_rows as f32],
        };
        if edges.edges().len() > MOST {
            return None;
        }
        let mut last = None;
        for open in edges.edges() {
            let (bent, line) = (&open.bent, &open.bent.line);
            let turning = patch.turning(bent);
            let steep = steepness(bent, turning);
            let off = patch.doubt(bent);
            if !(off <= doubt * steep)
                || (reach > 0.0 && !(patch.bend_of_pixel(bent) <= SURELY_STRAIGHT * steep))
            {
                return None;
            }
            let tilt = line.per_column.abs() * half_columns + line.per_row.abs() * half_rows;
            let terms = line.value.abs() + tilt + patch.bend(bent);
            let seen =
                reach * (line.per_column.abs() + turning[0] + line.per_row.abs() + turning[1]);
            let unit = 1.0 / (off + seen + ROUNDING * terms);
            let unit = if open.edge == Edge::Outer {
                unit
            } else {
                -unit
            };
            let bend = unit * bent.bend.middle;
            leaf.edges[leaf.count] = Quadratic {
                first: last != Some(open.piece),
                value: (unit * line.value) as f32,
                per_column: (unit * line.per_column) as f32,
                per_row: (unit * line.per_row) as f32,
                columns: (-0.5 * bend * right * right) as f32,
                both: (-bend * right * down) as f32,
                rows: (-0.5 * bend * down * down) as f32,
            };
            leaf.count += 1;
            last = Some(open.piece);
        }
        Some(leaf)
    }

    /// Draws row `j` of a tile, asking for pixels along its edges.
    pub(super) fn draw_row(&self, j: usize, row: &mut [u8], ask: impl Fn(usize) -> u8) {
        let dy = j as f32 + 0.5 - self.half[1];
        for (block, pixels) in row.chunks_mut(LANES).enumerate() {
            let first = block * LANES;
            let mut dx = [0.0_f32; LANES];
            for (i, dx) in dx.iter_mut().enumerate() {
                *dx = (first + i) as f32 + 0.5 - self.half[0];
            }
            // Off by no more than 1 from the most of the bands' least.
            let mut most = [f32::NEG_INFINITY; LANES];
            let mut least = [f32::INFINITY; LANES];
            for edge in &self.edges[..self.count] {
                if edge.first {
                    for (most, least) in most.iter_mut().zip(&mut least) {
                        *most = most.max(if *least == f32::INFINITY {
                            f32::NEG_INFINITY
                        } else {
                            *least
                        });
                        *least = f32::INFINITY;
                    }
                }
                let value = edge.value + dy * (edge.per_row + dy * edge.rows);
                let slope = edge.per_column + dy * edge.both;
                for (least, dx) in least.iter_mut().zip(&dx) {
                    *least = least.min(value + dx * (slope + dx * edge.columns));
                }
            }
            for (most, least) in most.iter_mut().zip(&least) {
                *most = most.max(*least);
            }
            for (i, pixel) in pixels.iter_mut().enumerate() {
                if most[i] >= 1.0 {
                    *pixel = WHITE;
                } else if most[i] >= -1.0 {
                    *pixel = ask(first + i);
                }
            }
        }
    }
}
