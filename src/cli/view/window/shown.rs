//! What of a scene is shown: its mask, its light, or a layer of its data in false colour.

use crate::render::Form;
use crate::scene::{Layer, LayerSet, Light, Scene, SceneError};

/// The light of a disk whose scene gives it none.
const DEFAULT_LIGHT: Light = Light::BlackBody {
    temperature: 7000.0,
};

/// What of a scene is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shown {
    /// Where the disk is.
    Mask,
    /// Its light, and the sky's.
    Light,
    /// One number of a layer.
    Channel(Layer, usize),
}

/// All that can be shown, in the order of the key.
const ALL: [Shown; 14] = [
    Shown::Mask,
    Shown::Light,
    Shown::Channel(Layer::Coverage, 0),
    Shown::Channel(Layer::Order, 0),
    Shown::Channel(Layer::Radius, 0),
    Shown::Channel(Layer::Azimuth, 0),
    Shown::Channel(Layer::Redshift, 0),
    Shown::Channel(Layer::EmissionCosine, 0),
    Shown::Channel(Layer::Temperature, 0),
    Shown::Channel(Layer::Sky, 0),
    Shown::Channel(Layer::Sky, 1),
    Shown::Channel(Layer::Sky, 2),
    Shown::Channel(Layer::SkyUv, 0),
    Shown::Channel(Layer::SkyUv, 1),
];

impl Shown {
    /// What pictures of a scene show.
    pub(super) fn of(scene: &Scene) -> Self {
        if scene.shows_colour() {
            Self::Light
        } else {
            Self::Mask
        }
    }

    /// Returns what comes so many places after this one, of what a scene has.
    pub(super) fn after(self, scene: &Scene, places: usize) -> Self {
        let has = |shown: &Self| match shown {
            Self::Light | Self::Channel(Layer::Sky | Layer::SkyUv, _) => true,
            Self::Channel(Layer::Temperature, _) => {
                scene.disk().is_some() && scene.light() != Some(Light::Bolometric)
            }
            Self::Mask | Self::Channel(..) => scene.disk().is_some(),
        };
        let all: Vec<Self> = ALL.into_iter().filter(has).collect();
        let place = all.iter().position(|&shown| shown == self);
        all[place.map_or(0, |place| place + places) % all.len()]
    }

    /// Returns what comes before this one.
    pub(super) fn before(self, scene: &Scene) -> Self {
        let mut shown = self;
        while shown.after(scene, 1) != self {
            shown = shown.after(scene, 1);
        }
        shown
    }

    /// Its name.
    pub(super) fn name(self) -> String {
        let component = |names: [&str; 3], component: usize| names[component].to_owned();
        match self {
            Self::Mask => "mask".into(),
            Self::Light => "light".into(),
            Self::Channel(Layer::Sky, c) => component(["sky.x", "sky.y", "sky.z"], c),
            Self::Channel(Layer::SkyUv, c) => component(["sky.u", "sky.v", ""], c),
            Self::Channel(layer, _) => layer.name().into(),
        }
    }

    /// The pixels that are drawn of it.
    pub(super) fn form(self) -> Form {
        match self {
            Self::Mask => Form::Grey8,
            Self::Light => Form::Rgb8,
            Self::Channel(layer, _) => Form::Layers(LayerSet::default().with(layer)),
        }
    }

    /// Returns the scene of which `darkness render` draws what is shown: 8 bits a sample; without light and sky for a
    /// mask; with a light where the disk has none and it is light that is shown.
    ///
    /// # Errors
    /// None for what [`Self::after`] returns of this scene.
    pub(super) fn scene(self, scene: &Scene) -> Result<Scene, SceneError> {
        let scene = scene
            .clone()
            .with_layers(LayerSet::default())?
            .with_bits(8)?;
        let is_dark = !scene.shows_colour();
        match self {
            Self::Mask => scene.with_light(None)?.with_sky(None),
            Self::Light if is_dark => scene.with_light(Some(DEFAULT_LIGHT)),
            Self::Light => Ok(scene),
            Self::Channel(layer, _) => {
                let scene = if layer == Layer::Temperature && scene.light().is_none() {
                    scene.with_light(Some(DEFAULT_LIGHT))?
                } else {
                    scene
                };
                scene.with_layers(LayerSet::default().with(layer))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtins;

    #[test]
    fn every_builtin_scene_can_show_what_the_keys_step_through() {
        for builtin in builtins() {
            let scene = Scene::builtin(builtin.name()).unwrap();
            let first = Shown::of(&scene);
            let mut shown = first;
            let mut names = Vec::new();
            loop {
                let drawn = shown.scene(&scene).unwrap();
                assert_eq!(drawn.camera(), scene.camera());
                if let Shown::Channel(layer, component) = shown {
                    assert!(drawn.layers().has(layer) && component < layer.channels());
                } else {
                    assert_eq!(drawn.shows_colour(), shown == Shown::Light);
                }
                names.push(shown.name());
                let next = shown.after(&scene, 1);
                assert_eq!(next.before(&scene), shown);
                shown = next;
                if shown == first {
                    break;
                }
            }
            let count = if scene.light() == Some(Light::Bolometric) {
                13
            } else {
                14
            };
            assert_eq!(
                names.len(),
                if scene.disk().is_some() { count } else { 6 },
                "{names:?}"
            );
        }
    }
}
