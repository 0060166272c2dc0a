//! Draws a frame without curves, by following every pixel's ray: the same picture from any method. Tells what a pixel
//! sees of the disk in the same way.

use core::f64::consts::PI;

use rayon::prelude::*;

use super::WHITE;
use super::error::{RenderError, blank, check_buffer};
use crate::light::{Sight, SightGeometry};
use crate::orbit::integrate::FixedStep;
use crate::orbit::{Event, EventKind, OrbitError, Orbits, Ray};
use crate::scene::{Disk, PixelRay, Scene, View};

/// Returns the frame's pixels, row by row from the top, drawn on all threads of the current rayon pool. Calls
/// `row_done` after each row.
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
    render_into(
        scene,
        view,
        orbits,
        row_done,
        &mut pixels,
        view.width() as usize,
    )?;
    Ok(pixels)
}

/// Draws the frame into a caller's buffer: row j begins at `j stride`.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit; [`RenderError::Orbit`] with what the
/// method returns for a ray that it cannot follow.
pub fn render_into(
    scene: &Scene,
    view: &View,
    orbits: &impl Orbits,
    row_done: &(dyn Fn() + Sync),
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    let needed = check_buffer(view, pixels, stride)?;
    let width = view.width() as usize;
    let rows = pixels[..needed].par_chunks_mut(stride).enumerate();
    rows.try_for_each(|(j, row)| {
        for (i, pixel) in row[..width].iter_mut().enumerate() {
            let sees = sees(scene, view, orbits, (i as u32, j as u32))?;
            *pixel = if sees { WHITE } else { 0 };
        }
        row_done();
        Ok(())
    })
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
    Ok(disk_crossing(scene.disk(), view, orbits, view.pixel(i, j))?.is_some())
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
    sight_along(scene, view, orbits, view.pixel(i, j))
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
    let disk = scene.disk();
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
    let pixel = view.pixel(i, j);
    let s = pixel.transverse();
    let (u_inner, u_outer) = (1.0 / scene.disk().inner, 1.0 / scene.disk().outer);
    Ray::new(view.u0(), view.dudphi(pixel)).is_ok_and(|ray| {
        s > 0.0 && method.disk_hit(ray, view.plane_crossing(pixel.ta, s), u_inner, u_outer)
    })
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
