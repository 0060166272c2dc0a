//! Which curves are open over a patch: neither wholly on one side of it nor on the other.

use super::patch::{Line, Patch, Side};
use super::{Edge, Isoradials};

/// The edges that are open over a patch. Those of a patch within it are among them.
#[derive(Debug, Clone, Copy)]
pub struct Open {
    quarter: usize,
    bands: [OpenBand; MOST],
    count: usize,
}

/// As many orders as there are at most.
const MOST: usize = super::MOST_ORDERS as usize;

/// One order's band between its two edges: the rays of the patch are in it that are on the right side of the edges
/// that are open.
#[derive(Debug, Clone, Copy, Default)]
pub struct OpenBand {
    /// Which of the quarter turn's pieces.
    piece: usize,
    /// The inner edge over the patch, if it is open: within the band is `g ≤ 0`.
    pub inner: Option<Line>,
    /// The outer edge: within the band is `g ≥ 0`.
    pub outer: Option<Line>,
}

/// What all rays of a patch have in common over which no edge is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uniform {
    /// They meet the disk.
    Hit,
    /// They do not.
    Miss,
}

impl OpenBand {
    /// A band between two edges, each of them if it is open.
    pub fn new(outer: Option<Line>, inner: Option<Line>) -> Self {
        Self {
            piece: 0,
            inner,
            outer,
        }
    }
}

impl Open {
    /// The bands that are open.
    pub fn bands(&self) -> &[OpenBand] {
        &self.bands[..self.count]
    }
}

impl Isoradials {
    /// What is open over `patch`, `half` so many pixels to either side of its centre; `before` is what was open over a
    /// patch that it is part of.
    ///
    /// # Errors
    /// What its rays have in common, where nothing is open.
    pub fn patched(
        &self,
        patch: &Patch,
        half: (f64, f64),
        before: Option<&Open>,
    ) -> Result<Open, Uniform> {
        let mut open = Open {
            quarter: patch.quarter(),
            bands: [OpenBand::default(); MOST],
            count: 0,
        };
        let before = before.filter(|open| open.quarter == patch.quarter());
        let count = before.map_or(self.quarter(open.quarter).len(), |before| before.count);
        for i in 0..count {
            let (piece, asked) = before.map_or((i, [true; 2]), |before| {
                let band = &before.bands[i];
                (band.piece, [band.outer.is_some(), band.inner.is_some()])
            });
            let band = OpenBand {
                piece,
                ..OpenBand::default()
            };
            match self.narrowed(patch, half, band, asked) {
                Ok(band) => {
                    open.bands[open.count] = band;
                    open.count += 1;
                }
                Err(Uniform::Hit) => return Err(Uniform::Hit),
                Err(Uniform::Miss) => {}
            }
        }
        if open.count == 0 {
            Err(Uniform::Miss)
        } else {
            Ok(open)
        }
    }

    /// The edges of a band that are open, of those asked for: outer, inner.
    #[inline]
    fn narrowed(
        &self,
        patch: &Patch,
        half: (f64, f64),
        mut band: OpenBand,
        [outer, inner]: [bool; 2],
    ) -> Result<OpenBand, Uniform> {
        let piece = &self.quarter(patch.quarter())[band.piece];
        if outer {
            let line = patch.line(piece, Edge::Outer, self.critical());
            match line.side(half) {
                Some(Side::Below) => return Err(Uniform::Miss),
                Some(Side::Above) => {}
                None => band.outer = Some(line),
            }
        }
        if inner {
            let line = patch.line(piece, Edge::Inner, self.critical());
            match line.side(half) {
                Some(Side::Above) => return Err(Uniform::Miss),
                Some(Side::Below) => {}
                None => band.inner = Some(line),
            }
        }
        if band.inner.is_none() && band.outer.is_none() {
            Err(Uniform::Hit)
        } else {
            Ok(band)
        }
    }
}
