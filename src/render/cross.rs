//! Turns on the pixels whose centres lie to the right of arcs, for hard edges.
//!
//! A pixel's row is that of its centre. A steep arc passes a row's centres at one place, and turns on the pixels from
//! the first centre to its right. A flat arc passes each column's centres at one place. Between two of them it goes
//! down by whole rows of centres, and turns these on from there. The parts fit together where arcs do.

use super::arc::EdgeArc;
use super::cells::{BITS, Cells, ONE, nearest};
use super::cover::CHUNK;

impl Cells {
    /// Turns on the pixels whose centres are to the right of an arc, or off if its weight is −1. Pixels whose centres
    /// are within `doubt` of the arc are added to `doubtful`.
    pub(super) fn cross(&mut self, arc: &EdgeArc, doubt: f64, doubtful: &mut Vec<(u32, u32)>) {
        if arc.steep {
            self.cross_steep(arc, doubt, doubtful);
        } else {
            self.cross_flat(arc, doubt, doubtful);
        }
        for (x, y) in arc.ends() {
            let (column, row) = (nearest(x - 0.5), nearest(y - 0.5));
            let (across, down) = (column as f64 + 0.5 - x, row as f64 + 0.5 - y);
            if across.abs().max(down.abs()) <= doubt {
                self.doubt(column - self.left, row - self.top, doubtful);
            }
        }
    }

    /// Returns the first row whose pixels' centres are below a crossing of the picture's left side.
    pub(super) fn first_below(&self, y: f64) -> i64 {
        centres_above(self.down(y))
    }

    /// Adds a pixel to those that are doubtful, if it is in the rows.
    fn doubt(&self, column: i64, row: i64, doubtful: &mut Vec<(u32, u32)>) {
        if (column as u64) < self.width as u64 && (row as u64) < self.rows as u64 {
            doubtful.push((column as u32, row as u32));
        }
    }

    /// Turns on the pixels of a row from a column on.
    #[inline(always)]
    fn turn_on(&mut self, row: i64, column: i64, weight: i32) {
        let column = column.clamp(0, self.width as i64) as usize;
        self.add(row as usize, column, weight, ONE, ONE);
    }

    fn cross_steep(&mut self, arc: &EdgeArc, doubt: f64, doubtful: &mut Vec<(u32, u32)>) {
        let first = centres_above(self.down(arc.u.0)).max(0);
        let last = centres_above(self.down(arc.u.1)).min(self.rows as i64);
        for row in first..last {
            let x = arc.at((self.top + row) as f64 + 0.5);
            // The first column whose centre is to the right.
            let column = nearest(x);
            let after = column as f64 + 0.5 - x;
            let column = column - self.left;
            self.turn_on(row, column, arc.weight);
            if after <= doubt {
                self.doubt(column, row, doubtful);
            } else if 1.0 - after <= doubt {
                self.doubt(column - 1, row, doubtful);
            }
        }
    }

    fn cross_flat(&mut self, arc: &EdgeArc, doubt: f64, doubtful: &mut Vec<(u32, u32)>) {
        let first = centres_above(self.across(arc.u.0)).max(0);
        let last = centres_above(self.across(arc.u.1)).min(self.width as i64);
        let centre = |column: i64, left: i64| (left + column) as f64 + 0.5;
        let rows = self.rows as i64;
        let mut level = centres_above(self.down(arc.v.0));
        let reach = arc.off_chord(CHUNK as f64);
        let mut column = first;
        while column < last {
            if column % CHUNK == 0 && column + CHUNK < last {
                // Whole chunks that do not come near the rows are passed over.
                let next = self.down(arc.at(centre(column + CHUNK, self.left)));
                if self.are_out((level << BITS, next), reach) {
                    level = centres_above(next);
                    column += CHUNK;
                    continue;
                }
            }
            let y = arc.at(centre(column, self.left)) - self.top as f64;
            // The first row whose centre is below.
            let next = nearest(y);
            self.turn_on_between(level, next, column, arc.weight);
            level = next;
            if next >= 0 && next <= rows {
                let after = next as f64 + 0.5 - y;
                if after <= doubt {
                    self.doubt(column, next, doubtful);
                } else if 1.0 - after <= doubt {
                    self.doubt(column, next - 1, doubtful);
                }
            }
            column += 1;
        }
        self.turn_on_between(
            level,
            centres_above(self.down(arc.v.1)),
            last.max(0),
            arc.weight,
        );
    }

    /// Turns on the rows that an arc passes downwards, and off those that it passes upwards.
    #[inline(always)]
    fn turn_on_between(&mut self, from: i64, to: i64, column: i64, weight: i32) {
        if from != to {
            let rows = self.rows as i64;
            let (from, to) = (from.clamp(0, rows), to.clamp(0, rows));
            for row in from..to {
                self.turn_on(row, column, weight);
            }
            for row in to..from {
                self.turn_on(row, column, -weight);
            }
        }
    }
}

/// How many pixels' centres are above a place, or left of it.
#[inline(always)]
fn centres_above(place: i64) -> i64 {
    (place + ONE / 2 - 1) >> BITS
}
