//! Draws a frame without curves, by following every pixel's ray: the same picture from any method. Tells what a pixel
//! sees of the disk in the same way.

use core::f64::consts::PI;

use rayon::prelude::*;

use super::error::{RenderError, blank};
use super::frame::Threads;
use super::ink::{Averaging, Colours, Data, Ink, PlaneRows, Rows, amplitude};
use super::planes::Target;
use super::shaded::ROWS_OF_BAND;
use super::sky::{FrameSky, SkyShader, SkySight, StarImages};
use super::tiles::{Rectangle, Run, TileRow};
use crate::isoradial::Escape;
use crate::light::{Sight, SightGeometry};
use crate::orbit::integrate::FixedStep;
use crate::orbit::invariants::Orbit;
use crate::orbit::{Event, EventKind, Fate, OrbitError, Orbits, Ray};
use crate::scene::{Disk, PixelRay, Scene, View};

/// Returns a mask, row by row from the top, drawn on all threads of the current rayon pool. Calls `row_done` after each
/// row.
///
/// # Errors
/// [`RenderError::Memory`] if the pixels do not fit into memory, [`RenderError::Orbit`] if the method cannot follow a
/// ray.
pub fn render(
    scene: &Scene,
    view: &View,
    orbits: &impl Orbits,
    row_done: &(dyn Fn() + Sync),
) -> Result<Vec<u8>, RenderError> {
    let mut pixels = blank(view)?;
    let frame = Frame {
        scene,
        view,
        orbits,
        colours: None,
        sky: None,
    };
    frame.draw(
        row_done,
        Target::Grey8(&mut pixels, view.region().width as usize),
    )?;
    Ok(pixels)
}

/// A frame whose pixels show what their centres' rays meet.
pub(super) struct Frame<'a, O> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) orbits: &'a O,
    /// Of a scene with light or a sky.
    pub(super) colours: Option<&'a Colours>,
    /// Where the form shows the sky or data of it.
    pub(super) sky: Option<&'a FrameSky<'a>>,
}

impl<O: Orbits> Frame<'_, O> {
    /// Draws the frame on all threads of the current rayon pool. Calls `row_done` after each row.
    ///
    /// # Errors
    /// [`RenderError::Orbit`] with what the method returns for a ray that it cannot follow; [`RenderError::NoLight`]
    /// for colours of a scene without light.
    pub(super) fn draw(
        &self,
        row_done: &(dyn Fn() + Sync),
        target: Target<'_>,
    ) -> Result<(), RenderError> {
        target.check(self.view)?;
        let colours = || self.colours.ok_or(RenderError::NoLight);
        match target {
            Target::Grey8(samples, stride) => self.rows(row_done, samples, stride, |place| {
                let sees = sees(self.scene, self.view, self.orbits, place)?;
                Ok([if sees { u8::MAX } else { 0 }])
            }),
            Target::Grey16(samples, stride) => self.rows(row_done, samples, stride, |place| {
                let sees = sees(self.scene, self.view, self.orbits, place)?;
                Ok([if sees { u16::MAX } else { 0 }])
            }),
            Target::Rgb8(samples, stride) => {
                let colours = colours()?;
                let codes = (
                    |y| colours.palette.rgb8(y),
                    |light| colours.display.rgb8(light),
                );
                self.colour_rows(row_done, samples, stride, colours, codes)
            }
            Target::Rgb16(samples, stride) => {
                let colours = colours()?;
                let of_light = |light| colours.display.rgb16(light);
                let codes = (|y| of_light(colours.radiance.rgb(y)), of_light);
                self.colour_rows(row_done, samples, stride, colours, codes)
            }
            Target::Planes(planes, layers) => {
                let data = Data::new(layers, self.colours, self.scene, Averaging::Centre)?;
                let bands = PlaneRows::bands(planes, self.view);
                let stars = self.stars();
                let bands = bands.enumerate().par_bridge();
                bands.try_for_each(|(number, mut memory)| {
                    let band = TileRow::new(self.view, number);
                    let light = self.sky_band(&stars, band);
                    let (first, last) = band.shown(self.view).rows;
                    for row in first..last {
                        self.data_row(&data, &mut memory, (band, row), &light)?;
                        row_done();
                    }
                    data.finish_sky(&mut memory);
                    self.clear_beyond_the_rim(&data, &mut memory, band);
                    memory.hand_over();
                    Ok(())
                })
            }
        }
    }

    /// Sets the layers of a band's row.
    fn data_row(
        &self,
        data: &Data<'_>,
        memory: &mut PlaneRows<'_>,
        (band, row): (TileRow, usize),
        light: &[[f32; 3]],
    ) -> Result<(), RenderError> {
        let columns = band.shown(self.view).columns;
        data.clear(memory, row, columns);
        for column in columns.0..columns.1 {
            let place = ((band.left + column) as u32, (band.top + row) as u32);
            let pixel = row * band.width + column;
            if !self.view.shows(centre(place)) {
                continue;
            }
            if let Some(sight) = sight(self.scene, self.view, self.orbits, place)? {
                data.set_sight(memory, pixel, &sight);
                continue;
            }
            let is_captured = self.is_captured(place)?;
            Data::set_hidden(memory, pixel, is_captured);
            data.put_light(memory, row, column, &light[pixel..=pixel]);
            if let Some(sky) = self.sky.filter(|_| !is_captured) {
                let sight = self.sky_sight(&sky.shader, place)?;
                data.put_direction(memory, pixel, &sky.shader, &sight);
            }
        }
        Ok(())
    }

    /// Clears what of a band is beyond the rim of a fisheye.
    fn clear_beyond_the_rim(&self, data: &Data<'_>, memory: &mut PlaneRows<'_>, band: TileRow) {
        for row in 0..band.rows {
            let (from, to) = band.seen_columns(self.view, row);
            data.clear(memory, row, (0, from));
            data.clear(memory, row, (to, band.width));
        }
    }

    /// The images of stars, band by band.
    fn stars(&self) -> StarImages {
        let mut stars = StarImages::default();
        if let Some(sky) = self.sky {
            sky.find_stars(&mut stars, ROWS_OF_BAND, Threads::All);
        }
        stars
    }

    /// The light of a band's sky where no disk is before it.
    fn sky_band(&self, stars: &StarImages, band: TileRow) -> Vec<[f32; 3]> {
        let mut light = vec![[0.0; 3]; band.width * band.rows];
        if let Some(sky) = self.sky {
            let whole = |row| Run {
                row,
                from: 0,
                to: band.width as u32,
            };
            let runs: Vec<Run> = (0..band.rows as u32).map(whole).collect();
            sky.paint(band, &runs, &mut light);
            if sky.has_stars() {
                stars.add(self.view, band, &mut light);
            }
        }
        light
    }

    /// Where the ray of a pixel's centre leaves to, by the method.
    fn sky_sight(&self, sky: &SkyShader<'_>, (i, j): (u32, u32)) -> Result<SkySight, OrbitError> {
        let pixel = self.view.pixel(i, j);
        let s = pixel.transverse();
        let angle = if s > 0.0 {
            let ray = Ray::new(self.view.u0(), self.view.dudphi(pixel))?;
            let events = self.orbits.follow(ray, &[])?;
            events.last().map_or(0.0, |end| end.angle)
        } else {
            0.0
        };
        let rate = f64::NAN;
        let (column, row) = centre((i, j));
        let point = (self.view.x_at(column), self.view.y_at(row));
        Ok(sky.sight(point, (pixel, s), Escape { angle, rate }))
    }

    /// Draws rows of colours: codes of an amplitude of the disk, or of light.
    fn colour_rows<T: Send + Copy + Default>(
        &self,
        row_done: &(dyn Fn() + Sync),
        samples: &mut [T],
        stride: usize,
        colours: &Colours,
        (of_amplitude, of_light): (
            impl Fn(f32) -> [T; 3] + Sync,
            impl Fn([f32; 3]) -> [T; 3] + Sync,
        ),
    ) -> Result<(), RenderError> {
        let stars = self.stars();
        let bands = Rows::bands(samples, self.view, stride);
        let bands = bands.enumerate().par_bridge();
        bands.try_for_each(|(number, mut memory)| {
            let band = TileRow::new(self.view, number);
            let light = self.sky_band(&stars, band);
            let Rectangle { columns, rows } = band.shown(self.view);
            for row in rows.0..rows.1 {
                let pixels = memory.colours(row, columns.0, columns.1);
                let light = &light[row * band.width..][columns.0..columns.1];
                for (i, (samples, light)) in pixels.iter_mut().zip(light).enumerate() {
                    let column = band.left + columns.0 + i;
                    let place = (column as u32, (band.top + row) as u32);
                    if !self.view.shows(centre(place)) {
                        *samples = [T::default(); 3];
                        continue;
                    }
                    *samples = match sight(self.scene, self.view, self.orbits, place)? {
                        Some(_) if colours.is_white => of_light([1.0; 3]),
                        Some(sight) => of_amplitude(amplitude(&sight) as f32),
                        None if self.sky.is_some() => of_light(*light),
                        None => [T::default(); 3],
                    };
                }
                row_done();
            }
            memory.hand_over();
            Ok(())
        })
    }

    /// Draws rows of pixels of `N` samples.
    fn rows<T: Send + Copy, const N: usize>(
        &self,
        row_done: &(dyn Fn() + Sync),
        samples: &mut [T],
        stride: usize,
        pixel: impl Fn((u32, u32)) -> Result<[T; N], OrbitError> + Sync,
    ) -> Result<(), RenderError> {
        let part = self.view.region();
        let (width, height) = (part.width as usize, part.height as usize);
        let needed = stride * (height - 1) + N * width;
        let rows = samples[..needed].par_chunks_mut(stride).enumerate();
        rows.try_for_each(|(j, row)| {
            let pixels = row[..N * width].as_chunks_mut::<N>().0;
            for (i, samples) in pixels.iter_mut().enumerate() {
                *samples = pixel((part.left + i as u32, part.top + j as u32))?;
            }
            row_done();
            Ok(())
        })
    }

    /// Whether the ray of a pixel's centre falls in.
    fn is_captured(&self, (i, j): (u32, u32)) -> Result<bool, OrbitError> {
        let pixel = self.view.pixel(i, j);
        if pixel.transverse() <= 0.0 {
            return Ok(pixel.z > 0.0);
        }
        let ray = Ray::new(self.view.u0(), self.view.dudphi(pixel))?;
        Ok(Orbit::new(ray).fate() == Fate::Capture)
    }
}

/// Whether a pixel (column, row) sees the disk.
///
/// # Errors
/// Returns the method's error if it cannot follow the ray.
pub fn sees(
    scene: &Scene,
    view: &View,
    orbits: &impl Orbits,
    (i, j): (u32, u32),
) -> Result<bool, OrbitError> {
    Ok(match scene.disk().filter(|_| view.shows(centre((i, j)))) {
        Some(disk) => disk_crossing(disk, view, orbits, view.pixel(i, j))?.is_some(),
        None => false,
    })
}

/// Returns what the centre of a pixel (column, row) sees of the disk: its ring, azimuth and redshift where the ray
/// meets it first, since the disk is opaque. `None` exactly where [`sees`] is false.
///
/// # Errors
/// Returns the method's error if it cannot follow the ray.
pub fn sight(
    scene: &Scene,
    view: &View,
    orbits: &impl Orbits,
    (i, j): (u32, u32),
) -> Result<Option<Sight>, OrbitError> {
    if !view.shows(centre((i, j))) {
        return Ok(None);
    }
    sight_along(scene, view, orbits, view.pixel(i, j))
}

/// The centre of a pixel (column, row), in pixels from the picture's left and top.
fn centre((i, j): (u32, u32)) -> (f64, f64) {
    (f64::from(i) + 0.5, f64::from(j) + 0.5)
}

/// Returns what the ray of any point of the picture sees of the disk, like [`sight`].
///
/// # Errors
/// Returns the method's error if it cannot follow the ray.
pub fn sight_along(
    scene: &Scene,
    view: &View,
    orbits: &impl Orbits,
    pixel: PixelRay,
) -> Result<Option<Sight>, OrbitError> {
    let Some(disk) = scene.disk() else {
        return Ok(None);
    };
    let Some(DiskCrossing { ray, order, angle }) = disk_crossing(disk, view, orbits, pixel)? else {
        return Ok(None);
    };
    let (u_inner, u_outer) = (1.0 / disk.inner, 1.0 / disk.outer);
    // The crossing lies on the disk; its u may be beyond an edge by the method's error. A ray that has ended by that
    // error has left over an outer edge that is farther away than it can tell from infinity.
    let u = orbits
        .u_at_angle(ray, angle)?
        .unwrap_or(0.0)
        .clamp(u_outer, u_inner);
    Ok(Some(SightGeometry::new(view).sight(pixel, order, u)))
}

/// Returns whether a pixel (column, row) sees the disk, by steps that end at each crossing of the disk's plane (see
/// [`FixedStep::disk_hit`]).
#[inline]
pub fn sees_in_steps(scene: &Scene, view: &View, method: &FixedStep, (i, j): (u32, u32)) -> bool {
    view.shows(centre((i, j))) && meeting_in_steps(scene, view, method, view.pixel(i, j)).is_some()
}

/// Returns what a pixel (column, row) sees of the disk, like [`sight`], by the steps of [`sees_in_steps`].
#[inline]
pub fn sight_in_steps(
    scene: &Scene,
    view: &View,
    method: &FixedStep,
    (i, j): (u32, u32),
) -> Option<Sight> {
    if !view.shows(centre((i, j))) {
        return None;
    }
    let pixel = view.pixel(i, j);
    let (order, u) = meeting_in_steps(scene, view, method, pixel)?;
    Some(SightGeometry::new(view).sight(pixel, order, u))
}

/// The order of the image in which a point of the picture shows the disk, and u there.
#[inline]
fn meeting_in_steps(
    scene: &Scene,
    view: &View,
    method: &FixedStep,
    pixel: PixelRay,
) -> Option<(u32, f64)> {
    let disk = scene.disk()?;
    let (u_inner, u_outer) = (1.0 / disk.inner, 1.0 / disk.outer);
    let s = pixel.transverse();
    let ray = Ray::new(view.u0(), view.dudphi(pixel)).ok()?;
    if s <= 0.0 {
        return None;
    }
    method.disk_meeting(ray, view.plane_crossing(pixel.ta, s), u_inner, u_outer)
}

/// Where a ray meets the disk first.
struct DiskCrossing {
    ray: Ray,
    /// The order of the image.
    order: u32,
    /// The angle swept.
    angle: f64,
}

/// Returns where the ray of a point of the picture meets the disk first.
fn disk_crossing(
    disk: &Disk,
    view: &View,
    orbits: &impl Orbits,
    pixel: PixelRay,
) -> Result<Option<DiskCrossing>, OrbitError> {
    let s = pixel.transverse();
    // A ray straight at the hole or away from it has no orbit plane, and misses the disk.
    if s <= 0.0 {
        return Ok(None);
    }
    let ray = Ray::new(view.u0(), view.dudphi(pixel))?;
    let events = orbits.follow(ray, &[disk.inner, disk.outer])?;
    let met = first_met(&events, view.plane_crossing(pixel.ta, s), disk);
    Ok(met.map(|(order, angle)| DiskCrossing { ray, order, angle }))
}

/// Returns the first of the angles `first + kπ` at which a ray is between the disk's two radii, and its number among
/// those angles. `events` are the ray's crossings of the two radii and its end. The angle 0 does not count: a ray that
/// starts in the plane does not cross it there.
fn first_met(events: &[Event], first: f64, disk: &Disk) -> Option<(u32, f64)> {
    let least = if first > 0.0 { 0.0 } else { 1.0 };
    let crossed_within = |from: f64, to: f64| {
        let k = ((from - first) / PI).ceil().max(least);
        let angle = first + k * PI;
        (angle <= to).then_some(((k - least) as u32, angle))
    };
    let enters = |event: &Event| {
        (event.kind == EventKind::Inbound && event.radius == disk.outer)
            || (event.kind == EventKind::Outbound && event.radius == disk.inner)
    };
    // A ray starts between the radii if its first crossing leads out of them. The camera's radius does not decide this:
    // where it equals the inner or the outer radius, it depends on the ray's direction.
    let starts_within = events
        .first()
        .is_some_and(|event| !matches!(event.kind, EventKind::End(_)) && !enters(event));
    let mut entered = starts_within.then_some(0.0);
    for event in events {
        if let Some(from) = entered
            && let Some(met) = crossed_within(from, event.angle)
        {
            return Some(met);
        }
        entered = enters(event).then_some(event.angle);
    }
    None
}
