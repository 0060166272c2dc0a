//! Which curves are open over a patch: neither wholly on one side of it nor on the other.

use super::patch::{Bent, Patch, Side};
use super::picture::{Line, Picture};
use super::{Edge, Isoradials};

/// As many orders as there are at most.
const MOST: usize = super::MOST_ORDERS as usize;

/// Which edges are open over a patch. Those of a patch within it are among them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Open {
    quarter: usize,
    /// Two bits for each piece of the quarter turn: its outer edge, its inner edge.
    edges: u32,
}

/// The edges that are open over one patch, order by order.
#[derive(Debug, Clone)]
pub struct OpenEdges {
    edges: [OpenEdge; 2 * MOST],
    count: usize,
}

/// One of them.
#[derive(Debug, Clone, Copy)]
pub struct OpenEdge {
    /// Which of the quarter turn's pieces.
    pub piece: usize,
    /// Which of its edges.
    pub edge: Edge,
    /// The edge over the patch.
    pub bent: Bent,
}

/// One order's band between its two edges, of which one at least is given: the rays are in it that are on the right
/// side of those.
#[derive(Debug, Clone, Copy, Default)]
pub struct Band {
    /// The outer edge: within the band is `g ≥ 0`.
    pub outer: Option<Line>,
    /// The inner edge: within the band is `g ≤ 0`.
    pub inner: Option<Line>,
}

/// What all rays of a patch have in common over which no edge is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uniform {
    /// They meet the disk.
    Hit,
    /// They do not.
    Miss,
}

impl OpenEdges {
    /// None at all.
    pub fn none() -> Self {
        let edge = OpenEdge {
            piece: 0,
            edge: Edge::Outer,
            bent: Bent::default(),
        };
        Self {
            edges: [edge; 2 * MOST],
            count: 0,
        }
    }

    /// The edges: each piece's outer one before its inner one.
    pub fn edges(&self) -> &[OpenEdge] {
        &self.edges[..self.count]
    }

    /// The edges of each piece, tangents in the patch's centre.
    pub fn bands(&self) -> Bands {
        Bands::of(self.edges(), |open| open.bent.line)
    }
}

/// Some orders' bands.
#[derive(Debug, Clone, Copy)]
pub struct Bands {
    bands: [Band; MOST],
    count: usize,
}

impl Bands {
    fn of(edges: &[OpenEdge], line: impl Fn(&OpenEdge) -> Line) -> Self {
        let mut bands = Self {
            bands: [Band::default(); MOST],
            count: 0,
        };
        let mut last = None;
        for open in edges {
            if last != Some(open.piece) {
                last = Some(open.piece);
                bands.count += 1;
            }
            let band = &mut bands.bands[bands.count - 1];
            match open.edge {
                Edge::Outer => band.outer = Some(line(open)),
                Edge::Inner => band.inner = Some(line(open)),
            }
        }
        bands
    }

    /// The bands.
    pub fn as_slice(&self) -> &[Band] {
        &self.bands[..self.count]
    }
}

impl Isoradials {
    /// What is open over `patch`, into `edges`; `before` is what was open over a patch that it is part of.
    ///
    /// # Errors
    /// What its rays have in common, where nothing is open.
    #[inline]
    pub fn patched(
        &self,
        patch: &Patch,
        before: Option<Open>,
        edges: &mut OpenEdges,
    ) -> Result<Open, Uniform> {
        let pieces = self.quarter(patch.quarter());
        let mut asked = before
            .filter(|open| open.quarter == patch.quarter())
            .map_or((1 << (2 * pieces.len())) - 1, |open| open.edges);
        let mut open = 0;
        edges.count = 0;
        while asked != 0 {
            let index = asked.trailing_zeros() as usize / 2;
            let both = (asked >> (2 * index)) & 3;
            asked &= !(3 << (2 * index));
            if !patch.overlaps(&pieces[index]) {
                continue;
            }
            let mut left = 0;
            let mut missed = false;
            for (bit, edge, outside, inside) in [
                (1, Edge::Outer, Side::Below, Side::Above),
                (2, Edge::Inner, Side::Above, Side::Below),
            ] {
                if both & bit == 0 {
                    continue;
                }
                let bent = patch.bent(&pieces[index], edge);
                let side = patch.side(&bent);
                if side == Some(outside) {
                    missed = true;
                    break;
                }
                if side != Some(inside) {
                    edges.edges[edges.count] = OpenEdge {
                        piece: index,
                        edge,
                        bent,
                    };
                    edges.count += 1;
                    left |= bit;
                }
            }
            if missed {
                edges.count -= left.count_ones() as usize;
            } else if left == 0 {
                return Err(Uniform::Hit);
            } else {
                open |= left << (2 * index);
            }
        }
        if open == 0 {
            Err(Uniform::Miss)
        } else {
            Ok(Open {
                quarter: patch.quarter(),
                edges: open,
            })
        }
    }
}

impl Picture<'_> {
    /// The bands of the edges that are open over a patch, tangents at a place in it.
    #[inline]
    pub fn bands_at(&self, place: (f64, f64), edges: &[OpenEdge]) -> Bands {
        let Some(spot) = self.spot(place, None) else {
            return Bands::of(&[], |_| Line::default());
        };
        let pieces = self.curves.quarter(spot.quarter);
        Bands::of(edges, |open| spot.line(&pieces[open.piece], open.edge))
    }
}
