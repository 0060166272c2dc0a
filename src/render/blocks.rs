//! A tile drawn: its edges are cubics, and most of its blocks are on one side of all of them.
//!
//! In each pixel's centre an edge's cubic is compared with what it may be off by, and with how far the pixel looks to
//! either side: it is given as a multiple of that. What decides nothing are the pixels along the edges, which are to be
//! asked. All of it is in single precision, sixteen blocks or pixels side by side; its rounding is part of what a cubic
//! may be off by.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};

use super::mask::WHITE;
use super::tiles::TILE;
use crate::isoradial::MOST_EDGES;
use crate::lanes::{Level, dispatch};

/// The side of the blocks that a tile is drawn in: so many pixels stand side by side.
const BLOCK: usize = 16;

/// A tile's blocks.
const BLOCKS: usize = (TILE / BLOCK) * (TILE / BLOCK);

/// So many rows are drawn before any of their pixels is asked.
const TOGETHER: usize = 4;

/// One edge over a tile, as a multiple of what it may be off by, and positive within its band:
/// `value + per_column dx + per_row dy − half_bend (across·d)² (1 − along·d)`, d from the tile's centre.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Cubic {
    pub(super) value: f32,
    pub(super) per_column: f32,
    pub(super) per_row: f32,
    pub(super) half_bend: f32,
}

/// Where a tile changes from one quarter turn to the other: positive in the first one, as a multiple of how far a pixel
/// looks to either side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Border {
    pub(super) value: f32,
    pub(super) per_column: f32,
    pub(super) per_row: f32,
}

/// The edges of a tile in one quarter turn.
#[derive(Debug)]
pub(super) struct Side {
    /// Each with whether it is another order's than the one before.
    edges: [(bool, Cubic); MOST_EDGES],
    count: usize,
    last: usize,
    /// Without edges: whether all of it is disk.
    is_disk: bool,
}

/// A tile whose edges are cubics.
#[derive(Debug)]
pub(super) struct Drawing {
    /// Pixels from its centre to its sides.
    pub(super) half: [f32; 2],
    /// For each pixel to the right and downwards.
    pub(super) across: [f32; 2],
    pub(super) along: [f32; 2],
    /// If it is in both quarter turns; in one of them it has but one side, the first.
    pub(super) border: Option<Border>,
    pub(super) sides: [Side; 2],
}

/// The pixels of a tile that are to be asked, each its column and its row in the tile.
#[derive(Debug)]
pub(super) struct Asked {
    pixels: [(u8, u8); TILE * TILE],
    count: usize,
}

/// Where a tile is drawn.
pub(super) struct Canvas<'a> {
    /// From its first pixel on.
    pub(super) pixels: &'a mut [u8],
    /// From one row to the next.
    pub(super) stride: usize,
    /// The columns and rows of it that are in the picture.
    pub(super) size: (usize, usize),
}

/// A tile's blocks, row by row: a bit for each.
struct Blocks {
    /// All its pixels see the disk.
    hit: u32,
    /// It has edges, or may have.
    mixed: u32,
}

impl Asked {
    pub(super) fn new() -> Self {
        Self {
            pixels: [(0, 0); TILE * TILE],
            count: 0,
        }
    }

    pub(super) fn push(&mut self, pixel: (u8, u8)) {
        self.pixels[self.count] = pixel;
        self.count += 1;
    }

    pub(super) fn pixels(&self) -> &[(u8, u8)] {
        &self.pixels[..self.count]
    }
}

impl Canvas<'_> {
    fn row(&mut self, row: usize, columns: Range<usize>) -> &mut [u8] {
        &mut self.pixels[row * self.stride..][columns]
    }
}

impl Side {
    pub(super) fn new(is_disk: bool) -> Self {
        Self {
            edges: [(false, Cubic::default()); MOST_EDGES],
            count: 0,
            last: usize::MAX,
            is_disk,
        }
    }

    /// Adds an edge of the last order or of another one.
    pub(super) fn push(&mut self, order: usize, cubic: Cubic) {
        self.edges[self.count] = (order != self.last, cubic);
        self.last = order;
        self.count += 1;
    }

    fn edges(&self) -> &[(bool, Cubic)] {
        &self.edges[..self.count]
    }

    /// How far pixels of a row are within the disk: the most of the bands, each of which is the least of its edges.
    #[inline(always)]
    fn depth<S: Simd>(&self, simd: S, dx: f32x16<S>, dy: f32, bend: f32x16<S>) -> f32x16<S> {
        let nothing = f32x16::splat(simd, f32::NEG_INFINITY);
        let mut least = if self.is_disk { -nothing } else { nothing };
        let mut most = nothing;
        for (new, edge) in self.edges() {
            let value = edge.value + dy * edge.per_row;
            let g = dx * edge.per_column + value - bend * edge.half_bend;
            if *new {
                most = simd.max_f32x16(most, least);
                least = g;
            } else {
                least = simd.min_f32x16(least, g);
            }
        }
        simd.max_f32x16(most, least)
    }
}

impl Drawing {
    /// Draws white pixels, all being black; those along the edges into `asked`.
    pub(super) fn draw(&self, level: Level, canvas: &mut Canvas<'_>, asked: &mut Asked) {
        dispatch!(level, |simd, _four| self.draw_in(simd, canvas, asked));
    }

    #[inline(always)]
    fn draw_in<S: Simd>(&self, simd: S, canvas: &mut Canvas<'_>, asked: &mut Asked) {
        asked.count = 0;
        let (width, height) = canvas.size;
        let blocks = if self.border.is_some() {
            Blocks {
                hit: 0,
                mixed: 0xffff,
            }
        } else if width.max(height) > BLOCK {
            self.blocks(simd)
        } else {
            Blocks { hit: 0, mixed: 1 }
        };
        let mut left = blocks.hit | blocks.mixed;
        while left != 0 {
            let block = left.trailing_zeros() as usize;
            left &= left - 1;
            let (column, row) = (COLUMNS[block] as usize, ROWS[block] as usize);
            if column >= width || row >= height {
                continue;
            }
            let columns = column..width.min(column + BLOCK);
            let rows = row..height.min(row + BLOCK);
            if blocks.hit & (1 << block) == 0 {
                self.draw_block(simd, canvas, (columns, rows), asked);
                continue;
            }
            for row in rows {
                let row = canvas.row(row, columns.clone());
                match row.first_chunk_mut() {
                    Some(row) => *row = [WHITE; BLOCK],
                    None => row.fill(WHITE),
                }
            }
        }
    }

    /// Which blocks are all alike: for those the cubics' values in their middles and the gradients there, with what is
    /// of second degree and higher, decide.
    ///
    /// With `α = across·δ` and `λ = along·δ`, δ being the way from the middle, `(across·d)² (1 − along·d)` has of those
    /// `α² (1 − along·d) − 2 (across·d) α λ − α² λ`.
    #[inline(always)]
    fn blocks<S: Simd>(&self, simd: S) -> Blocks {
        /// From a block's middle to the middles of the pixels at its sides.
        const REACH: f32 = 0.5 * (BLOCK - 1) as f32;
        let ([right, down], [farther_right, farther_down]) = (self.across, self.along);
        let middle = 0.5 * BLOCK as f32;
        let dx = f32x16::from_slice(simd, &COLUMNS) + (middle - self.half[0]);
        let dy = f32x16::from_slice(simd, &ROWS) + (middle - self.half[1]);
        let across = dx * right + dy * down;
        let nearer = -(dx * farther_right) + (1.0 - dy * farther_down);
        let square = across * across;
        let bend = square * nearer;
        let twice = across * nearer * 2.0;
        let (bend_right, bend_down) = (
            twice * right - square * farther_right,
            twice * down - square * farther_down,
        );
        let (alpha, lambda) = (
            REACH * (right.abs() + down.abs()),
            REACH * (farther_right.abs() + farther_down.abs()),
        );
        let beyond = simd.abs_f32x16(nearer) * (alpha * alpha)
            + simd.abs_f32x16(across) * (2.0 * alpha * lambda)
            + alpha * alpha * lambda;
        let nothing = f32x16::splat(simd, f32::NEG_INFINITY);
        // The least and the greatest of each band's edges, and the most of these.
        let (mut least, mut greatest) = (nothing, nothing);
        let (mut most_of_least, mut most) = (nothing, nothing);
        for (new, edge) in self.sides[0].edges() {
            let g = dx * edge.per_column + dy * edge.per_row + edge.value - bend * edge.half_bend;
            let (to_right, downwards) = (
                -(bend_right * edge.half_bend) + edge.per_column,
                -(bend_down * edge.half_bend) + edge.per_row,
            );
            let tilt = (simd.abs_f32x16(to_right) + simd.abs_f32x16(downwards)) * REACH;
            let change = tilt + beyond * edge.half_bend.abs();
            let (low, high) = (g - change, g + change);
            if *new {
                most_of_least = simd.max_f32x16(most_of_least, least);
                most = simd.max_f32x16(most, greatest);
                (least, greatest) = (low, high);
            } else {
                least = simd.min_f32x16(least, low);
                greatest = simd.min_f32x16(greatest, high);
            }
        }
        most_of_least = simd.max_f32x16(most_of_least, least);
        most = simd.max_f32x16(most, greatest);
        let (one, minus_one) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, -1.0));
        let hit = simd.to_bitmask_mask32x16(simd.simd_ge_f32x16(most_of_least, one)) as u32;
        let miss = simd.to_bitmask_mask32x16(simd.simd_lt_f32x16(most, minus_one)) as u32;
        Blocks {
            hit: hit & 0xffff,
            mixed: !(hit | miss) & 0xffff,
        }
    }

    /// Draws a block.
    #[inline(always)]
    fn draw_block<S: Simd>(
        &self,
        simd: S,
        canvas: &mut Canvas<'_>,
        (columns, rows): (Range<usize>, Range<usize>),
        asked: &mut Asked,
    ) {
        let ([right, down], [farther_right, farther_down]) = (self.across, self.along);
        let (one, minus_one) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, -1.0));
        let inside = (1_u32 << columns.len()) - 1;
        let dx = f32x16::from_slice(simd, &STEPS) + (columns.start as f32 + 0.5 - self.half[0]);
        let (across_row, along_row) = (dx * right, dx * farther_right);
        for top in rows.clone().step_by(TOGETHER) {
            // The pixels to be asked of some rows, a bit for each.
            let mut unsure = 0_u64;
            for j in top..rows.end.min(top + TOGETHER) {
                let dy = j as f32 + 0.5 - self.half[1];
                let across = across_row + dy * down;
                let bend = across * across * (-along_row + (1.0 - dy * farther_down));
                let mut most = self.sides[0].depth(simd, dx, dy, bend);
                if let Some(border) = &self.border {
                    // Surely of one quarter turn and what it is there, or what it is in both.
                    let first = dx * border.per_column + (border.value + dy * border.per_row);
                    let other = self.sides[1].depth(simd, dx, dy, bend);
                    let either = simd
                        .max_f32x16(simd.min_f32x16(first, most), simd.min_f32x16(-first, other));
                    most = simd.max_f32x16(either, simd.min_f32x16(most, other));
                }
                let white = simd.to_bitmask_mask32x16(simd.simd_ge_f32x16(most, one));
                let black = simd.to_bitmask_mask32x16(simd.simd_lt_f32x16(most, minus_one));
                let (white, some) = (white as u32 & inside, !black as u32 & inside);
                let row = canvas.row(j, columns.clone());
                let (low, high) = (SPREAD[white as usize & 0xff], SPREAD[white as usize >> 8]);
                if let Some(row) = row.first_chunk_mut::<BLOCK>() {
                    row[..8].copy_from_slice(&low);
                    row[8..].copy_from_slice(&high);
                } else {
                    for (pixel, white) in row.iter_mut().zip(low.into_iter().chain(high)) {
                        *pixel = white;
                    }
                }
                unsure |= u64::from(some & !white) << (BLOCK * (j - top));
            }
            while unsure != 0 {
                let i = unsure.trailing_zeros() as usize;
                unsure &= unsure - 1;
                let (column, row) = (columns.start + i % BLOCK, top + i / BLOCK);
                asked.push((column as u8, row as u8));
            }
        }
    }
}

const STEPS: [f32; BLOCK] = [
    0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0,
];

/// Where a tile's blocks begin.
const COLUMNS: [f32; BLOCKS] = [
    0.0, 16.0, 32.0, 48.0, 0.0, 16.0, 32.0, 48.0, 0.0, 16.0, 32.0, 48.0, 0.0, 16.0, 32.0, 48.0,
];
const ROWS: [f32; BLOCKS] = [
    0.0, 0.0, 0.0, 0.0, 16.0, 16.0, 16.0, 16.0, 32.0, 32.0, 32.0, 32.0, 48.0, 48.0, 48.0, 48.0,
];

/// White bytes where a number's bits are set, the lowest one first.
const SPREAD: [[u8; 8]; 256] = {
    let mut spread = [[0; 8]; 256];
    let mut i = 0;
    while i < 256 {
        let mut bit = 0;
        while bit < 8 {
            if i & (1 << bit) != 0 {
                spread[i][bit] = WHITE;
            }
            bit += 1;
        }
        i += 1;
    }
    spread
};
