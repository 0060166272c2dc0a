//! Four tiles of one size side by side: which of them are all disk or all sky, which edges are open over the others, and
//! whether those are cubics there. Such a tile is [drawn](super::blocks).

use super::blocks::{Border, Cubic, Drawing, Side};
use super::tiles::Kind;
use crate::isoradial::{
    Bent, Edge, EdgeOf, Line, Listing, MOST_EDGES, Open, Patch, Picture, Sifted,
};
use crate::lanes::{Four, Level, dispatch};

/// How many tiles stand side by side.
pub(super) const TILES: usize = 4;

/// Four tiles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tiles {
    /// Their centres.
    pub(super) columns: [f64; TILES],
    pub(super) rows: [f64; TILES],
    /// Pixels from there to their sides, with the margin in which edges are looked for too.
    pub(super) half: [f64; 2],
    /// A bit for each: whether it is asked about.
    pub(super) active: u32,
    /// The edges open over a tile that they are part of.
    pub(super) before: Option<Open>,
}

/// What is known of four tiles: a bit for each in every mask.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// All their pixels see the disk.
    pub(super) hit: u32,
    /// None of them does.
    pub(super) miss: u32,
    /// Nothing is known: they are all about the hole's direction, or in both quarter turns close to the disk's plane.
    pub(super) unknown: u32,
    /// They are in both quarter turns.
    pub(super) both: u32,
    /// All edges open over them are cubics, and straight over each pixel.
    pub(super) cubic: u32,
    /// The edges that are open over any of them: of one and of both quarter turns.
    edges: [GroupEdge; 4 * MOST_EDGES],
    count: usize,
    /// Of those in both quarter turns, in each.
    halves: [Seen; 2],
    turns: Turns,
}

/// An edge that is open over some of the tiles.
#[derive(Debug, Clone, Copy)]
struct GroupEdge {
    of: EdgeOf,
    quarter: usize,
    tiles: u32,
    /// Of each tile: the parts of its [`Cubic`].
    cubics: [[f64; TILES]; 4],
}

/// What is asked of four tiles.
#[derive(Debug, Clone, Copy)]
struct Look {
    /// The edges that are looked at, and the quarter turn.
    before: Open,
    /// A bit for each: whether it is asked about.
    active: u32,
    /// Whether a tile may reach beyond the quarter turn's end.
    beyond: bool,
}

/// What comes of it: a bit for each tile.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    /// The bounds are right for it.
    sound: u32,
    /// All its rays in the quarter turn meet the disk.
    hit: u32,
    /// None of them does.
    miss: u32,
}

/// How rays turn over each tile: s∂θ and ∂s/s, for each pixel to the right and downwards.
#[derive(Debug, Clone, Copy, Default)]
struct Turns {
    across: [[f64; TILES]; 2],
    along: [[f64; TILES]; 2],
}

impl Group {
    pub(super) fn new() -> Self {
        let edge = GroupEdge {
            of: EdgeOf {
                piece: 0,
                edge: Edge::Outer,
            },
            quarter: 0,
            tiles: 0,
            cubics: [[0.0; TILES]; 4],
        };
        Self {
            hit: 0,
            miss: 0,
            unknown: 0,
            both: 0,
            cubic: 0,
            edges: [edge; 4 * MOST_EDGES],
            count: 0,
            halves: [Seen::default(); 2],
            turns: Turns::default(),
        }
    }

    /// Looks at tiles.
    pub(super) fn look(&mut self, level: Level, picture: &Picture<'_>, tiles: &Tiles, kind: Kind) {
        self.count = 0;
        (self.hit, self.miss, self.both, self.cubic) = (0, 0, 0, tiles.active);
        let before = |quarter| tiles.before.unwrap_or(Open::all(quarter));
        let mut left = tiles.active;
        for quarter in [0, 1] {
            let before = before(quarter);
            if left != 0 && before.quarter() == quarter {
                let look = Look {
                    before,
                    active: left,
                    beyond: false,
                };
                let seen = dispatch!(level, |_simd, four| self
                    .look_in(four, picture, tiles, look, kind));
                self.hit |= seen.hit;
                self.miss |= seen.miss;
                left &= !seen.sound;
            }
        }
        if left != 0 && tiles.before.is_none() {
            let mut both = left;
            for quarter in [0, 1] {
                let look = Look {
                    before: before(quarter),
                    active: both,
                    beyond: true,
                };
                let seen = dispatch!(level, |_simd, four| self
                    .look_in(four, picture, tiles, look, kind));
                both &= seen.sound;
                self.halves[quarter] = seen;
            }
            let [first, second] = self.halves;
            let (hit, miss) = (first.hit & second.hit, first.miss & second.miss);
            self.hit |= both & hit;
            self.miss |= both & miss;
            self.both = both & !hit & !miss;
            left &= !both;
        }
        self.unknown = left;
    }

    /// Looks at tiles in one quarter turn.
    #[inline(always)]
    fn look_in<T: Four>(
        &mut self,
        like: T,
        picture: &Picture<'_>,
        tiles: &Tiles,
        look: Look,
        kind: Kind,
    ) -> Seen {
        let (columns, rows) = (like.of(tiles.columns), like.of(tiles.rows));
        let quarter = look.before.quarter();
        let patch = picture.patch_about(columns, rows, tiles.half, quarter);
        let sound = look.active
            & if look.beyond {
                patch.sound_beyond(picture)
            } else {
                patch.sound(picture)
            };
        if sound == 0 {
            return Seen::default();
        }
        // The same in both quarter turns.
        self.turns = Turns {
            across: patch.across().map(Into::into),
            along: patch.along().map(Into::into),
        };
        let mut listed = Listed {
            group: self,
            patch: &patch,
            kind,
        };
        let Sifted { hit, miss } = picture.sift(&patch, sound, look.before, &mut listed);
        Seen { sound, hit, miss }
    }

    /// Whether a tile is in both quarter turns.
    pub(super) fn is_in_both(&self, tile: usize) -> bool {
        self.both & (1 << tile) != 0
    }

    /// The edges that are open over a tile, which is neither hit nor missed nor unknown, nor in both quarter turns.
    pub(super) fn open(&self, tile: usize) -> Open {
        let mut edges = self.edges_of(tile).peekable();
        let quarter = edges.peek().map_or(0, |edge| edge.quarter);
        edges.fold(Open::none(quarter), |open, edge| open.with(edge.of))
    }

    /// The edges that are open over a tile in a quarter turn.
    pub(super) fn edges(&self, tile: usize, quarter: usize) -> impl Iterator<Item = EdgeOf> {
        let edges = self.edges_of(tile);
        edges
            .filter(move |edge| edge.quarter == quarter)
            .map(|edge| edge.of)
    }

    fn edges_of(&self, tile: usize) -> impl Iterator<Item = &GroupEdge> {
        self.edges[..self.count]
            .iter()
            .filter(move |edge| edge.tiles & (1 << tile) != 0)
    }

    /// What is drawn of a tile whose edges are cubics, `half` pixels from its centre to its sides: `border` is where it
    /// changes from one quarter turn to the other, if it does.
    pub(super) fn drawing(&self, tile: usize, half: f64, border: Option<Border>) -> Drawing {
        let mut drawing = Drawing {
            half: [half as f32; 2],
            across: self.turns.across.map(|four| four[tile] as f32),
            along: self.turns.along.map(|four| four[tile] as f32),
            border,
            sides: [Side::new(false), Side::new(false)],
        };
        if border.is_some() {
            drawing.sides = self
                .halves
                .map(|half| Side::new(half.hit & (1 << tile) != 0));
        }
        for edge in self.edges_of(tile) {
            let [value, per_column, per_row, half_bend] = edge.cubics.map(|four| four[tile] as f32);
            let cubic = Cubic {
                value,
                per_column,
                per_row,
                half_bend,
            };
            let side = if border.is_some() { edge.quarter } else { 0 };
            drawing.sides[side].push(edge.of.piece, cubic);
        }
        drawing
    }
}

/// Lists the edges that are open over four tiles.
struct Listed<'a, T> {
    group: &'a mut Group,
    patch: &'a Patch<T>,
    kind: Kind,
}

impl<T: Four> Listing<T> for Listed<'_, T> {
    #[inline(always)]
    fn list(&mut self, of: EdgeOf, tiles: u32, bent: &Bent<T>) {
        let (cubics, good) = cubics(self.patch, bent, of.edge, self.kind);
        self.group.cubic &= good | !tiles;
        self.group.edges[self.group.count] = GroupEdge {
            of,
            quarter: self.patch.quarter(),
            tiles,
            cubics,
        };
        self.group.count += 1;
    }
}

/// The share of its terms by which a cubic is off in single precision: its dozen roundings, with room.
const ROUNDING: f64 = 1.0 / 524_288.0;

/// Where a tile so many pixels to either side changes from one quarter turn to the other.
pub(super) fn border(line: &Line, half: [f64; 2], reach: f64) -> Border {
    let (wide, high) = (line.per_column.abs(), line.per_row.abs());
    let terms = line.value.abs() + wide * half[0] + high * half[1];
    let unit = 1.0 / ((wide + high) * reach + terms * ROUNDING);
    Border {
        value: (unit * line.value) as f32,
        per_column: (unit * line.per_column) as f32,
        per_row: (unit * line.per_row) as f32,
    }
}

/// An edge's cubics over four tiles, and for which of them it is one.
#[inline(always)]
fn cubics<T: Four>(
    patch: &Patch<T>,
    bent: &Bent<T>,
    edge: Edge,
    kind: Kind,
) -> ([[f64; TILES]; 4], u32) {
    let [half_columns, half_rows] = patch.half();
    let line = &bent.line;
    let turning = patch.turning(bent);
    let (steep_columns, steep_rows) = (line.per_column.abs(), line.per_row.abs());
    let steep = (steep_columns - turning[0]).larger(steep_rows - turning[1]);
    let off = patch.doubt(bent);
    let good = !(steep * kind.doubt).less(off)
        & steep.all(0.0).less(steep)
        & patch.bend_of_pixel(bent).less(steep * kind.bend);
    let terms =
        line.value.abs() + steep_columns * half_columns + steep_rows * half_rows + patch.bend(bent);
    let seen = (steep_columns + turning[0] + steep_rows + turning[1]) * kind.reach;
    let sign = if edge == Edge::Outer { 1.0 } else { -1.0 };
    let unit = steep.all(sign) / (off + seen + terms * ROUNDING);
    let cubics = [
        (unit * line.value).into(),
        (unit * line.per_column).into(),
        (unit * line.per_row).into(),
        (unit * bent.bend.middle * 0.5).into(),
    ];
    (cubics, good)
}
