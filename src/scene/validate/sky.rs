//! What the values of a sky may be.

use super::finite;
use super::light::exposure;
use crate::scene::error::SceneError;
use crate::scene::sky::{Sky, SkyFile, StarSource, Stars};

/// The most stars that are made.
pub const MAX_STAR_COUNT: u32 = 10_000_000;

/// The largest angular radius of a star, in radians.
pub const MAX_STAR_RADIUS: f64 = 0.01;

/// The smallest distance of a grid's lines, in degrees.
pub const MIN_GRID: f64 = 1.0;

/// The largest distance of a grid's lines, in degrees.
pub const MAX_GRID: f64 = 90.0;

/// Checks a sky.
///
/// # Errors
/// [`SceneError::Value`] for the first value that is not allowed.
pub(in crate::scene) fn sky(sky: &Sky) -> Result<(), SceneError> {
    if let Some(panorama) = &sky.panorama {
        file("sky.panorama", panorama)?;
    }
    for angle in sky.rotation {
        finite("sky.rotation", angle)?;
    }
    exposure("sky.exposure", sky.exposure)?;
    if let Some(stars) = &sky.stars {
        self::stars(stars)?;
    }
    if let Some(degrees) = sky.grid {
        SceneError::check(
            (MIN_GRID..=MAX_GRID).contains(&degrees) && 180.0 % degrees == 0.0,
            "sky.grid",
            degrees,
            format_args!(
                "the distance of a grid's lines is {MIN_GRID} to {MAX_GRID} degrees and divides 180 evenly, such as 15"
            ),
        )?;
    }
    Ok(())
}

fn stars(stars: &Stars) -> Result<(), SceneError> {
    match &stars.source {
        StarSource::File(catalogue) => file("sky.stars", catalogue)?,
        StarSource::Synthetic { count, seed } => {
            star_count(i64::from(*count))?;
            // A value that TOML cannot hold is negative as an i64.
            star_seed(*seed as i64)?;
        }
    }
    if let Some(magnitude) = stars.magnitude_limit {
        finite("sky.magnitude_limit", magnitude)?;
    }
    exposure("sky.star_exposure", stars.exposure)?;
    SceneError::check(
        stars.radius > 0.0 && stars.radius <= MAX_STAR_RADIUS,
        "sky.star_radius",
        stars.radius,
        format_args!(
            "a star's angular radius is above 0 and at most {MAX_STAR_RADIUS} radians; the default is 1e-6"
        ),
    )
}

/// Checks the number of random stars: 1 to [`MAX_STAR_COUNT`].
///
/// # Errors
/// [`SceneError::Value`]
pub(in crate::scene) fn star_count(count: i64) -> Result<u32, SceneError> {
    let counted = u32::try_from(count).ok();
    counted
        .filter(|count| (1..=MAX_STAR_COUNT).contains(count))
        .ok_or_else(|| {
            let reason = format_args!("a field of random stars has 1 to {MAX_STAR_COUNT} stars");
            SceneError::value("sky.stars.count", count, reason)
        })
}

/// Checks the seed of random stars: 0 to the largest whole number of TOML.
///
/// # Errors
/// [`SceneError::Value`]
pub(in crate::scene) fn star_seed(seed: i64) -> Result<u64, SceneError> {
    u64::try_from(seed).map_err(|_| {
        SceneError::value(
            "sky.stars.seed",
            seed,
            format_args!("a seed is 0 or above, up to {}", i64::MAX),
        )
    })
}

/// Checks the name of a file.
fn file(key: &'static str, file: &SkyFile) -> Result<(), SceneError> {
    let reason =
        "this names no file; give the file's name, relative to the folder of the scene's file";
    SceneError::check(!file.name.is_empty(), key, &file.name, reason)
}

#[cfg(test)]
mod tests {
    use super::super::super::Scene;
    use super::*;

    fn scene(sky: &str) -> Result<Scene, SceneError> {
        Scene::from_toml(&format!(
            "[camera]\nposition = [20, 0, 5]\nfov = 40\n[disk]\ninner = 3\nouter = 12\n[sky]\n{sky}\n\
             [image]\nwidth = 64\nheight = 36\n"
        ))
    }

    /// Asserts that a sentence with all of `words` refuses the sky.
    fn refused(sky: &str, words: &[&str]) {
        let message = scene(sky).expect_err(sky).to_string();
        for word in words {
            assert!(message.contains(word), "{sky}: {message}");
        }
    }

    #[test]
    fn skies_that_are_allowed() {
        for sky in [
            "",
            "panorama = \"night.png\"\nexposure = -100\nrotation = [1e300, -720, 0]",
            "stars = \"bright.csv\"\nmagnitude_limit = -30\nstar_radius = 0.01\nstar_exposure = 100",
            "stars = { count = 1, seed = 0 }",
            "stars = { count = 10000000, seed = 9223372036854775807 }\nstar_radius = 5e-324",
        ] {
            assert!(scene(sky).is_ok(), "{sky}");
        }
        for degrees in [1.0, 1.5, 7.5, 15.0, 60.0, 90.0] {
            let sky = scene(&format!("grid = {degrees}")).unwrap();
            assert_eq!(sky.sky().unwrap().grid, Some(degrees));
        }
    }

    #[test]
    fn skies_that_are_not() {
        for key in ["panorama", "stars"] {
            refused(
                &format!("{key} = \"\""),
                &[key, "names no file", "relative"],
            );
        }
        for turned in ["[nan, 0, 0]", "[0, inf, 0]", "[0, 0, -inf]"] {
            refused(&format!("rotation = {turned}"), &["sky.rotation", "finite"]);
        }
        for stops in ["100.1", "-1e300", "nan", "inf"] {
            let panorama = format!("panorama = \"night.png\"\nexposure = {stops}");
            refused(&panorama, &["sky.exposure = ", "-100 to 100 stops"]);
            let stars = format!("stars = \"bright.csv\"\nstar_exposure = {stops}");
            refused(&stars, &["sky.star_exposure = ", "-100 to 100 stops"]);
        }
        for magnitude in ["nan", "inf", "-inf"] {
            let stars = format!("stars = \"bright.csv\"\nmagnitude_limit = {magnitude}");
            refused(&stars, &["sky.magnitude_limit", "finite"]);
        }
        for radius in ["0", "-1e-6", "0.0101", "nan", "inf"] {
            let stars = format!("stars = \"bright.csv\"\nstar_radius = {radius}");
            refused(&stars, &["sky.star_radius", "0.01 radians", "1e-6"]);
        }
        for degrees in ["0", "-15", "0.5", "91", "180", "7", "nan", "inf"] {
            refused(
                &format!("grid = {degrees}"),
                &["sky.grid", "1 to 90", "divides 180"],
            );
        }
    }

    #[test]
    fn setters_check_what_files_are_checked_for() {
        let black = scene("").unwrap();
        let stars = |count, seed| Sky {
            stars: Some(Stars::new(StarSource::Synthetic { count, seed })),
            ..Sky::default()
        };
        for sky in [
            stars(0, 1),
            stars(MAX_STAR_COUNT + 1, 1),
            stars(1, u64::MAX),
            Sky {
                grid: Some(7.0),
                ..Sky::default()
            },
        ] {
            assert!(black.clone().with_sky(Some(sky)).is_err());
        }
        let field = black.clone().with_sky(Some(stars(5, 7))).unwrap();
        assert_eq!(field, scene("stars = { count = 5, seed = 7 }").unwrap());
        assert_eq!(Scene::from_toml(&field.to_toml()).unwrap(), field);
        assert_eq!(field.with_sky(None).unwrap().sky(), None);
    }
}
