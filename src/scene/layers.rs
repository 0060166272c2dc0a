//! What a frame of data may hold: its layers.

use core::fmt;

use super::error::SceneError;
use crate::quotation::beginning;

/// The most characters of an unknown name that an error quotes.
const LONGEST_NAME: usize = 40;

/// One kind of data of every pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Layer {
    /// The share of the pixel's square that the disk covers, 0 to 1; with hard edges 0 or 1.
    Coverage,
    /// The order of the image in which the disk is seen, −1 where it is not.
    Order,
    /// The radius at which the disk is seen, in Schwarzschild radii.
    Radius,
    /// The azimuth about the disk's axis, counterclockwise, 0 to 2π.
    Azimuth,
    /// The ratio of observed to emitted frequency, `g = 1/(1 + z)`.
    Redshift,
    /// The cosine of the angle between the light and the disk's normal, where it is emitted and for the matter there.
    EmissionCosine,
    /// The temperature of the black body that is seen, in kelvin.
    Temperature,
    /// Linear light, red, green and blue of Rec. 709, times the pixel's coverage.
    Colour,
    /// The direction in which the ray of the pixel's centre leaves: a unit vector in the scene's axes.
    Sky,
    /// The place of that direction in a panorama that is turned as the scene's sky: `u = ½ − longitude/2π` and
    /// `v = ½ + latitude/π`.
    SkyUv,
    /// The share of the pixel's square that hides the sky: covered by the disk or by the hole's shadow.
    Alpha,
}

impl Layer {
    /// The layers that a scene may name.
    pub const NAMED: [Self; 10] = [
        Self::Coverage,
        Self::Order,
        Self::Radius,
        Self::Azimuth,
        Self::Redshift,
        Self::EmissionCosine,
        Self::Temperature,
        Self::Colour,
        Self::Sky,
        Self::SkyUv,
    ];

    /// The layer's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coverage => "coverage",
            Self::Order => "order",
            Self::Radius => "radius",
            Self::Azimuth => "azimuth",
            Self::Redshift => "redshift",
            Self::EmissionCosine => "emission_cosine",
            Self::Temperature => "temperature",
            Self::Colour => "colour",
            Self::Sky => "sky",
            Self::SkyUv => "sky_uv",
            Self::Alpha => "alpha",
        }
    }

    /// The layer that a scene calls by this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.into_iter().find(|layer| layer.name() == name)
    }

    /// The numbers that it has for each pixel.
    pub fn channels(self) -> usize {
        match self {
            Self::Colour | Self::Sky => 3,
            Self::SkyUv => 2,
            _ => 1,
        }
    }

    /// What it holds where nothing of the disk is seen; layers of the sky where nothing of the sky is.
    pub fn nothing(self) -> f32 {
        match self {
            Self::Coverage | Self::Colour | Self::Alpha => 0.0,
            Self::Order => -1.0,
            Self::Radius
            | Self::Azimuth
            | Self::Redshift
            | Self::EmissionCosine
            | Self::Temperature
            | Self::Sky
            | Self::SkyUv => f32::NAN,
        }
    }
}

/// A set of layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LayerSet(u16);

impl LayerSet {
    /// The same set with one layer more.
    #[must_use]
    pub fn with(self, layer: Layer) -> Self {
        Self(self.0 | 1 << layer as u16)
    }

    /// The layers of these names.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a name that [`Layer::NAMED`] does not have, and for one that comes twice.
    pub fn from_names<T: AsRef<str>>(
        names: impl IntoIterator<Item = T>,
    ) -> Result<Self, SceneError> {
        names.into_iter().try_fold(Self::default(), |set, name| {
            let name = name.as_ref();
            let wrong =
                |reason| SceneError::value("image.layers", beginning(name, LONGEST_NAME), reason);
            let layer = Layer::named(name).ok_or_else(|| {
                let known = Layer::NAMED.map(Layer::name).join(", ");
                wrong(format!(
                    "there is no layer of this name; the layers are {known}"
                ))
            })?;
            if set.has(layer) {
                return Err(wrong(
                    "this layer is named twice; remove one of them".into(),
                ));
            }
            Ok(set.with(layer))
        })
    }

    /// The same set without a layer.
    #[must_use]
    pub fn without(self, layer: Layer) -> Self {
        Self(self.0 & !(1 << layer as u16))
    }

    /// Whether a layer is in it.
    pub fn has(self, layer: Layer) -> bool {
        self.0 >> layer as u16 & 1 == 1
    }

    /// Whether no layer is in it.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Its layers, in the order of [`Layer`].
    pub fn iter(self) -> impl Iterator<Item = Layer> {
        let all = Layer::NAMED.into_iter().chain([Layer::Alpha]);
        all.filter(move |&layer| self.has(layer))
    }
}

impl FromIterator<Layer> for LayerSet {
    fn from_iter<T: IntoIterator<Item = Layer>>(layers: T) -> Self {
        layers.into_iter().fold(Self::default(), Self::with)
    }
}

/// The names, as TOML writes a list of them.
impl fmt::Display for LayerSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.iter().map(Layer::name).collect();
        write!(f, "{names:?}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_layer_is_found_by_its_name_and_written_as_toml() {
        let names = Layer::NAMED.map(Layer::name);
        let all = LayerSet::from_names(names).unwrap();
        assert!(all.iter().eq(Layer::NAMED));
        assert_eq!(all.to_string(), format!("{names:?}"));
        assert_eq!(
            LayerSet::from_names(["redshift", "radius"])
                .unwrap()
                .to_string(),
            r#"["radius", "redshift"]"#
        );
        assert!(LayerSet::from_names([""; 0]).unwrap().is_empty());
    }

    #[test]
    fn unknown_and_repeated_names_are_refused() {
        for (names, word) in [
            (["radius", "alpha"], "alpha"),
            (["", "order"], "redshift"),
            (["order"; 2], "twice"),
        ] {
            let message = LayerSet::from_names(names).unwrap_err().to_string();
            assert!(
                message.starts_with("image.layers = \"") && message.contains(word),
                "{message}"
            );
        }
    }
}
