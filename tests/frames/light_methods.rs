//! Layers and colours of one scene by every method: from the map of the camera's radius, and from each pixel's own ray,
//! followed in closed form, by the table and by integration.

use darkness::Renderer;
use darkness::light::rec709::luminance;
use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::Adaptive;
use darkness::scene::{Layer, Scene};

use crate::light_references::Worst;
use crate::lit::{Edges, Layers, builtin_lit_scenes, random_lit_scenes, rgb_by_rays};
use crate::tables::table;

/// How two frames differ.
#[derive(Debug, Default)]
struct Apart {
    lit: usize,
    at_edges: usize,
    data: Worst,
    /// Of the luminance, relative.
    light: f64,
    /// Of 8-bit colours: the greatest, and how many pixels have any.
    codes: u8,
    coloured: usize,
    wrong: Vec<String>,
}

impl Apart {
    /// Adds what two frames of a scene show.
    fn add(&mut self, scene: &Scene, (a, b): (&Layers, &Layers), (a_rgb, b_rgb): (&[u8], &[u8])) {
        let edges = Edges::new(scene);
        let width = scene.image().width as usize;
        for pixel in 0..a_rgb.len() / 3 {
            let place = ((pixel % width) as u32, (pixel / width) as u32);
            let (a_sight, b_sight) = (a.sight(pixel), b.sight(pixel));
            let alpha = [a, b].map(|layers| layers.plane(Layer::Alpha)[pixel]);
            if a_sight.map(|s| s.order) != b_sight.map(|s| s.order)
                || (alpha[0] != alpha[1] && a_sight.is_some())
            {
                if edges.have(place) {
                    self.at_edges += 1;
                } else {
                    self.wrong
                        .push(format!("{place:?}: {a_sight:?} or {b_sight:?}"));
                }
                continue;
            }
            let codes = |rgb: &[u8]| [0, 1, 2].map(|c| rgb[3 * pixel + c]);
            let (a_codes, b_codes) = (codes(a_rgb), codes(b_rgb));
            let most = (0..3).map(|c| a_codes[c].abs_diff(b_codes[c])).max();
            let most = most.unwrap_or(0);
            self.codes = self.codes.max(most);
            self.coloured += usize::from(most > 0);
            if most > 1 {
                self.wrong.push(format!(
                    "{place:?}: {a_codes:?} or {b_codes:?}, {b_sight:?}"
                ));
            }
            let (Some(a_sight), Some(b_sight)) = (a_sight, b_sight) else {
                continue;
            };
            self.lit += 1;
            let mut here = Worst::default();
            here.add(&a_sight, &b_sight);
            if here
                .radius
                .max(here.azimuth)
                .max(here.redshift)
                .max(here.cosine)
                > 1e-6
            {
                self.wrong.push(format!("{place:?}: {here:?}, {b_sight:?}"));
            }
            self.data.add(&a_sight, &b_sight);
            let [a_light, b_light] = [a, b].map(|layers| luminance(layers.colour(pixel)));
            if b_light > 1e-9 {
                self.light = self.light.max((a_light / b_light - 1.0).abs());
            }
        }
    }
}

fn compare(scenes: impl IntoIterator<Item = (String, Scene)>) {
    let lookup = table("standard").lookup();
    let mut all: [Apart; 3] = Default::default();
    for (name, scene) in scenes {
        let exact = Layers::by_rays(&scene, &Exact);
        let exact_rgb = rgb_by_rays(&scene, &Exact);
        let mut renderer = Renderer::new(table("standard"));
        let map = Layers::rendered(&scene, table("standard").lookup());
        let map_rgb = renderer.render_rgb(&scene).unwrap().into_raw();
        let looked_up = Layers::by_rays(&scene, &lookup);
        let looked_up_rgb = rgb_by_rays(&scene, &lookup);
        let adaptive = Adaptive::default();
        let integrated = Layers::by_rays(&scene, &adaptive);
        let integrated_rgb = rgb_by_rays(&scene, &adaptive);
        let others = [
            (&map, &map_rgb),
            (&looked_up, &looked_up_rgb),
            (&integrated, &integrated_rgb),
        ];
        for (k, (layers, rgb)) in others.into_iter().enumerate() {
            let mut apart = Apart::default();
            apart.add(&scene, (layers, &exact), (rgb, &exact_rgb));
            let wrong = apart.wrong.len();
            if wrong > 0 {
                println!(
                    "{name} by method {k}: {wrong} wrong, {:?}\n{}",
                    &apart.wrong[..wrong.min(3)],
                    scene.to_toml()
                );
            }
            all[k].add(&scene, (layers, &exact), (rgb, &exact_rgb));
        }
    }
    for (name, apart) in ["map", "table", "integrated"].iter().zip(&all) {
        println!("{name}: {apart:?}");
    }
    for apart in &all {
        assert!(apart.wrong.is_empty());
    }
}

#[test]
fn built_in_scenes_are_the_same_by_every_method() {
    compare(builtin_lit_scenes());
}

#[test]
fn random_scenes_are_the_same_by_every_method() {
    let scenes = random_lit_scenes(
        std::env::var("CASES").map_or(40, |c| c.parse().unwrap()),
        (48, 36),
    )
    .into_iter();
    compare(scenes.map(|(kind, scene)| (format!("{kind:?}"), scene)));
}
