//! Measures how far each method displaces the disk's edges, in pixels of the picture.
//!
//! The exact ray that just meets an edge is found for each edge and order, at angles φ₁ spread evenly over those that
//! the picture shows. Rays outside the picture are left out. Curves give the displacement directly. For a method that
//! follows rays, the displaced edge is the ray at which the answer changes between "the ray meets the disk's plane
//! inside the edge" and "outside". Curves may leave out an order because it is thin: both its edges then count as
//! displaced by its thickness.
//!
//! Here fixed-step methods interpolate the crossing of the edge's radius between two steps, as for any ray. In frames
//! they stop at the disk's plane instead and need no interpolation.

use rayon::prelude::*;

use crate::isoradial::{CurveSpec, Edge, Isoradials, height_at};
use crate::orbit::exact::Exact;
use crate::orbit::{EventKind, Fate, Orbits, Ray};
use crate::scene::{Scene, View};

/// The number of orders measured: the direct image, two rings, and further rings if they are thicker than the picture's
/// tolerance.
pub(super) const ORDERS: usize = 6;

/// The number of orders that are measured whatever their thickness.
const ALWAYS: u32 = 3;

/// An edge displaced by more than this, in pixels, counts as lost.
const LOST: f64 = 1e4;

/// The displacements of one order's edges in pixels, and the number of lost edges.
#[derive(Debug, Clone, Default)]
pub(super) struct Displacements {
    pub(super) pixels: Vec<f64>,
    pub(super) lost: u64,
}

/// The exact positions of the edges.
pub(super) struct ExactEdges {
    spec: CurveSpec,
    /// The disk's inner and outer radius, in Schwarzschild radii.
    radii: (f64, f64),
    samples: Vec<EdgeSample>,
}

/// One point of one edge.
#[derive(Debug, Clone, Copy)]
struct EdgeSample {
    order: u32,
    edge: Edge,
    first: f64,
    /// `κ − κ_c` of the exact ray, with `κ_c` that of the critical ray.
    height: f64,
    /// The distance to the order's other edge, in pixels.
    thickness: f64,
}

impl ExactEdges {
    /// Finds the edges at `places` angles φ₁.
    pub(super) fn new(scene: &Scene, view: &View, places: u32) -> Self {
        let radii = scene
            .disk()
            .map_or((0.0, 0.0), |disk| (disk.inner, disk.outer));
        let spec = CurveSpec::new(scene, view, scene.tolerance());
        let (low, high) = spec.window.cotangent;
        let (from, to) = (libm::atan2(1.0, high), libm::atan2(1.0, low));
        let mut samples = Vec::new();
        for order in 0..ORDERS as u32 {
            for place in 0..places {
                let first = from + (to - from) * (f64::from(place) + 0.5) / f64::from(places);
                let angle = f64::from(order) * core::f64::consts::PI + first;
                let [inner, outer] =
                    [Edge::Inner, Edge::Outer].map(|edge| height_at(&spec, edge, angle, &Exact));
                let thickness = spec.pixels((outer, inner));
                if order >= ALWAYS && thickness < spec.tolerance {
                    continue;
                }
                for (edge, height) in [(Edge::Inner, inner), (Edge::Outer, outer)] {
                    let kappa = spec.critical() + height;
                    if spec.window.kappa.0 <= kappa && kappa <= spec.window.kappa.1 {
                        samples.push(EdgeSample {
                            order,
                            edge,
                            first,
                            height,
                            thickness,
                        });
                    }
                }
            }
        }
        Self {
            spec,
            radii,
            samples,
        }
    }

    /// Collects the displacements by order. `found` returns the displacement of one sample, or `None` if it is lost.
    fn displacements(
        &self,
        found: impl Fn(&EdgeSample) -> Option<f64> + Send + Sync,
    ) -> Vec<Displacements> {
        let all: Vec<_> = self.samples.par_iter().map(found).collect();
        let mut orders = vec![Displacements::default(); ORDERS];
        for (sample, found) in self.samples.iter().zip(all) {
            if let Some(order) = orders.get_mut(sample.order as usize) {
                match found {
                    Some(pixels) => order.pixels.push(pixels),
                    None => order.lost += 1,
                }
            }
        }
        orders
    }

    /// Returns the displacements of the edges of `curves`.
    pub(super) fn of_curves(&self, curves: &Isoradials) -> Vec<Displacements> {
        self.displacements(|sample| {
            let is_left_out = curves
                .left_out()
                .is_some_and(|thin| thin.order <= sample.order);
            if is_left_out {
                return Some(sample.thickness);
            }
            let height = curves.height(sample.order, sample.edge, sample.first)?;
            Some(self.spec.pixels((sample.height, height)))
        })
    }

    /// Returns the displacements of the edges as a method that follows rays sees them.
    pub(super) fn of_orbits(&self, orbits: &dyn Orbits) -> Vec<Displacements> {
        self.displacements(|sample| {
            let height = self.flip(orbits, sample)?;
            let pixels = self.spec.pixels((sample.height, height));
            (pixels <= LOST).then_some(pixels)
        })
    }

    /// Finds the height at which the method's answer changes, to a thousandth of its distance from the exact height.
    /// The search steps outwards from the exact height until the answer differs, and then bisects.
    fn flip(&self, orbits: &dyn Orbits, sample: &EdgeSample) -> Option<f64> {
        let exact = sample.height;
        let is_inside = self.is_inside(orbits, sample, exact)?;
        // Where the answer is "inside", the displaced edge is at a smaller height.
        let away = if is_inside { -1.0 } else { 1.0 };
        let at = |distance: f64| exact + away * distance;
        let mut near = 0.0;
        // One unit in the last place of the ray's slope.
        let mut far = f64::EPSILON * (self.spec.critical() + exact).abs().max(1e-6);
        while self.is_inside(orbits, sample, at(far))? == is_inside {
            if self.spec.pixels((exact, at(far))) > LOST {
                return None;
            }
            near = far;
            far *= 4.0;
        }
        while far - near > 1e-3 * far {
            let middle = 0.5 * (near + far);
            if self.is_inside(orbits, sample, at(middle))? == is_inside {
                near = middle;
            } else {
                far = middle;
            }
        }
        Some(at(far))
    }

    /// Returns whether the ray at `height` is inside the edge when it meets the disk's plane, or `None` if the method
    /// fails.
    fn is_inside(&self, orbits: &dyn Orbits, sample: &EdgeSample, height: f64) -> Option<bool> {
        let slope = self.spec.slope_scale * (self.spec.critical() + height);
        let ray = Ray::new(self.spec.u0, slope).ok()?;
        let radius = match sample.edge {
            Edge::Inner => self.radii.0,
            Edge::Outer => self.radii.1,
        };
        let angle = f64::from(sample.order) * core::f64::consts::PI + sample.first;
        let events = orbits.follow(ray, &[radius]).ok()?;
        let of = |kind| {
            let event = events.iter().find(|event| event.kind == kind);
            event.map(|event| event.angle)
        };
        Some(match (of(EventKind::Inbound), of(EventKind::Outbound)) {
            (Some(enter), Some(leave)) if enter < leave => enter < angle && angle < leave,
            // It crosses outwards first: it is inside before that crossing and after the inward one.
            (Some(enter), Some(leave)) => angle < leave || enter < angle,
            (Some(enter), None) => enter < angle,
            (None, Some(leave)) => angle < leave,
            (None, None) => events
                .last()
                .is_some_and(|end| end.kind == EventKind::End(Fate::Capture)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::integrate::{Adaptive, FixedStep, Scheme};

    fn worst(orders: &[Displacements]) -> f64 {
        assert!(orders.iter().all(|order| order.lost == 0));
        let all = orders.iter().flat_map(|order| &order.pixels);
        all.copied().fold(0.0, f64::max)
    }

    #[test]
    fn edges_are_as_accurate_as_the_method() {
        let scene = Scene::builtin("classic").unwrap();
        let view = View::new(&scene);
        let edges = ExactEdges::new(&scene, &view, 9);
        let of = |orbits: &dyn Orbits| edges.of_orbits(orbits);
        let adaptive = of(&Adaptive::default());
        assert_eq!(adaptive[0].pixels.len(), 18);
        assert!(worst(&adaptive) < 1e-9, "{:e}", worst(&adaptive));
        let rk4 = |h| worst(&of(&FixedStep::new(Scheme::Rk4, h)));
        assert!(rk4(0.2) > 4.0 * rk4(0.1) && rk4(0.1) < 0.01);
        let curves = Isoradials::new(&edges.spec, &Exact);
        let drawn = worst(&edges.of_curves(&curves));
        assert!(drawn > 0.0 && drawn <= scene.tolerance(), "{drawn:e}");
    }

    #[test]
    fn an_order_left_out_is_displaced_by_its_thickness() {
        let scene = Scene::builtin("classic").unwrap();
        let scene = scene.with_size(64, 36).unwrap();
        let view = View::new(&scene);
        let edges = ExactEdges::new(&scene, &view, 9);
        let curves = Isoradials::new(&CurveSpec::new(&scene, &view, 1.0), &Exact);
        let left_out = curves.left_out().unwrap();
        let order = &edges.of_curves(&curves)[left_out.order as usize];
        let most = order.pixels.iter().copied().fold(0.0, f64::max);
        assert!(order.lost == 0 && most > 1e-3, "{order:?}");
        assert!(most <= 1.01 * left_out.thickness, "{order:?}");
    }
}
