//! `[sky]` in a scene's file.

use std::fmt;
use std::sync::Arc;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::{line, maybe_three_numbers};
use crate::scene::sky::{DEFAULT_STAR_RADIUS, Sky, SkyFile, StarSource, Stars};
use crate::scene::validate;

/// `[sky]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "the table [sky]")]
struct SkyTable {
    panorama: Option<String>,
    #[serde(default, deserialize_with = "maybe_three_numbers")]
    rotation: Option<[f64; 3]>,
    exposure: Option<f64>,
    stars: Option<StarsKey>,
    magnitude_limit: Option<f64>,
    star_exposure: Option<f64>,
    star_radius: Option<f64>,
    shift: Option<bool>,
    grid: Option<f64>,
}

/// How the source of stars is written.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "sky.stars is the name of a CSV file, or { count = 20000, seed = 1 } for random stars"
)]
enum StarsKey {
    File(String),
    Synthetic(SyntheticTable),
}

/// `{ count = 20000, seed = 1 }`. The numbers are signed so that a negative one gets the same error as a zero.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SyntheticTable {
    count: i64,
    seed: i64,
}

/// Reads a sky. Errors name a key that means nothing without another.
pub(super) fn sky<'de, D: Deserializer<'de>>(source: D) -> Result<Option<Arc<Sky>>, D::Error> {
    let table = SkyTable::deserialize(source)?;
    if table.panorama.is_none() && table.exposure.is_some() {
        return Err(D::Error::custom(
            "sky.exposure is that of a panorama, and the sky has none; name a picture with sky.panorama, or remove \
             this key",
        ));
    }
    let stars = match table.stars {
        None => {
            let keys = [
                ("magnitude_limit", table.magnitude_limit.is_some()),
                ("star_exposure", table.star_exposure.is_some()),
                ("star_radius", table.star_radius.is_some()),
                ("shift", table.shift.is_some()),
            ];
            if let Some((key, _)) = keys.into_iter().find(|(_, is_set)| *is_set) {
                return Err(D::Error::custom(format_args!(
                    "sky.{key} is for stars, and the sky has none; set sky.stars, or remove this key"
                )));
            }
            None
        }
        Some(source) => Some(Stars {
            source: match source {
                StarsKey::File(name) => StarSource::File(SkyFile::new(name)),
                StarsKey::Synthetic(SyntheticTable { count, seed }) => StarSource::Synthetic {
                    count: validate::star_count(count).map_err(D::Error::custom)?,
                    seed: validate::star_seed(seed).map_err(D::Error::custom)?,
                },
            },
            magnitude_limit: table.magnitude_limit,
            exposure: table.star_exposure.unwrap_or(0.0),
            radius: table.star_radius.unwrap_or(DEFAULT_STAR_RADIUS),
            shift: table.shift.unwrap_or(true),
        }),
    };
    Ok(Some(Arc::new(Sky {
        panorama: table.panorama.map(SkyFile::new),
        rotation: table.rotation.unwrap_or_default(),
        exposure: table.exposure.unwrap_or(0.0),
        stars,
        grid: table.grid,
    })))
}

/// Writes the table. Keys at their defaults are left out.
pub(super) fn write(f: &mut fmt::Formatter<'_>, sky: &Sky) -> fmt::Result {
    let set = |value: f64, default: f64| (value.to_bits() != default.to_bits()).then_some(value);
    writeln!(f, "\n[sky]")?;
    if let Some(panorama) = &sky.panorama {
        writeln!(f, "panorama = {}", quoted(&panorama.name))?;
        line(f, "exposure", set(sky.exposure, 0.0))?;
    }
    let is_turned = sky.rotation.map(f64::to_bits) != [0; 3];
    line(f, "rotation", is_turned.then_some(sky.rotation))?;
    if let Some(stars) = &sky.stars {
        match &stars.source {
            StarSource::File(file) => writeln!(f, "stars = {}", quoted(&file.name))?,
            StarSource::Synthetic { count, seed } => {
                writeln!(f, "stars = {{ count = {count}, seed = {seed} }}")?;
            }
        }
        line(f, "magnitude_limit", stars.magnitude_limit)?;
        line(f, "star_exposure", set(stars.exposure, 0.0))?;
        line(f, "star_radius", set(stars.radius, DEFAULT_STAR_RADIUS))?;
        line(f, "shift", (!stars.shift).then_some(false))?;
    }
    line(f, "grid", sky.grid)
}

/// A text as a basic string of TOML 1.0.
fn quoted(text: &str) -> String {
    let characters = text.chars().map(|c| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04X}", u32::from(c)),
        c => c.to_string(),
    });
    format!("\"{}\"", characters.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::super::SceneFile;
    use super::*;

    const BEFORE: &str = "[camera]\nposition = [20.0, 0.0, 5.0]\nfocus = [0.0, 0.0, 0.0]\n\
        up = [0.0, 0.0, 1.0]\nfov = 40.0\n\
        \n[disk]\ninner = 3.0\nouter = 12.0\nnormal = [0.0, 0.0, 1.0]\n\n";
    const AFTER: &str = "\n[image]\nwidth = 64\nheight = 36\nantialias = true\ntolerance = 0.001\n";

    fn with(sky: &str) -> String {
        format!("{BEFORE}[sky]\n{sky}{AFTER}")
    }

    /// Asserts that the text is written as it was, or as `other`.
    fn written_as(sky: &str, other: &str) {
        let file = SceneFile::parse(&with(sky)).unwrap_or_else(|error| panic!("{sky}: {error}"));
        let written = file.to_string();
        assert_eq!(written, with(other));
        assert_eq!(SceneFile::parse(&written).unwrap(), file);
    }

    #[test]
    fn written_toml_reads_back() {
        for sky in [
            "",
            "panorama = \"a folder/night.exr\"\n",
            "panorama = \"night.exr\"\nexposure = -1.5\nrotation = [90.0, -0.1, 1e300]\n",
            "rotation = [-0.0, 0.0, 0.0]\n",
            "stars = \"bright.csv\"\n",
            "stars = { count = 20000, seed = 1 }\nmagnitude_limit = 6.5\nstar_exposure = 4.0\nstar_radius = 0.01\n\
             shift = false\ngrid = 15.0\n",
            "grid = 7.5\n",
            r#"panorama = "\"\\\u0009\u007F'ü.png"
"#,
        ] {
            written_as(sky, sky);
        }
    }

    #[test]
    fn defaults_are_left_out() {
        written_as(
            "panorama = 'night.exr'\nexposure = 0\nrotation = [0, 0, 0]\nstars = { seed = 7, count = 5 }\n\
             star_exposure = 0\nstar_radius = 1e-6\nshift = true\n",
            "panorama = \"night.exr\"\nstars = { count = 5, seed = 7 }\n",
        );
        let toml = with("stars = { count = 5, seed = 7 }\n");
        let sky = SceneFile::parse(&toml).unwrap().sky.unwrap();
        let stars = Stars::new(StarSource::Synthetic { count: 5, seed: 7 });
        let expected = Sky {
            stars: Some(stars),
            ..Sky::default()
        };
        assert_eq!(*sky, expected);
    }

    #[test]
    fn keys_that_mean_nothing_and_wrong_types_are_refused_with_their_place() {
        for (sky, words) in [
            ("exposure = 1.0\n", ["sky.exposure", "sky.panorama"]),
            (
                "magnitude_limit = 6\n",
                ["sky.magnitude_limit", "set sky.stars"],
            ),
            (
                "star_exposure = 1\n",
                ["sky.star_exposure", "set sky.stars"],
            ),
            ("star_radius = 1e-5\n", ["sky.star_radius", "set sky.stars"]),
            ("grid = 15\nshift = true\n", ["sky.shift", "set sky.stars"]),
            ("panorama = 3\n", ["expected a text", "panorama"]),
            ("stars = 3\n", ["CSV file", "{ count = 20000, seed = 1 }"]),
            ("stars = { count = 5 }\n", ["CSV file", "seed = 1"]),
            (
                "stars = { count = 5, seed = 1, colour = 2 }\n",
                ["CSV file", "seed = 1"],
            ),
            (
                "stars = { count = 0, seed = 1 }\n",
                ["sky.stars.count = 0", "1 to 10000000"],
            ),
            (
                "stars = { count = -5, seed = 1 }\n",
                ["sky.stars.count = -5", "1 to 10000000"],
            ),
            (
                "stars = { count = 10000001, seed = 1 }\n",
                ["sky.stars.count", "1 to 10000000"],
            ),
            (
                "stars = { count = 5, seed = -1 }\n",
                ["sky.stars.seed = -1", "0 or above"],
            ),
            ("rotation = [1, 2]\n", ["three numbers", "this one has 2"]),
            ("milky_way = true\n", ["`milky_way`", "panorama"]),
            ("grid = \"fine\"\n", ["expected a number", "grid"]),
        ] {
            let message = SceneFile::parse(&with(sky)).unwrap_err().to_string();
            for word in words.into_iter().chain(["line"]) {
                assert!(message.contains(word), "{sky}: {message}");
            }
        }
    }
}
