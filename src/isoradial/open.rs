//! Which curves are open over a patch: neither wholly on one side of it nor on the other.

use super::patch::{Line, Patch};
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

/// What is known of a patch.
#[derive(Debug)]
pub enum Patched {
    /// All its rays meet the disk.
    Hit,
    /// None does.
    Miss,
    /// It depends on the ray.
    Open(Open),
}

impl Open {
    /// The bands that are open.
    pub fn bands(&self) -> &[OpenBand] {
        &self.bands[..self.count]
    }
}

impl Isoradials {
    /// What is known of `patch`, `half` so many pixels to either side of its centre; `before` is what was open over a
    /// patch that it is part of.
    pub fn patched(&self, patch: &Patch, half: (f64, f64), before: Option<&Open>) -> Patched {
        let before = before.filter(|open| open.quarter == patch.quarter());
        let mut open = Open {
            quarter: patch.quarter(),
            bands: [OpenBand::default(); MOST],
            count: 0,
        };
        let pieces = self.quarter(patch.quarter());
        let mut narrow = |piece: usize, inner: bool, outer: bool| {
            let line = |edge| patch.line(&pieces[piece], edge, self.critical());
            let mut band = OpenBand {
                piece,
                ..OpenBand::default()
            };
            if outer {
                let line = line(Edge::Outer);
                let (low, high) = line.bounds(half);
                if high < 0.0 {
                    return false;
                }
                // Not `low < 0`, which would take what is no number for decided.
                if !(low >= 0.0) {
                    band.outer = Some(line);
                }
            }
            if inner {
                let line = line(Edge::Inner);
                let (low, high) = line.bounds(half);
                if low > 0.0 {
                    return false;
                }
                if !(high <= 0.0) {
                    band.inner = Some(line);
                }
            }
            if band.inner.is_none() && band.outer.is_none() {
                return true;
            }
            open.bands[open.count] = band;
            open.count += 1;
            false
        };
        let hit = match before {
            Some(before) => before
                .bands()
                .iter()
                .any(|band| narrow(band.piece, band.inner.is_some(), band.outer.is_some())),
            None => (0..pieces.len()).any(|piece| narrow(piece, true, true)),
        };
        if hit {
            Patched::Hit
        } else if open.count == 0 {
            Patched::Miss
        } else {
            Patched::Open(open)
        }
    }
}
