//! What the values of a scene may be.

use glam::DVec3;

use super::file::ImageTable;
use super::vector::{cosine, direction, norm};
use super::{Camera, Disk, ImageSize, Scene, SceneError};

/// The horizon's radius, in Schwarzschild radii: a camera stands strictly outside.
pub const HORIZON_RADIUS: f64 = 1.0;

/// The radius of the innermost stable circular orbit (6GM/c²), in Schwarzschild radii: the least inner edge of a
/// disk.
pub const ISCO_RADIUS: f64 = 3.0;

/// The farthest a camera may stand, in Schwarzschild radii: there two points of double precision are 1/8 apart.
pub const FARTHEST_CAMERA: f64 = 1e15;

/// The smallest vertical field of view, in degrees: far below what double precision can aim at, and far above where a pixel's
/// square leaves it.
pub const NARROWEST_FOV: f64 = 1e-100;

/// The largest outer edge of a disk, in Schwarzschild radii: as far as rays are followed
/// ([`MIN_U`](crate::orbit::MIN_U)).
pub const WIDEST_DISK: f64 = 1e100;

/// The most pixels on a side of a picture.
pub const MAX_IMAGE_SIDE: i64 = 1_000_000;

/// The most that an edge may be off by, in pixels: with more than one, rings as thick as a pixel are left out.
pub const MAX_TOLERANCE: f64 = 1.0;

/// A camera is in the disk's plane where |n·p̂| is no more than this: the cosine of the given components is rounded
/// by less (three products, two sums, a product of two lengths and a quotient, each by at most ε/2 of a term below
/// 1).
const IN_PLANE: f64 = 4.0 * f64::EPSILON;

/// A focus nearer to the camera than this share of the camera's radius is the camera's own place: the position itself
/// is known to ε/2 in each component.
const SAME_POINT: f64 = 4.0 * f64::EPSILON;

/// The sine of the angle between the view and up at which nothing is left of `f × up`: both directions and the
/// product's terms are rounded, together by up to about 4ε, so that less than two bits of it would be right.
const PARALLEL: f64 = 16.0 * f64::EPSILON;

/// What a scene says of its pictures, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Picture {
    pub(super) size: ImageSize,
    pub(super) antialias: bool,
    pub(super) tolerance: f64,
}

/// What is said of the pictures.
///
/// # Errors
/// One [`SceneError`] for the first value that is not allowed.
pub(super) fn picture(table: &ImageTable) -> Result<Picture, SceneError> {
    Ok(Picture {
        tolerance: tolerance(table.tolerance)?,
        size: image_size(table.width, table.height)?,
        antialias: table.antialias,
    })
}

/// The checked scene, of a camera whose position has the length `radius`.
///
/// # Errors
/// One [`SceneError`] for the first value that is not allowed, in the order of the file.
pub(super) fn scene(
    camera: Camera,
    radius: f64,
    disk: Disk,
    picture: Picture,
) -> Result<Scene, SceneError> {
    // What was finite may not be so any more between two keyframes.
    finite_vector("camera.position", camera.position.to_array())?;
    finite_vector("camera.focus", camera.focus.to_array())?;
    finite_direction("camera.up", camera.up.to_array())?;
    finite_direction("disk.normal", disk.normal.to_array())?;
    check_camera(&camera, radius)?;
    self::disk(disk.inner, disk.outer)?;
    if cosine(camera.position, disk.normal).abs() <= IN_PLANE
        && disk.inner <= radius
        && radius <= disk.outer
    {
        return Err(SceneError::InMatter {
            radius,
            inner: disk.inner,
            outer: disk.outer,
        });
    }
    let Picture {
        size,
        antialias,
        tolerance,
    } = picture;
    Ok(Scene {
        camera,
        radius,
        disk,
        image: size,
        antialias,
        tolerance,
    })
}

/// What an edge may be off by, in pixels: above 0, at most [`MAX_TOLERANCE`].
///
/// # Errors
/// [`SceneError::Tolerance`].
pub(super) fn tolerance(pixels: f64) -> Result<f64, SceneError> {
    if pixels > 0.0 && pixels <= MAX_TOLERANCE {
        Ok(pixels)
    } else {
        Err(SceneError::Tolerance { tolerance: pixels })
    }
}

/// The picture's size, each side between 1 and [`MAX_IMAGE_SIDE`].
///
/// # Errors
/// [`SceneError::ImageSide`]
pub(super) fn image_size(width: i64, height: i64) -> Result<ImageSize, SceneError> {
    let side = |key, value| match u32::try_from(value) {
        Ok(pixels) if (1..=MAX_IMAGE_SIDE).contains(&value) => Ok(pixels),
        _ => Err(SceneError::ImageSide { key, value }),
    };
    Ok(ImageSize {
        width: side("image.width", width)?,
        height: side("image.height", height)?,
    })
}

/// A radius where a camera can stand.
///
/// # Errors
/// [`SceneError::InsideHorizon`], [`SceneError::TooFar`].
pub(super) fn radius(radius: f64) -> Result<(), SceneError> {
    // Not so of what is not a number either.
    if radius > FARTHEST_CAMERA {
        return Err(SceneError::TooFar { radius });
    }
    if radius > HORIZON_RADIUS {
        Ok(())
    } else {
        Err(SceneError::InsideHorizon { radius })
    }
}

fn check_camera(camera: &Camera, radius: f64) -> Result<(), SceneError> {
    self::radius(radius)?;
    let view = camera.focus - camera.position;
    if norm(view) <= SAME_POINT * radius {
        return Err(SceneError::NoView);
    }
    if norm(direction(view).cross(direction(camera.up))) <= PARALLEL {
        return Err(SceneError::UpAlongView);
    }
    let fov = finite("camera.fov", camera.fov_degrees)?;
    if (NARROWEST_FOV..180.0).contains(&fov) {
        Ok(())
    } else {
        Err(SceneError::Fov { fov })
    }
}

/// Edges that a disk can have.
///
/// # Errors
/// One [`SceneError`] for the first value that is not allowed.
pub(super) fn disk(inner: f64, outer: f64) -> Result<(), SceneError> {
    finite("disk.inner", inner)?;
    finite("disk.outer", outer)?;
    if inner < ISCO_RADIUS {
        return Err(SceneError::InnerBelowIsco { inner });
    }
    if outer > WIDEST_DISK {
        return Err(SceneError::TooWide { outer });
    }
    if outer <= inner {
        return Err(SceneError::NoWidth { inner, outer });
    }
    Ok(())
}

/// A number that is one.
///
/// # Errors
/// [`SceneError::NotFinite`]
pub(super) fn finite(key: &'static str, value: f64) -> Result<f64, SceneError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(SceneError::NotFinite { key, value })
    }
}

/// A vector of [such](finite) numbers.
///
/// # Errors
/// [`SceneError::NotFinite`]
pub(super) fn finite_vector(key: &'static str, components: [f64; 3]) -> Result<DVec3, SceneError> {
    for value in components {
        finite(key, value)?;
    }
    Ok(DVec3::from_array(components))
}

/// Such a vector that points anywhere.
///
/// # Errors
/// [`SceneError::NotFinite`], [`SceneError::ZeroDirection`]
pub(super) fn finite_direction(
    key: &'static str,
    components: [f64; 3],
) -> Result<DVec3, SceneError> {
    let v = finite_vector(key, components)?;
    if v == DVec3::ZERO {
        Err(SceneError::ZeroDirection { key })
    } else {
        Ok(v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "[camera]\nposition = [20.0, 0.0, 5.0]\nfocus = [0.0, 0.0, 0.0]\nup = [0.0, 0.0, 1.0]\nfov = 40.0\n\
                        [disk]\ninner = 3.0\nouter = 12.0\nnormal = [0.0, 0.0, 1.0]\n\
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
    fn pictures() {
        for (key, full) in [("width", "image.width"), ("height", "image.height")] {
            for value in ["0", "-1", "1000001", "9223372036854775807"] {
                refused(&[(key, value)], &[full, value, "1000000"]);
            }
        }
        assert!(changed(&[("width", "1000000"), ("height", "1000000")]).is_ok());
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
