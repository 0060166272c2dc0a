//! The images of stars in a frame.
//!
//! # Roots
//! A star is seen wherever a ray leaves towards it. With θ its angle from p̂ these are the rays in the plane of p̂ and
//! the star that sweep `θ, 2π − θ, 2π + θ, 4π − θ, …`, alternately on its side of the hole and on the other one: one
//! image for each order, since the swept angle falls strictly with the angle from the hole's direction.
//!
//! # Light
//! An image is magnified by `|sin ψ dψ/(sin Φ dΦ)|` in solid angle, and its irradiance with it, since lensing keeps
//! radiance. That is infinite straight behind the hole, and straight before it for all orders but the first. There a
//! star of angular radius ρ is seen as a ring of the area `2π sin ψ ρ/|dΦ/dψ|` for each order, so that the
//! magnification is at most `2 sin ψ/(ρ |dΦ/dψ|)`.
//!
//! An image falls on the square of one pixel, centred on its place, and each pixel gets its share of the irradiance
//! over its own solid angle. So the sum over pixels does not depend on where between them the image falls.

use core::f64::consts::{PI, TAU};

use rayon::prelude::*;

use super::shader::SkyShader;
use crate::isoradial::{EscapeCurve, Image};
use crate::render::frame::Threads;
use crate::render::tiles::{TileRow, tiles_of};
use crate::scene::{PixelRay, Projection, Region, View};
use crate::sky::{Star, StarField};

/// Brighter images count as this bright, so that sums of 32 bits stay finite.
const BRIGHTEST: f64 = 1e30;

/// Nearer than this to straight before the hole, in radians, the magnification is that on the axis.
const AXIS: f64 = 1e-7;

/// More orders than the faintest image leaves of the brightest star: each is about e^{2π} times fainter than the one
/// before last.
const MOST_ORDERS: usize = 24;

/// Parts of a half turn of the angle swept.
const SHARES: usize = 16;

/// Stars of a task.
const CHUNK: usize = 2048;

/// The image of a star.
#[derive(Debug, Clone, Copy)]
struct Splat {
    /// The pixel to the upper left of its place.
    column: i32,
    row: i32,
    /// How far it is from there to the next pixel, to the right and down.
    right: f32,
    down: f32,
    /// Irradiance over the solid angle of a pixel in the picture's centre.
    light: [f32; 3],
}

/// The images of stars, sorted into bands of rows. The memory is reused.
#[derive(Debug, Default)]
pub(in crate::render) struct StarImages {
    chunks: Vec<Vec<Splat>>,
    sorted: Vec<Splat>,
    /// Where each band's images begin, and where the last band's end.
    firsts: Vec<usize>,
}

/// What stars are seen by.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct StarView<'a> {
    pub(in crate::render) shader: SkyShader<'a>,
    /// The irradiance of each star without magnification.
    pub(in crate::render) lights: &'a [[f32; 3]],
    /// The angular radius of stars, in radians.
    pub(in crate::render) radius: f64,
    /// Images whose pixels would be fainter than this are left out.
    pub(in crate::render) faintest: f64,
}

impl StarImages {
    /// Finds the images of stars, for bands of `rows` rows.
    pub(in crate::render) fn find(
        &mut self,
        field: &StarField,
        seen: &StarView<'_>,
        rows: usize,
        threads: Threads,
    ) {
        let stars = field.stars.chunks(CHUNK).zip(seen.lights.chunks(CHUNK));
        self.chunks.resize_with(stars.len(), Vec::new);
        let places = ImagePlaces::new(seen.shader.view, seen.shader.curve);
        let find = |stars: &[Star], lights: &[[f32; 3]], splats: &mut Vec<Splat>| {
            splats.clear();
            for (star, light) in stars.iter().zip(lights) {
                seen.images(star, *light, &places, splats);
            }
        };
        if threads == Threads::All {
            let stars = field.stars.par_chunks(CHUNK);
            let stars = stars.zip(seen.lights.par_chunks(CHUNK));
            let chunks = stars.zip(&mut self.chunks);
            chunks.for_each(|((stars, lights), splats)| find(stars, lights, splats));
        } else {
            let chunks = stars.zip(&mut self.chunks);
            chunks.for_each(|((stars, lights), splats)| find(stars, lights, splats));
        }
        self.sort(tiles_of(seen.shader.view), rows);
    }

    /// Sorts the images on a part of the picture into bands. In each they stay in the order of the stars.
    fn sort(&mut self, part: Region, rows: usize) {
        let (left, top) = (i64::from(part.left), i64::from(part.top));
        let (width, height) = (i64::from(part.width), i64::from(part.height));
        let bands = (height as usize).div_ceil(rows);
        // An image falls on two columns and on two rows, which may be in two bands.
        let bands_of = |splat: &Splat| {
            let (column, row) = (i64::from(splat.column) - left, i64::from(splat.row) - top);
            let is_in = (-1..width).contains(&column) && (-1..height).contains(&row);
            let last = (row + 1).clamp(0, height - 1) as usize;
            (row.max(0) as usize / rows..=last / rows).filter(move |_| is_in)
        };
        self.firsts.clear();
        self.firsts.resize(bands + 1, 0);
        for band in self.chunks.iter().flatten().flat_map(bands_of) {
            self.firsts[band] += 1;
        }
        let mut end = 0;
        for first in &mut self.firsts {
            end += *first;
            *first = end;
        }
        self.sorted.clear();
        self.sorted.resize(end, Splat::NONE);
        for chunk in self.chunks.iter().rev() {
            for splat in chunk.iter().rev() {
                for band in bands_of(splat) {
                    self.firsts[band] -= 1;
                    self.sorted[self.firsts[band]] = *splat;
                }
            }
        }
    }

    /// Adds the images of a band to its light.
    pub(in crate::render) fn add(&self, view: &View, band: TileRow, light: &mut [[f32; 3]]) {
        self.visit(band, |splat, row, column, share| {
            let share = share * over_solid_angle(view, band.left + column, band.top + row);
            let pixel = &mut light[row * band.width + column];
            for (pixel, c) in pixel.iter_mut().zip(splat.light) {
                *pixel += share * c;
            }
        });
    }

    /// Calls `pixel` with the row and the column of each pixel of a band that an image falls on, again and again where
    /// several do.
    pub(in crate::render) fn pixels(&self, band: TileRow, mut pixel: impl FnMut(usize, usize)) {
        self.visit(band, |_, row, column, _| pixel(row, column));
    }

    /// Calls `pixel` with each image of a band, the row and the column of a pixel that it falls on, and its share.
    fn visit(&self, band: TileRow, mut pixel: impl FnMut(&Splat, usize, usize, f32)) {
        let (width, rows) = (band.width as i64, band.rows as i64);
        for splat in &self.sorted[self.firsts[band.number]..self.firsts[band.number + 1]] {
            let row = i64::from(splat.row) - band.top as i64;
            let column = i64::from(splat.column) - band.left as i64;
            for (row, down) in [(row, 1.0 - splat.down), (row + 1, splat.down)] {
                for (column, right) in [(column, 1.0 - splat.right), (column + 1, splat.right)] {
                    if (0..rows).contains(&row) && (0..width).contains(&column) {
                        pixel(splat, row as usize, column as usize, right * down);
                    }
                }
            }
        }
    }
}

/// Returns the solid angle of a pixel in the picture's centre over that of a pixel.
fn over_solid_angle(view: &View, column: usize, row: usize) -> f32 {
    let (x, y) = (view.x_at(column as f64 + 0.5), view.y_at(row as f64 + 0.5));
    (1.0 / view.lens().solid_angle(x, y)) as f32
}

impl Splat {
    const NONE: Self = Self {
        column: 0,
        row: 0,
        right: 0.0,
        down: 0.0,
        light: [0.0; 3],
    };
}

impl StarView<'_> {
    /// Finds the images of a star.
    fn images(
        &self,
        star: &Star,
        light: [f32; 3],
        places: &ImagePlaces<'_>,
        splats: &mut Vec<Splat>,
    ) {
        let [p, a, b] = self.shader.axes();
        let direction = star.direction;
        let (along, across) = (direction.dot(p), (direction.dot(a), direction.dot(b)));
        let sine = (across.0 * across.0 + across.1 * across.1).sqrt();
        let first = usize::from(!places.shows_first(along));
        if first > places.last {
            return;
        }
        let theta = libm::atan2(sine, along);
        // A star on the axis is seen all around; one place stands for all.
        let side = if sine > 0.0 {
            (across.0 / sine, across.1 / sine)
        } else {
            (1.0, 0.0)
        };
        let brightest = light.iter().fold(0.0_f32, |most, c| most.max(c.abs()));
        let brightest = f64::from(brightest) / places.solid_angle;
        let spread = sine.max(0.5 * self.radius);
        let share = ((theta * (SHARES as f64 / PI)) as usize).min(SHARES - 1);
        for order in first..=places.last {
            // Odd orders come the other way about the hole.
            let share = if order % 2 == 0 {
                share
            } else {
                SHARES - 1 - share
            };
            let most = places.most[order][share];
            if brightest * most < self.faintest * spread {
                return;
            }
            let turns = TAU * (order / 2) as f64;
            let (angle, side) = if order % 2 == 0 {
                (turns + theta, side)
            } else {
                (turns + TAU - theta, (-side.0, -side.1))
            };
            let image = self.shader.curve.image(angle);
            let Some(place) = places.place(&image, side) else {
                continue;
            };
            let magnification = if angle < AXIS {
                1.0 / (image.rate * image.rate)
            } else {
                // Nothing diverges straight before the hole but for rays that have turned about it.
                let is_plain = order == 0 && along > 0.0;
                image.magnification(if is_plain { sine } else { spread })
            };
            if brightest * magnification < self.faintest {
                continue;
            }
            let scale = magnification / places.solid_angle;
            let light = light.map(|c| (f64::from(c) * scale).clamp(-BRIGHTEST, BRIGHTEST));
            places.splat(place, light, splats);
        }
    }
}

/// From directions to places in the picture.
struct ImagePlaces<'a> {
    view: &'a View,
    size: (f64, f64),
    /// Of a pixel in the picture's centre.
    solid_angle: f64,
    /// For each order and each share of its half turn, a bound of `sin ψ |dψ/dΦ|`: that at the share's start, since
    /// both factors fall with the angle.
    most: [[f64; SHARES]; MOST_ORDERS],
    /// The cosines of the angles that rays of the picture sweep within half a turn, the least and the greatest.
    cosines: (f64, f64),
    /// The last order that the picture may show.
    last: usize,
}

impl<'a> ImagePlaces<'a> {
    fn new(view: &'a View, curve: &EscapeCurve) -> Self {
        // Stars half a pixel beyond the picture still shine into it.
        let (least, greatest) = hole_angles(view, 1.0);
        let swept = |psi: f64| {
            let escape = curve.at(libm::cos(psi), libm::sin(psi));
            escape.map_or(f64::INFINITY, |escape| escape.angle)
        };
        let (most_swept, least_swept) = (swept(least), swept(greatest));
        let last = (most_swept / PI).min(MOST_ORDERS as f64 - 1.0) as usize;
        let cosines = (
            libm::cos(most_swept.min(PI)) - 1e-9,
            libm::cos(least_swept.min(PI)) + 1e-9,
        );
        let most = core::array::from_fn(|order| {
            core::array::from_fn(|share| {
                if order == 0 {
                    return f64::INFINITY;
                }
                let angle = PI * (order as f64 + share as f64 / SHARES as f64);
                let image = curve.image(angle);
                image.sine / image.rate
            })
        });
        let side = view.pixel_side();
        Self {
            view,
            size: (f64::from(view.width()), f64::from(view.height())),
            solid_angle: side * side,
            most,
            cosines,
            last,
        }
    }

    /// Returns whether the picture may show the first image of a star whose angle from p̂ has this cosine.
    #[inline]
    fn shows_first(&self, cosine: f64) -> bool {
        cosine >= self.cosines.0 && cosine <= self.cosines.1
    }

    /// Returns where an image on a side of the hole is seen, in pixels from the picture's left and top; `None` where
    /// none of its light falls into the picture.
    #[inline]
    fn place(&self, image: &Image, side: (f64, f64)) -> Option<(f64, f64)> {
        let (column, row) = self.view.place_of(PixelRay {
            z: image.cosine,
            ta: image.sine * side.0,
            tb: image.sine * side.1,
        })?;
        let is_within = |place: f64, size: f64| place > -0.5 && place < size + 0.5;
        (is_within(column, self.size.0) && is_within(row, self.size.1)).then_some((column, row))
    }

    /// Adds the light of an image at a place: as wide an angle as a pixel in the picture's centre.
    ///
    /// A fisheye stretches what is far from its centre around it, and an equirectangular picture what is far from the
    /// horizon along its rows. There an image is several squares, side by side.
    fn splat(&self, (column, row): (f64, f64), light: [f64; 3], splats: &mut Vec<Splat>) {
        let (width, height) = self.size;
        let mut push = |(column, row): (f64, f64), share: f64| {
            let (left, above) = ((column - 0.5).floor(), (row - 0.5).floor());
            splats.push(Splat {
                column: left as i32,
                row: above as i32,
                right: (column - 0.5 - left) as f32,
                down: (row - 0.5 - above) as f32,
                light: light.map(|c| (c * share) as f32),
            });
        };
        let lens = self.view.lens();
        if lens.projection() == Projection::Perspective {
            return push((column, row), 1.0);
        }
        let narrowing = lens.narrowing(self.view.x_at(column), self.view.y_at(row));
        let stretch = (1.0 / narrowing).min(width);
        // A little less: a stretch of 1 may be rounded.
        let count = (stretch - 1e-6).ceil().max(1.0);
        let apart = (stretch - 1.0).max(0.0) / (count - 1.0).max(1.0);
        for i in 0..count as u32 {
            let aside = (f64::from(i) - 0.5 * (count - 1.0)) * apart;
            if lens.projection() == Projection::Fisheye {
                let (x, y) = (column - 0.5 * width, row - 0.5 * height);
                let (sine, cosine) = libm::sincos(aside / (x * x + y * y).sqrt().max(1.0));
                let turned = (x * cosine - y * sine, x * sine + y * cosine);
                push(
                    (turned.0 + 0.5 * width, turned.1 + 0.5 * height),
                    1.0 / count,
                );
                continue;
            }
            let along = column + aside;
            let around = along - (along / width).floor() * width;
            // What falls over a pole comes down on its other side.
            let over = if row < 0.5 {
                Some(-row)
            } else if row > height - 0.5 {
                Some(2.0 * height - row)
            } else {
                None
            };
            for (column, row) in [(around, Some(row)), (around + 0.5 * width, over)] {
                let Some(row) = row else {
                    continue;
                };
                let column = if column >= width {
                    column - width
                } else {
                    column
                };
                push((column, row), 1.0 / count);
                // The picture's left side is its right side.
                if column < 0.5 {
                    push((column + width, row), 1.0 / count);
                } else if column > width - 0.5 {
                    push((column - width, row), 1.0 / count);
                }
            }
        }
    }
}

/// Returns bounds of the angles between the hole's direction and the rays of a picture that is wider by `margin` pixels
/// on each side.
fn hole_angles(view: &View, margin: f64) -> (f64, f64) {
    let centre = view.ray_at(0.0, 0.0);
    let axis = libm::atan2(centre.transverse(), centre.z);
    let (x, y) = (view.x_at(-margin), view.y_at(-margin));
    let corner = match view.lens().projection() {
        Projection::Perspective => libm::atan((x * x + y * y).sqrt()),
        Projection::Fisheye => y,
        Projection::Equirectangular => PI,
    };
    ((axis - corner).max(0.0), (axis + corner).min(PI))
}
