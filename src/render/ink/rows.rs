//! Memory of samples.

use crate::render::tiles::{Rectangle, TileRow};
use crate::scene::View;

/// Samples of a band: those that are drawn, and where these are not whole tiles, memory for the tiles.
#[derive(Debug)]
pub(super) struct Samples<'b, T> {
    drawn: &'b mut [T],
    /// From one row that is drawn to the next.
    stride: usize,
    /// Row by row; empty where all of the tiles is drawn.
    tiles: Vec<T>,
    /// What of the tiles is drawn.
    shown: Rectangle,
    /// Samples of a row of the tiles, and of a pixel.
    width: usize,
    channels: usize,
}

impl<'b, T: Copy + Default> Samples<'b, T> {
    /// Splits memory for the drawn part of a view, whose rows are `stride` samples apart, into bands.
    pub(super) fn bands(
        drawn: &'b mut [T],
        view: &View,
        stride: usize,
        channels: usize,
    ) -> impl Iterator<Item = Self> {
        let (view, mut rest) = (*view, drawn);
        (0..TileRow::count(&view)).map(move |number| {
            let band = TileRow::new(&view, number);
            let shown = band.shown(&view);
            // The last row ends with its last pixel.
            let samples = stride.saturating_mul(shown.rows.1 - shown.rows.0);
            let samples = samples.min(rest.len());
            let (drawn, after) = core::mem::take(&mut rest).split_at_mut(samples);
            rest = after;
            let is_whole = shown.columns == (0, band.width) && shown.rows == (0, band.rows);
            let width = channels * band.width;
            Self {
                drawn,
                stride,
                tiles: if is_whole {
                    Vec::new()
                } else {
                    vec![T::default(); width * band.rows]
                },
                shown,
                width,
                channels,
            }
        })
    }

    /// All samples of the tiles, and how far apart their rows are.
    #[inline(always)]
    pub(super) fn all(&mut self) -> (&mut [T], usize) {
        if self.tiles.is_empty() {
            (self.drawn, self.stride)
        } else {
            (&mut self.tiles, self.width)
        }
    }

    /// Copies what is drawn out of the tiles.
    pub(super) fn hand_over(&mut self) {
        if self.tiles.is_empty() {
            return;
        }
        let (from, to) = (
            self.channels * self.shown.columns.0,
            self.channels * self.shown.columns.1,
        );
        let rows = self.tiles.chunks_exact(self.width).skip(self.shown.rows.0);
        for (drawn, row) in self.drawn.chunks_mut(self.stride).zip(rows) {
            drawn[..to - from].copy_from_slice(&row[from..to]);
        }
    }
}

/// A band's memory: rows of colours.
pub(in crate::render) struct Rows<'b, T>(Samples<'b, T>);

impl<'b, T: Copy + Default> Rows<'b, T> {
    /// Splits memory for the drawn part of a view, whose rows are `stride` samples apart, into bands.
    pub(in crate::render) fn bands(
        samples: &'b mut [T],
        view: &View,
        stride: usize,
    ) -> impl Iterator<Item = Self> {
        Samples::bands(samples, view, stride, 3).map(Self)
    }

    /// The colours of some pixels of a row.
    #[inline(always)]
    pub(in crate::render) fn colours(
        &mut self,
        row: usize,
        from: usize,
        to: usize,
    ) -> &mut [[T; 3]] {
        let (samples, stride) = self.0.all();
        let row = &mut samples[row * stride..];
        row[3 * from..3 * to].as_chunks_mut::<3>().0
    }

    /// Hands over the pixels that are drawn.
    pub(in crate::render) fn hand_over(&mut self) {
        self.0.hand_over();
    }
}
