//! The built-in scenes.

/// The name of the scene that is rendered where none is asked for.
pub const DEFAULT_SCENE: &str = "classic";

/// A built-in scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Builtin {
    name: &'static str,
    toml: &'static str,
}

impl Builtin {
    /// The built-in scene of this name, if there is one.
    pub(super) fn named(name: &str) -> Option<&'static Self> {
        builtins().iter().find(|builtin| builtin.name == name)
    }

    /// The name of the built-in scene that was probably meant by `name`, of which at most a third is wrong.
    pub fn meant(name: &str) -> Option<&'static str> {
        let names = builtins().iter().map(Self::name);
        let nearest = names.min_by_key(|known| strsim::osa_distance(name, known))?;
        let wrong = strsim::osa_distance(name, nearest);
        (3 * wrong <= nearest.len()).then_some(nearest)
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Its TOML form with comments: a file to start from.
    pub fn toml(&self) -> &'static str {
        self.toml
    }

    /// What it shows, in one line: the first comment of its TOML form.
    pub fn description(&self) -> &'static str {
        self.toml
            .lines()
            .next()
            .unwrap_or_default()
            .trim_start_matches('#')
            .trim()
    }
}

/// The built-in scenes, [`DEFAULT_SCENE`] first.
pub fn builtins() -> &'static [Builtin] {
    &BUILTINS
}

/// The scene in `builtin/NAME.toml`.
macro_rules! builtin {
    ($name:literal) => {
        Builtin {
            name: $name,
            toml: include_str!(concat!("builtin/", $name, ".toml")),
        }
    };
}

static BUILTINS: [Builtin; 17] = [
    builtin!("classic"),
    builtin!("face-on"),
    builtin!("edge-on"),
    builtin!("close-up"),
    builtin!("inside"),
    builtin!("photon-ring"),
    builtin!("lit"),
    builtin!("luminet"),
    builtin!("rings"),
    builtin!("grid"),
    builtin!("stars"),
    builtin!("orbit"),
    builtin!("approach"),
    builtin!("tilt"),
    builtin!("lit-orbit"),
    builtin!("plunge"),
    builtin!("flyby"),
];

#[cfg(test)]
mod tests {
    use super::super::{Animation, Light, Scene, StarSource, View};
    use super::*;

    #[test]
    fn every_builtin_is_a_valid_scene_with_a_description() {
        for builtin in builtins() {
            let scene = Scene::from_toml(builtin.toml()).unwrap();
            assert_eq!(Scene::builtin(builtin.name()).unwrap(), scene);
            let again = Scene::from_toml(&scene.to_toml()).unwrap();
            assert_eq!(again.camera(), scene.camera());
            assert_eq!(again.disk(), scene.disk());
            let animation = Animation::from_toml(builtin.toml()).unwrap();
            assert_eq!(
                Animation::from_toml(&animation.to_toml()).unwrap(),
                animation
            );
            for number in 1..=animation.last() {
                animation.check(number).unwrap();
            }
            assert!(builtin.toml().starts_with("# "), "{}", builtin.name());
            assert!(
                (20..100).contains(&builtin.description().chars().count()),
                "{}",
                builtin.description()
            );
        }
        assert_eq!(builtins()[0].name(), DEFAULT_SCENE);
    }

    #[test]
    fn a_misspelled_name_leads_to_the_one_that_was_meant() {
        for (name, meant) in [
            ("orbt", Some("orbit")),
            ("clasic", Some("classic")),
            ("classc", Some("classic")),
            ("lit_orbit", Some("lit-orbit")),
            ("Edge-on", Some("edge-on")),
            ("gird", Some("grid")),
            ("foo", None),
            ("mine.toml", None),
        ] {
            assert_eq!(Builtin::meant(name), meant, "{name}");
        }
    }

    #[test]
    fn the_scenes_are_what_their_names_say() {
        let scene = |name| Scene::builtin(name).unwrap();
        let radius = |name| scene(name).camera().position.length();
        assert_eq!(View::new(&scene("edge-on")).n_p(), 0.0);
        assert_eq!(View::new(&scene("face-on")).n_a(), 0.0);
        assert!((radius("close-up") - 6.0).abs() < 0.1);
        assert!(radius("inside") > 1.0 && radius("inside") < 1.5);
    }

    #[test]
    fn lit_scenes_are_what_their_names_say() {
        let light = |name| Scene::builtin(name).unwrap().light();
        let black_body = Some(Light::BlackBody {
            temperature: 7000.0,
        });
        for name in ["lit", "rings", "lit-orbit", "plunge"] {
            assert_eq!(light(name), black_body, "{name}");
        }
        assert_eq!(light("luminet"), Some(Light::Bolometric));
        assert_eq!(light(DEFAULT_SCENE), None);
        let classic = Scene::builtin("classic").unwrap();
        assert_eq!(
            classic.with_light(black_body).unwrap(),
            Scene::builtin("lit").unwrap()
        );
        let orbit = Animation::load("orbit").unwrap();
        assert_eq!(
            orbit.with_light(black_body).unwrap(),
            Animation::load("lit-orbit").unwrap()
        );
        // 80° from the pole.
        let n_p = |name| View::new(&Scene::builtin(name).unwrap()).n_p();
        for name in ["lit", "luminet", "rings"] {
            assert!(
                (n_p(name) - libm::cos(80.0_f64.to_radians())).abs() < 1e-5,
                "{name}"
            );
        }
    }

    #[test]
    fn skies_are_what_their_names_say() {
        let grid = Scene::builtin("grid").unwrap();
        assert!(grid.disk().is_none() && grid.sky().unwrap().grid == Some(15.0));
        let stars = Scene::builtin("stars").unwrap();
        let film = Animation::load("flyby").unwrap();
        let source = StarSource::Synthetic {
            count: 60_000,
            seed: 1,
        };
        for sky in [stars.sky(), film.sky()] {
            assert_eq!(sky.unwrap().stars.as_ref().unwrap().source, source);
        }
        let lit = Scene::builtin("lit").unwrap();
        assert_eq!((stars.disk(), stars.light()), (lit.disk(), lit.light()));
        assert!(lit.sky().is_none() && film.shows_colour() && grid.shows_colour());
        assert!(!Scene::builtin(DEFAULT_SCENE).unwrap().shows_colour());
    }

    #[test]
    fn the_flyby_passes_above_the_disk_and_the_hole_drifts_through_the_picture() {
        let film = Animation::load("flyby").unwrap();
        let mut before = f64::NEG_INFINITY;
        for number in 1..=film.last() {
            let scene = film.check(number).unwrap();
            assert!((25.0..38.0).contains(&scene.radius()) && scene.camera().position.z > 7.0);
            let camera = scene.camera();
            let ahead = (camera.focus - camera.position).normalize();
            let right = ahead.cross(camera.up).normalize();
            let x = -camera.position.dot(right) / -camera.position.dot(ahead);
            let half_width = libm::tan(20_f64.to_radians()) * 16.0 / 9.0;
            let place = -x / half_width;
            assert!(place >= before, "frame {number}");
            before = place;
            assert!(place.abs() < 1.0, "frame {number}: {place}");
            assert!(number > 1 || place < -0.9, "{place}");
        }
        assert!(before > 0.9, "{before}");
    }

    #[test]
    fn the_plunge_ends_above_the_photon_sphere_with_the_hole_in_view() {
        let plunge = Animation::load("plunge").unwrap();
        let mut before = f64::INFINITY;
        for number in 1..=plunge.last() {
            let scene = plunge.check(number).unwrap();
            assert!(scene.radius() <= before && scene.radius() > 1.5);
            before = scene.radius();
            // Above the disk.
            assert!(scene.camera().position.z > 1.0);
            // The angle from the picture's centre to the hole's, and to the shadow's nearest edge from there: all rays
            // within sin α = b_c √(1 − 1/r)/r, b_c = 3√3/2, fall in (Synge 1966).
            let view = View::new(&scene);
            let centre = view.ray_at(0.0, 0.0);
            let to_hole = libm::atan2(centre.transverse(), centre.z);
            let shadow = libm::asin(1.5 * 3.0_f64.sqrt() * view.slope_scale());
            let half_height = scene.camera().fov_degrees.to_radians() / 2.0;
            assert!((to_hole - shadow).abs() < half_height, "frame {number}");
        }
        assert!((before - 1.55).abs() < 1e-4);
    }

    #[test]
    fn the_photon_ring_scene_is_centred_on_the_shadows_edge() {
        let view = View::new(&Scene::builtin("photon-ring").unwrap());
        let centre = view.ray_at(0.0, 0.0);
        // A static observer sees the critical rays at sin α = b_c √(1 − 1/r)/r, b_c = 3√3/2 (Synge 1966).
        let edge = 1.5 * 3.0_f64.sqrt() * view.slope_scale();
        let (sine, half_height) = (centre.transverse(), view.y_at(0.0));
        assert!(
            (sine - edge).abs() < half_height,
            "{sine} {edge} {half_height}"
        );
        assert!(centre.ta > 0.0);
    }
}
