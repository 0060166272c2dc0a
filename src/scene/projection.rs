//! How directions become places in the picture; `lens.rs` has the formulas.

use serde::Deserialize;

/// The height of a picture of the whole sphere, in degrees.
pub(super) const SPHERE: f64 = 180.0;

/// How directions become places in the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
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

impl TryFrom<String> for Projection {
    type Error = String;

    fn try_from(name: String) -> Result<Self, Self::Error> {
        let all = [Self::Perspective, Self::Fisheye, Self::Equirectangular];
        let named = all.into_iter().find(|projection| projection.name() == name);
        named.ok_or_else(|| {
            format!(
                "there is no projection {name:?}; there are perspective, fisheye and equirectangular"
            )
        })
    }
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

#[cfg(test)]
mod tests {
    use super::super::{Animation, Override, Scene, SceneError};
    use super::*;

    fn scene(camera: &str, size: &str) -> Result<Scene, SceneError> {
        Scene::from_toml(&format!(
            "[camera]\nradius = 20\ninclination = 80\n{camera}\n[disk]\n[image]\n{size}\n"
        ))
    }

    #[test]
    fn projections_have_names_and_defaults() {
        let fisheye = scene("projection = \"fisheye\"", "").unwrap();
        assert_eq!(fisheye.camera().projection, Projection::Fisheye);
        assert_eq!(fisheye.camera().fov_degrees, 180.0);
        let sphere = scene(
            "projection = \"equirectangular\"",
            "width = 64\nheight = 32",
        );
        let sphere = sphere.unwrap();
        assert_eq!(sphere.camera().projection, Projection::Equirectangular);
        for scene in [fisheye, sphere] {
            assert_eq!(Scene::from_toml(&scene.to_toml()).unwrap(), scene);
        }
        let flat = scene("projection = \"perspective\"", "").unwrap();
        assert!(!flat.to_toml().contains("projection"));
        assert_eq!(flat.camera().fov_degrees, 30.0);
    }

    #[test]
    fn what_makes_no_sense_is_told() {
        for (camera, size, words) in [
            ("projection = \"dome\"", "", ["fisheye", "equirectangular"]),
            ("projection = 5", "", ["`5`", "text"]),
            ("fov = 200", "", ["camera.fov", "fisheye"]),
            (
                "projection = \"fisheye\"\nfov = 361",
                "",
                ["camera.fov", "360"],
            ),
            (
                "projection = \"fisheye\"\nfov = 0",
                "",
                ["camera.fov", "360"],
            ),
            (
                "projection = \"fisheye\"\nfov_horizontal = 90",
                "",
                ["camera.fov_horizontal", "whole angle"],
            ),
            (
                "projection = \"equirectangular\"\nfov = 90",
                "width = 64\nheight = 32",
                ["camera.fov", "whole sphere"],
            ),
            (
                "projection = \"equirectangular\"",
                "width = 64\nheight = 33",
                ["image.width", "66x33"],
            ),
        ] {
            let error = scene(camera, size).expect_err(camera).to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
        let sphere = scene(
            "projection = \"equirectangular\"",
            "width = 64\nheight = 32",
        );
        let error = sphere.unwrap().with_size(64, 64).unwrap_err().to_string();
        assert!(error.contains("image.width"), "{error}");
    }

    #[test]
    fn keyframes_do_not_zoom_a_whole_sphere() {
        let error = Animation::from_toml(
            "[camera]\nposition = [20, 0, 3]\nprojection = \"equirectangular\"\n[disk]\n\
             [image]\nwidth = 64\nheight = 32\n\
             [animation]\nframes = 9\n[[animation.keyframe]]\nframe = 1\nfov = 3\n",
        );
        let error = error.unwrap_err().to_string();
        assert!(error.contains("animation.keyframe.fov"), "{error}");
    }

    #[test]
    fn an_override_takes_the_place_of_the_field_of_view() {
        let load = |overrides: &[&str]| {
            let overrides: Vec<_> = overrides
                .iter()
                .map(|text| Override::parse(text).unwrap())
                .collect();
            Animation::load_with("classic", &overrides)?.first_frame()
        };
        let dome = load(&["camera.projection=fisheye"]).unwrap();
        assert_eq!(dome.camera().fov_degrees, 180.0);
        for order in [
            ["camera.projection=fisheye", "camera.fov=220"],
            ["camera.fov=220", "camera.projection=fisheye"],
        ] {
            assert_eq!(load(&order).unwrap().camera().fov_degrees, 220.0);
        }
        let sphere = [
            "camera.projection=equirectangular",
            "image.width=64",
            "image.height=32",
        ];
        assert_eq!(load(&sphere).unwrap().camera().fov_degrees, 180.0);
    }
}
