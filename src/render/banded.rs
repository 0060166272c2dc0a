//! An outline in a view, sorted into bands of rows.
//!
//! Each band is drawn by one thread: its arcs leave areas or toggles in cells, which are summed row by row.

use super::arc::EdgeArc;
use super::cells::{Cells, ONE, fixed};
use super::edge_map::EdgeMap;
use super::path::OutlinePath;
use crate::isoradial::{Boundary, Isoradials};
use crate::scene::{Region, View};

/// The largest error of an arc for smooth edges, in pixels.
const SMOOTH: f64 = 1.0 / 512.0;

/// The largest error of an arc for hard edges, in pixels. Pixels whose centres are within twice that of an arc are
/// evaluated one by one.
const HARD: f64 = 1.0 / 200.0;

/// Every pixel is evaluated by itself, with hard edges, if rounding moves an edge by more than this, in pixels, or if
/// the outline takes too many arcs. An outline has no meaning below the rounding of its curves.
pub(super) const COARSE: f64 = 0.1;

/// An outline, sorted into bands.
#[derive(Debug, Default)]
pub(super) struct BandedOutline {
    path: OutlinePath,
    /// The arcs that pass each band, band by band.
    sorted: Vec<u32>,
    /// Where each band's arcs begin in that list, and where the last band's end.
    firsts: Vec<usize>,
    smooth: bool,
    /// The distance from an arc within which a pixel's centre is doubtful.
    doubt: f64,
    /// The winding number along the picture's left side, without the path's crossings of it.
    left: i32,
    /// The first column and the first row of the part that is drawn, and its size.
    left_column: usize,
    top: usize,
    width: usize,
    height: usize,
    /// Rows of a band.
    rows: usize,
}

/// What a thread draws a band with.
#[derive(Debug, Default)]
pub(super) struct BandScratch {
    cells: Cells,
    /// Pixels of the band whose centres are too near to an arc: column and row.
    pub(super) doubtful: Vec<(u32, u32)>,
    /// The path's crossings of the left side within the band: the first row that lies wholly below, and the weight.
    left_crossings: Vec<(usize, i32)>,
    /// The winding number along the left side at the band's top.
    left: i32,
    rows: usize,
}

impl BandedOutline {
    /// Traces the outline of what `weight` tells in a view: see [`OutlinePath::draw`].
    pub(super) fn trace(
        &mut self,
        half: &mut OutlinePath,
        map: &EdgeMap<'_>,
        smooth: bool,
        weight: impl Fn(&Boundary) -> i32 + Sync,
        on_all_threads: bool,
    ) {
        let tolerance = if smooth { SMOOTH } else { HARD };
        let rounding = map.curves.error().rounding;
        self.doubt = 2.0 * (tolerance + rounding) + 2.0 / ONE as f64;
        self.smooth = smooth;
        self.path.draw(half, map, tolerance, weight, on_all_threads);
    }

    /// Whether the outline is more than rounding.
    pub(super) fn is_meaningful(&self, curves: &Isoradials) -> bool {
        curves.error().rounding <= COARSE && self.path.is_complete()
    }

    /// Sorts the path's arcs into bands of `rows` rows of a part of the picture: counts those of each band, and places
    /// them from the last to the first. `sees` tells what the outline encloses, at one place.
    ///
    /// The path is that of the whole picture. What of it is to the left of the part counts along the part's left side,
    /// so that each pixel gets the same sums as in the whole picture.
    pub(super) fn sort(
        &mut self,
        view: &View,
        part: Region,
        rows: usize,
        sees: impl Fn((f64, f64)) -> bool,
    ) {
        (self.left_column, self.top) = (part.left as usize, part.top as usize);
        (self.width, self.height) = (part.width as usize, part.height as usize);
        self.rows = rows;
        self.left = left(&self.path, view, sees);
        let (top, height) = (f64::from(part.top), self.height);
        let band = |row: f64| ((row - top).max(0.0) as usize).min(height - 1) / rows;
        let bands_of = |arc: &EdgeArc| {
            let (first, last) = arc.rows();
            let last = last + 1.0 / ONE as f64;
            let is_in = last >= top && first <= top + height as f64;
            (band(first)..=band(last)).filter(move |_| is_in)
        };
        let bands = height.div_ceil(rows);
        self.firsts.clear();
        self.firsts.resize(bands + 1, 0);
        for arc in &self.path.arcs {
            for band in bands_of(arc) {
                self.firsts[band] += 1;
            }
        }
        let mut end = 0;
        for first in &mut self.firsts {
            end += *first;
            *first = end;
        }
        self.sorted.clear();
        self.sorted.resize(end, 0);
        for (i, arc) in self.path.arcs.iter().enumerate().rev() {
            for band in bands_of(arc) {
                self.firsts[band] -= 1;
                self.sorted[self.firsts[band]] = i as u32;
            }
        }
    }

    /// Draws a band's arcs into cells. Returns the band's first row in the picture.
    pub(super) fn draw(&self, band: usize, scratch: &mut BandScratch) -> usize {
        let above = band * self.rows;
        let top = self.top + above;
        let rows = self.rows.min(self.height - above);
        scratch.rows = rows;
        let cells = &mut scratch.cells;
        cells.set((self.left_column, top), (self.width, rows));
        scratch.doubtful.clear();
        for &arc in &self.sorted[self.firsts[band]..self.firsts[band + 1]] {
            let arc = &self.path.arcs[arc as usize];
            if self.smooth {
                cells.cover(arc);
            } else {
                cells.cross(arc, self.doubt, &mut scratch.doubtful);
            }
        }
        scratch.left = self.left;
        scratch.left_crossings.clear();
        for crossing in &self.path.left_crossings {
            let first = if self.smooth {
                cells.cover_below(crossing.y, crossing.weight)
            } else {
                cells.first_below(crossing.y)
            };
            if first <= 0 {
                scratch.left += crossing.weight;
            } else if first < rows as i64 {
                scratch
                    .left_crossings
                    .push((first as usize, crossing.weight));
            }
        }
        scratch.left_crossings.sort_unstable();
        top
    }
}

impl BandScratch {
    /// Calls `row` for each row of the band that was drawn, from the top, with the sum at its left side. It must walk
    /// the cells.
    #[inline]
    pub(super) fn rows(&mut self, mut row: impl FnMut(&mut Cells, usize, i64)) {
        let mut left = self.left;
        let mut crossings = self.left_crossings.iter().peekable();
        for number in 0..self.rows {
            while let Some((_, weight)) = crossings.next_if(|&&(first, _)| first <= number) {
                left += weight;
            }
            row(&mut self.cells, number, i64::from(left) * ONE);
        }
    }
}

/// Returns the winding number along the picture's left side, without the path's crossings of it.
///
/// It follows from one place far from the path: from whether what is drawn is seen there, and from what the path adds
/// on the way there from the left side.
fn left(path: &OutlinePath, view: &View, sees: impl Fn((f64, f64)) -> bool) -> i32 {
    /// The most places that are tried.
    const MOST: u32 = 24;
    /// A place this far from the path is far enough, in pixels.
    const FAR: f64 = 2.0;
    // Places spread over the picture, the first one in its middle (Roberts 2018: the plastic number's powers). Pixels'
    // centres alone would not do: in a picture of one row all of them may lie on an edge.
    let place =
        |i: u32, share: f64, size: u32| (0.5 + f64::from(i) * share).fract() * f64::from(size);
    let mut best = (-1.0, (0.0, 0.0));
    for i in 0..MOST {
        let place = (
            place(i, 0.754_877_666_246_692_8, view.width()),
            place(i, 0.569_840_290_998_053_3, view.height()),
        );
        if !view.shows(place) {
            continue;
        }
        let distance = distance(path, place);
        if distance > best.0 {
            best = (distance, place);
        }
        if distance > FAR {
            break;
        }
    }
    i32::from(sees(best.1)) - winding(path, best.1)
}

/// Returns about how far a place is from the path: along rows for steep arcs, along columns for flat ones.
pub(super) fn distance(path: &OutlinePath, (x, y): (f64, f64)) -> f64 {
    path.arcs.iter().fold(f64::INFINITY, |least, arc| {
        let (u, v) = if arc.steep { (y, x) } else { (x, y) };
        let nearest = u.clamp(arc.u.0, arc.u.1);
        least.min((u - nearest).abs().max((v - arc.at(nearest)).abs()))
    })
}

/// Returns what the path adds to the winding number on the way down the picture's left side and then right to a place.
fn winding(path: &OutlinePath, (x, y): (f64, f64)) -> i32 {
    let is_below = |place: f64| i32::from(fixed(place) > fixed(y));
    let from_left = path
        .left_crossings
        .iter()
        .map(|crossing| crossing.weight * (1 - is_below(crossing.y)));
    let arcs = path.arcs.iter().map(|arc: &EdgeArc| {
        let passes = if arc.steep {
            let passes = is_below(arc.u.1) - is_below(arc.u.0);
            if passes != 0 && arc.at(y) < x {
                passes
            } else {
                0
            }
        } else if arc.u.0 < x {
            let last = if arc.u.1 <= x { arc.v.1 } else { arc.at(x) };
            is_below(last) - is_below(arc.v.0)
        } else {
            0
        };
        arc.weight * passes
    });
    from_left.chain(arcs).sum()
}
