//! What light, and the values that it becomes in a picture, may be.

use crate::scene::error::SceneError;
use crate::scene::layers::{Layer, LayerSet};
use crate::scene::values::Light;

/// The lowest temperature of a disk's hottest ring, in kelvin. Nothing cooler is visible.
pub const MIN_TEMPERATURE: f64 = 100.0;

/// The highest temperature of a disk's hottest ring, in kelvin. Colour no longer changes there.
pub const MAX_TEMPERATURE: f64 = 1e9;

/// The largest exposure, in stops; the smallest is its negative.
pub const MAX_EXPOSURE: f64 = 100.0;

/// Checks the light of a scene with or without a disk: a temperature from [`MIN_TEMPERATURE`] to [`MAX_TEMPERATURE`].
///
/// # Errors
/// [`SceneError::Value`]
pub(in crate::scene) fn light(light: Option<Light>, has_disk: bool) -> Result<(), SceneError> {
    if let Some(light) = light {
        let reason = "there is no disk that could shine; add the table [disk] or remove this light";
        SceneError::check(has_disk, "disk.light", light, reason)?;
    }
    let Some(Light::BlackBody { temperature }) = light else {
        return Ok(());
    };
    SceneError::check(
        (MIN_TEMPERATURE..=MAX_TEMPERATURE).contains(&temperature),
        "disk.light.temperature",
        temperature,
        format_args!(
            "the temperature of the hottest ring is {MIN_TEMPERATURE} to {MAX_TEMPERATURE:e} kelvin"
        ),
    )
}

/// Checks the exposure that `key` names, in stops: at most [`MAX_EXPOSURE`] either way.
///
/// # Errors
/// [`SceneError::Value`]
pub(in crate::scene) fn exposure(key: &'static str, stops: f64) -> Result<(), SceneError> {
    SceneError::check(
        stops.abs() <= MAX_EXPOSURE,
        key,
        stops,
        format_args!("the exposure is -{MAX_EXPOSURE} to {MAX_EXPOSURE} stops; the default is 0"),
    )
}

/// Checks the bits of a picture's samples: 8 or 16. They are signed so that a negative number gets the same sentence.
///
/// # Errors
/// [`SceneError::Value`]
pub(in crate::scene) fn bits(bits: i64) -> Result<u8, SceneError> {
    let reason = "a PNG picture's samples have 8 or 16 bits; the default is 8";
    SceneError::check(matches!(bits, 8 | 16), "image.bits", bits, reason)?;
    Ok(bits as u8)
}

/// Checks that a scene with this light, with a sky or without, has all of `layers`.
///
/// # Errors
/// [`SceneError::Value`]
pub(in crate::scene) fn layers(
    layers: LayerSet,
    light: Option<Light>,
    has_sky: bool,
) -> Result<(), SceneError> {
    let check = |is_allowed, reason| {
        SceneError::check(is_allowed, "image.layers", format_args!("{layers}"), reason)
    };
    check(
        !layers.has(Layer::Alpha),
        "alpha is no layer of its own; files hold it beside colour",
    )?;
    check(
        !layers.has(Layer::Colour) || light.is_some() || has_sky,
        "a disk without light has no colour; add the table [disk.light] or [sky], or remove this layer",
    )?;
    check(
        !layers.has(Layer::Temperature) || matches!(light, Some(Light::BlackBody { .. })),
        "only black bodies have a temperature; set disk.light.model = \"blackbody\" or remove this layer",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Animation, Scene, Tone};

    const NONE: &str = "";
    const TABLE: &str = "[disk.light]\n";
    const BLACK_BODY: &str = "[disk.light]\nmodel = \"blackbody\"\ntemperature = 7000";
    const BOLOMETRIC: &str = "[disk.light]\nmodel = \"bolometric\"";

    fn scene(light: &str, image: &str) -> Result<Scene, SceneError> {
        Scene::from_toml(&format!(
            "[camera]\nposition = [20, 0, 5]\nfov = 40\n[disk]\ninner = 3\nouter = 12\n{light}\n\
             [image]\nwidth = 64\nheight = 36\n{image}"
        ))
    }

    /// Asserts that a sentence with all of `words` refuses the scene.
    fn refused(light: &str, image: &str, words: &[&str]) {
        let message = scene(light, image)
            .expect_err(&format!("{light}\n{image}"))
            .to_string();
        for word in words {
            assert!(message.contains(word), "{light}\n{image}: {message}");
        }
    }

    #[test]
    fn what_is_not_said_has_its_default() {
        let mask = scene(NONE, "").unwrap();
        assert_eq!(
            (mask.light(), mask.exposure(), mask.tone(), mask.bits()),
            (None, 0.0, Tone::Neutral, 8)
        );
        assert!(mask.layers().is_empty());
        let scene = |light| {
            scene(
                light,
                "exposure = -2\ntone = \"none\"\nbits = 16\nlayers = [\"colour\", \"order\"]",
            )
            .unwrap()
        };
        assert_eq!(
            scene(BLACK_BODY).light(),
            Some(Light::BlackBody {
                temperature: 7000.0
            })
        );
        let lit = scene(BOLOMETRIC);
        assert_eq!(
            (lit.light(), lit.exposure(), lit.tone(), lit.bits()),
            (Some(Light::Bolometric), -2.0, Tone::None, 16)
        );
        assert!(lit.layers().iter().eq([Layer::Order, Layer::Colour]));
    }

    #[test]
    fn temperatures() {
        for kelvin in ["99.9", "0", "-7000", "1.1e9", "nan", "inf"] {
            let light = BLACK_BODY.replace("7000", kelvin);
            refused(
                &light,
                "",
                &["disk.light.temperature = ", "100 to 1e9 kelvin"],
            );
        }
        for kelvin in ["100", "1e9"] {
            assert!(scene(&BLACK_BODY.replace("7000", kelvin), "").is_ok());
        }
        refused(
            &BLACK_BODY.replace("temperature = 7000", ""),
            "",
            &["line", "disk.light.temperature is missing", "kelvin"],
        );
        refused(
            &format!("{BOLOMETRIC}\ntemperature = 7000"),
            "",
            &["line", "bolometric", "remove it"],
        );
        refused(
            &BLACK_BODY.replace("7000", "\"hot\""),
            "",
            &["line", "expected a number"],
        );
    }

    #[test]
    fn models() {
        for text in [TABLE.to_owned(), format!("{TABLE}temperature = 7000")] {
            refused(
                &text,
                "",
                &[
                    "line",
                    "disk.light.model is missing",
                    "blackbody",
                    "bolometric",
                ],
            );
        }
        refused(
            &BOLOMETRIC.replace("bolometric", "neon"),
            "",
            &["line", "`neon`", "`blackbody`", "`bolometric`"],
        );
        refused(
            &format!("{BOLOMETRIC}\ncolour = 3"),
            "",
            &["line", "`colour`"],
        );
        refused(
            "light = 3",
            "",
            &["line", "expected the table [disk.light]"],
        );
    }

    #[test]
    fn exposures_bits_and_tones() {
        for stops in ["100.1", "-1e300", "nan", "inf"] {
            refused(
                BLACK_BODY,
                &format!("exposure = {stops}"),
                &["image.exposure = ", "-100 to 100 stops"],
            );
        }
        for bits in ["0", "-8", "10", "32", "9223372036854775807"] {
            refused(
                BLACK_BODY,
                &format!("bits = {bits}"),
                &["image.bits = ", bits, "8 or 16"],
            );
        }
        refused(
            BLACK_BODY,
            "bits = 8.0",
            &["line", "expected a whole number"],
        );
        refused(
            BLACK_BODY,
            "tone = \"filmic\"",
            &["line", "`filmic`", "`neutral`", "`none`"],
        );
        assert!(
            scene(BLACK_BODY, "exposure = 100").is_ok()
                && scene(BLACK_BODY, "exposure = -100").is_ok()
        );
    }

    #[test]
    fn layers_that_do_not_exist_or_that_the_light_does_not_have() {
        refused(
            BLACK_BODY,
            "layers = [\"radius\", \"depth\"]",
            &["line", "\"depth\"", "coverage, order, radius"],
        );
        refused(
            BLACK_BODY,
            "layers = [\"alpha\"]",
            &[
                "line",
                "\"alpha\"",
                "emission_cosine, temperature, colour, sky, sky_uv",
            ],
        );
        refused(
            BLACK_BODY,
            "layers = [\"radius\", \"radius\"]",
            &["line", "\"radius\"", "twice"],
        );
        refused(
            BLACK_BODY,
            "layers = \"radius\"",
            &["line", "expected a list"],
        );
        refused(
            NONE,
            "layers = [\"colour\"]",
            &["image.layers = [\"colour\"]", "[disk.light]"],
        );
        refused(
            NONE,
            "layers = [\"temperature\"]",
            &["image.layers", "blackbody"],
        );
        refused(
            BOLOMETRIC,
            "layers = [\"temperature\"]",
            &["image.layers", "blackbody"],
        );
        let known = LayerSet::from_iter(Layer::NAMED).to_string();
        assert!(scene(BLACK_BODY, &format!("layers = {known}")).is_ok());
        assert!(
            scene(
                NONE,
                "layers = [\"radius\", \"redshift\", \"emission_cosine\"]"
            )
            .is_ok()
        );
    }

    #[test]
    fn setters_check_what_files_are_checked_for() {
        let scene = scene(NONE, "").unwrap();
        let animation = Animation::from_toml(&scene.to_toml()).unwrap();
        let black_body = |temperature| Some(Light::BlackBody { temperature });
        let only = |layer| LayerSet::default().with(layer);
        for kelvin in [99.0, 2e9, f64::NAN] {
            assert!(scene.clone().with_light(black_body(kelvin)).is_err());
            assert!(animation.clone().with_light(black_body(kelvin)).is_err());
        }
        assert!(
            scene.clone().with_exposure(f64::NAN).is_err()
                && animation.clone().with_exposure(101.0).is_err()
        );
        assert!(scene.clone().with_bits(10).is_err() && animation.clone().with_bits(0).is_err());
        for layer in [Layer::Colour, Layer::Temperature, Layer::Alpha] {
            assert!(scene.clone().with_layers(only(layer)).is_err());
            assert!(animation.clone().with_layers(only(layer)).is_err());
        }
        let lit = scene
            .with_light(black_body(7000.0))
            .and_then(|lit| lit.with_layers(only(Layer::Temperature)));
        let lit = lit
            .and_then(|lit| lit.with_exposure(1.5))
            .and_then(|lit| lit.with_bits(16));
        let lit = lit.unwrap().with_tone(Tone::None);
        assert!(lit.clone().with_light(None).is_err());
        assert!(lit.clone().with_light(Some(Light::Bolometric)).is_err());
        let film = animation
            .with_light(black_body(7000.0))
            .and_then(|lit| lit.with_layers(only(Layer::Temperature)));
        let film = film
            .and_then(|lit| lit.with_exposure(1.5))
            .and_then(|lit| lit.with_bits(16));
        let film = film.unwrap().with_tone(Tone::None);
        assert_eq!(film.frame(1).unwrap(), lit);
        assert_eq!(film.to_toml(), lit.to_toml());
        assert!(film.with_light(None).is_err());
    }
}
