//! Adds the areas that arcs cover to cells, for smooth edges.
//!
//! # Steps along an arc
//! An arc is cut where its main coordinate passes from one pixel to the next, or finer. Between two places the chord
//! takes its place, off by `|v″|/8n²` pixels at most for n steps a pixel, and by two thirds of that in the mean.

use super::arc::EdgeArc;
use super::cells::{BITS, Cells, ONE, fixed, nearest};

/// How far a chord may be off its arc, in pixels.
const CHORD: f64 = 1.0 / 256.0;

/// Most steps a pixel.
const MOST_STEPS: i64 = 16;

/// How many columns of a flat arc are looked at together.
pub(super) const CHUNK: i64 = 32;

/// A point (x, y) in 2⁻¹⁶ pixels from the first column and the first row of cells.
#[derive(Debug, Clone, Copy)]
struct Point {
    x: i64,
    y: i64,
}

impl Cells {
    /// Adds the shares of pixels that an arc covers.
    pub(super) fn cover(&mut self, arc: &EdgeArc) {
        if arc.steep {
            self.cover_steep(arc);
        } else {
            self.cover_flat(arc);
        }
    }

    /// Covers the rows below a crossing of the picture's left side, of which only the crossing's own row is covered in
    /// part: that part is added. Returns the first row that is covered whole.
    pub(super) fn cover_below(&mut self, y: f64, weight: i32) -> i64 {
        let y = self.down(y);
        let row = y >> BITS;
        let part = ((row + 1) << BITS) - y;
        if (row as u64) < self.rows as u64 {
            self.add(row as usize, 0, weight, part, part);
        }
        row + 1
    }

    fn cover_steep(&mut self, arc: &EdgeArc) {
        let (begin, end) = (self.down(arc.u.0), self.down(arc.u.1));
        let (first, last) = (begin.max(0), end.min(self.ends().1));
        if first >= last {
            return;
        }
        let step = ONE / steps(arc);
        let (top, scale) = (self.top as f64, 1.0 / ONE as f64);
        let at = |cells: &Self, y: i64| Point {
            x: cells.across(arc.at(top + y as f64 * scale)),
            y,
        };
        // At its ends an arc is where the next one begins.
        let mut from = if begin == first {
            Point {
                x: self.across(arc.v.0),
                y: first,
            }
        } else {
            at(self, first)
        };
        let mut y = (first / step + 1) * step;
        while y < last {
            let to = at(self, y);
            self.cover_in_row(from, to, arc.weight);
            from = to;
            y += step;
        }
        let to = if end == last {
            Point {
                x: self.across(arc.v.1),
                y: last,
            }
        } else {
            at(self, last)
        };
        self.cover_in_row(from, to, arc.weight);
    }

    fn cover_flat(&mut self, arc: &EdgeArc) {
        let (begin, end) = (self.across(arc.u.0), self.across(arc.u.1));
        let (first, last) = (begin.max(0), end.min(self.ends().0));
        let mut from = Point {
            x: first,
            y: self.down(arc.v.0),
        };
        if first > last {
            if end < 0 {
                let y = self.down(arc.v.1);
                self.cover_in_column(from, Point { x: first, y }, arc.weight);
            }
            return;
        }
        let step = ONE / steps(arc);
        let (left, scale) = (self.left as f64, 1.0 / ONE as f64);
        let at = |cells: &Self, x: i64| Point {
            x,
            y: cells.down(arc.at(left + x as f64 * scale)),
        };
        if begin < first {
            // What is beyond the left side is laid along it.
            let to = at(self, first);
            self.cover_in_column(from, to, arc.weight);
            from = to;
        }
        let reach = arc.off_chord(CHUNK as f64);
        let chunk = CHUNK << BITS;
        while from.x < last {
            // Whole chunks that do not come near the rows are passed over.
            let chunk_end = (from.x / chunk + 1) * chunk;
            let end = (chunk_end < last).then(|| at(self, chunk_end));
            if let Some(end) = end.filter(|end| self.are_out((from.y, end.y), reach)) {
                from = end;
                continue;
            }
            let mut x = (from.x / step + 1) * step;
            while x < last.min(chunk_end + 1) {
                let to = at(self, x);
                self.cover_in_column(from, to, arc.weight);
                from = to;
                x += step;
            }
            if end.is_none() {
                break;
            }
        }
        let to = if end == last {
            Point {
                x: last,
                y: self.down(arc.v.1),
            }
        } else {
            at(self, last)
        };
        self.cover_in_column(from, to, arc.weight);
    }

    /// Whether all places between two y are out of the rows, though they may be `reach` pixels beyond either.
    #[inline(always)]
    pub(super) fn are_out(&self, y: (i64, i64), reach: f64) -> bool {
        let reach = fixed(reach) + ONE;
        y.0.max(y.1) < -reach || y.0.min(y.1) > self.ends().1 + reach
    }

    /// Adds a chord that goes down in one row.
    #[inline(always)]
    fn cover_in_row(&mut self, from: Point, to: Point, weight: i32) {
        let row = (from.y >> BITS) as usize;
        let (first, last) = (from.x >> BITS, to.x >> BITS);
        let height = to.y - from.y;
        if first == last && (first as u64) < self.width as u64 {
            self.cover_in_pixel((first, row), from.x + to.x, height, weight);
        } else {
            self.cover_across(row, (from.x, to.x), height, weight);
        }
    }

    /// Adds a chord that goes down by `height` in one row from one x to another. What of it is beyond a side of the
    /// cells is laid along that side.
    fn cover_across(&mut self, row: usize, (from, to): (i64, i64), height: i64, weight: i32) {
        let right = self.ends().0;
        let rises = to > from;
        let slope = height as f64 / (to - from) as f64;
        let (mut at, mut covered) = (from, 0);
        while covered != height {
            let column = if rises { at >> BITS } else { (at - 1) >> BITS };
            // The next column's side, or that of the cells.
            let side = if rises {
                if at < 0 { 0 } else { (column + 1) << BITS }
            } else if at > right {
                right
            } else {
                column << BITS
            };
            let is_last = if rises {
                side >= to || at >= right
            } else {
                side <= to || at <= 0
            };
            let next = if is_last { to } else { side };
            let total = if is_last {
                height
            } else {
                nearest(slope * (next - from) as f64)
            };
            let (part, x) = (total - covered, at.clamp(0, right) + next.clamp(0, right));
            self.cover_in_pixel((column.clamp(0, right >> BITS), row), x, part, weight);
            if is_last {
                return;
            }
            (at, covered) = (next, total);
        }
    }

    /// Adds a chord that goes right in one column.
    #[inline(always)]
    fn cover_in_column(&mut self, from: Point, to: Point, weight: i32) {
        let row = from.y >> BITS;
        if row != to.y >> BITS {
            self.cover_down(from, to, weight);
        } else if (row as u64) < self.rows as u64 && from.y != to.y {
            let pixel = (from.x >> BITS, row as usize);
            self.cover_in_pixel(pixel, from.x + to.x, to.y - from.y, weight);
        }
    }

    /// Adds a chord that passes several rows in one column.
    fn cover_down(&mut self, from: Point, to: Point, weight: i32) {
        let column = from.x >> BITS;
        let bottom = self.ends().1;
        let slope = (to.x - from.x) as f64 / (to.y - from.y) as f64;
        let x_at = |y: i64| from.x + nearest(slope * (y - from.y) as f64);
        let (first, last) = (from.y.clamp(0, bottom), to.y.clamp(0, bottom));
        let falls = last > first;
        let mut at = Point {
            x: x_at(first),
            y: first,
        };
        while at.y != last {
            let row = if falls {
                at.y >> BITS
            } else {
                (at.y - 1) >> BITS
            };
            let y = if falls {
                ((row + 1) << BITS).min(last)
            } else {
                (row << BITS).max(last)
            };
            let next = Point {
                x: if y == to.y { to.x } else { x_at(y) },
                y,
            };
            self.cover_in_pixel((column, row as usize), at.x + next.x, next.y - at.y, weight);
            at = next;
        }
    }

    /// Adds a chord that goes down by `height` in one pixel, a column and a row: the area to its right. `twice_x` is
    /// the sum of its ends' x.
    #[inline(always)]
    fn cover_in_pixel(
        &mut self,
        (column, row): (i64, usize),
        twice_x: i64,
        height: i64,
        weight: i32,
    ) {
        let twice_right = ((column + 1) << (BITS + 1)) - twice_x;
        let area = (height * twice_right + ONE) >> (BITS + 1);
        self.add(row, column as usize, weight, height, area);
    }
}

/// How many steps a pixel an arc is cut into: a power of two.
fn steps(arc: &EdgeArc) -> i64 {
    let mut steps = 1;
    let mut off = arc.off_chord(1.0);
    while off > CHORD && steps < MOST_STEPS {
        steps *= 2;
        off *= 0.25;
    }
    steps
}
