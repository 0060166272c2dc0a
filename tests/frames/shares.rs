//! The share of each pixel that the disk covers, without the renderer: from the curves alone, in two ways that have
//! nothing in common with it or with each other.
//!
//! *Swept*: the picture is cut into wedges about the hole's direction, on whose sides the curves say at which κ the
//! disk begins and ends. The union over the orders is one of intervals there; between two sides it is made of
//! quadrangles, which are cut at the pixels' sides. Wedges are halved until the edges between are chords to
//! [`SAGITTA`].
//!
//! *Counted*: a pixel's points on a lattice, each asked by itself.

use core::f64::consts::{PI, TAU};

use darkness::isoradial::{CurveSpec, Edge, Isoradials};
use darkness::orbit::path::SweptAngles;
use darkness::scene::{PixelRay, Scene, View};
use rayon::prelude::*;

/// How far a chord may be from the edge it stands for, in pixels: a pixel's share is off by no more than that times the
/// edge's length in it, some 1e-3.
const SAGITTA: f64 = 5e-4;

/// What a swept share may be off by: a pixel holds some 1.4 pixels of an edge.
pub(crate) const SWEPT: f64 = 1.4 * SAGITTA;

/// From one grey to the next.
pub(crate) const LEVEL: f64 = 1.0 / 255.0;

/// So many halvings of a wedge at most: where the union changes its kind the wedge left out has a width of `2π/256 /
/// 2^DEEPEST`.
const DEEPEST: u32 = 34;

/// So many parts of a stretch that is far too long for one.
const PARTS: u32 = 8;

/// A scene's view and curves.
pub(crate) struct Picture {
    pub(crate) view: View,
    pub(crate) curves: Isoradials,
}

/// One of the disk's images' edges: order, edge.
type Tag = (u32, bool);

/// Where the disk ends along a side of a wedge.
#[derive(Debug, Clone, Copy)]
struct End {
    tag: Tag,
    /// The angle to the hole's direction.
    psi: f64,
    /// `(w, w X, w Y)`, of length 1: the direction in the picture's coordinates.
    place: [f64; 3],
}

/// A stretch of a wedge's side that the disk covers.
type Stretch = [End; 2];

impl Picture {
    pub(crate) fn new(scene: &Scene, angles: &impl SweptAngles) -> Self {
        let view = View::new(scene);
        let spec = CurveSpec::new(scene, &view, scene.tolerance());
        let curves = Isoradials::new(&spec, angles);
        Self { view, curves }
    }

    pub(crate) fn width(&self) -> usize {
        self.view.width() as usize
    }

    pub(crate) fn height(&self) -> usize {
        self.view.height() as usize
    }

    pub(crate) fn orders(&self) -> Vec<u32> {
        let orders = self.curves.orders().iter();
        orders
            .map(darkness::isoradial::ImageOrder::number)
            .collect()
    }

    /// The share of each pixel that the union of the images of these orders covers: swept.
    pub(crate) fn swept(&self, orders: &[u32]) -> Vec<f64> {
        const WEDGES: u32 = 256;
        let (from, to) = self.azimuths();
        let at = |i: u32| from + (to - from) * f64::from(i) / f64::from(WEDGES);
        let size = self.width() * self.height();
        (0..WEDGES)
            .into_par_iter()
            .fold(
                || vec![0.0; size],
                |mut shares, i| {
                    let sides = [at(i), at(i + 1)];
                    let stretches = sides.map(|azimuth| self.side(azimuth, orders));
                    self.wedge(sides, &stretches, orders, DEEPEST, &mut shares);
                    shares
                },
            )
            .reduce(
                || vec![0.0; size],
                |mut a, b| {
                    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
                    a
                },
            )
    }

    /// The azimuths about the hole's direction that the picture shows.
    fn azimuths(&self) -> (f64, f64) {
        let (width, height) = (self.width() as f64, self.height() as f64);
        let azimuth = |column: f64, row: f64| {
            let ray = self.ray(column, row);
            libm::atan2(ray.tb, ray.ta)
        };
        let inside = |kappa: f64| {
            let [w, x, y] = self.place([kappa, 0.0, 0.0]);
            let (x, y) = (x / w, y / w);
            let (right, top) = (-self.view.x_at(-2.0), self.view.y_at(-2.0));
            w > 0.0 && x.abs() < right && y.abs() < top
        };
        if inside(1.0) || inside(-1.0) {
            return (-PI, PI);
        }
        // A rectangle that shows neither end of the axis shows no azimuth that is not between those of its corners.
        let middle = azimuth(0.5 * width, 0.5 * height);
        let turned = |column, row| {
            let turn = azimuth(column, row) - middle;
            turn - TAU * (turn / TAU).round()
        };
        let corners = [
            turned(-1.0, -1.0),
            turned(width + 1.0, -1.0),
            turned(-1.0, height + 1.0),
            turned(width + 1.0, height + 1.0),
        ];
        let least = corners.into_iter().fold(f64::INFINITY, f64::min);
        let most = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        (middle + least, middle + most)
    }

    fn ray(&self, column: f64, row: f64) -> PixelRay {
        self.view
            .ray_at(self.view.x_at(column), self.view.y_at(row))
    }

    /// A direction (inward, along â, along b̂) in the picture's coordinates, as a unit vector.
    fn place(&self, [z, a, b]: [f64; 3]) -> [f64; 3] {
        let length = (z * z + a * a + b * b).sqrt();
        let ray = PixelRay { z, ta: a, tb: b };
        self.view.direction_of(ray).map(|part| part / length)
    }

    /// κ of the outer and the inner edge in a direction across the line to the hole, that has the part `cosine` along
    /// â.
    pub(crate) fn edges(&self, order: u32, cosine: f64) -> Option<[f64; 2]> {
        let first = libm::atan2(self.view.n_p().abs(), self.view.plane_slope() * cosine);
        let kappa = |edge| Some(self.curves.critical() + self.curves.height(order, edge, first)?);
        Some([kappa(Edge::Outer)?, kappa(Edge::Inner)?])
    }

    /// The stretches of a half-circle of directions that the union of the orders' images covers.
    fn side(&self, azimuth: f64, orders: &[u32]) -> Vec<Stretch> {
        let (cosine, sine) = (libm::cos(azimuth), libm::sin(azimuth));
        let mut covered: Vec<[(f64, Tag); 2]> = orders
            .iter()
            .filter_map(|&order| {
                let [outer, inner] = self.edges(order, cosine)?;
                let valid = outer.is_finite() && inner.is_finite() && outer < inner;
                valid.then_some([(outer, (order, false)), (inner, (order, true))])
            })
            .collect();
        covered.sort_by(|a, b| a[0].0.total_cmp(&b[0].0));
        let mut union: Vec<[(f64, Tag); 2]> = Vec::new();
        for next in covered {
            match union.last_mut() {
                Some(last) if next[0].0 <= last[1].0 => {
                    if next[1].0 > last[1].0 {
                        last[1] = next[1];
                    }
                }
                _ => union.push(next),
            }
        }
        let end = |(kappa, tag): (f64, Tag)| End {
            tag,
            psi: libm::atan2(1.0, kappa),
            place: self.place([kappa, cosine, sine]),
        };
        union.into_iter().map(|stretch| stretch.map(end)).collect()
    }

    fn wedge(
        &self,
        sides: [f64; 2],
        stretches: &[Vec<Stretch>; 2],
        orders: &[u32],
        depth: u32,
        shares: &mut [f64],
    ) {
        let middle = 0.5 * (sides[0] + sides[1]);
        let between = self.side(middle, orders);
        let tags = |side: &[Stretch]| -> Vec<[Tag; 2]> {
            side.iter()
                .map(|stretch| stretch.map(|end| end.tag))
                .collect()
        };
        let alike = [&stretches[0], &stretches[1]]
            .iter()
            .all(|side| tags(side) == tags(&between));
        let [first, last] = stretches;
        if alike {
            let straight = (0..between.len()).all(|i| {
                (0..2).all(|end| {
                    let places = [&first[i], &between[i], &last[i]].map(|side| side[end].place);
                    self.is_chord(places)
                })
            });
            if straight || depth == 0 {
                for (a, b, azimuths) in [
                    (first, &between, [sides[0], middle]),
                    (&between, last, [middle, sides[1]]),
                ] {
                    for (&a, &b) in a.iter().zip(b) {
                        self.cover_stretches([a, b], azimuths, shares);
                    }
                }
                return;
            }
        } else if depth == 0 {
            return;
        }
        self.wedge(
            [sides[0], middle],
            &[first.clone(), between.clone()],
            orders,
            depth - 1,
            shares,
        );
        self.wedge(
            [middle, sides[1]],
            &[between, last.clone()],
            orders,
            depth - 1,
            shares,
        );
    }

    /// Whether the second of three places is on the chord of the others, as far as the picture shows.
    fn is_chord(&self, places: [[f64; 3]; 3]) -> bool {
        // A place behind the camera has no point in the picture; its wedge is halved until what is left of it is small.
        const NARROW: f64 = 1e-3;
        if places.iter().any(|place| place[0] < 1e-3) {
            let [a, _, b] = places;
            let all_behind = places.iter().all(|place| place[0] < -1e-3);
            let apart = a
                .iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            return all_behind || apart < NARROW;
        }
        let points = places.map(|place| self.point(place));
        let (width, height) = (self.view.width().into(), self.view.height().into());
        let beyond = |axis: usize, most: f64| {
            points.iter().all(|point| point[axis] < -5.0)
                || points.iter().all(|point| point[axis] > most + 5.0)
        };
        if beyond(0, width) || beyond(1, height) {
            return true;
        }
        let [a, middle, b] = points;
        let along = [b[0] - a[0], b[1] - a[1]];
        let away = [middle[0] - a[0], middle[1] - a[1]];
        let length = libm::hypot(along[0], along[1]);
        let off = if length > 0.0 {
            (along[0] * away[1] - along[1] * away[0]).abs() / length
        } else {
            libm::hypot(away[0], away[1])
        };
        // An edge that is on the whole less bent has its middle within its chord.
        off <= SAGITTA && libm::hypot(away[0], away[1]) <= length + SAGITTA
    }

    /// A direction's column and row.
    fn point(&self, [w, x, y]: [f64; 3]) -> [f64; 2] {
        let side = self.view.pixel_side();
        [
            0.5 * f64::from(self.view.width()) + x / w / side,
            0.5 * f64::from(self.view.height()) - y / w / side,
        ]
    }

    /// Covers what is between two stretches, in parts that are far from half-circles: those have no sides.
    fn cover_stretches(&self, stretches: [Stretch; 2], azimuths: [f64; 2], shares: &mut [f64]) {
        let long = stretches
            .iter()
            .any(|[outer, inner]| outer.psi - inner.psi > 0.5);
        if !long {
            let [a, b] = stretches;
            return self.cover(&[a[0], a[1], b[1], b[0]].map(|end| end.place), shares);
        }
        let at = |side: usize, part: u32| {
            let [outer, inner] = stretches[side].map(|end| end.psi);
            let psi = outer + (inner - outer) * f64::from(part) / f64::from(PARTS);
            let (across, inward) = libm::sincos(psi);
            let (sine, cosine) = libm::sincos(azimuths[side]);
            self.place([inward, across * cosine, across * sine])
        };
        for part in 0..PARTS {
            let corners = [at(0, part), at(0, part + 1), at(1, part + 1), at(1, part)];
            self.cover(&corners, shares);
        }
    }

    /// Adds a quadrangle's area to the pixels it lies in.
    fn cover(&self, corners: &[[f64; 3]; 4], shares: &mut [f64]) {
        const BEHIND: f64 = 1e-4;
        let ahead = cut(corners, |place| place[0] - BEHIND, mixed);
        let points: Vec<[f64; 2]> = ahead.into_iter().map(|place| self.point(place)).collect();
        let range = |points: &[[f64; 2]], axis: usize, most: usize| {
            let (low, high) = points
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                    (low.min(p[axis]), high.max(p[axis]))
                });
            let whole = |place: f64| place.max(0.0).min(most as f64) as usize;
            whole(low.floor())..whole(high.ceil())
        };
        for row in range(&points, 1, self.height()) {
            let strip = between(&points, 1, row as f64);
            for column in range(&strip, 0, self.width()) {
                let piece = between(&strip, 0, column as f64);
                shares[row * self.width() + column] += area(&piece);
            }
        }
    }

    /// The share of a pixel, counted.
    pub(crate) fn counted(&self, column: usize, row: usize, lattice: Lattice) -> f64 {
        let hits = lattice
            .points()
            .filter(|(x, y)| self.meets(column as f64 + x, row as f64 + y))
            .count();
        hits as f64 / f64::from(lattice.count)
    }

    /// The shares of all pixels, counted.
    pub(crate) fn all_counted(&self, lattice: Lattice) -> Vec<f64> {
        let width = self.width();
        (0..width * self.height())
            .into_par_iter()
            .map(|k| self.counted(k % width, k / width, lattice))
            .collect()
    }

    /// Whether the disk is seen at a point of the picture.
    pub(crate) fn meets(&self, column: f64, row: f64) -> bool {
        let ray = self.ray(column, row);
        let s = ray.transverse();
        let (n, d) = (self.view.n_p().abs() * s, self.view.plane_slope() * ray.ta);
        s > 0.0 && self.curves.meets(ray.z, s, n, d)
    }
}

/// A lattice of Fibonacci's: of all lattices of as many points the one on which a straight edge's area is counted best
/// (Niederreiter 1992, *Random Number Generation and Quasi-Monte Carlo Methods*, §5.1).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    count: u32,
    step: u32,
}

impl Lattice {
    pub(crate) const FINE: Self = Self {
        count: 4181,
        step: 2584,
    };

    fn points(self) -> impl Iterator<Item = (f64, f64)> {
        let count = f64::from(self.count);
        (0..self.count).map(move |i| {
            let place = (f64::from(i) + 0.5) / count;
            (place, (place * f64::from(self.step)).fract())
        })
    }
}

/// The part of a convex polygon on which an affine function is positive.
fn cut<const N: usize>(
    corners: &[[f64; N]],
    side: impl Fn(&[f64; N]) -> f64,
    mix: impl Fn(&[f64; N], &[f64; N], f64) -> [f64; N],
) -> Vec<[f64; N]> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (i, a) in corners.iter().enumerate() {
        let b = &corners[(i + 1) % corners.len()];
        let (at_a, at_b) = (side(a), side(b));
        if at_a >= 0.0 {
            kept.push(*a);
        }
        if (at_a >= 0.0) != (at_b >= 0.0) {
            kept.push(mix(a, b, at_a / (at_a - at_b)));
        }
    }
    kept
}

fn mixed<const N: usize>(a: &[f64; N], b: &[f64; N], share: f64) -> [f64; N] {
    core::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}

/// The part of a polygon between two of the pixels' sides.
fn between(points: &[[f64; 2]], axis: usize, from: f64) -> Vec<[f64; 2]> {
    let above = cut(points, |point| point[axis] - from, mixed);
    cut(&above, |point| from + 1.0 - point[axis], mixed)
}

fn area(points: &[[f64; 2]]) -> f64 {
    let Some(origin) = points.first() else {
        return 0.0;
    };
    let doubled: f64 = points
        .windows(2)
        .map(|pair| {
            let [a, b] =
                [pair[0], pair[1]].map(|point| [point[0] - origin[0], point[1] - origin[1]]);
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    0.5 * doubled.abs()
}

/// How far a picture is from the shares it ought to show, in parts of full scale.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Errors {
    /// Root mean square, over all pixels.
    pub(crate) rms: f64,
    /// The greatest, and where: column, row.
    pub(crate) worst: f64,
    pub(crate) at: (usize, usize),
    /// The mean.
    pub(crate) bias: f64,
    /// How many pixels an edge passes.
    pub(crate) edge: usize,
}

impl Errors {
    pub(crate) fn new(pixels: &[u8], shares: &[f64], width: usize) -> Self {
        assert_eq!(pixels.len(), shares.len());
        let errors: Vec<f64> = pixels
            .iter()
            .zip(shares)
            .map(|(&pixel, &share)| f64::from(pixel) / 255.0 - share)
            .collect();
        let count = errors.len() as f64;
        let worst = (0..errors.len())
            .max_by(|&a, &b| errors[a].abs().total_cmp(&errors[b].abs()))
            .unwrap_or(0);
        Self {
            rms: (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt(),
            worst: errors[worst].abs(),
            at: (worst % width, worst / width),
            bias: errors.iter().sum::<f64>() / count,
            edge: shares
                .iter()
                .filter(|&&share| share > 1e-6 && share < 1.0 - 1e-6)
                .count(),
        }
    }

    pub(crate) fn print(&self, name: &str) {
        println!(
            "{name}: root mean square {:.5}, worst {:.4} at {:?}, mean {:+.6}, {} pixels on edges",
            self.rms, self.worst, self.at, self.bias, self.edge
        );
    }
}

/// A scene's text, with +z up and as the disk's normal.
pub(crate) fn described(
    position: [f64; 3],
    focus: [f64; 3],
    fov: f64,
    (inner, outer): (f64, f64),
    (width, height): (u32, u32),
) -> String {
    format!(
        "[camera]\nposition = {position:?}\nfocus = {focus:?}\nup = [0.1, 0.2, 1.0]\nfov = {fov:?}\n\
         [disk]\ninner = {inner:?}\nouter = {outer:?}\n[image]\nwidth = {width}\nheight = {height}\n"
    )
}
