//! The outline of the disk's image: which order's image lies in front, azimuth by azimuth.
//!
//! At each azimuth about the hole the image of order k covers an interval of κ, from its outer edge's curve to its
//! inner edge's. Where intervals overlap the lowest order lies in front: light reaches the camera from there first. So
//! along an azimuth the picture is a sequence of stretches of κ, each with one order or none, and a [`Boundary`]
//! stands wherever that changes. The sequence depends on x alone (see the [module's page](super)) and changes only
//! where curves of two orders cross. A [`Sector`] is an interval of x without such a change. So sectors belong to the
//! curves, not to the view: all frames of one camera radius share them.
//!
//! # Where curves cross
//! Curves of one order never cross: the inner edge has the greater κ everywhere. Curves of two orders may. Both are
//! splines g(x) of h; if one of them has a pole, both are taken as `x h`. Over an interval of length δ a function
//! differs from its chord by no more than `ε = max|g″| δ²/8`, and its slope from the chord's by no more than
//! `max|g″| δ/2 = 4ε/δ`. With d the difference of the two functions, and ε the sum of both bounds:
//!
//! * the same sign at both ends and `min |d| > ε`: they do not cross, and touch nowhere;
//! * opposite signs and `|d₀| + |d₁| > 4ε`: d is monotone, and they cross once;
//! * else the interval is halved, until it is shorter than [`SHORTEST`]. Two crossings nearer to each other than that
//!   are left out: between them an order as thin as rounding would be in front.

use super::edge::Edge;
use super::quarter_curves::QuarterCurves;

/// No interval of x is halved that is shorter than this.
const SHORTEST: f64 = 1e-13;

/// The most intervals over which two curves are compared. A sound table's curves take some dozens. Curves from a table
/// whose numbers mean nothing would take millions.
const MOST_INTERVALS: u32 = 1 << 12;

/// One curve at which the order in front changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Boundary {
    /// Which of the quarter turn's pieces has the curve.
    pub(crate) piece: usize,
    /// Which of the piece's two curves it is.
    pub(crate) edge: Edge,
    /// The order in front at lesser κ, farther from the hole's direction.
    pub(crate) below: Option<u32>,
    /// The order in front at greater κ.
    pub(crate) above: Option<u32>,
}

/// An interval of x in which the boundaries stay the same, and none crosses another.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sector {
    /// Its least and its greatest x.
    pub(crate) x: (f64, f64),
    /// Its boundaries, by rising κ.
    pub(crate) boundaries: Vec<Boundary>,
}

/// The sectors of one quarter turn, by rising x.
pub(super) fn sectors(pieces: &[QuarterCurves]) -> Vec<Sector> {
    let Some(first) = pieces.first() else {
        return Vec::new();
    };
    let (from, to) = first.range();
    let curves = Curves { pieces };
    let mut ends = vec![from];
    ends.extend(curves.crossings((from, to)));
    ends.push(to);
    let mut sectors: Vec<Sector> = Vec::new();
    for x in ends.windows(2) {
        let boundaries = curves.boundaries(0.5 * (x[0] + x[1]));
        match sectors.last_mut() {
            Some(last) if last.boundaries == boundaries => last.x.1 = x[1],
            _ => sectors.push(Sector {
                x: (x[0], x[1]),
                boundaries,
            }),
        }
    }
    sectors
}

/// The curves of one quarter turn.
struct Curves<'a> {
    pieces: &'a [QuarterCurves],
}

/// A curve: its piece, its edge.
type Curve = (usize, Edge);

/// Two curves of different orders, over an interval of x.
struct Pair<'a> {
    curves: [(&'a QuarterCurves, Edge); 2],
    /// Whether they are compared as `x h`.
    scaled: bool,
}

impl Pair<'_> {
    /// How much greater the first is than the second at x.
    fn difference(&self, x: f64) -> f64 {
        let [a, b] = self.curves.map(|(piece, edge)| {
            let [value, _] = piece.value_and_slope(edge, x);
            if self.scaled && !piece.has_pole() {
                x * value
            } else {
                value
            }
        });
        a - b
    }

    /// The sum of both `max|g″|` over an interval.
    fn bend(&self, x: (f64, f64)) -> f64 {
        let [a, b] = self.curves.map(|(piece, edge)| {
            let bend = piece.bend(edge, x);
            if self.scaled && !piece.has_pole() {
                // (x h)″ = 2h′ + x h″.
                let [_, slope] = piece.value_and_slope(edge, x.0);
                2.0 * (slope.abs() + bend * (x.1 - x.0)) + x.1 * bend
            } else {
                bend
            }
        });
        a + b
    }

    /// Adds where they cross in an interval, at whose ends they differ by `first` and `last`: see the
    /// [module's page](self).
    fn find(
        &self,
        x: (f64, f64),
        (first, last): (f64, f64),
        intervals: &mut u32,
        found: &mut Vec<f64>,
    ) {
        *intervals += 1;
        let width = x.1 - x.0;
        let off_chord = 0.125 * self.bend(x) * width * width;
        let crosses = (first < 0.0) != (last < 0.0);
        let is_short = width <= SHORTEST || *intervals > MOST_INTERVALS;
        if crosses && (is_short || first.abs() + last.abs() > 4.0 * off_chord) {
            found.push(self.root(x, first));
        } else if !is_short && (crosses || first.abs().min(last.abs()) <= off_chord) {
            let middle = 0.5 * (x.0 + x.1);
            let between = self.difference(middle);
            self.find((x.0, middle), (first, between), intervals, found);
            self.find((middle, x.1), (between, last), intervals, found);
        }
    }

    /// Where they cross once in an interval, by bisection to the last bit.
    fn root(&self, (mut low, mut high): (f64, f64), at_low: f64) -> f64 {
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if (self.difference(middle) < 0.0) == (at_low < 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
}

impl Curves<'_> {
    /// All x at which curves of two orders cross, in order.
    fn crossings(&self, x: (f64, f64)) -> Vec<f64> {
        let edges = [Edge::Outer, Edge::Inner];
        let mut found = Vec::new();
        for (i, first) in self.pieces.iter().enumerate() {
            for second in &self.pieces[i + 1..] {
                for (a, b) in edges.into_iter().flat_map(|a| edges.map(|b| (a, b))) {
                    let pair = Pair {
                        curves: [(first, a), (second, b)],
                        scaled: first.has_pole() || second.has_pole(),
                    };
                    pair.find(
                        x,
                        (pair.difference(x.0), pair.difference(x.1)),
                        &mut 0,
                        &mut found,
                    );
                }
            }
        }
        found.sort_by(f64::total_cmp);
        found.dedup();
        found
    }

    /// h at x.
    fn value(&self, (piece, edge): Curve, x: f64) -> f64 {
        let piece = &self.pieces[piece];
        let [value, _] = piece.value_and_slope(edge, x);
        if piece.has_pole() { value / x } else { value }
    }

    /// The boundaries at x, by rising κ.
    fn boundaries(&self, x: f64) -> Vec<Boundary> {
        let mut curves: Vec<(f64, usize, Edge)> = (0..self.pieces.len())
            .flat_map(|piece| [(piece, Edge::Outer), (piece, Edge::Inner)])
            .map(|(piece, edge)| (self.value((piece, edge), x), piece, edge))
            .collect();
        curves.sort_by(|a, b| a.0.total_cmp(&b.0));
        // How far into each piece's interval the walk is: 1 within.
        let mut within = vec![0; self.pieces.len()];
        let mut below = None;
        let mut boundaries = Vec::new();
        for (_, piece, edge) in curves {
            within[piece] += if edge == Edge::Outer { 1 } else { -1 };
            let front = within.iter().position(|&within| within > 0);
            let above = front.map(|front| self.pieces[front].order);
            if above != below {
                boundaries.push(Boundary {
                    piece,
                    edge,
                    below,
                    above,
                });
            }
            below = above;
        }
        boundaries
    }
}
