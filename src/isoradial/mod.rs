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

mod nodes;
mod range;
mod solve;

use core::f64::consts::{FRAC_PI_2, PI};

use crate::orbit::invariants::{critical_slope, three_u_minus_two};
use crate::orbit::path::SweptAngles;
use crate::table::spline::{Scale, Stencil, value};
use nodes::Nodes;
pub use range::{Bundle, Verdict};
use solve::Target;

/// What the curves are drawn for: one camera radius, one disk, one size of pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The camera's inverse radius.
    pub u0: f64,
    /// `u0 √(1 − u0)`: du/dφ over κ.
    pub slope_scale: f64,
    /// Inverse radius of the disk's inner edge.
    pub u_inner: f64,
    /// Inverse radius of the disk's outer edge.
    pub u_outer: f64,
    /// The smallest angle between the rays of neighbouring pixels, in radians.
    pub pixel_angle: f64,
    /// What an edge may be off by, in pixels.
    pub tolerance: f64,
}

impl Sight {
    /// κ of the critical ray: towards the hole from outside the photon sphere, away from it from inside.
    pub fn critical(&self) -> f64 {
        let size = critical_slope(self.u0) / self.slope_scale;
        if three_u_minus_two(self.u0) < 0.0 {
            size
        } else {
            -size
        }
    }
}

/// Thinner orders than this, in pixels, are left out.
const THINNEST: f64 = 1e-3;

/// The images' orders beyond this one are e^{−12π} as thick as the first: below the rounding of the ray itself.
const MOST_ORDERS: usize = 12;

/// The curves of both edges of the disk for every order that can be seen.
#[derive(Debug, Clone)]
pub struct Isoradials {
    critical: f64,
    orders: Vec<Order>,
    error: f64,
}

/// The image of one order: two quarter turns.
#[derive(Debug, Clone)]
struct Order {
    pieces: [Piece; 2],
    /// The greatest thickness, in pixels.
    thickness: f64,
}

/// A quarter turn of both curves.
#[derive(Debug, Clone)]
struct Piece {
    axis: Scale,
    inner: Vec<f64>,
    outer: Vec<f64>,
    /// No ray of this piece meets the disk with `h` below this
    lowest: f64,
    /// or above this.
    highest: f64,
}

impl Isoradials {
    /// The curves of `sight`, from a method's swept angles.
    ///
    /// Orders are added while the last one is thicker than a thousandth of a pixel; the curves' nodes are doubled,
    /// piece by piece, until they are right to a tenth of the tolerance in the middle of every cell, or as right as
    /// the angles are. [`Self::error`] tells what was reached.
    pub fn new(sight: &Sight, angles: &impl SweptAngles) -> Self {
        let mut curves = Self {
            critical: sight.critical(),
            orders: Vec::new(),
            error: 0.0,
        };
        for k in 0..MOST_ORDERS {
            let (order, error) = curves.order(k, sight, angles);
            if k > 0 && order.thickness < THINNEST {
                break;
            }
            curves.error = curves.error.max(error);
            curves.orders.push(order);
        }
        curves
    }

    fn order(&self, k: usize, sight: &Sight, angles: &impl SweptAngles) -> (Order, f64) {
        let mut thickness: f64 = 0.0;
        let mut error: f64 = 0.0;
        let pieces = [0, 1].map(|quarter| {
            let at = Quarter {
                start: k as f64 * PI + f64::from(quarter) * FRAC_PI_2,
                pole: k == 0 && quarter == 0,
            };
            let draw = |u_disk: f64| {
                let target = Target {
                    u0: sight.u0,
                    slope_scale: sight.slope_scale,
                    critical: self.critical,
                    u_disk,
                };
                Nodes::draw(&target, at, sight, angles)
            };
            let (inner, outer) = (draw(sight.u_inner), draw(sight.u_outer));
            let count = inner.values.len().max(outer.values.len());
            let (inner, outer) = (inner.with_count(count), outer.with_count(count));
            error = error.max(inner.error).max(outer.error);
            let kappas = |nodes: &Nodes| (0..count).map(|i| nodes.kappa(i)).collect::<Vec<f64>>();
            for (high, low) in kappas(&inner).into_iter().zip(kappas(&outer)) {
                thickness = thickness.max(between(low, high) / sight.pixel_angle);
            }
            Piece::new(&inner, &outer, self.critical)
        });
        (Order { pieces, thickness }, error)
    }

    /// κ of the critical ray.
    pub fn critical(&self) -> f64 {
        self.critical
    }

    /// How many orders are kept: 0 (direct) to this less one.
    pub fn orders(&self) -> usize {
        self.orders.len()
    }

    /// The greatest thickness of the image of order `k`, in pixels.
    pub fn thickness(&self, k: usize) -> f64 {
        self.orders.get(k).map_or(0.0, |order| order.thickness)
    }

    /// The largest error of the curves in the middle of a cell, in pixels.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// How many bytes a frame reads of the curves.
    pub fn bytes(&self) -> usize {
        let pieces = self.orders.iter().flat_map(|order| &order.pieces);
        pieces
            .map(|piece| (piece.inner.len() + piece.outer.len()) * size_of::<f64>())
            .sum()
    }

    /// Whether the ray with inward part `z` and transverse length `s > 0` meets the disk, where `N = |n·p̂| s` and D
    /// are the parts of the tangent of φ₁.
    #[inline]
    pub fn meets(&self, z: f64, s: f64, n: f64, d: f64) -> bool {
        let excess = z - self.critical * s;
        let beyond = usize::from(d < 0.0);
        let mut axis = None;
        for (k, order) in self.orders.iter().enumerate() {
            let piece = &order.pieces[beyond];
            if excess < piece.lowest * s || excess > piece.highest * s {
                continue;
            }
            let x = *axis.get_or_insert_with(|| {
                if d < 0.0 {
                    -d / (n - d)
                } else if n > 0.0 {
                    n / (n + d)
                } else {
                    0.0
                }
            });
            let scaled = if k == 0 && beyond == 0 {
                excess * x
            } else {
                excess
            };
            let stencil = piece.axis.stencil(x);
            if piece.within(scaled, s, &stencil) {
                return true;
            }
        }
        false
    }
}

impl Piece {
    fn new(inner: &Nodes, outer: &Nodes, critical: f64) -> Self {
        let count = inner.values.len();
        let highest = (0..count)
            .map(|i| inner.kappa(i))
            .fold(f64::NEG_INFINITY, f64::max)
            - critical;
        let lowest = (0..count)
            .map(|i| outer.kappa(i))
            .fold(f64::INFINITY, f64::min)
            - critical;
        // Between the nodes a smooth curve may pass its nodes' extremes a little: by a share of the angle between
        // them.
        let (widest, narrowest) = (angle(critical + lowest), angle(critical + highest));
        let margin = 0.01 * (widest - narrowest);
        let cotangent = |angle: f64| libm::cos(angle) / libm::sin(angle) - critical;
        let share = 0.01 * (highest - lowest);
        let below = if widest + margin < PI {
            (lowest - share).max(cotangent(widest + margin))
        } else {
            f64::NEG_INFINITY
        };
        let above = if narrowest > margin {
            (highest + share).min(cotangent(narrowest - margin))
        } else {
            f64::INFINITY
        };
        Self {
            axis: inner.axis(),
            inner: inner.coefficients(),
            outer: outer.coefficients(),
            lowest: below,
            highest: above,
        }
    }

    #[inline]
    fn within(&self, scaled: f64, s: f64, stencil: &Stencil) -> bool {
        scaled >= s * value(&self.outer, stencil) && scaled <= s * value(&self.inner, stencil)
    }
}

/// The quarter turn that a piece covers.
#[derive(Debug, Clone, Copy)]
struct Quarter {
    /// Orbit angle at x = 0.
    start: f64,
    /// Whether h has a pole at x = 0.
    pole: bool,
}

impl Quarter {
    /// The orbit angle at x: `tan(φ − start) = x/(1 − x)`.
    fn angle(self, x: f64) -> f64 {
        self.start + libm::atan2(x, 1.0 - x)
    }
}

/// The angle between two rays of cotangents κ, in radians: without subtracting two angles.
fn between(low: f64, high: f64) -> f64 {
    if high.is_infinite() || low.is_infinite() {
        return angle(low) - angle(high);
    }
    libm::atan2(high - low, 1.0 + high * low)
}

/// The angle between a ray of cotangent κ and the hole's direction, in [0, π].
fn angle(kappa: f64) -> f64 {
    libm::atan2(1.0, kappa)
}
