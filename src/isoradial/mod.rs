//! Isoradial curves: which rays of one camera meet one radius of the disk, as a function of the orbit angle.
//!
//! Rays of one plane that leave one point never meet again before they have wound round the hole once more: the
//! optical metric's Gaussian curvature `−u³(1 − 3u/4)` is negative (Gibbons & Werner 2008, *Class. Quantum Grav.* 25,
//! 235009). At a fixed orbit angle φ, u therefore rises strictly with the ray's slope, and exactly one slope carries
//! a ray from `u0` to `u_d` in the angle φ. With `κ = z/s` (the cotangent of the angle between the ray and the hole's
//! direction, `du/dφ = u0 √(1 − u0) κ`), a ray that meets the disk's plane at φ meets the disk iff
//!
//! ```text
//! κ(φ; u_outer) ≤ z/s ≤ κ(φ; u_inner)
//! ```
//!
//! These curves (Luminet 1979, *Astron. Astrophys.* 75, 228, section 4) depend on the camera's radius and on the
//! disk's two radii, not on where the camera looks. What is kept of them is `h = κ − κ_c`, the distance from the
//! critical ray, which falls as `e^{−φ}`: the photon rings keep their digits however thin they are.
//!
//! # The axis
//! The plane is met at `φ₁ + kπ`, `tan φ₁ = N/D`, `N = |n·p̂| s ≥ 0`. Each quarter turn of φ is one piece of
//! its own: its axis is `x = N/(N + D)` while D ≥ 0 and `x = |D|/(N + |D|)` beyond π/2, one division and no
//! trigonometry, analytic in φ within the piece. In the first piece h has a pole at φ = 0; there `x h` is kept.

//! Only the part of each quarter turn that the picture shows is drawn: between the least and the greatest x of its
//! rays.
//!
//! # How many orders, how many nodes
//! Both follow from the picture and from one number, [`Sight::tolerance`] T, in pixels.
//!
//! * *Orders.* To leave out an order that is nowhere thicker than T moves no edge by more than T: its two edges are
//!   that close to each other. Order k + 1 is in the end e^−π times as thick as order k (Ohanian 1987, *Am. J. Phys.*
//!   55, 428), so that the first order thinner than T is the last one looked at.
//! * *Nodes.* They are doubled until the curve between them is right to T/2. The other half of T is for the angles: an
//!   error δφ of the method's angles moves an edge by `|∂ψ/∂φ| δφ`, see [`sensitivity`], and a table is good enough
//!   where that is no more than T/2.
//!
//! [`Isoradials::error`] tells what has come of it, each part for itself; `tests/needs.rs` checks it against exact
//! edges, and that choices made for 8 T break T.

mod interval;
mod nodes;
mod open;
mod patch;
mod picture;
mod piece;
mod range;
mod runs;
mod sight;
mod solve;
mod turns;

use core::f64::consts::{FRAC_PI_2, PI};

use crate::orbit::path::{FixedRadiiAngles, SweptAngles};
use nodes::{Coarsest, LOOKED_AT, Nodes, SOLVED, coarsest};
pub(crate) use open::{Band, EdgeOf, Listing, MOST_BANDS, MOST_EDGES, Open, Sifted};
pub(crate) use patch::{Bent, Patch};
pub(crate) use picture::{Line, Picture};
use piece::{Piece, thickness};
pub use range::{Bundle, Verdict};
use sight::Shown;
pub use sight::Sight;
use solve::{Closeness, Found, Target, target};
use turns::Turns;

/// The images' orders beyond this one are e^{−12π} as thick as the first: below the rounding of the ray itself.
const MOST_ORDERS: u32 = 12;

/// One of the disk's edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// The inner one.
    Inner,
    /// The outer one.
    Outer,
}

/// What an edge may be off by, in pixels: its parts.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EdgeError {
    /// Between the curves' nodes, and of the nodes themselves.
    pub interpolation: f64,
    /// From the error of the angles that the curves were drawn from.
    pub angles: f64,
    /// From rounding.
    pub rounding: f64,
}

impl EdgeError {
    /// All of it.
    pub fn total(&self) -> f64 {
        self.interpolation + self.angles + self.rounding
    }
}

/// The curves of both edges of the disk for every order that the picture shows.
#[derive(Debug, Clone)]
pub struct Isoradials {
    sight: Sight,
    critical: f64,
    /// Of each quarter turn, order by order, those that the picture shows.
    quarters: [Vec<Piece>; 2],
    orders: Vec<Order>,
    left_out: Option<Thinness>,
    error: EdgeError,
}

/// The image of one order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order {
    number: u32,
    thickness: f64,
    nodes: usize,
}

/// The first order that was left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thinness {
    /// Its number.
    pub order: u32,
    /// Its greatest thickness, in pixels.
    pub thickness: f64,
}

impl Order {
    /// Its number: 0 is the direct image, 1 the first ring.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Its greatest thickness at its coarsest nodes, in pixels; of rays that the picture does not show, in the size of
    /// its pixels there.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// How many nodes its curves have.
    pub fn nodes(&self) -> usize {
        self.nodes
    }
}

impl Isoradials {
    /// The curves of `sight`, from a method's swept angles: as many orders and nodes as the [module's page](self)
    /// derives.
    pub fn new(sight: &Sight, angles: &impl SweptAngles) -> Self {
        let mut curves = Self {
            sight: *sight,
            critical: sight.critical(),
            quarters: [Vec::new(), Vec::new()],
            orders: Vec::new(),
            left_out: None,
            error: EdgeError::default(),
        };
        let allowed = 0.5 * sight.tolerance;
        let shown = Shown::new(sight);
        let closeness = Closeness {
            psi: SOLVED * allowed / shown.most_per_radian(),
            phi: 0.0,
        };
        let mut hand = hand(sight, &shown, angles);
        for number in 0..MOST_ORDERS {
            let outline = hand.outline(number, closeness);
            let thickness = outline.thickness(&shown);
            if number > 0 && thickness < sight.tolerance {
                curves.left_out = Some(Thinness {
                    order: number,
                    thickness,
                });
                break;
            }
            let drawn = hand.refine(outline, allowed);
            curves.error = hand.error(curves.error, &drawn);
            let pieces = drawn.pieces(number, sight);
            if pieces.iter().any(Option::is_some) {
                curves.orders.push(Order {
                    number,
                    thickness,
                    nodes: pieces.iter().flatten().map(Piece::nodes).sum(),
                });
            }
            for (quarter, piece) in curves.quarters.iter_mut().zip(pieces) {
                quarter.extend(piece);
            }
        }
        curves
    }

    /// Whether these curves will do for the picture of `sight` too, as they are: those of the same camera radius and
    /// disk that show more or smaller pixels.
    pub fn serves(&self, sight: &Sight) -> bool {
        self.sight.and(sight) == Some(self.sight)
    }

    /// κ of the critical ray.
    pub fn critical(&self) -> f64 {
        self.critical
    }

    /// The orders that the picture shows, direct first.
    pub fn orders(&self) -> &[Order] {
        &self.orders
    }

    /// The first order that is thinner than the tolerance.
    pub fn left_out(&self) -> Option<Thinness> {
        self.left_out
    }

    /// What the curves may be off by, in pixels.
    pub fn error(&self) -> EdgeError {
        self.error
    }

    /// How many nodes the curves have.
    pub fn nodes(&self) -> usize {
        self.orders.iter().map(Order::nodes).sum()
    }

    /// How many bytes a frame reads of the curves.
    pub fn bytes(&self) -> usize {
        self.quarters.iter().flatten().map(Piece::bytes).sum()
    }

    /// `κ − κ_c` of an edge's curve where the plane is met at `first`, φ₁ in [0, π], by the image of order `number`.
    /// None where no picture was asked for it.
    pub fn height(&self, number: u32, edge: Edge, first: f64) -> Option<f64> {
        let (sine, cosine) = (libm::sin(first).abs(), libm::cos(first));
        let mut pieces = self.quarter(usize::from(cosine < 0.0)).iter();
        let piece = pieces.find(|piece| piece.order == number)?;
        Some(piece.height(edge, place(sine, cosine)))
    }

    /// Whether the ray with inward part `z` and transverse length `s > 0` meets the disk, where `N = |n·p̂| s` and D
    /// are the parts of the tangent of φ₁: a ray of the picture that the curves were drawn for.
    #[inline]
    pub fn meets(&self, z: f64, s: f64, n: f64, d: f64) -> bool {
        let excess = z - self.critical * s;
        let mut axis = None;
        for piece in self.quarter(usize::from(d < 0.0)) {
            if excess < piece.lowest * s || excess > piece.highest * s {
                continue;
            }
            let x = *axis.get_or_insert_with(|| place(n, d));
            if piece.meets(excess, s, x) {
                return true;
            }
        }
        false
    }

    /// The pieces of one quarter turn, order by order.
    #[inline]
    fn quarter(&self, quarter: usize) -> &[Piece] {
        &self.quarters[quarter]
    }
}

/// The ray that reaches an edge in a given angle: its `κ − κ_c`, as right as the method's angles are. `angle` is
/// above 0; it is the `φ₁ + kπ` of [`Isoradials::height`].
pub fn height_at(sight: &Sight, edge: Edge, angle: f64, angles: &impl SweptAngles) -> f64 {
    let target = target(sight, edge, angles);
    target.bracket(angle, target.first_guess(angle), 1e-13).0
}

/// How far an edge moves when every angle changes: `|∂ψ/∂φ|` of the curves of `sight` at most, in pixels per radian,
/// from exact angles on the coarsest nodes.
///
/// An order's angles all but stand still next to those of the order before: its curves are about e^−π as steep. So
/// none is looked at after one that, seen or not, would matter no more than what was found.
pub fn sensitivity(sight: &Sight, angles: &impl SweptAngles) -> f64 {
    let shown = Shown::new(sight);
    let closeness = Closeness {
        psi: 0.0,
        phi: LOOKED_AT,
    };
    let mut hand = hand(sight, &shown, angles);
    let mut most: f64 = 0.0;
    for number in 0..MOST_ORDERS {
        let outline = hand.outline(number, closeness);
        if number > 0 && outline.thickness(&shown) < sight.tolerance {
            break;
        }
        most = most.max(hand.sensitivity(&outline));
        if number > 0 && hand.steepest() * shown.most_per_radian() <= most {
            break;
        }
    }
    most
}

/// Where on its quarter turn's axis a ray meets the plane, `tan φ₁ = n/d`.
#[inline]
fn place(n: f64, d: f64) -> f64 {
    if d < 0.0 {
        -d / (n - d)
    } else if n > 0.0 {
        n / (n + d)
    } else {
        0.0
    }
}

/// What draws the curves of one order after the other.
struct Hand<'a, B> {
    shown: &'a Shown,
    /// Of the method's angles.
    angle_error: f64,
    /// Inner and outer edge.
    targets: [Target<B>; 2],
    /// The nodes of each quarter turn that the picture shows.
    turns: [Option<Turns>; 2],
    /// The order before: the coarsest nodes of inner and outer edge of each quarter turn.
    before: [Option<[Coarsest; 2]>; 2],
}

/// Nothing is drawn yet.
fn hand<'a, A: SweptAngles>(
    sight: &Sight,
    shown: &'a Shown,
    angles: &'a A,
) -> Hand<'a, impl FixedRadiiAngles> {
    Hand {
        shown,
        angle_error: angles.error(),
        targets: [Edge::Inner, Edge::Outer].map(|edge| target(sight, edge, angles)),
        turns: sight.window.quarters().map(|x| x.map(Turns::new)),
        before: [None, None],
    }
}

impl<B: FixedRadiiAngles> Hand<'_, B> {
    /// The curves of order `number` on the coarsest nodes, right to `closeness`. The orders come one after the other.
    fn outline(&mut self, number: u32, closeness: Closeness) -> Drawn {
        let mut ends: Option<[Found; 2]> = None;
        Drawn([0, 1].map(|index| {
            let turns = self.turns[index].as_mut()?;
            let quarter = Quarter::new(number, index, turns.x());
            let before = self.before[index].as_ref();
            let found = [0, 1].map(|edge| {
                // Of order 1 the curve before has another shape: it begins at the camera.
                let before = before.filter(|_| number > 1).map(|both| &both[edge]);
                let end = ends.map(|both| both[edge]).filter(|_| quarter.x.0 == 0.0);
                coarsest(&self.targets[edge], quarter, turns, before, end, closeness)
            });
            ends = (quarter.x.1 == 1.0).then(|| found.map(|found| found[found.len() - 1]));
            self.before[index] = Some(found);
            Some([0, 1].map(|edge| Nodes::new(&self.targets[edge], quarter, &found[edge])))
        }))
    }

    /// The same curves on as many nodes as it takes for an error of `allowed` pixels.
    fn refine(&mut self, outline: Drawn, allowed: f64) -> Drawn {
        let angle_error = self.angle_error;
        let mut turns = self.turns.iter_mut();
        Drawn(outline.0.map(|pair| {
            let turns = turns.next()?.as_mut()?;
            let mut targets = self.targets.iter();
            let refined = pair?.map(|nodes| {
                let target = targets.next()?;
                Some(nodes.refine(target, turns, self.shown, allowed, angle_error))
            });
            let [Some(inner), Some(outer)] = refined else {
                return None;
            };
            Some([inner, outer])
        }))
    }

    fn sensitivity(&mut self, drawn: &Drawn) -> f64 {
        let mut most: f64 = 0.0;
        for (pair, turns) in drawn.0.iter().zip(&mut self.turns) {
            if let (Some(pair), Some(turns)) = (pair, turns) {
                for nodes in pair {
                    most = nodes.sensitivity(most, turns, self.shown);
                }
            }
        }
        most
    }

    /// What these curves, or those before, may be off by.
    fn error(&mut self, mut error: EdgeError, drawn: &Drawn) -> EdgeError {
        for (pair, turns) in drawn.0.iter().zip(&mut self.turns) {
            if let (Some(pair), Some(turns)) = (pair, turns) {
                for nodes in pair {
                    error = nodes.error(error, turns, self.shown, self.angle_error);
                }
            }
        }
        error
    }

    /// `|∂ψ/∂φ|` of the last order's curves at most, seen or not, on the coarsest nodes; infinite if a slope is not
    /// known.
    fn steepest(&self) -> f64 {
        let points = self.before.iter().flatten().flatten().flatten();
        points.fold(0.0, |most: f64, point| {
            let kappa = self.shown.critical + point.h;
            let slope = point.slope.abs() / (1.0 + kappa * kappa);
            most.max(if slope.is_nan() { f64::INFINITY } else { slope })
        })
    }
}

/// The curves of one order on the nodes they were drawn on, inner and outer edge of each quarter turn.
struct Drawn([Option<[Nodes; 2]>; 2]);

impl Drawn {
    fn thickness(&self, shown: &Shown) -> f64 {
        let pairs = self.0.iter().flatten();
        pairs.fold(0.0, |most: f64, [inner, outer]| {
            most.max(thickness(inner, outer, shown))
        })
    }

    /// The pieces that the picture shows any ray of.
    fn pieces(&self, number: u32, sight: &Sight) -> [Option<Piece>; 2] {
        let (low, high) = sight.heights();
        self.0.each_ref().map(|pair| {
            pair.as_ref()
                .map(|[inner, outer]| Piece::new(number, inner, outer))
                .filter(|piece| piece.lowest <= high && piece.highest >= low)
        })
    }
}

/// The part of a quarter turn that a piece covers.
#[derive(Debug, Clone, Copy)]
struct Quarter {
    /// Orbit angle at x = 0.
    start: f64,
    /// Whether h has a pole at x = 0.
    pole: bool,
    /// Least and greatest x.
    x: (f64, f64),
}

impl Quarter {
    /// The quarter turn `index` (0 or 1) of order `number`, between two places.
    fn new(number: u32, index: usize, x: (f64, f64)) -> Self {
        Self {
            start: f64::from(number) * PI + if index == 0 { 0.0 } else { FRAC_PI_2 },
            pole: number == 0 && index == 0,
            x,
        }
    }

    /// The place at a share of the way, the ends exactly.
    fn x_at(self, share: f64) -> f64 {
        x_at(self.x, share)
    }

    /// h over what is kept of it at x.
    fn over_kept(self, x: f64) -> f64 {
        if self.pole { 1.0 / x } else { 1.0 }
    }

    /// h, dh/dφ and d²h/dφ² at x, from what is kept of h there and its derivatives in x: `dx/dφ = x² + (1 − x)²`.
    fn along(self, x: f64, (y, slope, bend): (f64, f64, f64)) -> (f64, f64, f64) {
        let (h, slope, bend) = if self.pole {
            let h = y / x;
            let h_slope = (slope - h) / x;
            (h, h_slope, (bend - 2.0 * h_slope) / x)
        } else {
            (y, slope, bend)
        };
        let rate = x * x + (1.0 - x) * (1.0 - x);
        (
            h,
            slope * rate,
            (bend * rate + slope * (4.0 * x - 2.0)) * rate,
        )
    }

    /// What is kept of the point at x, and its derivative in x.
    fn kept(self, x: f64, point: Found) -> (f64, f64) {
        let slope = point.slope / (x * x + (1.0 - x) * (1.0 - x));
        if self.pole {
            (point.h * x, point.h + slope * x)
        } else {
            (point.h, slope)
        }
    }
}

/// The place at a share of the way from one to another, the ends exactly.
fn x_at(x: (f64, f64), share: f64) -> f64 {
    if share >= 1.0 {
        x.1
    } else {
        x.0 + (x.1 - x.0) * share
    }
}
