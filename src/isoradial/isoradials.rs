//! The curves of all orders in a picture, and the test of a ray against them.

use super::builder::{MAX_ORDERS, curve_builder};
use super::curve_spec::CurveSpec;
use super::edge::{Edge, EdgeError};
use super::nodes::NODE_SHARE;
use super::outline::{self, Sector};
use super::pixel_metric::PixelMetric;
use super::quarter_curves::QuarterCurves;
use super::quarter_turn::x_of_crossing;
use super::solve::SolveTolerance;
use crate::orbit::path::SweptAngles;

/// The curves of both edges of the disk, for every order in the picture.
#[derive(Debug, Clone)]
pub struct Isoradials {
    spec: CurveSpec,
    critical: f64,
    /// For each of the two quarter turns, the curves of the visible orders, lowest first.
    quarters: [Vec<QuarterCurves>; 2],
    /// For each of the two quarter turns, which order lies in front.
    sectors: [Vec<Sector>; 2],
    orders: Vec<ImageOrder>,
    left_out: Option<OmittedOrder>,
    error: EdgeError,
}

/// The image of one order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageOrder {
    number: u32,
    thickness: f64,
    nodes: usize,
}

/// The first order that is thinner than the tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OmittedOrder {
    /// The order's number.
    pub order: u32,
    /// Its greatest thickness, in pixels.
    pub thickness: f64,
}

impl ImageOrder {
    /// Returns the order's number: 0 for the direct image, 1 for the first ring.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Returns the order's greatest thickness at the coarsest nodes, in pixels. Rays outside the picture count too,
    /// with the size that its pixels would have there.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Returns the number of nodes of the order's curves.
    pub fn nodes(&self) -> usize {
        self.nodes
    }
}

impl Isoradials {
    /// Builds the curves of `spec` from a method's swept angles. The [module's page](super) derives how many orders and
    /// nodes they have. Without a disk there are none.
    pub fn new(spec: &CurveSpec, angles: &impl SweptAngles) -> Self {
        let mut curves = Self {
            spec: *spec,
            critical: spec.critical(),
            quarters: [Vec::new(), Vec::new()],
            sectors: [Vec::new(), Vec::new()],
            orders: Vec::new(),
            left_out: None,
            error: EdgeError::default(),
        };
        let Some(u_edges) = spec.u_edges else {
            return curves;
        };
        let allowed = 0.5 * spec.tolerance;
        let metric = PixelMetric::new(spec);
        let tolerance = SolveTolerance {
            psi: NODE_SHARE * allowed / metric.max_per_radian(),
            phi: 0.0,
        };
        let mut builder = curve_builder(spec, u_edges, &metric, angles);
        for number in 0..MAX_ORDERS {
            let coarse = builder.coarse(number, tolerance);
            let thickness = coarse.thickness(&metric);
            if number > 0 && thickness < spec.tolerance {
                curves.left_out = Some(OmittedOrder {
                    order: number,
                    thickness,
                });
                break;
            }
            let refined = builder.refine(coarse, allowed);
            curves.error = builder.error(curves.error, &refined);
            let mut nodes = 0;
            for (quarter, visible) in refined.visible(number, spec) {
                nodes += visible.nodes();
                curves.quarters[quarter].push(visible);
            }
            if nodes > 0 {
                curves.orders.push(ImageOrder {
                    number,
                    thickness,
                    nodes,
                });
            }
        }
        curves.sectors = [0, 1].map(|quarter| outline::sectors(&curves.quarters[quarter]));
        curves
    }

    /// Returns whether these curves serve the picture of `spec` too: it has the same camera radius and disk, shows no
    /// other rays, and needs no smaller error.
    pub fn serves(&self, spec: &CurveSpec) -> bool {
        self.spec.union(spec) == Some(self.spec)
    }

    /// Returns whether they were built for a picture [beside](CurveSpec::is_beside) that of `spec`.
    pub(crate) fn are_beside(&self, spec: &CurveSpec) -> bool {
        self.spec.is_beside(spec)
    }

    /// Returns the inverse radii of the outer and the inner edge, 0 without a disk.
    pub(crate) fn u_edges(&self) -> (f64, f64) {
        let [inner, outer] = self.spec.u_edges.unwrap_or_default();
        (outer, inner)
    }

    /// Returns what they were built for.
    pub(super) fn spec(&self) -> &CurveSpec {
        &self.spec
    }

    /// Returns κ of the critical ray.
    pub fn critical(&self) -> f64 {
        self.critical
    }

    /// Returns the orders in the picture, the direct image first.
    pub fn orders(&self) -> &[ImageOrder] {
        &self.orders
    }

    /// Returns the first order that is thinner than the tolerance, if there is one.
    pub fn left_out(&self) -> Option<OmittedOrder> {
        self.left_out
    }

    /// Returns the bound of the edges' error, in pixels.
    pub fn error(&self) -> EdgeError {
        self.error
    }

    /// Returns the number of nodes of all curves.
    pub fn nodes(&self) -> usize {
        self.orders.iter().map(ImageOrder::nodes).sum()
    }

    /// Returns the number of bytes of the curves that a frame reads.
    pub fn bytes(&self) -> usize {
        self.quarters
            .iter()
            .flatten()
            .map(QuarterCurves::bytes)
            .sum()
    }

    /// Returns `κ − κ_c` of an edge's curve for the image of order `number`, at the angle `φ₁ = first` in [0, π] at
    /// which the ray meets the plane first. Returns `None` if the picture does not show this part of the curve.
    pub fn height(&self, number: u32, edge: Edge, first: f64) -> Option<f64> {
        let (sine, cosine) = (libm::sin(first).abs(), libm::cos(first));
        let mut orders = self.quarter(usize::from(cosine < 0.0)).iter();
        let curves = orders.find(|curves| curves.order == number)?;
        Some(curves.height(edge, x_of_crossing(sine, cosine)))
    }

    /// Returns whether a ray of the picture meets the disk. Its inward part is `z`, its transverse length `s > 0`, and
    /// it meets the plane at `tan φ₁ = n/d` with `n = |n·p̂| s`.
    #[inline]
    pub fn meets(&self, z: f64, s: f64, n: f64, d: f64) -> bool {
        self.front(z, s, n, d).is_some()
    }

    /// Returns the lowest order at which a ray of the picture meets the disk: see [`Self::meets`].
    #[inline]
    pub(crate) fn front(&self, z: f64, s: f64, n: f64, d: f64) -> Option<u32> {
        let excess = z - self.critical * s;
        let mut x = None;
        for curves in self.quarter(usize::from(d < 0.0)) {
            if excess < curves.h_range.0 * s || excess > curves.h_range.1 * s {
                continue;
            }
            let x = *x.get_or_insert_with(|| x_of_crossing(n, d));
            if curves.meets(excess, s, x) {
                return Some(curves.order);
            }
        }
        None
    }

    /// Returns the sectors of one quarter turn by rising x: which order lies in front.
    pub(crate) fn sectors(&self, quarter: usize) -> &[Sector] {
        &self.sectors[quarter]
    }

    /// Returns the curves of one quarter turn, order by order.
    #[inline]
    pub(crate) fn quarter(&self, quarter: usize) -> &[QuarterCurves] {
        &self.quarters[quarter]
    }
}
