//! The image of one order: where places of the disk's plane are seen, and what they show.
//!
//! # The azimuth along a curve
//! A curve of constant radius is a function of the azimuth α about the hole in the picture, and of the azimuth ϑ in the
//! disk's plane, with `tan ϑ = n tan α` and `n = |n·p̂|`. Near the disk's plane (n → 0) neither is a good parameter: α
//! hardly changes along the front and the back of the disk, ϑ hardly changes along its sides. Their mean s is. From
//! `tan ϑ = n tan α` follows `sin(α − ϑ) = m sin(α + ϑ)`, `m = (1 − n)/(1 + n)`, so that
//!
//! ```text
//! α = s + ½ asin(m sin 2s)
//! ```

use core::f64::consts::PI;

use kurbo::Point;

use crate::isoradial::{CurveSpec, Edge, height_at};
use crate::light::SightGeometry;
use crate::light::flux;
use crate::orbit::exact::Exact;
use crate::scene::{PixelRay, View};

/// The image of one order in a view.
pub(super) struct DiskImage<'a> {
    view: &'a View,
    order: u32,
    geometry: SightGeometry,
    /// m of the [module's page](self). Seen from the disk's plane φ is the same at all azimuths, and s is α.
    stretch: f64,
}

/// What is seen of one place of the disk's plane.
pub(super) struct SeenPlace {
    ray: PixelRay,
    u: f64,
    /// g, the ratio of observed to emitted frequency.
    redshift: f64,
}

impl SeenPlace {
    /// Returns g, the ratio of observed to emitted frequency.
    pub(super) fn redshift(&self) -> f64 {
        self.redshift
    }

    /// Returns `g⁴ F/F_max`, the observed bolometric flux.
    pub(super) fn flux(&self) -> f64 {
        let square = self.redshift * self.redshift;
        square * square * flux::relative(self.u)
    }
}

impl<'a> DiskImage<'a> {
    /// Prepares the image of order `order`, 0 for the direct image.
    pub(super) fn new(view: &'a View, order: u32) -> Self {
        let n = view.n_p().abs();
        Self {
            view,
            order,
            geometry: SightGeometry::new(view),
            stretch: if n > 0.0 { (1.0 - n) / (1.0 + n) } else { 0.0 },
        }
    }

    /// Returns the ray that meets the plane at inverse radius `u` and azimuth `s`. All s an integer multiple of 2π
    /// apart are one azimuth.
    pub(super) fn see(&self, u: f64, s: f64) -> SeenPlace {
        let alpha = s + 0.5 * libm::asin(self.stretch * libm::sin(2.0 * s));
        let (sine, cosine) = libm::sincos(alpha);
        let first = self.view.plane_crossing(cosine, 1.0);
        let first = if first > 0.0 { first } else { PI };
        let angle = first + f64::from(self.order) * PI;
        let mut spec = CurveSpec::all_round(self.view.u0(), self.view.slope_scale(), None);
        spec.u_edges = Some([u, u]);
        let kappa = spec.critical() + height_at(&spec, Edge::Inner, angle, &Exact);
        let ray = PixelRay {
            z: kappa,
            ta: cosine,
            tb: sine,
        };
        SeenPlace {
            ray,
            u,
            redshift: self.geometry.sight(ray, self.order, u).redshift,
        }
    }

    /// Returns where a place is seen, in pixels from the picture's left and top; `None` behind the camera.
    pub(super) fn point(&self, seen: &SeenPlace) -> Option<Point> {
        let point = Point::from(self.view.place_of(seen.ray)?);
        point.is_finite().then_some(point)
    }
}
