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
mod sight;
mod solve;

use core::f64::consts::{FRAC_PI_2, PI};

use crate::orbit::path::SweptAngles;
use nodes::Nodes;
pub(crate) use open::{Band, EdgeOf, Found, MOST_BANDS, MOST_EDGES, Open};
pub(crate) use patch::{Bent, Patch};
pub(crate) use picture::{Line, Picture};
use piece::{Piece, thickness};
pub use range::{Bundle, Verdict};
pub use sight::Sight;
use solve::Target;

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
    /// Between the curves' nodes.
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

    fn max(self, other: Self) -> Self {
        Self {
            interpolation: self.interpolation.max(other.interpolation),
            angles: self.angles.max(other.angles),
            rounding: self.rounding.max(other.rounding),
        }
    }
}

/// The curves of both edges of the disk for every order that the picture shows.
#[derive(Debug, Clone)]
pub struct Isoradials {
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

    /// Its greatest thickness, in pixels; of rays that the picture does not show, in the size of its pixels there.
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
            critical: sight.critical(),
            quarters: [Vec::new(), Vec::new()],
            orders: Vec::new(),
            left_out: None,
            error: EdgeError::default(),
        };
        for number in 0..MOST_ORDERS {
            let drawn = Drawn::new(sight, number, 0.5 * sight.tolerance, angles);
            let thickness = drawn.thickness(sight);
            if number > 0 && thickness < sight.tolerance {
                curves.left_out = Some(Thinness {
                    order: number,
                    thickness,
                });
                break;
            }
            curves.error = curves.error.max(drawn.error(sight, angles.error()));
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
    let target = Target::new(sight, edge);
    target.solve(angle, target.first_guess(angle), angles)
}

/// How far an edge moves when every angle changes: `|∂ψ/∂φ|` of the curves of `sight` at most, in pixels per radian,
/// from exact angles on the coarsest nodes.
pub fn sensitivity(sight: &Sight, angles: &impl SweptAngles) -> f64 {
    let mut most: f64 = 0.0;
    for number in 0..MOST_ORDERS {
        let drawn = Drawn::new(sight, number, f64::INFINITY, angles);
        if number > 0 && drawn.thickness(sight) < sight.tolerance {
            break;
        }
        most = most.max(drawn.sensitivity(sight));
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

/// The curves of one order on the nodes they were drawn on, inner and outer edge of each quarter turn.
struct Drawn([Option<[Nodes; 2]>; 2]);

impl Drawn {
    fn new(sight: &Sight, number: u32, allowed: f64, angles: &impl SweptAngles) -> Self {
        let [first, second] = sight.window.quarters();
        let draw = |index: u32, x: (f64, f64)| {
            let quarter = Quarter::new(number, index, x);
            [Edge::Inner, Edge::Outer]
                .map(|edge| Nodes::draw(&Target::new(sight, edge), quarter, sight, allowed, angles))
        };
        Self([first.map(|x| draw(0, x)), second.map(|x| draw(1, x))])
    }

    fn curves(&self) -> impl Iterator<Item = &Nodes> {
        self.0.iter().flatten().flatten()
    }

    fn thickness(&self, sight: &Sight) -> f64 {
        let pairs = self.0.iter().flatten();
        pairs.fold(0.0, |most: f64, [inner, outer]| {
            most.max(thickness(inner, outer, sight))
        })
    }

    fn sensitivity(&self, sight: &Sight) -> f64 {
        self.curves()
            .fold(0.0, |most, nodes| most.max(nodes.sensitivity(sight)))
    }

    fn error(&self, sight: &Sight, angle_error: f64) -> EdgeError {
        self.curves().fold(EdgeError::default(), |most, nodes| {
            most.max(nodes.error(sight, angle_error))
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
    /// The quarter turn `index` (0 or 1) of order `number`, between two places. Those closer than a share of 1e-6
    /// (a camera on the disk's axis meets its plane at one angle) are taken that far apart: nodes need a distance.
    fn new(number: u32, index: u32, x: (f64, f64)) -> Self {
        const CLOSEST: f64 = 1e-6;
        let middle = (0.5 * (x.0 + x.1)).clamp(CLOSEST, 1.0 - CLOSEST);
        Self {
            start: f64::from(number) * PI + f64::from(index) * FRAC_PI_2,
            pole: number == 0 && index == 0,
            x: (x.0.min(middle - CLOSEST), x.1.max(middle + CLOSEST)),
        }
    }

    /// The place at a share of the way, the ends exactly.
    fn x_at(self, share: f64) -> f64 {
        if share >= 1.0 {
            self.x.1
        } else {
            self.x.0 + (self.x.1 - self.x.0) * share
        }
    }

    /// The orbit angle at x: `tan(φ − start) = x/(1 − x)`.
    fn angle(self, x: f64) -> f64 {
        self.start + libm::atan2(x, 1.0 - x)
    }

    /// h over what is kept of it at x.
    fn over_kept(self, x: f64) -> f64 {
        if self.pole { 1.0 / x } else { 1.0 }
    }
}
