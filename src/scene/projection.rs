//! How directions become places in the picture; `lens.rs` has the formulas.

use serde::Deserialize;

/// How directions become places in the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Projection {
    /// A flat picture: straight lines stay straight.
    #[default]
    Perspective,
    /// A disk in the middle of the picture, as domes show it: distances from its centre are angles from the direction
    /// ahead. The disk is as high as the picture, and the field of view is its whole angle.
    Fisheye,
    /// The whole sphere: longitude across, latitude down. The direction ahead is in the centre.
    Equirectangular,
}

impl Projection {
    /// The projection's name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Perspective => "perspective",
            Self::Fisheye => "fisheye",
            Self::Equirectangular => "equirectangular",
        }
    }

    /// Returns the greatest number of pixels in a radian, as a multiple of that in the picture's centre, at an angle
    /// with this cosine: from the picture's centre, or for an equirectangular picture from its horizon.
    ///
    /// In perspective that is `1/cos² θ`. The fisheye's is `θ/sin θ`, at most `1/cos²(θ/2)`. The last is `1/cos θ`.
    pub fn stretch(self, cosine: f64) -> f64 {
        match self {
            Self::Perspective => 1.0 / (cosine * cosine),
            Self::Fisheye => 2.0 / (1.0 + cosine),
            Self::Equirectangular => 1.0 / cosine,
        }
    }
}
