//! What the values of a scene may be.

use std::fmt::Debug;

use glam::DVec3;

use super::error::SceneError;
use super::projection::{Projection, SPHERE};
use super::values::{Camera, Disk, ImageSettings, ImageSize, Region};
use super::vector::{cosine, direction, norm};

mod light;
mod sky;

pub use light::{MAX_EXPOSURE, MAX_TEMPERATURE, MIN_TEMPERATURE};
pub(super) use light::{bits, exposure, layers, light};
pub use sky::{MAX_GRID, MAX_STAR_COUNT, MAX_STAR_RADIUS, MIN_GRID};
pub(super) use sky::{sky, star_count, star_seed};

/// The horizon's radius, in Schwarzschild radii. A camera stands outside it.
pub const HORIZON_RADIUS: f64 = 1.0;

/// The radius of the innermost stable circular orbit (6GM/c²), in Schwarzschild radii: the smallest inner edge of a
/// disk.
pub const ISCO_RADIUS: f64 = 3.0;

/// The largest radius of a camera, in Schwarzschild radii. Two neighbouring doubles are 1/8 apart there.
pub const FARTHEST_CAMERA: f64 = 1e15;

/// The smallest vertical field of view, in degrees. It is far below what double precision can aim at; the square of a
/// pixel's side is still a normal number.
pub const NARROWEST_FOV: f64 = 1e-100;

/// The largest outer edge of a disk, in Schwarzschild radii: rays are followed no farther
/// ([`MIN_U`](crate::orbit::MIN_U)).
pub const WIDEST_DISK: f64 = 1e100;

/// The most pixels on a side of a picture.
pub const MAX_IMAGE_SIDE: i64 = 1_000_000;

/// The largest error of an edge that may be asked for, in pixels. A larger one would leave out rings as thick as a
/// pixel.
pub const MAX_TOLERANCE: f64 = 1.0;

/// A camera is in the disk's plane where |n·p̂| is at most this. The cosine of the given components has a smaller
/// rounding error: three products, two sums, a product of two lengths and a quotient, each at most ε/2 of a term below
/// 1.
const IN_PLANE: f64 = 4.0 * f64::EPSILON;

/// A focus is the camera's own place where its distance is at most this share of the camera's radius: each component
/// of the position is known to ε/2.
const SAME_POINT: f64 = 4.0 * f64::EPSILON;

/// The view and up are parallel where the sine of their angle is at most this. Both directions and the terms of
/// `f × up` are rounded, together by up to about 4ε, so less than two bits of the product would be right.
const PARALLEL: f64 = 16.0 * f64::EPSILON;

/// Checks a scene whose camera has the radius `radius`, in the order of a scene's file.
///
/// # Errors
/// [`SceneError::Value`] for the first value that is not allowed.
pub(super) fn scene(
    camera: &Camera,
    radius: f64,
    disk: Option<&Disk>,
    size: ImageSize,
) -> Result<(), SceneError> {
    // Finite keyframes can have values between them that are not.
    finite_vector("camera.position", camera.position.to_array())?;
    finite_vector("camera.focus", camera.focus.to_array())?;
    finite_direction("camera.up", camera.up.to_array())?;
    let Some(disk) = disk else {
        check_camera(camera, radius)?;
        return shape(camera.projection, size);
    };
    finite_direction("disk.normal", disk.normal.to_array())?;
    check_camera(camera, radius)?;
    shape(camera.projection, size)?;
    edges(disk.inner, disk.outer)?;
    let is_in_plane = cosine(camera.position, disk.normal).abs() <= IN_PLANE;
    SceneError::check(
        !(is_in_plane && (disk.inner..=disk.outer).contains(&radius)),
        "camera.position",
        camera.position.to_array(),
        format_args!(
            "the camera is inside the disk's matter: in the disk's plane, at radius {radius:?} between \
             disk.inner = {:?} and disk.outer = {:?}; move it off the plane or out of the disk",
            disk.inner, disk.outer
        ),
    )
}

/// Checks a picture's settings. The sizes are signed so that a negative one gets the same sentence as a zero.
///
/// # Errors
/// [`SceneError::Value`] for the first value that is not allowed.
pub(super) fn image(
    width: i64,
    height: i64,
    antialias: bool,
    tolerance: f64,
) -> Result<ImageSettings, SceneError> {
    self::tolerance(tolerance)?;
    let size = image_size(width, height)?;
    Ok(ImageSettings::new(size, antialias, tolerance))
}

/// Checks an edge's largest error, in pixels: above 0, at most [`MAX_TOLERANCE`].
///
/// # Errors
/// [`SceneError::Value`]
pub(super) fn tolerance(pixels: f64) -> Result<(), SceneError> {
    SceneError::check(
        pixels > 0.0 && pixels <= MAX_TOLERANCE,
        "image.tolerance",
        pixels,
        format_args!(
            "an edge's largest error is above 0 and at most {MAX_TOLERANCE} pixel; the default is 0.001"
        ),
    )
}

/// Checks a picture's size: each side from 1 to [`MAX_IMAGE_SIDE`] pixels.
///
/// # Errors
/// [`SceneError::Value`]
pub(super) fn image_size(width: i64, height: i64) -> Result<ImageSize, SceneError> {
    let side = |key, value| match u32::try_from(value) {
        Ok(pixels) if (1..=MAX_IMAGE_SIDE).contains(&value) => Ok(pixels),
        _ => Err(SceneError::value(
            key,
            value,
            format!(
                "a picture's side has 1 to {MAX_IMAGE_SIDE} pixels, so that it fits common image formats"
            ),
        )),
    };
    Ok(ImageSize {
        width: side("image.width", width)?,
        height: side("image.height", height)?,
    })
}

/// Checks a part of a picture: its left, its top, its width and its height.
///
/// # Errors
/// [`SceneError::Value`] for a part without pixels, and for one that reaches beyond the picture.
pub(super) fn crop(
    part: [i64; 4],
    ImageSize { width, height }: ImageSize,
) -> Result<Region, SceneError> {
    let refused = |reason: &str| SceneError::value("image.crop", part, reason);
    let [left, top, columns, rows] = part;
    if columns < 1 || rows < 1 {
        return Err(refused(
            "a part of a picture has at least one column and one row; write [left, top, width, height]",
        ));
    }
    let side = |first: i64, count: i64, all: u32| {
        let end = first
            .checked_add(count)
            .filter(|&end| first >= 0 && end <= i64::from(all));
        let part = (u32::try_from(first), u32::try_from(count));
        match (end, part) {
            (Some(_), (Ok(first), Ok(count))) => Ok((first, count)),
            _ => Err(refused(&format!(
                "this part, [left, top, width, height], reaches beyond the picture of {width} × {height} pixels"
            ))),
        }
    };
    let ((left, width), (top, height)) = (side(left, columns, width)?, side(top, rows, height)?);
    Ok(Region {
        left,
        top,
        width,
        height,
    })
}

/// Checks the radius of a camera, which the `value` of `key` gives.
///
/// # Errors
/// [`SceneError::Value`]
pub(super) fn radius(
    key: &'static str,
    value: impl Debug + Copy,
    radius: f64,
) -> Result<(), SceneError> {
    let check = |is_allowed, reason: &str| {
        let reason = format_args!("the camera is at radius {radius:?}; {reason}");
        SceneError::check(is_allowed, key, value, reason)
    };
    check(
        radius > HORIZON_RADIUS,
        "a static camera needs a radius above 1, outside the horizon",
    )?;
    check(
        radius <= FARTHEST_CAMERA,
        "at most 1e15 is allowed, since double precision is too coarse farther out",
    )
}

fn check_camera(camera: &Camera, radius: f64) -> Result<(), SceneError> {
    self::radius("camera.position", camera.position.to_array(), radius)?;
    let view = camera.focus - camera.position;
    SceneError::check(
        norm(view) > SAME_POINT * radius,
        "camera.focus",
        camera.focus.to_array(),
        "this point cannot be told apart from camera.position; the camera needs another point to look at",
    )?;
    SceneError::check(
        norm(direction(view).cross(direction(camera.up))) > PARALLEL,
        "camera.up",
        camera.up.to_array(),
        "this direction is parallel to the view from camera.position to camera.focus; give another one",
    )?;
    fov("camera.fov", camera.fov_degrees, camera.projection)
}

/// Checks a field of view, in degrees.
///
/// # Errors
/// [`SceneError::Value`]
pub(super) fn fov(
    key: &'static str,
    degrees: f64,
    projection: Projection,
) -> Result<(), SceneError> {
    match projection {
        Projection::Perspective => SceneError::check(
            (NARROWEST_FOV..180.0).contains(&degrees),
            key,
            degrees,
            format_args!(
                "a flat picture's field of view is at least {NARROWEST_FOV:e} and below 180 degrees; \
                 camera.projection = \"fisheye\" goes up to 360"
            ),
        ),
        Projection::Fisheye => SceneError::check(
            (NARROWEST_FOV..=360.0).contains(&degrees),
            key,
            degrees,
            format_args!(
                "a fisheye's whole angle is at least {NARROWEST_FOV:e} and at most 360 degrees"
            ),
        ),
        Projection::Equirectangular => SceneError::check(
            degrees == SPHERE,
            key,
            degrees,
            "an equirectangular picture is 180 degrees high; leave out the field of view",
        ),
    }
}

/// Checks that a picture has the shape that its projection needs.
///
/// # Errors
/// [`SceneError::Value`]
pub(super) fn shape(projection: Projection, size: ImageSize) -> Result<(), SceneError> {
    let ImageSize { width, height } = size;
    SceneError::check(
        projection != Projection::Equirectangular || u64::from(width) == 2 * u64::from(height),
        "image.width",
        width,
        format_args!(
            "an equirectangular picture is twice as wide as high, and image.height is {height}; its size may be \
             {}x{height}",
            2 * u64::from(height)
        ),
    )
}

/// Checks a disk's edges.
///
/// # Errors
/// [`SceneError::Value`] for the first value that is not allowed.
pub(super) fn edges(inner: f64, outer: f64) -> Result<(), SceneError> {
    finite("disk.inner", inner)?;
    finite("disk.outer", outer)?;
    SceneError::check(
        inner >= ISCO_RADIUS,
        "disk.inner",
        inner,
        "no stable circular orbit exists inside 3 Schwarzschild radii (the ISCO), so no disk does",
    )?;
    SceneError::check(
        outer <= WIDEST_DISK,
        "disk.outer",
        outer,
        format_args!(
            "at most {WIDEST_DISK:e} is allowed, since squares of larger radii leave double precision"
        ),
    )?;
    SceneError::check(
        outer > inner,
        "disk.outer",
        outer,
        format_args!("the outer edge must be above the inner edge, disk.inner = {inner:?}"),
    )
}

/// Checks that a number is finite.
///
/// # Errors
/// [`SceneError::Value`]
pub(super) fn finite(key: &'static str, value: f64) -> Result<(), SceneError> {
    let reason = "every number must be finite, between keyframes too";
    SceneError::check(value.is_finite(), key, value, reason)
}

/// Checks that a vector's components are finite.
///
/// # Errors
/// [`SceneError::Value`]
pub(super) fn finite_vector(key: &'static str, components: [f64; 3]) -> Result<DVec3, SceneError> {
    for value in components {
        finite(key, value)?;
    }
    Ok(DVec3::from_array(components))
}

/// Checks that a vector is finite and not zero.
///
/// # Errors
/// [`SceneError::Value`]
pub(super) fn finite_direction(
    key: &'static str,
    components: [f64; 3],
) -> Result<DVec3, SceneError> {
    let v = finite_vector(key, components)?;
    let reason = "a direction must not be the zero vector";
    SceneError::check(v != DVec3::ZERO, key, components, reason)?;
    Ok(v)
}

#[cfg(test)]
mod tests;
