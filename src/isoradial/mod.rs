//! Isoradial curves: which rays of one camera meet one radius of the disk, as a function of the orbit angle.
//!
//! # The curves
//! A ray stays in one plane through the hole. Its slope at the camera is `κ = z/s`, the cotangent of the angle between
//! the ray and the hole's direction, and `du/dφ = u0 √(1 − u0) κ`. The isoradial curve `κ(φ; u_d)` is the slope of the
//! ray that reaches the inverse radius `u_d` in the orbit angle φ (Luminet 1979, *Astron. Astrophys.* 75, 228,
//! section 4).
//!
//! There is exactly one such ray. Two rays of one plane that leave one point do not meet again before they have wound
//! around the hole once more, because the Gaussian curvature of the optical metric, `−u³(1 − 3u/4)`, is negative
//! (Gibbons & Werner 2008, *Class. Quantum Grav.* 25, 235009). So at a fixed φ, u rises strictly with κ.
//!
//! # The inequality
//! It follows that a ray that crosses the disk's plane at φ meets the disk iff
//!
//! ```text
//! κ(φ; u_outer) ≤ z/s ≤ κ(φ; u_inner)
//! ```
//!
//! The curves depend on the camera's radius and on the disk's two radii. They do not depend on where the camera looks.
//!
//! What is stored is `h = κ − κ_c`, the distance from the critical ray. It falls as `e^{−φ}`, so that photon rings keep
//! all their digits however thin they are.
//!
//! # The axis
//! A ray crosses the disk's plane at the angles `φ₁ + kπ`, where `tan φ₁ = N/D` and `N = |n·p̂| s ≥ 0`. The number k is
//! the *order* of the image. Each quarter turn of φ has its own splines. Their axis is `x = N/(N + D)` where `D ≥ 0`,
//! and `x = |D|/(N + |D|)` beyond π/2. So x takes one division and no trigonometry, and it is analytic in φ within the
//! quarter turn. In the first quarter turn h has a pole at φ = 0. There the splines hold `x h`.
//!
//! The splines cover only what the picture shows of a quarter turn: from the least to the greatest x of its rays.
//!
//! # How many orders, how many nodes
//! Both follow from the picture and from one number, [`CurveSpec::tolerance`] T, in pixels.
//!
//! * *Orders.* The two edges of an order that is nowhere thicker than T are at most T apart. So leaving it out moves no
//!   edge by more than T. Order k + 1 is asymptotically `e^{−π}` times as thick as order k (Ohanian 1987, *Am. J.
//!   Phys.* 55, 428), so the first order thinner than T ends the search.
//! * *Nodes.* Their number is doubled until the spline between them is right to T/2. The other half of T is for the
//!   method's angles: an error δφ moves an edge by `|∂ψ/∂φ| δφ`, see [`sensitivity`]. A table is good enough where that
//!   is at most T/2.
//!
//! [`Isoradials::error`] returns the error that was reached, part by part. `tests/frames/needs.rs` compares it with
//! exact edges, and checks that choices made for 8 T break T.

mod builder;
mod chebyshev;
mod coarse;
mod curve_spec;
mod edge;
pub mod escape;
mod isoradials;
mod node_angles;
mod nodes;
mod outline;
mod pixel_metric;
mod quarter_curves;
mod quarter_turn;
mod radius_map;
mod ray_angles;
mod ray_bounds;
mod sensitivity;
mod solve;

pub(crate) use chebyshev::Chebyshev;
pub use curve_spec::CurveSpec;
pub use edge::{Edge, EdgeError};
pub use escape::{Escape, EscapeCurve, Image};
pub use isoradials::{ImageOrder, Isoradials, OmittedOrder};
pub(crate) use outline::{Boundary, Sector};
pub(crate) use radius_map::PlaneMeeting;
pub use radius_map::RadiusMap;
pub use ray_bounds::RayBounds;
pub use sensitivity::sensitivity;
pub use solve::height_at;
