//! The cells of some rows of pixels: what the arcs of a path leave in them, summed along the rows.
//!
//! # Derivation
//! Let a path wind around the disk, and let it pass a row of pixels. The share of a pixel that the disk covers is the
//! path's winding number, averaged over the pixel's square. Going right along the row, the winding number changes by
//! the weight of each arc that is crossed downwards, and by its opposite for one crossed upwards. So a part of an arc
//! that lies within one pixel and goes down by `dy`, at a share x̄ of the pixel's width in the mean, changes the
//! pixel's share by `dy (1 − x̄)`, its *area*, and that of all pixels to the right by `dy`, its *height*. A prefix sum
//! along the row gives the shares. `cover.rs` adds areas for smooth edges, `cross.rs` whole pixels for hard ones.
//!
//! # Integers
//! Coordinates, heights and areas are counted in 2⁻¹⁶ pixels. A cell holds both in one number, the height above the
//! 32nd bit, the area below it. Sums of integers are the same in any order, and the heights of a closed path cancel to
//! nothing.

/// Bits of a coordinate's fraction.
pub(super) const BITS: u32 = 16;

/// One pixel.
pub(super) const ONE: i64 = 1 << BITS;

/// Some rows of cells.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// Row by row, each as long as `stride`: a row of pixels, and one cell for all that is beyond its right side.
    sums: Vec<i64>,
    /// A bit for each cell that may not be 0, row by row.
    marks: Vec<u64>,
    stride: usize,
    words: usize,
    pub(super) width: usize,
    pub(super) rows: usize,
    /// The first column's and the first row's place in the picture.
    pub(super) left: i64,
    pub(super) top: i64,
}

impl Cells {
    /// Makes room for `rows` rows of `width` pixels from a column and a row of the picture on. All cells are empty.
    pub(super) fn set(&mut self, (left, top): (usize, usize), (width, rows): (usize, usize)) {
        let stride = width + 1;
        let words = stride.div_ceil(64);
        if (self.stride, self.words) != (stride, words) {
            self.sums.clear();
            self.marks.clear();
        }
        self.sums.resize(self.sums.len().max(stride * rows), 0);
        self.marks.resize(self.marks.len().max(words * rows), 0);
        (self.stride, self.words, self.width, self.rows) = (stride, words, width, rows);
        (self.left, self.top) = (left as i64, top as i64);
    }

    /// Adds a height and an area, of an arc of weight 1.
    #[inline(always)]
    pub(super) fn add(&mut self, row: usize, column: usize, weight: i32, height: i64, area: i64) {
        let cell = &mut self.sums[row * self.stride + column];
        *cell += i64::from(weight) * ((height << 32) + area);
        self.marks[row * self.words + column / 64] |= 1 << (column % 64);
    }

    /// x in 2⁻¹⁶ pixels from the first column.
    #[inline(always)]
    pub(super) fn across(&self, x: f64) -> i64 {
        fixed(x) - (self.left << BITS)
    }

    /// y in 2⁻¹⁶ pixels from the first row.
    #[inline(always)]
    pub(super) fn down(&self, y: f64) -> i64 {
        fixed(y) - (self.top << BITS)
    }

    /// The right side and the lower side of the rows, in 2⁻¹⁶ pixels.
    pub(super) fn ends(&self) -> (i64, i64) {
        ((self.width as i64) << BITS, (self.rows as i64) << BITS)
    }

    /// Sums a row from the left, where the winding number is `left`, in 2⁻¹⁶, and empties it. Calls `run` for each run
    /// of pixels that no arc passes, with its first column, the column after its last and its share. Calls `pixel` for
    /// each other pixel. Shares are 0 to [`ONE`].
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

/// A coordinate in 2⁻¹⁶ pixels.
#[inline(always)]
pub(super) fn fixed(coordinate: f64) -> i64 {
    nearest(coordinate * ONE as f64)
}

/// The nearest integer, for numbers below 2⁵¹: a sum with 1.5 · 2⁵² is rounded to it.
#[inline(always)]
pub(super) fn nearest(number: f64) -> i64 {
    const ROUNDER: f64 = 6_755_399_441_055_744.0;
    let bits = (number + ROUNDER).to_bits().cast_signed();
    bits.wrapping_sub(ROUNDER.to_bits().cast_signed())
}
