//! Where a method puts the disk's edges, in pixels from where the exact method puts them.
//!
//! At angles φ₁ spread evenly over those that the picture shows, for each edge and order, the exact ray that just
//! meets the edge is found; those outside the picture are left out. Curves tell their own; of a method that steps
//! rays the ray is sought at which its answer flips: that it is closer to the hole than the edge when it meets the
//! disk's plane, or that it is not. An order that curves leave out for its thinness is one whose two edges are drawn
//! on each other: they count as displaced by its thickness.
//!
//! Rays are asked for their crossings of the edge's radius, as a ray is anywhere; the frames' fixed steps end at the
//! disk's plane itself, and are spared the interpolation between steps.

use rayon::prelude::*;

use crate::isoradial::{Edge, Isoradials, Sight, height_at};
use crate::orbit::exact::Exact;
use crate::orbit::{EventKind, Fate, Orbits, Ray};
use crate::scene::{Scene, View};

/// The orders looked at: the direct image, two rings, and further ones where the picture needs them, which are
/// those thicker than its tolerance.
pub(super) const ORDERS: usize = 6;

/// The orders that are looked at anyway.
const ALWAYS: u32 = 3;

/// An edge further off than this, in pixels, is lost.
const LOST: f64 = 1e4;

/// Found of one order: displacements in pixels, and how many edges are not found.
#[derive(Debug, Clone, Default)]
pub(super) struct Displacements {
    pub(super) pixels: Vec<f64>,
    pub(super) lost: u64,
}

/// Where the edges should be.
pub(super) struct Edges {
    sight: Sight,
    /// The disk's inner and outer radius.
    radii: (f64, f64),
    samples: Vec<Sample>,
}

/// One place on one edge.
#[derive(Debug, Clone, Copy)]
struct Sample {
    order: u32,
    edge: Edge,
    first: f64,
    /// `κ − κ_c` of the exact ray.
    height: f64,
    /// To the other edge, in pixels.
    thickness: f64,
}

impl Edges {
    /// At `places` φ₁.
    pub(super) fn new(scene: &Scene, view: &View, places: u32) -> Self {
        let sight = Sight::new(scene, view, scene.tolerance());
        let (low, high) = sight.window.cotangent;
        let (from, to) = (libm::atan2(1.0, high), libm::atan2(1.0, low));
        let mut samples = Vec::new();
        for order in 0..ORDERS as u32 {
            for place in 0..places {
                let first = from + (to - from) * (f64::from(place) + 0.5) / f64::from(places);
                let angle = f64::from(order) * core::f64::consts::PI + first;
                let [inner, outer] =
                    [Edge::Inner, Edge::Outer].map(|edge| height_at(&sight, edge, angle, &Exact));
                let thickness = sight.pixels((outer, inner));
                if order >= ALWAYS && thickness < sight.tolerance {
                    continue;
                }
                for (edge, height) in [(Edge::Inner, inner), (Edge::Outer, outer)] {
                    let kappa = sight.critical() + height;
                    if sight.window.kappa.0 <= kappa && kappa <= sight.window.kappa.1 {
                        samples.push(Sample {
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
            sight,
            radii: (scene.disk().inner, scene.disk().outer),
            samples,
        }
    }

    /// The displacements, order by order, where `found` tells each edge's; `None` where it is lost.
    fn displacements(
        &self,
        found: impl Fn(&Sample) -> Option<f64> + Send + Sync,
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

    /// Of curves.
    pub(super) fn of_curves(&self, curves: &Isoradials) -> Vec<Displacements> {
        self.displacements(|sample| {
            let is_left_out = curves
                .left_out()
                .is_some_and(|thin| thin.order <= sample.order);
            if is_left_out {
                return Some(sample.thickness);
            }
            let height = curves.height(sample.order, sample.edge, sample.first)?;
            Some(self.sight.pixels((sample.height, height)))
        })
    }

    /// Of a method that follows rays.
    pub(super) fn of_orbits(&self, orbits: &dyn Orbits) -> Vec<Displacements> {
        self.displacements(|sample| {
            let height = self.flip(orbits, sample)?;
            let pixels = self.sight.pixels((sample.height, height));
            (pixels <= LOST).then_some(pixels)
        })
    }

    /// The height at which the method's answer flips, to a thousandth of its distance from the exact one: between two
    /// heights that the search outwards from there has found it to differ at.
    fn flip(&self, orbits: &dyn Orbits, sample: &Sample) -> Option<f64> {
        let exact = sample.height;
        let is_inside = self.is_inside(orbits, sample, exact)?;
        // Inside there, the edge is at a smaller height.
        let away = if is_inside { -1.0 } else { 1.0 };
        let at = |distance: f64| exact + away * distance;
        let mut near = 0.0;
        // One unit in the last place of the ray's own slope.
        let mut far = f64::EPSILON * (self.sight.critical() + exact).abs().max(1e-6);
        while self.is_inside(orbits, sample, at(far))? == is_inside {
            if self.sight.pixels((exact, at(far))) > LOST {
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

    /// Whether the ray of `height` is closer to the hole than the edge when it meets the disk's plane; `None` where the
    /// method does not say.
    fn is_inside(&self, orbits: &dyn Orbits, sample: &Sample, height: f64) -> Option<bool> {
        let slope = self.sight.slope_scale * (self.sight.critical() + height);
        let ray = Ray::new(self.sight.u0, slope).ok()?;
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
            // Out first: inside before that, and again after it is back in.
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
    fn edges_are_found_as_well_as_the_method_finds_rays() {
        let scene = Scene::builtin("classic").unwrap();
        let view = View::new(&scene);
        let edges = Edges::new(&scene, &view, 9);
        let of = |orbits: &dyn Orbits| edges.of_orbits(orbits);
        let adaptive = of(&Adaptive::default());
        assert_eq!(adaptive[0].pixels.len(), 18);
        assert!(worst(&adaptive) < 1e-9, "{:e}", worst(&adaptive));
        let rk4 = |h| worst(&of(&FixedStep::new(Scheme::Rk4, h)));
        assert!(rk4(0.2) > 4.0 * rk4(0.1) && rk4(0.1) < 0.01);
        let curves = Isoradials::new(&edges.sight, &Exact);
        let drawn = worst(&edges.of_curves(&curves));
        assert!(drawn > 0.0 && drawn <= scene.tolerance(), "{drawn:e}");
    }

    #[test]
    fn an_order_left_out_is_off_by_its_thickness() {
        let scene = Scene::builtin("classic").unwrap();
        let scene = scene.with_size(64, 36).unwrap();
        let view = View::new(&scene);
        let edges = Edges::new(&scene, &view, 9);
        let curves = Isoradials::new(&Sight::new(&scene, &view, 1.0), &Exact);
        let left_out = curves.left_out().unwrap();
        let order = &edges.of_curves(&curves)[left_out.order as usize];
        let most = order.pixels.iter().copied().fold(0.0, f64::max);
        assert!(order.lost == 0 && most > 1e-3, "{order:?}");
        assert!(most <= 1.01 * left_out.thickness, "{order:?}");
    }
}
