//! A frame by following every pixel's ray by itself: the same picture from any method, without curves.

use core::f64::consts::PI;

use rayon::prelude::*;

use super::WHITE;
use super::error::{RenderError, blank, check_buffer};
use crate::orbit::integrate::FixedStep;
use crate::orbit::{Event, EventKind, OrbitError, Orbits, Ray};
use crate::scene::{Disk, Scene, View};

/// The frame's pixels, row by row from the top, on all threads of the current rayon pool. `row_done` is called after
/// each row.
///
/// # Errors
/// [`RenderError::Memory`]; [`RenderError::Orbit`] with what the method returns for a ray that it cannot follow.
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
/// What the method returns for a ray that it cannot follow.
pub fn sees(
    scene: &Scene,
    view: &View,
    orbits: &impl Orbits,
    (i, j): (u32, u32),
) -> Result<bool, OrbitError> {
    let pixel = view.pixel(i, j);
    let s = pixel.transverse();
    // Straight at the hole or away from it: no plane, no disk.
    if s <= 0.0 {
        return Ok(false);
    }
    let start = Ray::new(view.u0(), view.dudphi(pixel))?;
    let events = orbits.follow(start, &[scene.disk().inner, scene.disk().outer])?;
    Ok(meets(
        &events,
        view.plane_crossing(pixel.ta, s),
        scene.disk(),
    ))
}

/// Whether a pixel (column, row) sees the disk, by steps that end at each crossing of the disk's plane: see
/// [`FixedStep::disk_hit`].
#[inline]
pub fn sees_in_steps(scene: &Scene, view: &View, method: &FixedStep, (i, j): (u32, u32)) -> bool {
    let pixel = view.pixel(i, j);
    let s = pixel.transverse();
    let (u_inner, u_outer) = (1.0 / scene.disk().inner, 1.0 / scene.disk().outer);
    Ray::new(view.u0(), view.dudphi(pixel)).is_ok_and(|ray| {
        s > 0.0 && method.disk_hit(ray, view.plane_crossing(pixel.ta, s), u_inner, u_outer)
    })
}

/// Whether a ray with these events (crossings of the disk's two radii, and the end) is between the two radii at one
/// of the angles `first + kπ`; at 0 the ray starts in the plane, which is no crossing.
fn meets(events: &[Event], first: f64, disk: &Disk) -> bool {
    let crosses_within = |from: f64, to: f64| {
        let least = if first > 0.0 { 0.0 } else { 1.0 };
        let k = ((from - first) / PI).ceil().max(least);
        first + k * PI <= to
    };
    let enters = |event: &Event| {
        (event.kind == EventKind::Inbound && event.radius == disk.outer)
            || (event.kind == EventKind::Outbound && event.radius == disk.inner)
    };
    // A ray that starts between the radii is one whose first crossing leads out of them. The camera's radius would
    // not tell, where it is the inner or the outer one: there it depends on where the ray goes.
    let starts_within = events
        .first()
        .is_some_and(|event| !matches!(event.kind, EventKind::End(_)) && !enters(event));
    let mut entered = starts_within.then_some(0.0);
    for event in events {
        if let Some(from) = entered
            && crosses_within(from, event.angle)
        {
            return true;
        }
        entered = enters(event).then_some(event.angle);
    }
    false
}
