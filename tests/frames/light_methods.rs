//! Layers and colours of one scene by every method: from the map of the camera's radius, and from each pixel's own ray,
//! followed in closed form, by the table and by integration.

use darkness::Renderer;
use darkness::light::rec709::luminance;
use darkness::orbit::Orbits;
use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::Adaptive;
use darkness::scene::{Layer, Projection, Scene};

use crate::light_references::Worst;
use crate::lit::{Edges, Layers, builtin_lit_scenes, random_lit_scenes, rgb_by_rays};
use crate::projections::seen_by;
use crate::tables::table;

/// What data may differ by, relative (radius, redshift) or not (azimuth, emission cosine). Table and map are right to
/// 1e-7 or so, and a float32 is rounded by 6e-8.
const MOST: f64 = 1e-6;

/// What 8-bit codes may differ by: amplitudes are right to 2e-5, a twentieth of a code where light rises fastest, so
/// that the rounding may fall otherwise.
const MOST_CODES: u8 = 1;

/// One in so many of the pixels that are seen may have another code. One in 1,500 was seen.
const ONE_IN: usize = 500;

/// How frames differ from those of exact rays.
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
    /// Pixels that differ by more than is allowed.
    wrong: Vec<String>,
}

/// A frame's layers and its 8-bit colours.
type Frame = (Layers, Vec<u8>);

impl Apart {
    fn add(
        &mut self,
        name: &str,
        scene: &Scene,
        (layers, rgb): &Frame,
        (exact, exact_rgb): &Frame,
    ) {
        let edges = Edges::new(scene);
        let width = scene.image().width as usize;
        for pixel in 0..rgb.len() / 3 {
            let place = ((pixel % width) as u32, (pixel / width) as u32);
            let sights = [layers, exact].map(|layers| layers.sight(pixel));
            let hides = [layers, exact].map(|layers| layers.plane(Layer::Alpha)[pixel]);
            let orders = sights.map(|sight| sight.map(|sight| sight.order));
            if orders[0] != orders[1] || hides[0] != hides[1] {
                self.at_edges += 1;
                if !edges.have(place) {
                    self.wrong
                        .push(format!("{name}, {place:?}: {sights:?}, alpha {hides:?}"));
                }
                continue;
            }
            let codes = [rgb, exact_rgb].map(|rgb| [0, 1, 2].map(|c| rgb[3 * pixel + c]));
            let apart = (0..3).map(|c| codes[0][c].abs_diff(codes[1][c])).max();
            let apart = apart.unwrap_or(0);
            self.codes = self.codes.max(apart);
            self.coloured += usize::from(apart > 0);
            let [Some(found), Some(known)] = sights else {
                continue;
            };
            self.lit += 1;
            let mut here = Worst::default();
            here.add(&found, &known);
            if here.greatest() > MOST || apart > MOST_CODES {
                self.wrong
                    .push(format!("{name}, {place:?}: {here:?}, {codes:?}, {known:?}"));
            }
            self.data.add(&found, &known);
            let light = [layers, exact].map(|layers| luminance(layers.colour(pixel)));
            // What is darker has no code.
            if light[1] > 1e-6 {
                self.light = self.light.max((light[0] / light[1] - 1.0).abs());
            }
        }
    }
}

fn by_rays(scene: &Scene, orbits: &impl Orbits) -> Frame {
    (Layers::by_rays(scene, orbits), rgb_by_rays(scene, orbits))
}

fn by_map(scene: &Scene) -> Frame {
    let rgb = Renderer::new(table("standard")).render_rgb(scene).unwrap();
    let layers = Layers::rendered(scene, table("standard").lookup());
    (layers, rgb.into_raw())
}

fn compare(scenes: impl IntoIterator<Item = (String, Scene)>, least_lit: usize) {
    let mut all: [Apart; 3] = Default::default();
    for (name, scene) in scenes {
        let exact = by_rays(&scene, &Exact);
        let frames = [
            by_map(&scene),
            by_rays(&scene, &table("standard").lookup()),
            by_rays(&scene, &Adaptive::default()),
        ];
        for (apart, frame) in all.iter_mut().zip(&frames) {
            apart.add(&name, &scene, frame, &exact);
        }
    }
    for (name, apart) in ["map", "table", "integration"].iter().zip(&all) {
        println!("{name}: {apart:?}");
        assert!(apart.wrong.is_empty(), "{name}: {:?}", apart.wrong.first());
        assert!(apart.coloured * ONE_IN <= apart.lit, "{name}: {apart:?}");
        assert!(apart.lit > least_lit, "{name}: {apart:?}");
    }
}

#[test]
fn built_in_scenes_are_the_same_by_every_method() {
    compare(builtin_lit_scenes(), 5000);
}

#[test]
fn random_scenes_are_the_same_by_every_method() {
    let scenes = random_lit_scenes(100, (48, 36)).into_iter();
    let scenes = scenes.map(|(kind, scene)| (format!("{kind:?}, {}", scene.to_toml()), scene));
    compare(scenes, 5000);
}

#[test]
fn fisheyes_and_whole_spheres_are_the_same_by_every_method() {
    let scenes = random_lit_scenes(60, (48, 36)).into_iter().enumerate();
    let scenes = scenes.map(|(number, (kind, scene))| {
        let (projection, fov) = match number % 4 {
            0 => (Projection::Fisheye, 360.0),
            1 => (Projection::Fisheye, scene.camera().fov_degrees),
            _ => (Projection::Equirectangular, 180.0),
        };
        let scene = seen_by(&scene, projection, fov, 36);
        (format!("{kind:?}, {}", scene.to_toml()), scene)
    });
    compare(scenes, 2000);
}
