//! Which curves are open over a patch: neither wholly on one side of it nor on the other.

use super::Edge;
use super::patch::{Bent, Patch};
use super::picture::{Line, Picture, Spot};
use super::piece::Piece;
use crate::lanes::Real;

/// As many orders as there are at most.
pub(crate) const MOST_BANDS: usize = super::MOST_ORDERS as usize;

/// As many edges.
pub(crate) const MOST_EDGES: usize = 2 * MOST_BANDS;

/// Which edges are open over a patch. Those of a patch within it are among them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Open {
    quarter: usize,
    /// Two bits for each piece of the quarter turn: its outer edge, its inner edge.
    edges: u32,
}

/// An edge of a piece of a quarter turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct EdgeOf {
    /// Which piece.
    pub(crate) piece: usize,
    /// Which edge.
    pub(crate) edge: Edge,
}

/// What several patches have of edges: a bit for each patch.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Sifted {
    /// All its rays meet the disk.
    pub(crate) hit: u32,
    /// None of them does.
    pub(crate) miss: u32,
}

/// One order's band between its two edges, of which one at least is given: the rays are in it that are on the right
/// side of those.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Band<T = f64> {
    /// The outer edge: within the band is `g ≥ 0`.
    pub(crate) outer: Option<Line<T>>,
    /// The inner edge: within the band is `g ≤ 0`.
    pub(crate) inner: Option<Line<T>>,
}

impl Open {
    /// Every edge of a quarter turn.
    pub(crate) fn all(quarter: usize) -> Self {
        Self {
            quarter,
            edges: (1 << MOST_EDGES) - 1,
        }
    }

    /// None of a quarter turn.
    pub(crate) fn none(quarter: usize) -> Self {
        Self { quarter, edges: 0 }
    }

    /// And this one.
    pub(crate) fn with(mut self, of: EdgeOf) -> Self {
        self.edges |= 1 << of.bit();
        self
    }

    /// The quarter turn, 0 or 1.
    pub(crate) fn quarter(self) -> usize {
        self.quarter
    }
}

impl EdgeOf {
    fn bit(self) -> usize {
        2 * self.piece
            + match self.edge {
                Edge::Outer => 0,
                Edge::Inner => 1,
            }
    }
}

/// What is told of the edges that are open over patches: a trait, for the instructions of a closure's caller are not
/// always its own.
pub(crate) trait Listing<T> {
    /// An edge is open over those of the patches that there is a bit for.
    fn list(&mut self, of: EdgeOf, patches: u32, bent: &Bent<T>);
}

impl Picture<'_> {
    /// What is open over patches of one quarter turn, of those that `active` has a bit for: `found` is told each edge
    /// that is, with a bit for each patch over which it is, each piece's outer edge before its inner one. `before` are
    /// the edges that were open over a patch that they are part of.
    #[inline(always)]
    pub(crate) fn sift<T: Real>(
        &self,
        patch: &Patch<T>,
        active: u32,
        before: Open,
        list: &mut impl Listing<T>,
    ) -> Sifted {
        let pieces = self.curves.quarter(patch.quarter());
        let none = patch.none();
        let mut asked = before.edges & ((1 << (2 * pieces.len())) - 1);
        if self.n == 0.0 && pieces.first().is_some_and(Piece::has_pole) {
            // From within the disk's plane the direct image's φ is 0 over the first quarter turn: the ray meets the
            // plane where the camera is, which is not in the disk.
            asked &= !3;
        }
        let (mut hit, mut open) = (0, 0);
        while asked != 0 {
            let piece = asked.trailing_zeros() as usize / 2;
            let both = asked >> (2 * piece);
            asked &= !(3 << (2 * piece));
            let mut within = active & !hit & patch.overlaps(&pieces[piece]);
            if within == 0 {
                continue;
            }
            let about = patch.about(&pieces[piece]);
            let mut outer = None;
            let mut unsure = [0; 2];
            if both & 1 != 0 {
                let bent = patch.bent(&pieces[piece], Edge::Outer, &about);
                let [least, greatest] = patch.range(&bent);
                within &= !greatest.less(none);
                unsure[0] = !none.less(least);
                outer = Some(bent);
            }
            let mut inner = None;
            if both & 2 != 0 && within != 0 {
                let bent = patch.bent(&pieces[piece], Edge::Inner, &about);
                let [least, greatest] = patch.range(&bent);
                within &= !none.less(least);
                unsure[1] = !greatest.less(none);
                inner = Some(bent);
            }
            if let (Some(bent), true) = (&outer, within & unsure[0] != 0) {
                let edge = Edge::Outer;
                list.list(EdgeOf { piece, edge }, within & unsure[0], bent);
            }
            if let (Some(bent), true) = (&inner, within & unsure[1] != 0) {
                let edge = Edge::Inner;
                list.list(EdgeOf { piece, edge }, within & unsure[1], bent);
            }
            let unsure = within & (unsure[0] | unsure[1]);
            hit |= within & !unsure;
            open |= unsure;
        }
        Sifted {
            hit,
            miss: active & !hit & !open,
        }
    }

    /// An edge's tangent at a place.
    #[inline(always)]
    pub(crate) fn tangent<T: Real>(&self, spot: &Spot<T>, of: EdgeOf) -> Line<T> {
        spot.line(&self.curves.quarter(spot.quarter)[of.piece], of.edge)
    }
}
