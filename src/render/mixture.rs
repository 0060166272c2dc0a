//! What a partly covered pixel shows: the mean over the covered part of its square.
//!
//! # Derivation
//! Within a pixel what an order shows changes across its edges, and hardly along them. So the mean is taken along one
//! line through the pixel's centre, at a right angle to the nearest edge, with the length of the square's section there
//! as weight: a trapezium. Edges are where `f = h − h_edge(x)` is 0, with `h = κ − κ_c`; to first order an edge is at
//! the distance `−f/|∇f|` from the centre. How much of the square is covered is known exactly from the cells. Where
//! the line tells something else, the edges are too bent for it. Then, and where the whole disk is small, the square is
//! taken apart into smaller ones, each with a line of its own.

use super::section::Section;
use super::shader::{PlaceRay, Shader};
use crate::isoradial::Boundary;

/// The line may be this far from the true share.
const WRONG: f64 = 0.05;

/// Parts of a side of a pixel where the line is not enough.
const SIDE: usize = 6;

/// A boundary near a pixel.
#[derive(Debug, Clone, Copy, Default)]
struct Near {
    /// `κ − κ_c` on it at the pixel's x.
    h: f64,
    /// How far it is from the pixel's centre, towards the hole's direction, in pixels.
    distance: f64,
    /// `|∇(h − h_edge)|`, by which the distance was measured.
    per_pixel: f64,
    /// The unit vector towards the hole's direction, at a right angle to it.
    normal: (f64, f64),
}

/// A square of the picture, and what is near.
pub(super) struct Mixture<'a> {
    pub(super) shader: &'a Shader<'a>,
    place: (f64, f64),
    /// The side of the square, in pixels.
    side: f64,
    pub(super) ray: PlaceRay,
    /// How κ and x change from a pixel to the next, across and down.
    change: [(f64, f64); 2],
    /// The boundaries at the centre's azimuth, by rising κ.
    boundaries: &'a [Boundary],
}

/// Nodes and weights of Gauss and Legendre's quadrature over −1 to 1.
const TWO: [(f64, f64); 2] = [
    (-0.577_350_269_189_625_8, 1.0),
    (0.577_350_269_189_625_8, 1.0),
];
const FIVE: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

impl<'a> Mixture<'a> {
    /// Prepares the pixel with its centre at a place.
    pub(super) fn new(shader: &'a Shader<'a>, place: (f64, f64)) -> Self {
        Self::of_square(shader, place, 1.0)
    }

    /// Prepares a square with its centre at a place.
    fn of_square(shader: &'a Shader<'a>, place: (f64, f64), square: f64) -> Self {
        let ray = shader.ray(place);
        let view = shader.view;
        let side = view.pixel_side();
        let (z, ta, tb) = (view.z(), view.ta(), view.tb());
        let s = ray.s;
        let kappa = ray.ray.z / s;
        let (n_p, d_a) = (view.n_p().abs(), view.plane_slope());
        let (n, d) = (n_p * s, d_a * ray.ray.ta);
        let total = n + d.abs();
        let gradient = |z: f64, ta: f64, tb: f64| {
            let s_change = (ray.ray.ta * ta + ray.ray.tb * tb) / s;
            let (n_change, d_change) = (n_p * s_change, d_a * ta);
            let d_size_change = d_change.abs() * (d * d_change).signum();
            // x = N/(N + D) ahead, |D|/(N + |D|) beyond.
            let x_change = if d < 0.0 {
                (n * d_size_change - d.abs() * n_change) / (total * total)
            } else {
                (d * n_change - n * d_size_change) / (total * total)
            };
            ((z - kappa * s_change) / s, x_change)
        };
        let along_x = gradient(z.per_x * side, ta.per_x * side, tb.per_x * side);
        let along_y = gradient(-z.per_y * side, -ta.per_y * side, -tb.per_y * side);
        let sectors = shader.curves.sectors(ray.meets.quarter);
        let x = ray.meets.x;
        let sector = sectors
            .iter()
            .find(|sector| x <= sector.x.1)
            .or(sectors.last());
        Self {
            shader,
            place,
            side: square,
            ray,
            change: [along_x, along_y],
            boundaries: sector.map_or(&[][..], |sector| &sector.boundaries),
        }
    }

    /// Where a boundary is.
    #[inline]
    fn near(&self, boundary: &Boundary) -> Near {
        let meets = self.ray.meets;
        let piece = &self.shader.curves.quarter(meets.quarter)[boundary.piece];
        let [kept, kept_slope] = piece.value_and_slope(boundary.edge, meets.x);
        let (h, slope) = if piece.has_pole() {
            let h = kept / meets.x;
            (h, (kept_slope - h) / meets.x)
        } else {
            (kept, kept_slope)
        };
        let [across, down] = self.change.map(|(kappa, x)| kappa - slope * x);
        let per_pixel = (down * down + across * across).sqrt();
        Near {
            h,
            distance: (h - self.ray.h) / per_pixel,
            per_pixel,
            normal: (across / per_pixel, down / per_pixel),
        }
    }

    /// Returns the mean of what an order shows over its part of the square, which is `share`. `colour` is of an
    /// amplitude.
    pub(super) fn mean(
        &self,
        order: u32,
        share: f64,
        colour: impl Fn(f64) -> [f32; 3],
    ) -> [f32; 3] {
        let mut parts = self.shader.fineness;
        if parts == 1 {
            let (sum, covered) = self.along_line(order, &colour);
            if (covered - share).abs() <= WRONG && covered > 0.0 {
                return sum.map(|c| c / covered as f32);
            }
            parts = SIDE;
        }
        let mut total = [0.0; 3];
        let mut all_covered = 0.0;
        for i in 0..parts * parts {
            let offset = |i: usize| (i as f64 + 0.5) / parts as f64 - 0.5;
            let place = (
                self.place.0 + offset(i % parts),
                self.place.1 + offset(i / parts),
            );
            let part = Mixture::of_square(self.shader, place, 1.0 / parts as f64);
            let (sum, covered) = part.along_line(order, &colour);
            for (total, c) in total.iter_mut().zip(sum) {
                *total += c;
            }
            all_covered += covered;
        }
        if all_covered > 0.0 {
            return total.map(|c| c / all_covered as f32);
        }
        let u = self.shader.u_on_disk(order, &self.ray);
        colour(self.shader.amplitude(u, self.shader.lambda(&self.ray)))
    }

    /// Returns the share of the square that an order covers, and the colours' mean over it times that share, along the
    /// line through the centre.
    fn along_line(&self, order: u32, colour: &impl Fn(f64) -> [f32; 3]) -> ([f32; 3], f64) {
        let mut sum = [0.0; 3];
        let mut all_covered = 0.0;
        if self.ray.s <= 0.0 {
            return (sum, 0.0);
        }
        let u_at = self.shader.u_along(order, &self.ray);
        let lambda = self.shader.lambda_along(&self.ray);
        for pair in self.boundaries.windows(2) {
            if pair[0].above != Some(order) {
                continue;
            }
            let (low, high) = (self.near(&pair[0]), self.near(&pair[1]));
            let is_low = low.distance.abs() < high.distance.abs();
            let normal = if is_low { low.normal } else { high.normal };
            let section = Section::new(normal, self.side);
            let (from, to) = (
                low.distance.max(-section.far),
                high.distance.min(section.far),
            );
            if from >= to || (to - from).is_nan() {
                continue;
            }
            let covered = section.share_below(to) - section.share_below(from);
            let is_thin = to - from > 0.03 * (high.distance - low.distance);
            let nodes = if is_thin { &FIVE[..] } else { &TWO[..] };
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let (mut stretch, mut weights) = ([0.0; 3], 0.0);
            for (node, weight) in nodes {
                let t = middle + half * node;
                let weight = (weight * section.length(t)) as f32;
                // Each edge's distance has a scale of its own. At t = 0 this is the ray's h.
                let above = (t - low.distance) * low.per_pixel;
                let below = (high.distance - t) * high.per_pixel;
                let h = low.h + (high.h - low.h) * above / (above + below);
                let rgb = colour(self.shader.amplitude(u_at(h), lambda(t, normal)));
                for (sum, c) in stretch.iter_mut().zip(rgb) {
                    *sum += weight * c;
                }
                weights += weight;
            }
            if weights > 0.0 {
                for (sum, c) in sum.iter_mut().zip(stretch) {
                    *sum += c * (covered as f32 / weights);
                }
                all_covered += covered;
            }
        }
        (sum, all_covered)
    }

    /// Returns the order and the ray of the centre, or of the covered place that is nearest to it.
    pub(super) fn nearest_covered(&self) -> Option<(u32, PlaceRay)> {
        if let Some(order) = self.shader.front(&self.ray) {
            return Some((order, self.ray));
        }
        let covering = self.boundaries.iter().filter_map(|boundary| {
            let order = boundary.above.or(boundary.below)?;
            Some((order, self.near(boundary)))
        });
        let (order, near) =
            covering.min_by(|a, b| a.1.distance.abs().total_cmp(&b.1.distance.abs()))?;
        let place = (
            self.place.0 + near.distance * near.normal.0,
            self.place.1 + near.distance * near.normal.1,
        );
        Some((order, self.shader.ray(place)))
    }

    /// Returns the share of the pixel that the hole's shadow covers.
    pub(super) fn shadow(&self) -> f64 {
        self.shader.shadow(self.place)
    }
}
