//! Memory of samples.

/// A band's memory: rows of samples, some distance apart.
pub(in crate::render) struct Rows<'b, T> {
    samples: &'b mut [T],
    stride: usize,
}

impl<'b, T: Copy + Default> Rows<'b, T> {
    /// Splits memory, whose rows are `stride` samples apart, into bands of `rows` rows.
    pub(in crate::render) fn bands(
        samples: &'b mut [T],
        stride: usize,
        rows: usize,
    ) -> impl Iterator<Item = Self> {
        let bands = samples.chunks_mut(stride.saturating_mul(rows));
        bands.map(move |samples| Self { samples, stride })
    }

    /// The colours of some pixels of a row.
    #[inline(always)]
    pub(super) fn colours(&mut self, row: usize, from: usize, to: usize) -> &mut [[T; 3]] {
        let row = &mut self.samples[row * self.stride..];
        row[3 * from..3 * to].as_chunks_mut::<3>().0
    }
}
