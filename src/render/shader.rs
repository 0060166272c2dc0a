//! What the ray of any place in the picture shows, from the map of the camera's radius.

use super::centre::front;
use super::flux_spline::FluxSpline;
use super::shadow;
use crate::isoradial::{Isoradials, PlaneMeeting, RadiusMap};
use crate::light::{SightGeometry, redshift};
use crate::scene::{PixelRay, View};

/// Finds the inverse radius at which a ray with `κ − κ_c = h` meets the disk's plane in an order, where the map has a
/// gap.
pub(super) type Gaps<'a> = &'a (dyn Fn(u32, f64, PlaneMeeting) -> Option<f64> + Sync);

/// Shades places of one view.
pub(super) struct Shader<'a> {
    pub(super) view: &'a View,
    pub(super) curves: &'a Isoradials,
    map: &'a RadiusMap,
    gaps: Gaps<'a>,
    pub(super) geometry: SightGeometry,
    clock_rate: f64,
    /// The inverse radii of the outer and the inner edge.
    pub(super) u_edges: (f64, f64),
    /// Whether the camera is in the disk's plane.
    pub(super) is_in_plane: bool,
    pub(super) flux: &'static FluxSpline,
    /// Whether the light may change within a pixel in more than one direction.
    pub(super) is_coarse: bool,
    /// The share of its light that a partly covered pixel may be off by, where one line does not do.
    pub(super) light_tolerance: f64,
    /// A partly covered pixel is cut at least into so many parts a side.
    pub(super) least_parts: usize,
}

/// From nearer than this the hole looks as large as from here, about.
const CLOSE: f64 = 3.0;

/// Pixels are coarse if they are longer than this share of a Schwarzschild radius at the hole's distance.
const COARSE: f64 = 1.0 / 24.0;

/// A fine pixel's light may be off by this share of it, a coarse one's by less: it has more of the whole light.
const FINE: f64 = 0.01;
const FINEST: f64 = 0.0005;

/// A partly covered pixel is cut into parts that are shorter than this share of a Schwarzschild radius at the hole's
/// distance.
const LONGEST_PART: f64 = 0.4;

/// But into no more than so many a side.
const MOST_PARTS: f64 = 32.0;

/// A ray of the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlaceRay {
    /// (X, Y) in the picture.
    pub(super) point: (f64, f64),
    pub(super) ray: PixelRay,
    /// The length of its transverse part.
    pub(super) s: f64,
    /// `κ − κ_c`
    pub(super) h: f64,
    pub(super) meets: PlaneMeeting,
}

impl<'a> Shader<'a> {
    pub(super) fn new(
        view: &'a View,
        curves: &'a Isoradials,
        map: &'a RadiusMap,
        gaps: Gaps<'a>,
    ) -> Self {
        let pixel = view.pixel_side() * view.radius().max(CLOSE);
        let fineness = COARSE / pixel;
        Self {
            flux: FluxSpline::shared(),
            is_coarse: fineness < 1.0,
            light_tolerance: (FINE * fineness * fineness * fineness).clamp(FINEST, FINE),
            least_parts: (pixel / LONGEST_PART).ceil().clamp(1.0, MOST_PARTS) as usize,
            view,
            curves,
            map,
            gaps,
            geometry: SightGeometry::new(view),
            clock_rate: view.clock_rate(),
            u_edges: curves.u_edges(),
            is_in_plane: view.n_p() == 0.0,
        }
    }

    /// Returns the ray of a place, in pixels from the picture's left and its top.
    #[inline(always)]
    pub(super) fn ray(&self, place: (f64, f64)) -> PlaceRay {
        let view = self.view;
        let point = (view.x_at(place.0), view.y_at(place.1));
        let ray = view.ray_at(point.0, point.1);
        let s = ray.transverse();
        let (n, d) = (self.view.n_p().abs() * s, self.view.plane_slope() * ray.ta);
        PlaceRay {
            point,
            ray,
            s,
            h: (ray.z - self.curves.critical() * s) / s,
            meets: PlaneMeeting::new(n, d),
        }
    }

    /// Returns the inverse radius at which a ray meets the disk's plane in an order; `None` where the map does not go.
    #[inline(always)]
    pub(super) fn u(&self, order: u32, ray: &PlaceRay) -> Option<f64> {
        let section = self.map.section(order, ray.meets)?;
        let column = section.column(ray.meets.x);
        let tau = column.tau(ray.h);
        column.holds(tau).then(|| column.u(tau))
    }

    /// Returns the same for a ray that meets the disk there, up to rounding.
    #[inline]
    pub(super) fn u_on_disk(&self, order: u32, ray: &PlaceRay) -> f64 {
        let (outer, inner) = self.u_edges;
        let u = match self.map.section(order, ray.meets) {
            Some(section) => {
                let column = section.column(ray.meets.x);
                column.u(column.clamped(column.tau(ray.h)))
            }
            None => (self.gaps)(order, ray.h, ray.meets).unwrap_or(outer),
        };
        within(u, (outer, inner))
    }

    /// Returns inverse radii, all at the x of `ray`, for several `κ − κ_c` on the disk.
    #[inline]
    pub(super) fn u_along(&self, order: u32, ray: &PlaceRay) -> impl Fn(f64) -> f64 + '_ {
        let section = self.map.section(order, ray.meets);
        let column = section.map(|section| section.column(ray.meets.x));
        let (meets, (outer, inner)) = (ray.meets, self.u_edges);
        move |h| {
            let u = match &column {
                Some(column) => column.u(column.clamped(column.tau(h))),
                None => (self.gaps)(order, h, meets).unwrap_or(outer),
            };
            within(u, (outer, inner))
        }
    }

    /// Returns the angular momentum of a ray's light along the disk's axis.
    #[inline(always)]
    pub(super) fn lambda(&self, ray: &PlaceRay) -> f64 {
        self.geometry.angular_momentum(ray.ray).along
    }

    /// Returns [`Self::lambda`] at a distance from a ray's place, in pixels along a unit vector: λ is linear in the
    /// direction, up to its length. Within a pixel the direction is nearly linear in the place.
    #[inline(always)]
    pub(super) fn lambda_along(&self, ray: &PlaceRay) -> impl Fn(f64, (f64, f64)) -> f64 + use<> {
        let PixelRay { z, ta, tb } = ray.ray;
        let scale =
            self.view.n_a() / ((z * z + ta * ta + tb * tb).sqrt() * self.view.slope_scale());
        let [right, down] = self.view.changes_at(ray.point.0, ray.point.1);
        move |distance, (x, y)| (tb + distance * (x * right.tb + y * down.tb)) * scale
    }

    /// Returns the redshift g of light with the angular momentum `lambda` from the ring at u.
    #[inline(always)]
    pub(super) fn redshift(&self, u: f64, lambda: f64) -> f64 {
        redshift(u, self.clock_rate, lambda)
    }

    /// Returns the amplitude `g² √(F/F_max)`.
    #[inline(always)]
    pub(super) fn amplitude(&self, u: f64, lambda: f64) -> f64 {
        let g = self.redshift(u, lambda);
        g * g * self.flux.signed_root(u)
    }

    /// Returns the order in front along a ray.
    #[inline]
    pub(super) fn front(&self, ray: &PlaceRay) -> Option<u32> {
        let PlaceRay { ray, s, .. } = *ray;
        let (n, d) = (self.view.n_p().abs() * s, self.view.plane_slope() * ray.ta);
        if s > 0.0 {
            self.curves.front(ray.z, s, n, d)
        } else {
            None
        }
    }

    /// Returns the order in front at a place.
    pub(super) fn front_at(&self, place: (f64, f64)) -> Option<u32> {
        front(self.view, self.curves, place)
    }

    /// Returns the share of a pixel's square that the hole's shadow covers, the pixel's centre at a place.
    pub(super) fn shadow(&self, place: (f64, f64)) -> f64 {
        shadow::share(self.view, self.curves.critical(), place)
    }

    /// Returns whether the hole's shadow covers a place.
    pub(super) fn shadow_covers(&self, place: (f64, f64)) -> bool {
        shadow::covers(self.view, self.curves.critical(), place)
    }

    /// Returns the order that is told of what the curves call `order`, along a ray.
    ///
    /// They differ where the camera is in the disk's plane: rays towards one side of the hole meet it at `kπ`, those
    /// towards the other at `(k + 1)π`. The first crossing of both is at π.
    #[inline]
    pub(super) fn told(&self, order: u32, ray: &PlaceRay) -> u32 {
        if self.is_in_plane && ray.meets.quarter == 0 {
            order.saturating_sub(1)
        } else {
            order
        }
    }
}

/// Returns the nearest of the inverse radii between two. What is not a number becomes the first: seen from within the
/// disk's plane, a sliver of the direct image may belong to a pixel whose own ray never meets the disk.
#[inline]
fn within(u: f64, (outer, inner): (f64, f64)) -> f64 {
    u.max(outer).min(inner)
}
