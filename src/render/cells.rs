//! Signed areas: what the arcs of a path leave in the cells of some rows of pixels.
//!
//! # Derivation
//! Let a path wind around the disk, and let it pass a row of pixels. The share of a pixel that the disk covers is the
//! path's winding number, averaged over the pixel's square. Going right along the row the winding number changes by the
//! weight of each arc that is crossed downwards, and by its opposite for one crossed upwards. So a part of an arc that
//! lies within one pixel and goes down by `dy`, at a share x̄ of the pixel's width in the mean, changes the pixel's
//! share by `dy (1 − x̄)`, its *area*, and that of all pixels to the right by `dy`, its *height*. A prefix sum along the
//! row gives the shares.
//!
//! # Integers
//! Coordinates are rounded to 2⁻¹⁶ pixels, heights are their differences, areas are rounded to 2⁻¹⁶. A cell holds both in one
//! number, the height above the 32nd bit, the area below it. Sums of integers are the same in any order, and the
//! heights of a closed path cancel to nothing.
//!
//! # Steps along an arc
//! An arc is cut where its main coordinate passes from one pixel to the next, or finer: between two places the chord
//! takes its place, off by `|v″|/8n²` pixels at most for n steps a pixel. Half of [`CHORD`] is left on the mean.

use super::arc::EdgeArc;

/// Bits of a coordinate's fraction.
const BITS: u32 = 16;

/// One pixel.
pub(super) const ONE: i64 = 1 << BITS;

/// How far a chord may be off its arc, in pixels.
const CHORD: f64 = 1.0 / 256.0;

/// How many columns of a flat arc are looked at together.
const CHUNK: i64 = 32;

/// Most steps a pixel.
const MOST_STEPS: i64 = 16;

/// Some rows of cells.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// Row by row, each as long as `stride`: a row of pixels, and one cell for all that is beyond its right side.
    sums: Vec<i64>,
    /// A bit for each cell that may not be 0, row by row.
    marks: Vec<u64>,
    stride: usize,
    words: usize,
    width: usize,
    rows: usize,
    /// The first row's place in the picture.
    top: i64,
}

/// A point (x, y) in 2⁻¹⁶ pixels, y from the first row of cells.
#[derive(Debug, Clone, Copy)]
struct Point {
    x: i64,
    y: i64,
}

impl Cells {
    /// Makes room for `rows` rows of `width` pixels from row `top` of the picture on. All cells are empty.
    pub(super) fn set(&mut self, width: usize, top: usize, rows: usize) {
        let stride = width + 1;
        let words = stride.div_ceil(64);
        if (self.stride, self.words) != (stride, words) {
            self.sums.clear();
            self.marks.clear();
        }
        self.sums.resize(self.sums.len().max(stride * rows), 0);
        self.marks.resize(self.marks.len().max(words * rows), 0);
        (self.stride, self.words, self.width, self.rows) = (stride, words, width, rows);
        self.top = top as i64;
    }

    /// Adds a height and an area, of an arc of weight 1.
    #[inline(always)]
    fn add(&mut self, row: usize, column: usize, weight: i32, height: i64, area: i64) {
        let cell = &mut self.sums[row * self.stride + column];
        *cell += i64::from(weight) * ((height << 32) + area);
        self.marks[row * self.words + column / 64] |= 1 << (column % 64);
    }

    /// y in 2⁻¹⁶ pixels from the first row.
    #[inline(always)]
    fn down(&self, y: f64) -> i64 {
        fixed(y) - (self.top << BITS)
    }

    /// The right side of the picture, and the lower side of the rows, in 2⁻¹⁶ pixels.
    fn ends(&self) -> (i64, i64) {
        ((self.width as i64) << BITS, (self.rows as i64) << BITS)
    }

    /// Adds the shares of pixels that an arc covers.
    pub(super) fn cover(&mut self, arc: &EdgeArc) {
        if arc.steep {
            self.cover_steep(arc);
        } else {
            self.cover_flat(arc);
        }
    }

    fn cover_steep(&mut self, arc: &EdgeArc) {
        let (begin, end) = (self.down(arc.u.0), self.down(arc.u.1));
        let (first, last) = (begin.max(0), end.min(self.ends().1));
        if first >= last {
            return;
        }
        let step = ONE / steps(arc);
        let (top, scale) = (self.top as f64, 1.0 / ONE as f64);
        let at = |y: i64| Point {
            x: fixed(arc.at(top + y as f64 * scale)),
            y,
        };
        // At its ends an arc is where the next one begins.
        let mut from = if begin == first {
            Point {
                x: fixed(arc.v.0),
                y: first,
            }
        } else {
            at(first)
        };
        let mut y = (first / step + 1) * step;
        while y < last {
            let to = at(y);
            self.cover_in_row(from, to, arc.weight);
            from = to;
            y += step;
        }
        let to = if end == last {
            Point {
                x: fixed(arc.v.1),
                y: last,
            }
        } else {
            at(last)
        };
        self.cover_in_row(from, to, arc.weight);
    }

    fn cover_flat(&mut self, arc: &EdgeArc) {
        let (begin, end) = (fixed(arc.u.0), fixed(arc.u.1));
        let (first, last) = (begin.max(0), end.min(self.ends().0));
        if first > last {
            return;
        }
        let step = ONE / steps(arc);
        let scale = 1.0 / ONE as f64;
        let at = |cells: &Self, x: i64| Point {
            x,
            y: cells.down(arc.at(x as f64 * scale)),
        };
        let mut from = Point {
            x: first,
            y: self.down(arc.v.0),
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
    fn are_out(&self, y: (i64, i64), reach: f64) -> bool {
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
            let twice_left = (from.x + to.x) - (first << (BITS + 1));
            self.add(
                row,
                first as usize,
                weight,
                height,
                area(height, twice_left),
            );
        } else {
            self.cover_across(row, (from.x, to.x), height, weight);
        }
    }

    /// Adds a chord that goes down by `height` in one row from one x to another. What of it is beyond a side of the
    /// picture is laid along that side.
    fn cover_across(&mut self, row: usize, (from, to): (i64, i64), height: i64, weight: i32) {
        let right = self.ends().0;
        let rises = to > from;
        let slope = height as f64 / (to - from) as f64;
        let (mut at, mut covered) = (from, 0);
        while covered != height {
            let column = if rises { at >> BITS } else { (at - 1) >> BITS };
            // The next column's side, or the picture's.
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
            let (part, left) = (total - covered, at.clamp(0, right) + next.clamp(0, right));
            let column = column.clamp(0, right >> BITS);
            self.add(
                row,
                column as usize,
                weight,
                part,
                area(part, left - (column << (BITS + 1))),
            );
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
            let column = from.x >> BITS;
            let twice_left = (from.x + to.x) - (column << (BITS + 1));
            let height = to.y - from.y;
            self.add(
                row as usize,
                column as usize,
                weight,
                height,
                area(height, twice_left),
            );
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
            let twice_left = (at.x + next.x) - (column << (BITS + 1));
            let height = next.y - at.y;
            self.add(
                row as usize,
                column as usize,
                weight,
                height,
                area(height, twice_left),
            );
            at = next;
        }
    }

    /// Turns on, for all pixels whose centres an arc passes on the left, the disk on its right. Pixels whose centres are
    /// within `doubt` of the arc are added to `doubtful`.
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
                self.doubt(column, row - self.top, doubtful);
            }
        }
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
            self.turn_on(row, column, arc.weight);
            let after = column as f64 + 0.5 - x;
            if after <= doubt {
                self.doubt(column, row, doubtful);
            } else if 1.0 - after <= doubt {
                self.doubt(column - 1, row, doubtful);
            }
        }
    }

    fn cross_flat(&mut self, arc: &EdgeArc, doubt: f64, doubtful: &mut Vec<(u32, u32)>) {
        let first = centres_above(fixed(arc.u.0)).max(0);
        let last = centres_above(fixed(arc.u.1)).min(self.width as i64);
        let rows = self.rows as i64;
        let mut level = centres_above(self.down(arc.v.0));
        let reach = arc.off_chord(CHUNK as f64);
        let mut column = first;
        while column < last {
            if column % CHUNK == 0 && column + CHUNK < last {
                // Whole chunks that do not come near the rows are passed over.
                let next = self.down(arc.at((column + CHUNK) as f64 + 0.5));
                if self.are_out((level << BITS, next), reach) {
                    level = centres_above(next);
                    column += CHUNK;
                    continue;
                }
            }
            let y = arc.at(column as f64 + 0.5) - self.top as f64;
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

    /// Covers what is below a step on the picture's left side in the step's own row. Returns the first row that is
    /// covered whole.
    pub(super) fn cover_below(&mut self, y: f64, weight: i32) -> i64 {
        let y = self.down(y);
        let row = y >> BITS;
        let part = ((row + 1) << BITS) - y;
        if (row as u64) < self.rows as u64 {
            self.add(row as usize, 0, weight, part, part);
        }
        row + 1
    }

    /// The first row whose pixels' centres are below a step on the picture's left side.
    pub(super) fn first_below(&self, y: f64) -> i64 {
        centres_above(self.down(y))
    }

    /// Walks a row that begins with the winding number `left`, in 2⁻¹⁶, and empties it. `run` is told each run of pixels
    /// of one share, `pixel` each pixel by itself: share 0 to [`ONE`].
    #[inline(always)]
    pub(super) fn walk(
        &mut self,
        row: usize,
        left: i64,
        mut run: impl FnMut(usize, usize, i64),
        mut pixel: impl FnMut(usize, i64),
    ) {
        let cells = &mut self.sums[row * self.stride..][..self.stride];
        let marks = &mut self.marks[row * self.words..][..self.words];
        let (mut share, mut next) = (left, 0);
        for (i, word) in marks.iter_mut().enumerate() {
            if *word == 0 {
                continue;
            }
            let mut bits = core::mem::take(word);
            while bits != 0 {
                let column = 64 * i + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                if column > next {
                    run(next, column, share.clamp(0, ONE));
                }
                let cell = core::mem::take(&mut cells[column]);
                let area = i64::from(cell as i32);
                if column < self.width {
                    pixel(column, (share + area).clamp(0, ONE));
                }
                share += (cell - area) >> 32;
                next = column + 1;
            }
        }
        if next < self.width {
            run(next, self.width, share.clamp(0, ONE));
        }
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

/// The area right of a chord of some height, twice the share of the pixel's width to its left in the mean.
#[inline(always)]
fn area(height: i64, twice_share: i64) -> i64 {
    let right = 2 * ONE - twice_share;
    (height * right + ONE) >> (BITS + 1)
}

/// How many pixels' centres are above a place, or left of it.
#[inline(always)]
fn centres_above(place: i64) -> i64 {
    (place + ONE / 2 - 1) >> BITS
}

/// A coordinate in 2⁻¹⁶ pixels.
#[inline(always)]
pub(super) fn fixed(coordinate: f64) -> i64 {
    nearest(coordinate * ONE as f64)
}

/// The nearest integer, for numbers below 2⁵¹: a sum with 1.5 · 2⁵² is rounded to it.
#[inline(always)]
fn nearest(number: f64) -> i64 {
    const ROUNDER: f64 = 6_755_399_441_055_744.0;
    let bits = (number + ROUNDER).to_bits().cast_signed();
    bits.wrapping_sub(ROUNDER.to_bits().cast_signed())
}
