//! Pixels over which edges bend, in strips along the line that divides the quarter turns.
//!
//! Close to the disk's plane all that is seen depends on the distance from that line, on a scale of a pixel or much less,
//! and hardly on the place along it: across it a pixel is cut as often as it must be, along it not at all, whichever way
//! the line runs through the picture.

use super::area::{Polygon, off};
use super::mask::sees;
use crate::isoradial::{Band, Bent, Edge, EdgeOf, Line, Listing, MOST_BANDS, Open, Patch, Picture};
use crate::lanes::{Four, Level, dispatch, level};

/// How far an edge may be off its tangent over a strip, as a share of the strip's side. The lines that are taken for edges
/// are off them by as much to one side as to the other, which for a whole pixel they are not.
const STRAIGHT: f64 = 1.0 / 32.0;

/// The smallest strips, in pixels: of one over which an edge still bends it counts what its middle sees.
const SMALLEST: f64 = 1.0 / 4096.0;

/// How many strips stand side by side.
const STRIPS: usize = 4;

/// Cuts pixels of a picture into strips.
pub(super) struct Strips<'a> {
    /// Turned so that the strips lie along its rows.
    picture: Picture<'a>,
    /// Of the angle it is turned by.
    cosine: f64,
    sine: f64,
    level: Level,
}

/// The edges that are open over four strips.
struct OpenEdges<T> {
    bands: [Band<T>; MOST_BANDS],
    /// A bit for each strip over which an outer, an inner edge is open.
    strips: [[u32; 2]; MOST_BANDS],
    count: usize,
    /// A bit for each strip over which none bends.
    straight: u32,
}

/// Lists them.
struct Listed<'a, T> {
    patch: &'a Patch<T>,
    open: &'a mut OpenEdges<T>,
    /// Whose edge was the last one.
    piece: Option<usize>,
}

impl<T: Four> Listing<T> for Listed<'_, T> {
    #[inline(always)]
    fn list(&mut self, of: EdgeOf, strips: u32, bent: &Bent<T>) {
        let open = &mut *self.open;
        if self.piece != Some(of.piece) {
            self.piece = Some(of.piece);
            open.count += 1;
        }
        let [wide, high] = self.patch.half().map(|half| 2.0 * half);
        let line = Line {
            value: bent.line.value - self.patch.mean_bend(bent),
            ..bent.line
        };
        let steep = (line.per_column.abs() * wide).larger(line.per_row.abs() * high);
        open.straight &= self.patch.bend(bent).less(steep * STRAIGHT) | !strips;
        let (band, open) = (
            &mut open.bands[open.count - 1],
            &mut open.strips[open.count - 1],
        );
        match of.edge {
            Edge::Outer => (band.outer, open[0]) = (Some(line), strips),
            Edge::Inner => (band.inner, open[1]) = (Some(line), strips),
        }
    }
}

impl<T: Four> OpenEdges<T> {
    /// Those over one of the strips, seen from another place so far away.
    fn bands(&self, strip: usize, (right, down): (f64, f64)) -> ([Band; MOST_BANDS], usize) {
        let mut bands = [Band::default(); MOST_BANDS];
        let mut count = 0;
        for (band, open) in self.bands.iter().zip(self.strips).take(self.count) {
            let one = |line: &Option<Line<T>>, open: u32| {
                let line = line.as_ref().filter(|_| open & (1 << strip) != 0)?;
                let mut line = line.one(strip);
                line.value = line.value + right * line.per_column + down * line.per_row;
                Some(line)
            };
            let (outer, inner) = (one(&band.outer, open[0]), one(&band.inner, open[1]));
            if outer.is_some() || inner.is_some() {
                bands[count] = Band { outer, inner };
                count += 1;
            }
        }
        (bands, count)
    }
}

impl<'a> Strips<'a> {
    pub(super) fn new(picture: &Picture<'a>) -> Self {
        let (picture, [cosine, sine]) = picture.turned();
        Self {
            picture,
            cosine,
            sine,
            level: level(),
        }
    }

    /// What of a pixel is the disk.
    pub(super) fn share(&self, column: usize, row: usize) -> f64 {
        let view = self.picture.view();
        let right = column as f64 + 0.5 - 0.5 * f64::from(view.width());
        let down = row as f64 + 0.5 - 0.5 * f64::from(view.height());
        let centre = (
            right * self.cosine + down * self.sine,
            down * self.cosine - right * self.sine,
        );
        let pixel = Polygon::rectangle([1.0; 2]).turned(self.cosine, self.sine);
        let border = self.picture.border_about(centre);
        let mut share = self.area(&pixel.above(&border), centre, 0);
        // On the disk's axis there is no second quarter turn.
        if border != Line::default() {
            share += self.area(&pixel.above(&border.opposite()), centre, 1);
        }
        share.clamp(0.0, 1.0)
    }

    /// How much of a part of a pixel about `centre` is the disk, all of it in one quarter turn.
    fn area(&self, part: &Polygon, centre: (f64, f64), quarter: usize) -> f64 {
        if part.is_empty() {
            return 0.0;
        }
        dispatch!(self.level, |_simd, four| self
            .area_of_strips(four, part, centre, quarter))
    }

    #[inline(always)]
    fn area_of_strips<T: Four>(
        &self,
        like: T,
        part: &Polygon,
        centre: (f64, f64),
        quarter: usize,
    ) -> f64 {
        let [columns, rows] = part.extent();
        let is_wide = self.picture.is_wide(
            (centre.0 + columns.0, centre.0 + columns.1),
            (centre.1 + rows.0, centre.1 + rows.1),
        );
        let (from, to) = if is_wide { columns } else { rows };
        let step = (to - from) / STRIPS as f64;
        let middle = |(from, to): (f64, f64)| 0.5 * (from + to);
        let mut half = [0.5 * (columns.1 - columns.0), 0.5 * (rows.1 - rows.0)];
        half[usize::from(!is_wide)] = 0.5 * step;
        let middles = [0, 1, 2, 3].map(|i| {
            let across = from + step * (f64::from(i) + 0.5);
            if is_wide {
                (across, middle(rows))
            } else {
                (middle(columns), across)
            }
        });
        let patch = self.picture.patch_about(
            like.of(middles.map(|(right, _)| centre.0 + right)),
            like.of(middles.map(|(_, down)| centre.1 + down)),
            half,
            quarter,
        );
        let sound = patch.sound_beyond(&self.picture) & ((1 << STRIPS) - 1);
        let empty = Band {
            outer: None,
            inner: None,
        };
        let mut open = OpenEdges {
            bands: [empty; MOST_BANDS],
            strips: [[0; 2]; MOST_BANDS],
            count: 0,
            straight: sound,
        };
        let mut listed = Listed {
            patch: &patch,
            open: &mut open,
            piece: None,
        };
        let all = Open::all(quarter);
        let sifted = self.picture.sift(&patch, sound, all, &mut listed);
        let is_small = 4.0 * half[0] * half[1] <= SMALLEST;
        let mut area = 0.0;
        let mut next = 0;
        while next < STRIPS {
            let i = next;
            let is = |mask: u32, i: usize| mask & (1 << i) != 0;
            next += 1;
            if is(sifted.miss, i) {
                continue;
            }
            while is(sifted.hit, i) && is(sifted.hit, next) {
                next += 1;
            }
            let cut = |end: usize, sign: f64| Line {
                value: -sign * (from + step * end as f64),
                per_column: if is_wide { sign } else { 0.0 },
                per_row: if is_wide { 0.0 } else { sign },
            };
            let mut strip = *part;
            if i > 0 {
                strip = strip.above(&cut(i, 1.0));
            }
            if next < STRIPS {
                strip = strip.above(&cut(next, -1.0));
            }
            if strip.is_empty() {
                continue;
            }
            area += if is(sifted.hit, i) {
                strip.area()
            } else if is(open.straight, i) {
                let (right, down) = middles[i];
                let (bands, count) = open.bands(i, (-right, -down));
                strip.area() - off(&strip, &bands[..count])
            } else if is_small {
                let (right, down) = strip.middle();
                f64::from(self.sees((centre.0 + right, centre.1 + down))) * strip.area()
            } else {
                self.area(&strip, centre, quarter)
            };
        }
        area
    }

    /// Whether the disk is seen at a place of the turned picture.
    fn sees(&self, (right, down): (f64, f64)) -> bool {
        let view = self.picture.view();
        let place = (
            right * self.cosine - down * self.sine + 0.5 * f64::from(view.width()),
            right * self.sine + down * self.cosine + 0.5 * f64::from(view.height()),
        );
        sees(view, self.picture.curves(), place)
    }
}
