//! The discs that mark the points before and behind the hole.

use std::f64::consts::PI;

use glam::DVec3;

use super::lines::from_nearest_integer;
use super::polygon::{area_in_circle, cross, dot, edges};

/// A disc's radius, in degrees.
pub(super) const RADIUS: f64 = 2.0;

/// A filled disc.
#[derive(Debug, Clone)]
pub(super) struct Mark {
    /// Its centre's place.
    u: f64,
    pub(super) v: f64,
    sin_latitude: f64,
    cos_latitude: f64,
    colour: [f64; 3],
}

impl Mark {
    pub(super) fn new(centre: DVec3, colour: [f64; 3]) -> Self {
        let sin_latitude = centre.z.clamp(-1.0, 1.0);
        Self {
            u: 0.5 - libm::atan2(centre.y, centre.x) / (2.0 * PI),
            v: 0.5 + libm::asin(sin_latitude) / PI,
            sin_latitude,
            cos_latitude: (1.0 - sin_latitude * sin_latitude).sqrt(),
            colour,
        }
    }

    // Inlined, its trigonometry would be computed for every pixel ahead of the test.
    #[inline(never)]
    pub(super) fn paint_over(
        &self,
        colour: &mut [f64; 4],
        place: [f64; 2],
        along_u: [f64; 2],
        along_v: [f64; 2],
    ) {
        let share = self.share(place, along_u, along_v);
        let [red, green, blue] = self.colour;
        for (below, above) in colour.iter_mut().zip([red, green, blue, 1.0]) {
            *below += share * (above - *below);
        }
    }

    /// Returns the share of the footprint that lies in the disc.
    ///
    /// The sky is seen from far above the footprint's centre (orthographic projection), where the disc is a disc but
    /// for the curvature of the sky across 2°, and the footprint a parallelogram.
    fn share(&self, [u, v]: [f64; 2], along_u: [f64; 2], along_v: [f64; 2]) -> f64 {
        const RADIUS_SINE: f64 = 0.034_899_496_702_500_97;
        let latitude = v - 0.5;
        let (sin_latitude, cos_latitude) = sin_cos_half_turns(latitude);
        let (sin_longitude, cos_longitude) =
            sin_cos_half_turns(2.0 * from_nearest_integer(u - self.u));
        let towards_sight =
            self.sin_latitude * sin_latitude + self.cos_latitude * cos_latitude * cos_longitude;
        // Coordinates towards growing u and growing v.
        let centre = [
            -self.cos_latitude * sin_longitude,
            self.sin_latitude * cos_latitude - self.cos_latitude * sin_latitude * cos_longitude,
        ];
        let [mut x, mut y] =
            [0, 1].map(|side| [2.0 * PI * cos_latitude * along_u[side], PI * along_v[side]]);
        let (x_square, y_square) = (dot(x, x), dot(y, y));
        let distance = dot(centre, centre).sqrt();
        let reach = 0.5 * (x_square.sqrt() + y_square.sqrt());
        if towards_sight <= 0.0 || distance >= RADIUS_SINE + reach {
            return 0.0;
        }
        if distance + reach <= RADIUS_SINE {
            return 1.0;
        }
        let mut area = cross(x, y);
        if area.abs() <= 1e-7 * x_square.max(y_square) {
            // A footprint without area becomes a thin one.
            let thin = |[a0, a1]: [f64; 2], [b0, b1]: [f64; 2]| [a0 + 1e-6 * b1, a1 - 1e-6 * b0];
            (x, y) = (thin(x, y), thin(y, [-x[0], -x[1]]));
            area = cross(x, y);
        }
        let corner = |s: f64, t: f64| [0, 1].map(|i| s * x[i] + t * y[i] - centre[i]);
        let corners = [
            corner(-0.5, -0.5),
            corner(0.5, -0.5),
            corner(0.5, 0.5),
            corner(-0.5, 0.5),
        ];
        let covered = edges(&corners).map(|(start, end)| area_in_circle(RADIUS_SINE, start, end));
        (covered.sum::<f64>() / area).clamp(0.0, 1.0)
    }
}

/// Returns the sine and cosine of π `x`, to 1e-9 for |x| up to 1.
#[inline(always)]
pub(super) fn sin_cos_half_turns(x: f64) -> (f64, f64) {
    // Taylor's series of a sine and a cosine up to π/2.
    let y = 0.5 * PI * x;
    let square = y * y;
    let factor = |product: f64, rest: f64| 1.0 - square * (1.0 / product) * rest;
    let sine = y * [210.0, 156.0, 110.0, 72.0, 42.0, 20.0, 6.0]
        .into_iter()
        .fold(1.0, |rest, product| factor(product, rest));
    let cosine = [240.0, 182.0, 132.0, 90.0, 56.0, 30.0, 12.0, 2.0]
        .into_iter()
        .fold(1.0, |rest, product| factor(product, rest));
    (2.0 * sine * cosine, 1.0 - 2.0 * sine * sine)
}
