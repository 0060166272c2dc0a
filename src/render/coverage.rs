//! Antialiased frames: each pixel is the share of its square that the disk covers.
//!
//! # Derivation
//! Over one pixel an edge is a straight line: where `g`, linear in the pixel's neighbourhood with the value and the
//! gradient that it has at the centre (`src/isoradial/picture.rs`), is 0. The share on one side of it is known in closed
//! form, so that a straight edge is drawn exactly, and rings thinner than a pixel keep their light. The disk is the
//! union of its orders' bands: where edges of several orders share a pixel its square is clipped at all of them.
//!
//! A pixel over which an edge bends, where the whole ring is some pixels across or close to the disk's plane, is cut in
//! strips (`strips.rs`) across the way it bends, and those again where they must be: so are pixels that look at the hole
//! or at where the quarter turns meet.

use super::area::{apart, share_of_band, share_of_union};
use super::blocks::{Asked, Canvas};
use super::group::Group;
use super::strips::Strips;
use super::tiles::{Kind, Pixels, Threads, fill_frame};
use super::{RenderError, blank};
use crate::isoradial::{
    Band, Bent, Edge, EdgeOf, Isoradials, Line, Listing, MOST_BANDS, Open, Patch, Picture,
};
use crate::lanes::{Four, Level, dispatch};
use crate::scene::View;

/// What is not linear of an edge over a pixel, in pixels, beyond which the pixel is cut up.
const STRAIGHT: f64 = 1.0 / 32.0;

/// How far about a pixel its edges are looked for, as a share of its sides: farther than the tangent of
/// a straight one is off. So it makes no difference which edges beyond that are looked at too: their tangents do not
/// reach the pixel.
const MARGIN: f64 = 1.0 / 16.0;

/// The frame's pixels, row by row from the top, on all threads of the current rayon pool.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let mut pixels = blank(view)?;
    render_into(view, curves, &mut pixels, view.width() as usize)?;
    Ok(pixels)
}

/// The frame, on all threads of the current rayon pool, drawn into a caller's buffer: row j begins at `j stride`, whatever lies between the rows' ends is left
/// as it is. Nothing is allocated.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
pub fn render_into(
    view: &View,
    curves: &Isoradials,
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    render_on(view, curves, Threads::All, pixels, stride)
}

/// The same, on some threads.
pub(super) fn render_on(
    view: &View,
    curves: &Isoradials,
    threads: Threads,
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    let kind = Shares::new(view, curves);
    fill_frame(view, curves, kind, threads, pixels, stride)
}

/// The same pixels, each found by itself.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render_every_pixel(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let shares = Shares::new(view, curves);
    super::each_pixel(view, |column, row| shares.value(column, row, None))
}

/// What of a pixel is the disk.
pub(super) struct Shares<'a> {
    picture: Picture<'a>,
    strips: Strips<'a>,
}

impl Pixels for Shares<'_> {
    const KIND: Kind = Kind {
        reach: 0.5,
        // Measured as the cheapest.
        doubt: 0.2,
        // A tile's bound may be less than a pixel's own, which begins from another centre and is that of the pixel and its
        // margin: in a tile of two by two pixels, four from the hole's direction, by a factor of 2.2.
        bend: 0.4 * STRAIGHT,
        margin: MARGIN,
        smallest: 1,
    };

    fn value(&self, column: usize, row: usize, open: Option<Open>) -> u8 {
        byte(self.share(column, row, open))
    }

    fn draw_along(
        &self,
        level: Level,
        (group, tile): (&Group, usize),
        corner: (usize, usize),
        asked: &Asked,
        canvas: &mut Canvas<'_>,
    ) {
        let draw = |quarter, asked: &[(u8, u8)], canvas: &mut Canvas<'_>| {
            let mut edges = Edges::new(quarter);
            for of in group.edges(tile, quarter) {
                edges.push(of);
            }
            let place = Place {
                picture: &self.picture,
                edges: &edges,
                corner,
            };
            dispatch!(level, |_simd, four| place.draw(four, asked, canvas));
        };
        if !group.is_in_both(tile) {
            draw(group.open(tile).quarter(), asked.pixels(), canvas);
            return;
        }
        for quarter in [0, 1] {
            let mut side = Asked::new();
            for &(i, j) in asked.pixels() {
                let (column, row) = (corner.0 + usize::from(i), corner.1 + usize::from(j));
                let border = self
                    .picture
                    .border_about((column as f64 + 0.5, row as f64 + 0.5));
                // A pixel's distance from where the quarter turns meet: its patch is in one of them from 1.07 on.
                let gradient = libm::hypot(border.per_column, border.per_row);
                if border.value.abs() < 1.25 * gradient {
                    if quarter == 0 {
                        canvas.pixels[usize::from(j) * canvas.stride + usize::from(i)] =
                            self.value(column, row, None);
                    }
                } else if usize::from(border.value < 0.0) == quarter {
                    side.push((i, j));
                }
            }
            draw(quarter, side.pixels(), canvas);
        }
    }
}

/// With the margin to either side.
fn about((from, to): (f64, f64)) -> (f64, f64) {
    let margin = MARGIN * (to - from);
    (from - margin, to + margin)
}

fn byte(share: f64) -> u8 {
    (255.0 * share + 0.5) as u8
}

/// Edges of one quarter turn, piece by piece.
struct Edges {
    quarter: usize,
    /// Those of each piece, its outer one first.
    bands: [[Option<EdgeOf>; 2]; MOST_BANDS],
    count: usize,
}

impl Edges {
    fn new(quarter: usize) -> Self {
        Self {
            quarter,
            bands: [[None; 2]; MOST_BANDS],
            count: 0,
        }
    }

    /// Adds an edge of the last piece or of one after it.
    fn push(&mut self, of: EdgeOf) {
        let last = self.bands[..self.count]
            .last()
            .map(|band| band[0].or(band[1]));
        if last.flatten().map(|last| last.piece) != Some(of.piece) {
            self.count += 1;
        }
        self.bands[self.count - 1][usize::from(of.edge == Edge::Inner)] = Some(of);
    }
}

/// A pixel's sides.
const PIXEL: [f64; 2] = [1.0; 2];

/// How many pixels stand side by side.
const PIXELS: usize = 4;

/// A tile with nothing but `edges` open over it, all of which are straight in each of its pixels.
struct Place<'a> {
    picture: &'a Picture<'a>,
    edges: &'a Edges,
    corner: (usize, usize),
}

impl Place<'_> {
    /// Draws some of its pixels.
    #[inline(always)]
    fn draw<T: Four>(&self, like: T, asked: &[(u8, u8)], canvas: &mut Canvas<'_>) {
        for some in asked.chunks(PIXELS) {
            let (mut columns, mut rows) = ([0.0; PIXELS], [0.0; PIXELS]);
            for i in 0..PIXELS {
                // As many as there are, the last one over and over.
                let (column, row) = some[i.min(some.len() - 1)];
                columns[i] = (self.corner.0 + usize::from(column)) as f64 + 0.5;
                rows[i] = (self.corner.1 + usize::from(row)) as f64 + 0.5;
            }
            let shares = self.shares(like.of(columns), like.of(rows));
            for (&(i, j), share) in some.iter().zip(shares) {
                canvas.pixels[usize::from(j) * canvas.stride + usize::from(i)] = byte(share);
            }
        }
    }

    /// The shares of pixels: as [`share_of_union`] has it, for all at once.
    #[inline(always)]
    fn shares<T: Four>(&self, columns: T, rows: T) -> [f64; PIXELS] {
        let spot = self.picture.spot(columns, rows, self.edges.quarter);
        let (none, all) = (columns.all(0.0), columns.all(1.0));
        let empty = Band {
            outer: None,
            inner: None,
        };
        let mut bands = [empty; MOST_BANDS];
        let mut partial = [0; MOST_BANDS];
        let (mut most, mut sum, mut count) = (none, none, none);
        let mut overlap = 0;
        let edges = &self.edges.bands[..self.edges.count];
        for (index, [outer, inner]) in edges.iter().enumerate() {
            let mut band = empty;
            if let Some(of) = *outer {
                band.outer = Some(self.picture.tangent(&spot, of));
            }
            if let Some(of) = *inner {
                band.inner = Some(self.picture.tangent(&spot, of));
            }
            let share = none.larger(share_of_band(&band, PIXEL, none));
            if edges.len() == 1 {
                return share.into();
            }
            most = most.larger(share);
            sum = sum + share;
            count = count + none.if_less(share, all, none);
            partial[index] = none.less(share);
            for (before, is_partial) in bands[..index].iter().zip(partial) {
                let both = partial[index] & is_partial;
                if both != 0 {
                    overlap |= both & !apart(&band, before, PIXEL);
                }
            }
            bands[index] = band;
        }
        overlap &= most.less(all);
        let several = all.if_less(count, most.if_less(all, sum, most), most);
        let mut shares: [f64; PIXELS] = several.into();
        for (i, share) in shares.iter_mut().enumerate() {
            if overlap & (1 << i) != 0 {
                let mut one = [Band::default(); MOST_BANDS];
                for (one, band) in one.iter_mut().zip(&bands[..edges.len()]) {
                    *one = band.one(i);
                }
                *share = share_of_union(&one[..edges.len()], PIXEL);
            }
        }
        shares
    }
}

impl<T: Four> Line<T> {
    /// That of one of the pixels, or strips.
    pub(super) fn one(&self, i: usize) -> Line {
        Line {
            value: self.value.into()[i],
            per_column: self.per_column.into()[i],
            per_row: self.per_row.into()[i],
        }
    }
}

impl<T: Four> Band<T> {
    /// That of one of the pixels.
    fn one(&self, i: usize) -> Band {
        let one = |line: &Line<T>| line.one(i);
        Band {
            outer: self.outer.as_ref().map(one),
            inner: self.inner.as_ref().map(one),
        }
    }
}

/// The edges that are open over one patch.
struct OpenEdges {
    open: Open,
    bands: [Band; MOST_BANDS],
    count: usize,
    /// How far they are from their tangents at most, as a share of their gradients.
    bend: f64,
}

impl OpenEdges {
    /// The bands between them, their tangents in the patch's centre.
    fn bands(&self) -> &[Band] {
        &self.bands[..self.count]
    }

    /// Whether they are their tangents.
    fn are_straight(&self) -> bool {
        self.bend <= STRAIGHT
    }
}

/// Lists the edges that are open over one patch.
struct Listed<'a> {
    patch: &'a Patch,
    open: &'a mut OpenEdges,
    /// Whose edge was the last one.
    piece: Option<usize>,
}

impl Listing<f64> for Listed<'_> {
    fn list(&mut self, of: EdgeOf, _: u32, bent: &Bent) {
        let open = &mut *self.open;
        if self.piece != Some(of.piece) {
            self.piece = Some(of.piece);
            open.count += 1;
        }
        let band = &mut open.bands[open.count - 1];
        match of.edge {
            Edge::Outer => band.outer = Some(bent.line),
            Edge::Inner => band.inner = Some(bent.line),
        }
        open.open = open.open.with(of);
        // The gradient's larger part is its length, but for a factor of √2.
        let gradient = bent.line.per_column.abs().max(bent.line.per_row.abs());
        let bend = self.patch.bend(bent) / gradient;
        // Not a number is no straight line.
        open.bend = if bend <= open.bend { open.bend } else { bend };
    }
}

/// What of a patch is the disk.
#[expect(
    clippy::large_enum_variant,
    reason = "it is taken apart where it is made, and a box would be allocated"
)]
enum Seen {
    All,
    Nothing,
    Along(OpenEdges),
}

impl<'a> Shares<'a> {
    fn new(view: &'a View, curves: &'a Isoradials) -> Self {
        let picture = Picture::new(view, curves);
        Self {
            strips: Strips::new(&picture),
            picture,
        }
    }

    /// What of a patch is the disk.
    fn sift(&self, patch: &Patch, before: Option<Open>) -> Seen {
        let quarter = patch.quarter();
        let before = before
            .filter(|before| before.quarter() == quarter)
            .unwrap_or(Open::all(quarter));
        let mut open = OpenEdges {
            open: Open::none(quarter),
            bands: [Band::default(); MOST_BANDS],
            count: 0,
            bend: 0.0,
        };
        let mut listed = Listed {
            patch,
            open: &mut open,
            piece: None,
        };
        let sifted = self.picture.sift(patch, 1, before, &mut listed);
        if sifted.hit != 0 {
            Seen::All
        } else if sifted.miss != 0 {
            Seen::Nothing
        } else {
            Seen::Along(open)
        }
    }

    /// The share of a pixel.
    fn share(&self, column: usize, row: usize, open: Option<Open>) -> f64 {
        let (left, top) = (column as f64, row as f64);
        let patch = self
            .picture
            .patch(about((left, left + 1.0)), about((top, top + 1.0)));
        match patch.map(|patch| self.sift(&patch, open)) {
            Some(Seen::All) => 1.0,
            Some(Seen::Nothing) => 0.0,
            Some(Seen::Along(edges)) if edges.are_straight() => {
                share_of_union(edges.bands(), PIXEL)
            }
            _ => self.strips.share(column, row),
        }
    }
}
