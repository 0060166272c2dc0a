//! What a partly covered pixel shows: the mean over the covered part of its square.
//!
//! # Derivation
//! Within a pixel what an order shows changes across its edges, and hardly along them. So the mean is taken along one
//! line through the pixel's centre, at a right angle to the nearest edge, with the length of the square's section there
//! as weight: a trapezium. Edges are where `f = h − h_edge(x)` is 0, with `h = κ − κ_c`; to first order an edge is at
//! the distance `−f/|∇f|` from the centre.
//!
//! That holds where x hardly changes within the pixel and edges are straight there. How much of the square is covered
//! is known from the cells, so that a line that tells something else is found out. Then the square is halved until
//! halves change its light no more, each time along the axis that changes it most. Coarse pixels always are.

use super::section::Section;
use super::shader::{PlaceRay, Shader};
use crate::isoradial::Boundary;
use crate::scene::PixelRay;

/// A line may be this far from the true share.
const WRONG: f64 = 0.1;

/// Where x changes by more than this within a pixel, one line is not enough.
const FAST: f64 = 0.08;

/// Beside [`Shader::light_tolerance`] a pixel's light may be off by this much of the hottest ring's.
const ABSOLUTE: f64 = 1e-5;

/// Where no edge is near, light may change along a line by this multiple of what it may be off.
const EVEN: f64 = 4.0;

/// An edge is not near if it is farther away than this multiple of half a diagonal.
const CLEAR: f64 = 2.0;

/// A pixel's parts have at least this area.
const LEAST_AREA: f64 = 1.0 / 16384.0;

/// And at least this width and height.
const LEAST_SIDE: f64 = 1.0 / 256.0;

/// An order that shows more than this share of its width has five nodes.
const THIN: f64 = 0.03;

/// Where the light at two nodes differs by more than this share of their sum, five are used.
const STEEP: f32 = 0.2;

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

/// A pixel's square or a part of it, and what is near.
pub(super) struct Mixture<'a> {
    pub(super) shader: &'a Shader<'a>,
    /// Its centre.
    place: (f64, f64),
    /// Its width and height, in pixels.
    sides: (f64, f64),
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
        Self::of_part(shader, place, (1.0, 1.0))
    }

    /// Prepares a part with its centre at a place.
    fn of_part(shader: &'a Shader<'a>, place: (f64, f64), sides: (f64, f64)) -> Self {
        let ray = shader.ray(place);
        let view = shader.view;
        let s = ray.s;
        let kappa = ray.ray.z / s;
        let (n_p, d_a) = (view.n_p().abs(), view.plane_slope());
        let (n, d) = (n_p * s, d_a * ray.ray.ta);
        let total = n + d.abs();
        let gradient = |PixelRay { z, ta, tb }| {
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
        let sectors = shader.curves.sectors(ray.meets.quarter);
        let x = ray.meets.x;
        let sector = sectors
            .iter()
            .find(|sector| x <= sector.x.1)
            .or(sectors.last());
        Self {
            shader,
            place,
            sides,
            ray,
            change: view.changes_at(ray.point.0, ray.point.1).map(gradient),
            boundaries: sector.map_or(&[][..], |sector| &sector.boundaries),
        }
    }

    /// How much x changes, at most.
    fn x_change(&self) -> f64 {
        let [across, down] = self.change.map(|(_, x)| x.abs());
        across * self.sides.0 + down * self.sides.1
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

    /// Returns the mean of what an order shows over its part of the pixel, which is `share`. `colour` is of an
    /// amplitude.
    pub(super) fn mean(
        &self,
        order: u32,
        share: f64,
        colour: impl Fn(f64) -> [f32; 3],
    ) -> [f32; 3] {
        let line = self.along_line(order, &colour);
        let is_right = (line.covered - share).abs() <= WRONG && line.covered > 0.0;
        let shader = self.shader;
        let total = if is_right && self.x_change() <= FAST && !shader.is_coarse {
            line
        } else {
            let about = share * line.mean_size();
            self.in_parts(order, shader.light_tolerance * about + ABSOLUTE, &colour)
        };
        if total.covered > 0.0 {
            return total.light.map(|c| c / total.covered as f32);
        }
        let (_, ray) = self
            .nearest_covered_by(Some(order))
            .unwrap_or((order, self.ray));
        let u = shader.u_on_disk(order, &ray);
        colour(shader.amplitude(u, limited(shader.lambda(&ray), u)))
    }

    /// Returns what an order shows of the pixel, cut into as many parts as the view asks for, each of them
    /// [refined](Self::refined).
    fn in_parts(&self, order: u32, allowed: f64, colour: &impl Fn(f64) -> [f32; 3]) -> Total {
        let parts = self.shader.least_parts;
        let side = 1.0 / parts as f64;
        let offset = |i: usize| (i as f64 + 0.5) * side - 0.5;
        let mut total = Total::default();
        for i in 0..parts * parts {
            let part = self.part((offset(i % parts), offset(i / parts)), (side, side));
            let line = part.along_line(order, colour);
            total.add(part.refined(order, line, allowed, colour), side * side);
        }
        total
    }

    /// A part of it, with its centre at a distance from its own.
    fn part(&self, (right, down): (f64, f64), sides: (f64, f64)) -> Self {
        let place = (self.place.0 + right, self.place.1 + down);
        Self::of_part(self.shader, place, sides)
    }

    /// Returns what [`Self::along_line`] would if the part were cut into ever smaller ones. `line` is what it returns.
    /// A whole pixel's light may be off by about `allowed`.
    fn refined(
        &self,
        order: u32,
        line: Total,
        allowed: f64,
        colour: &impl Fn(f64) -> [f32; 3],
    ) -> Total {
        let (width, height) = self.sides;
        let area = width * height;
        // A line through the centre is exact where the light is linear.
        let is_even = f64::from(line.change) * area.sqrt() <= EVEN * allowed;
        if is_even || area < 2.0 * LEAST_AREA {
            return line;
        }
        let halves = |sides: (f64, f64), step: (f64, f64)| {
            [-1.0, 1.0].map(|sign| {
                let half = self.part((sign * step.0, sign * step.1), sides);
                let line = half.along_line(order, colour);
                (half, line)
            })
        };
        let cuts = [
            (width >= 2.0 * LEAST_SIDE).then(|| halves((0.5 * width, height), (0.25 * width, 0.0))),
            (height >= 2.0 * LEAST_SIDE)
                .then(|| halves((width, 0.5 * height), (0.0, 0.25 * height))),
        ];
        let mut chosen: Option<(f64, Total, _)> = None;
        for halves in cuts.into_iter().flatten() {
            let mut sum = Total::default();
            for (_, line) in &halves {
                sum.add(*line, 0.5);
            }
            let off = f64::from(apart(sum.light, line.light));
            if chosen.as_ref().is_none_or(|(worst, ..)| off > *worst) {
                chosen = Some((off, sum, halves));
            }
        }
        let Some((off, sum, halves)) = chosen else {
            return line;
        };
        // The errors of small parts are as often positive as negative.
        if off * area.sqrt() <= allowed {
            return sum;
        }
        let mut total = Total::default();
        for (half, line) in halves {
            total.add(half.refined(order, line, allowed, colour), 0.5);
        }
        total
    }

    /// Returns what an order shows of the part, along the line through its centre.
    fn along_line(&self, order: u32, colour: &impl Fn(f64) -> [f32; 3]) -> Total {
        let mut total = Total::default();
        if self.ray.s <= 0.0 {
            total.change = f32::INFINITY;
            return total;
        }
        if self.x_change() > FAST {
            total.change = f32::INFINITY;
        }
        let u_at = self.shader.u_along(order, &self.ray);
        let lambda = self.shader.lambda_along(&self.ray);
        for pair in self.boundaries.windows(2) {
            if pair[0].above != Some(order) {
                continue;
            }
            let (low, high) = (self.near(&pair[0]), self.near(&pair[1]));
            // From within the disk's plane the direct image over a quarter turn is at the camera itself.
            if !(high.h - low.h).is_finite() {
                continue;
            }
            let is_low = low.distance.abs() < high.distance.abs();
            let normal = if is_low { low.normal } else { high.normal };
            let section = Section::new(normal, self.sides);
            let (from, to) = (
                low.distance.max(-section.far),
                high.distance.min(section.far),
            );
            let is_near = |edge: Near| edge.distance.abs() < CLEAR * section.far;
            if is_near(low) || is_near(high) {
                total.change = f32::INFINITY;
            }
            if from >= to || (to - from).is_nan() {
                continue;
            }
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let at = |(node, weight): (f64, f64)| {
                let t = middle + half * node;
                // Each edge's distance has a scale of its own. At t = 0 this is the ray's h.
                let above = (t - low.distance) * low.per_pixel;
                let below = (high.distance - t) * high.per_pixel;
                let h = low.h + (high.h - low.h) * above / (above + below);
                let u = u_at(h);
                let light = colour(self.shader.amplitude(u, limited(lambda(t, normal), u)));
                (light, (weight * section.length(t)) as f32)
            };
            let is_thin = to - from > THIN * (high.distance - low.distance);
            let (mut mean, mut change) = (None, 0.0);
            if !is_thin {
                let two = TWO.map(at);
                let [(a, _), (b, _)] = two;
                change = apart(a, b);
                mean = (!is_steep(a, b)).then(|| mean_of(two));
            }
            let mean = mean.unwrap_or_else(|| {
                let five = FIVE.map(at);
                change = apart(five[0].0, five[4].0);
                mean_of(five)
            });
            total.change = total.change.max(change);
            total.add(
                Total {
                    light: mean,
                    covered: 1.0,
                    change: 0.0,
                },
                section.share_below(to) - section.share_below(from),
            );
        }
        total
    }

    /// Returns the order and the ray of the centre, or of the covered place that is nearest to it.
    pub(super) fn nearest_covered(&self) -> Option<(u32, PlaceRay)> {
        if let Some(order) = self.shader.front(&self.ray) {
            return Some((order, self.ray));
        }
        self.nearest_covered_by(None)
    }

    /// Returns a place that is covered, by this order or by any, as near to the centre as can be, where the centre is
    /// not.
    fn nearest_covered_by(&self, order: Option<u32>) -> Option<(u32, PlaceRay)> {
        let covering = self.boundaries.iter().filter_map(|boundary| {
            let covers = |of: &u32| order.is_none_or(|order| *of == order);
            let order = boundary
                .above
                .filter(covers)
                .or(boundary.below.filter(covers))?;
            Some((order, boundary, self.near(boundary)))
        });
        let nearest = covering.min_by(|a, b| a.2.distance.abs().total_cmp(&b.2.distance.abs()));
        if let Some((order, boundary, near)) = nearest
            && let Some(ray) = self.foot(boundary, near)
        {
            return Some((order, ray));
        }
        // The edge is too bent for its slope to lead there. So places all over the pixel are tried.
        let offset = |i: usize| (i as f64 + 0.5) / TRIED as f64 - 0.5;
        let places = (0..TRIED * TRIED).map(|i| (offset(i % TRIED), offset(i / TRIED)));
        let found = places.filter_map(|(right, down)| {
            let ray = self.shader.ray((self.place.0 + right, self.place.1 + down));
            let front = self.shader.front(&ray)?;
            let is_sought = order.is_none_or(|order| front == order);
            is_sought.then_some((right * right + down * down, front, ray))
        });
        let nearest = found.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, order, ray)| (order, ray))
    }

    /// Returns the ray of the place of a boundary that is nearest to the centre, by Newton's method; `None` where that
    /// leads out of the pixel.
    fn foot(&self, boundary: &Boundary, first: Near) -> Option<PlaceRay> {
        const FAR: f64 = 0.71;
        const NEAR: f64 = 0.003;
        let (mut place, mut near) = (self.place, first);
        for _ in 0..4 {
            place = (
                place.0 + near.distance * near.normal.0,
                place.1 + near.distance * near.normal.1,
            );
            let moved = (place.0 - self.place.0, place.1 - self.place.1);
            let is_within = moved.0.abs().max(moved.1.abs()) <= FAR;
            if !is_within {
                return None;
            }
            let there = Self::new(self.shader, place);
            if there.ray.meets.quarter != self.ray.meets.quarter {
                return None;
            }
            near = there.near(boundary);
            if near.distance.abs() <= NEAR {
                return Some(there.ray);
            }
        }
        None
    }

    /// Returns the share of the pixel that the hole's shadow covers.
    pub(super) fn shadow(&self) -> f64 {
        self.shader.shadow(self.place)
    }
}

/// Places a side of a pixel that are tried where no slope leads to the disk.
const TRIED: usize = 32;

/// Light over the covered part of an area, and how much of it is covered, both as shares of the area.
#[derive(Debug, Clone, Copy, Default)]
struct Total {
    light: [f32; 3],
    covered: f64,
    /// How much the light changes along the line, if no edge is near.
    change: f32,
}

impl Total {
    /// Adds a part that is this share of the area.
    fn add(&mut self, part: Self, share: f64) {
        for (sum, c) in self.light.iter_mut().zip(part.light) {
            *sum += c * share as f32;
        }
        self.covered += part.covered * share;
    }

    /// The greatest component of the mean light of what is covered.
    fn mean_size(&self) -> f64 {
        let size = self
            .light
            .iter()
            .fold(0.0, |size: f32, c| size.max(c.abs()));
        if self.covered > 0.0 {
            f64::from(size) / self.covered
        } else {
            0.0
        }
    }
}

/// The mean of light with weights.
fn mean_of<const N: usize>(nodes: [([f32; 3], f32); N]) -> [f32; 3] {
    let (mut sum, mut weights) = ([0.0; 3], 0.0);
    for (light, weight) in nodes {
        for (sum, c) in sum.iter_mut().zip(light) {
            *sum += weight * c;
        }
        weights += weight;
    }
    sum.map(|c| if weights > 0.0 { c / weights } else { 0.0 })
}

/// The greatest difference of two colours' components.
fn apart(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter()
        .zip(b)
        .fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// Whether light changes much from one node to the other.
fn is_steep(a: [f32; 3], b: [f32; 3]) -> bool {
    (0..3).any(|i| (a[i] - b[i]).abs() > STEEP * (a[i] + b[i]).abs() + STEEP * 0.05)
}

/// An angular momentum that light at u can have: no ray has a greater impact parameter than `1/(u √(1 − u))` there.
fn limited(lambda: f64, u: f64) -> f64 {
    if lambda.abs() * u <= 1.0 {
        return lambda;
    }
    let most = 1.0 / (u * (1.0 - u).sqrt());
    lambda.clamp(-most, most)
}
