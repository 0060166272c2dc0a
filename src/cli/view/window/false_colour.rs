//! Numbers as colours: viridis, which is perceptually uniform and can be read by the colour-blind, and its scale.

use colorous::VIRIDIS;

use super::bitmap::colour;
use super::shown::Shown;
use crate::scene::{Layer, Scene};

/// The numbers at the ends of a scale of colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ColourScale {
    pub(super) from: f64,
    pub(super) to: f64,
}

/// The colour where there is no number: black, which is not on the scale.
const NOTHING: u32 = 0;

/// The number of colours, so that a pixel only looks its colour up.
const COLOURS: usize = 1024;

/// The orders on the scale.
const ORDERS: f64 = 3.0;

impl ColourScale {
    /// The scale of a layer's channel: all that it can be, or else all that there is in `values`.
    pub(super) fn new(scene: &Scene, layer: Layer, values: impl Iterator<Item = f32>) -> Self {
        let (from, to) = match (layer, scene.disk()) {
            (Layer::Coverage | Layer::EmissionCosine | Layer::SkyUv, _) => (0.0, 1.0),
            (Layer::Order, _) => (0.0, ORDERS),
            (Layer::Radius, Some(disk)) => (disk.inner, disk.outer),
            (Layer::Azimuth, _) => (0.0, std::f64::consts::TAU),
            (Layer::Sky, _) => (-1.0, 1.0),
            _ => {
                let finite = values.filter(|value| value.is_finite());
                let ends = finite.fold(None, |ends: Option<(f32, f32)>, value| {
                    let (least, most) = ends.unwrap_or((value, value));
                    Some((least.min(value), most.max(value)))
                });
                let (least, most) = ends.unwrap_or((0.0, 1.0));
                (least.into(), most.into())
            }
        };
        Self { from, to }
    }

    /// Returns the colours of the scale, as [`Self::of`] looks them up.
    pub(super) fn colours() -> Vec<u32> {
        let of = |place| {
            let colorous::Color { r, g, b } = VIRIDIS.eval_continuous(place);
            colour([r, g, b])
        };
        (0..COLOURS)
            .map(|i| of(i as f64 / (COLOURS - 1) as f64))
            .collect()
    }

    /// Returns the colour of a number, of a layer that holds `nothing` where there is none.
    pub(super) fn of(self, colours: &[u32], value: f32, nothing: f32) -> u32 {
        if !value.is_finite() || value == nothing {
            return NOTHING;
        }
        let span = self.to - self.from;
        let place = if span > 0.0 {
            (f64::from(value) - self.from) / span
        } else {
            0.5
        };
        let last = colours.len() - 1;
        let place = (place * last as f64 + 0.5).clamp(0.0, last as f64);
        colours[place as usize]
    }

    /// Returns what stands beside the scale: the name of what is shown, and the numbers at its ends.
    pub(super) fn labels(self, shown: Shown) -> [String; 3] {
        let (unit, factor) = match shown {
            Shown::Channel(Layer::Azimuth, _) => ("°", 1_f64.to_degrees()),
            Shown::Channel(Layer::Temperature, _) => (" K", 1.0),
            _ => ("", 1.0),
        };
        let label = |value: f64| {
            let value = value * factor;
            // Four digits.
            let digits = match value.abs() {
                size if size >= 1000.0 => 0,
                size if size >= 100.0 => 1,
                size if size >= 10.0 => 2,
                _ => 3,
            };
            let text = format!("{value:.digits$}");
            let short = if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.')
            } else {
                &text
            };
            format!("{short}{unit}")
        };
        [label(self.from), shown.name(), label(self.to)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lightness L* of a colour.
    fn lightness(colour: u32) -> f64 {
        let linear =
            |shift: u32| crate::light::srgb::decode(f64::from(colour >> shift & 255) / 255.0);
        let y = 0.2126 * linear(16) + 0.7152 * linear(8) + 0.0722 * linear(0);
        116.0 * libm::cbrt(y) - 16.0
    }

    #[test]
    fn lightness_grows_evenly_along_the_scale() {
        let colours = ColourScale::colours();
        let from = lightness(colours[0]);
        let step = (lightness(colours[COLOURS - 1]) - from) / (COLOURS - 1) as f64;
        for (i, &colour) in colours.iter().enumerate() {
            // A tenth of the span would be seen as a band.
            let even = from + step * i as f64;
            assert!((lightness(colour) - even).abs() < 3.0, "{i}");
        }
    }

    #[test]
    fn numbers_have_the_colours_of_their_places() {
        let scene = Scene::builtin("lit").unwrap();
        let colours = ColourScale::colours();
        let scale = ColourScale::new(&scene, Layer::Radius, std::iter::empty());
        let of = |value| scale.of(&colours, value, f32::NAN);
        assert_eq!((of(3.0), of(12.0)), (colours[0], colours[COLOURS - 1]));
        assert_eq!((of(2.0), of(99.0)), (of(3.0), of(12.0)));
        assert_eq!(of(f32::NAN), NOTHING);
        assert!(!colours.contains(&NOTHING));
        let values = [f32::NAN, 0.5, 1.5, f32::NAN];
        let found = ColourScale::new(&scene, Layer::Redshift, values.into_iter());
        assert_eq!(found, ColourScale { from: 0.5, to: 1.5 });
        let flat = ColourScale { from: 1.0, to: 1.0 };
        assert_eq!(flat.of(&colours, 1.0, f32::NAN), colours[COLOURS / 2]);
        assert_eq!(scale.of(&colours, -1.0, Layer::Order.nothing()), NOTHING);
    }

    #[test]
    fn labels_are_short_and_have_units() {
        let labels = |from, to, layer| ColourScale { from, to }.labels(Shown::Channel(layer, 0));
        assert_eq!(labels(3.0, 12.0, Layer::Radius), ["3", "radius", "12"]);
        let azimuth = labels(0.0, std::f64::consts::TAU, Layer::Azimuth);
        assert_eq!(azimuth, ["0°", "azimuth", "360°"]);
        let temperature = labels(812.34, 10234.5, Layer::Temperature);
        assert_eq!(temperature, ["812.3 K", "temperature", "10234 K"]);
        assert_eq!(labels(0.4812, 1.4, Layer::Redshift)[0], "0.481");
    }
}
