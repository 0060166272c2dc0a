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
mod tests {
    use super::super::Scene;
    use super::*;

    const GOOD: &str = "[camera]\nposition = [20.0, 0.0, 5.0]\nfocus = [0.0, 0.0, 0.0]\nup = [0.0, 0.0, 1.0]\n\
                        fov = 40.0\n[disk]\ninner = 3.0\nouter = 12.0\nnormal = [0.0, 0.0, 1.0]\n\
                        [image]\nwidth = 64\nheight = 36\nantialias = false\ntolerance = 0.001\n";

    /// The good scene with the keys' values replaced.
    fn changed(changes: &[(&str, &str)]) -> Result<Scene, SceneError> {
        let mut lines: Vec<String> = GOOD.lines().map(str::to_owned).collect();
        for (key, value) in changes {
            let line = lines
                .iter_mut()
                .find(|line| line.starts_with(&format!("{key} =")))
                .unwrap();
            *line = format!("{key} = {value}");
        }
        Scene::from_toml(&lines.join("\n"))
    }

    /// Asserts that the change is refused by a sentence that holds all of `words`.
    fn refused(changes: &[(&str, &str)], words: &[&str]) {
        let message = changed(changes)
            .expect_err(&format!("{changes:?}"))
            .to_string();
        for word in words {
            assert!(message.contains(word), "{changes:?}: {message}");
        }
    }

    #[test]
    fn the_good_scene_is_good() {
        assert!(changed(&[]).is_ok());
    }

    #[test]
    fn numbers_that_are_not_finite() {
        for (key, full) in [
            ("position", "camera.position"),
            ("focus", "camera.focus"),
            ("up", "camera.up"),
        ] {
            refused(&[(key, "[20.0, nan, 5.0]")], &[full, "NaN", "finite"]);
        }
        refused(
            &[("normal", "[0.0, 0.0, inf]")],
            &["disk.normal", "inf", "finite"],
        );
        refused(&[("fov", "nan")], &["camera.fov", "NaN"]);
        refused(&[("inner", "-inf")], &["disk.inner", "-inf"]);
        refused(&[("outer", "inf")], &["disk.outer", "inf"]);
    }

    #[test]
    fn cameras_at_the_horizon_or_too_far() {
        for position in [
            "[0.0, 0.0, 0.0]",
            "[0.5, 0.0, 0.1]",
            "[0.6, 0.8, 0.0]",
            "[1.0, 0.0, 0.0]",
            "[1e-300, 0, 0]",
        ] {
            refused(&[("position", position)], &["camera.position", "horizon"]);
        }
        assert!(changed(&[("position", "[1.0000000000000002, 0, 0]")]).is_ok());
        refused(
            &[("position", "[1e15, 1.0e9, 0.0]")],
            &["camera.position", "1e15"],
        );
        refused(
            &[("position", "[1e300, 1e300, 0.0]")],
            &["camera.position", "1e15"],
        );
        assert!(changed(&[("position", "[1e15, 0.0, 0.0]")]).is_ok());
    }

    #[test]
    fn cameras_in_the_disks_matter() {
        for position in ["[3.0, 0.0, 0.0]", "[0.0, -12.0, 0.0]", "[5.0, 0.0, 4e-15]"] {
            refused(
                &[("position", position)],
                &["camera.position", "disk.inner", "disk.outer", "plane"],
            );
        }
        for position in ["[2.9, 0.0, 0.0]", "[12.1, 0.0, 0.0]", "[5.0, 0.0, 1e-14]"] {
            assert!(changed(&[("position", position)]).is_ok(), "{position}");
        }
        refused(
            &[
                ("position", "[1.0, 4.0, 0.5]"),
                ("normal", "[4e300, -1e300, 0.0]"),
            ],
            &["camera.position"],
        );
    }

    #[test]
    fn cameras_that_look_nowhere() {
        refused(
            &[("focus", "[20.0, 0.0, 5.0]")],
            &["camera.focus", "camera.position"],
        );
        refused(
            &[("focus", "[20.000000000000004, 0.0, 5.0]")],
            &["camera.focus", "camera.position"],
        );
        assert!(changed(&[("focus", "[20.0000000000001, 0.0, 5.0]")]).is_ok());
        assert!(changed(&[("focus", "[1.7e308, 1.7e308, 1.7e308]")]).is_ok());
    }

    #[test]
    fn pictures_without_an_upward_direction() {
        refused(
            &[("position", "[0.0, 0.0, 40.0]")],
            &["camera.up", "parallel"],
        );
        refused(&[("up", "[-4.0, 0.0, -1.0]")], &["camera.up", "parallel"]);
        refused(
            &[("up", "[4.0, 0.0, 1.000000000000001]")],
            &["camera.up", "parallel"],
        );
        assert!(changed(&[("up", "[4.0, 0.0, 1.0000000000001]")]).is_ok());
        refused(&[("up", "[0, 0, 0]")], &["camera.up", "zero"]);
    }

    #[test]
    fn directions_have_any_length_but_zero() {
        refused(&[("normal", "[0.0, -0.0, 0.0]")], &["disk.normal", "zero"]);
        assert!(
            changed(&[
                ("up", "[0.0, 1e-300, 0.0]"),
                ("normal", "[1e300, 0.0, 1e300]")
            ])
            .is_ok()
        );
        assert!(
            changed(&[
                ("up", "[0.0, 5e-324, 0.0]"),
                ("normal", "[1.7e308, 0.0, 1.7e308]")
            ])
            .is_ok()
        );
    }

    #[test]
    fn fields_of_view() {
        for fov in ["0.0", "-30.0", "180.0", "1e300"] {
            refused(&[("fov", fov)], &["camera.fov", "180"]);
        }
        assert!(changed(&[("fov", "1e-9")]).is_ok());
    }

    #[test]
    fn disks() {
        refused(
            &[("inner", "2.9999999")],
            &["disk.inner", "ISCO", "3 Schwarzschild radii", "stable"],
        );
        refused(&[("inner", "-5.0")], &["disk.inner", "ISCO"]);
        refused(&[("outer", "3.0")], &["disk.outer", "disk.inner"]);
        refused(&[("outer", "2.0")], &["disk.outer", "disk.inner"]);
    }

    #[test]
    fn without_a_disk_its_place_is_free() {
        let sky_in_place = |toml: &str| {
            let (camera, rest) = toml.split_once("[disk]").unwrap();
            let image = &rest[rest.find("[image]").unwrap()..];
            Scene::from_toml(&format!("{camera}[sky]\n{image}"))
        };
        assert!(sky_in_place(GOOD).is_ok());
        let inside = GOOD.replace("[20.0, 0.0, 5.0]", "[5.0, 0.0, 0.0]");
        assert!(sky_in_place(&inside).is_ok() && Scene::from_toml(&inside).is_err());
        let horizon = sky_in_place(&GOOD.replace("[20.0, 0.0, 5.0]", "[0.5, 0.0, 0.0]"));
        assert!(horizon.unwrap_err().to_string().contains("horizon"));
    }

    #[test]
    fn pictures() {
        for (key, full) in [("width", "image.width"), ("height", "image.height")] {
            for value in ["0", "-1", "1000001", "9223372036854775807"] {
                refused(&[(key, value)], &[full, value, "1000000"]);
            }
        }
        assert!(changed(&[("width", "1000000"), ("height", "1000000")]).is_ok());
    }

    #[test]
    fn parts_of_pictures() {
        let cropped = |crop: &str| {
            let toml = format!("{GOOD}crop = {crop}\n");
            Scene::from_toml(&toml).map_err(|error| error.to_string())
        };
        for (crop, words) in [
            ("[60, 0, 5, 5]", "beyond the picture of 64 × 36 pixels"),
            ("[0, 30, 5, 7]", "beyond the picture"),
            ("[-1, 0, 5, 5]", "beyond the picture"),
            ("[1, 0, 9223372036854775807, 5]", "beyond the picture"),
            ("[0, 0, 0, 5]", "at least one column and one row"),
            ("[0, 0, 5, -5]", "at least one column and one row"),
        ] {
            let message = cropped(crop).unwrap_err();
            assert!(
                message.starts_with(&format!("image.crop = {crop}: ")) && message.contains(words),
                "{message}"
            );
        }
        let message = cropped("[0, 0, 5]").unwrap_err();
        assert!(
            message.contains("four whole numbers, [left, top, width, height]; this one has 3"),
            "{message}"
        );
        let message = cropped("[0, 0, 5, 1.5]").unwrap_err();
        assert!(message.contains("expected a whole number"), "{message}");
        let scene = cropped("[60, 0, 4, 36]").unwrap();
        assert_eq!(
            (scene.size().width, scene.size().height, scene.image().width),
            (4, 36, 64)
        );
        assert!(scene.to_toml().ends_with("\ncrop = [60, 0, 4, 36]\n"));
        assert_eq!(Scene::from_toml(&scene.to_toml()).unwrap(), scene);
        // A part that the new size does not have is refused.
        assert!(scene.clone().with_size(63, 36).is_err() && scene.with_size(65, 36).is_ok());
    }

    #[test]
    fn tolerances() {
        for tolerance in ["0.0", "-0.001", "1.5", "nan", "inf"] {
            refused(
                &[("tolerance", tolerance)],
                &["image.tolerance", "pixel", "0.001"],
            );
        }
        for tolerance in ["1.0", "1", "1e-12", "5e-324"] {
            assert!(changed(&[("tolerance", tolerance)]).is_ok(), "{tolerance}");
        }
    }
}
