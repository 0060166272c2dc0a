//! The light of pixels that the disk covers in part, against averages over many samples of their squares.

use std::path::Path;

use darkness::light::rec709::{linear_rgb, luminance};
use darkness::light::{Radiance, flux};
use darkness::render::pixelwise;
use darkness::scene::{Animation, Layer, Light, Scene, View};
use darkness::table::Lookup;

use crate::lit::Layers;
use crate::tables::table;

const LIT: Light = Light::BlackBody {
    temperature: 7000.0,
};

/// Differences of a frame's light from averages, over the pixels that are not dark in either.
#[derive(Debug, Default)]
struct Apart {
    pixels: usize,
    worst: f64,
    worst_at: ((u32, u32), f64, f64),
    squares: f64,
    /// The whole light of the frame, and of the averages.
    whole: (f64, f64),
}

impl Apart {
    fn add(&mut self, place: (u32, u32), found: f64, known: f64) {
        self.whole.0 += found;
        self.whole.1 += known;
        if found == 0.0 && known == 0.0 {
            return;
        }
        self.pixels += 1;
        let difference = (found - known).abs();
        self.squares += difference * difference;
        if difference > self.worst {
            self.worst = difference;
            self.worst_at = (place, found, known);
        }
    }

    fn rms(&self) -> f64 {
        (self.squares / self.pixels as f64).sqrt()
    }

    /// Relative.
    fn of_whole(&self) -> f64 {
        (self.whole.0 / self.whole.1 - 1.0).abs()
    }

    /// Whether the worst pixel, the rms and the whole light are within bounds; prints them.
    fn is_within(&self, name: &str, (worst, rms, whole): (f64, f64, f64)) -> bool {
        let (found_rms, found_whole) = (self.rms(), self.of_whole());
        println!("{name}: rms {found_rms:.2e}, whole {found_whole:.2e}, {self:?}");
        self.worst <= worst && found_rms <= rms && found_whole <= whole
    }
}

/// The worst pixel, the rms over the pixels that are lit, and the whole light.
const MOST: (f64, f64, f64) = (0.015, 5e-4, 1e-4);

/// The averages of `average-classic.csv`: for each lit pixel, g⁴F and the luminance.
fn averages() -> Vec<((u32, u32), f64, [f64; 3])> {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/light/average-classic.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(|line| {
        let row: Vec<f64> = line.split(',').map(|v| v.parse().expect(line)).collect();
        (
            (row[0] as u32, row[1] as u32),
            row[3],
            [row[4], row[5], row[6]],
        )
    })
    .collect()
}

fn classic(light: Light) -> Scene {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/masks/coverage-classic.toml");
    Scene::load(path).unwrap().with_light(Some(light)).unwrap()
}

/// Compares a frame's light, as `of` tells it, with averages; what has none is dark.
fn against<const N: usize>(
    name: &str,
    scene: &Scene,
    known: &[((u32, u32), [f64; N])],
    of: impl Fn([f64; 3]) -> [f64; N],
    most: [(f64, f64, f64); N],
) {
    let layers = Layers::rendered(scene, table("standard").lookup());
    let (width, height) = (scene.image().width, scene.image().height);
    let mut apart: [Apart; N] = core::array::from_fn(|_| Apart::default());
    let mut truth = vec![[0.0; N]; (width * height) as usize];
    for &((i, j), values) in known {
        truth[(j * width + i) as usize] = values;
    }
    for (pixel, known) in truth.iter().enumerate() {
        let place = (pixel as u32 % width, pixel as u32 / width);
        let found = of(layers.colour(pixel));
        for k in 0..N {
            apart[k].add(place, found[k], known[k]);
        }
    }
    let within = (0..N).map(|k| apart[k].is_within(&format!("{name}, {k}"), most[k]));
    assert!(within.collect::<Vec<_>>() == [true; N], "{name}");
}

#[test]
fn luminances_equal_the_averages_of_the_reference() {
    let known: Vec<_> = averages()
        .into_iter()
        .map(|(place, _, xyz)| (place, [xyz[1]]))
        .collect();
    against(
        "luminance",
        &classic(LIT),
        &known,
        |rgb| [luminance(rgb)],
        [MOST],
    );
}

#[test]
fn colours_equal_the_averages_of_the_reference() {
    let known: Vec<_> = averages()
        .into_iter()
        .map(|(place, _, xyz)| (place, linear_rgb(xyz)))
        .collect();
    against("colour", &classic(LIT), &known, |rgb| rgb, [MOST; 3]);
}

#[test]
fn bolometric_light_equals_the_averages_of_the_reference() {
    let known: Vec<_> = averages()
        .into_iter()
        .map(|(place, grey, _)| (place, [grey]))
        .collect();
    against(
        "bolometric",
        &classic(Light::Bolometric),
        &known,
        |rgb| [rgb[1]],
        [MOST],
    );
}

/// The mean light of each pixel's own rays, by the standard table.
struct Samples<'a> {
    scene: &'a Scene,
    view: View,
    radiance: Radiance,
    orbits: Lookup<'static>,
}

impl<'a> Samples<'a> {
    fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            view: View::new(scene),
            radiance: Radiance::new(scene.light().expect("a scene with light")),
            orbits: table("standard").lookup(),
        }
    }

    fn luminance_at(&self, column: f64, row: f64) -> f64 {
        let (x, y) = (self.view.x_at(column), self.view.y_at(row));
        let ray = self.view.ray_at(x, y);
        let sight = pixelwise::sight_along(self.scene, &self.view, &self.orbits, ray).unwrap();
        sight.map_or(0.0, |sight| {
            let amplitude = sight.redshift * sight.redshift * flux::signed_root(sight.u);
            luminance(self.radiance.rgb(amplitude))
        })
    }

    /// The mean luminance of a pixel over `count` places of its part within `reach` of the point `middle`: there is
    /// nothing farther away. The places are spread by the plastic number's powers (Roberts 2018), so that they meet
    /// thin rings along rows or columns in their share.
    fn mean(&self, (i, j): (u32, u32), count: u32, (middle, reach): ((f64, f64), f64)) -> f64 {
        let side = |first: u32, middle: f64| {
            let from = f64::from(first).max(middle - reach);
            (from, f64::from(first + 1).min(middle + reach) - from)
        };
        let ((left, width), (top, height)) = (side(i, middle.0), side(j, middle.1));
        if width <= 0.0 || height <= 0.0 {
            return 0.0;
        }
        // Each pixel begins elsewhere, so that errors do not add up over a frame.
        let start = f64::from(i * 7 + j * 11) * 0.618_033_988_749_894_9;
        let light = |k: u32| {
            let share = |step: f64| (start + f64::from(k) * step).fract();
            let x = left + width * share(0.754_877_666_246_692_8);
            self.luminance_at(x, top + height * share(0.569_840_290_998_053_3))
        };
        (0..count).map(light).sum::<f64>() / f64::from(count) * width * height
    }
}

/// The pixels that the disk covers in part or wholly, and their neighbours.
fn lit_pixels(scene: &Scene, layers: &Layers) -> Vec<(u32, u32)> {
    let (width, height) = (scene.image().width, scene.image().height);
    let shares = layers.plane(Layer::Coverage);
    let is_covered = |i: u32, j: u32| shares[(j * width + i) as usize] > 0.0;
    let is_near = |&(i, j): &(u32, u32)| {
        let rows = j.saturating_sub(1)..(j + 2).min(height);
        let mut near =
            rows.flat_map(|j| (i.saturating_sub(1)..(i + 2).min(width)).map(move |i| (i, j)));
        near.any(|(i, j)| is_covered(i, j))
    };
    let all = (0..height).flat_map(|j| (0..width).map(move |i| (i, j)));
    all.filter(is_near).collect()
}

/// Compares the light of some of a frame's pixels, every `step`th near the disk, with the mean of `count` samples.
fn against_samples(
    name: &str,
    scene: &Scene,
    (count, step): (u32, usize),
    about: ((f64, f64), f64),
    most: (f64, f64, f64),
) -> bool {
    let samples = Samples::new(scene);
    let layers = Layers::rendered(scene, table("standard").lookup());
    let mut apart = Apart::default();
    for &(i, j) in lit_pixels(scene, &layers).iter().step_by(step) {
        let known = samples.mean((i, j), count, about);
        let pixel = (j * scene.image().width + i) as usize;
        apart.add((i, j), luminance(layers.colour(pixel)), known);
    }
    apart.is_within(name, most)
}

/// A lit scene of 160 × 90 pixels, from `radius` at an inclination, that many pixels from edge to edge of the disk.
fn distant(radius: f64, inclination: f64, pixels: f64, aside: f64) -> Scene {
    let (sine, cosine) = libm::sincos(inclination.to_radians());
    let half = libm::atan(0.5 * 90.0 * 24.0 / radius / pixels);
    // Off the middle by a part of a pixel.
    let away = aside * 24.0 / pixels;
    let text = format!(
        "[camera]\nposition = [{:e}, 0.0, {:e}]\nfocus = [0.0, {away:e}, {:e}]\nfov = {:e}\n\
         [disk]\ninner = 3.0\nouter = 12.0\n[image]\nwidth = 160\nheight = 90\nantialias = true\n",
        radius * sine,
        radius * cosine,
        0.4 * away,
        2.0 * half.to_degrees(),
    );
    Scene::from_toml(&text)
        .unwrap()
        .with_light(Some(LIT))
        .unwrap()
}

/// A pixel's share is right to 1e-3, where it is largest, and its light to the share's error times the disk's light,
/// which is 3 at most here. The mean over a part that is thinner than a tenth of a pixel and bent within it was seen
/// to be off by 3 %.
const WORST_OF_TINY: f64 = 0.006;

#[test]
fn disks_of_a_few_pixels_have_the_light_of_samples() {
    let scenes = [
        (1000.0, 80.0, 4.0, 0.3),
        (1000.0, 80.0, 1.5, 0.45),
        (1000.0, 80.0, 0.7, 0.0),
        (1000.0, 80.0, 0.3, 0.4),
        (1e6, 60.0, 5.0, 0.1),
        (1000.0, 89.5, 8.0, 0.3),
        (1000.0, 5.0, 2.0, 0.0),
        (30.0, 80.0, 5.0, 0.5),
    ];
    let within = scenes.map(|(radius, inclination, pixels, aside)| {
        let scene = distant(radius, inclination, pixels, aside);
        let name = format!("{radius}, {inclination}°, {pixels} pixels, {aside}");
        // Light is bent towards the hole: the disk looks larger by about a Schwarzschild radius.
        let about = (hole(&scene), 0.6 * pixels + 0.01);
        // The shares' errors are nearly all of one sign; the smaller the disk, the more they are of it.
        let whole = 1.5e-3 + 2.5e-3 / (pixels * pixels);
        against_samples(
            &name,
            &scene,
            (6000, 1),
            about,
            (WORST_OF_TINY, 1.5e-3, whole),
        )
    });
    assert!(within.iter().all(|is_within| *is_within));
}

/// Where the hole is in the picture, in pixels from its left and its top.
fn hole(scene: &Scene) -> (f64, f64) {
    let camera = scene.camera();
    let f = (camera.focus - camera.position).normalize();
    let right = f.cross(camera.up).normalize();
    let p = -camera.position;
    let half_height = f64::from(scene.image().height) / 2.0;
    let scale = half_height / libm::tan(0.5 * camera.fov_degrees.to_radians()) / p.dot(f);
    let middle = f64::from(scene.image().width) / 2.0;
    let up = right.cross(f);
    (
        middle + scale * p.dot(right),
        half_height - scale * p.dot(up),
    )
}

#[test]
fn thin_rings_have_the_light_of_samples() {
    // The samples' own error is about 2e-4.
    const FINE: (f64, f64, f64) = (0.003, 5e-4, 1e-4);
    let frames = [
        ("lit", 1, FINE),
        ("luminet", 1, FINE),
        ("lit-orbit", 60, FINE),
        ("plunge", 150, (0.006, 5e-4, 2e-4)),
        ("rings", 1, (0.01, 1e-3, 5e-4)),
        // Through a wide lens, with light of 2.7: a hundredth of it, or a fifth where it is dark, was seen.
        ("plunge", 240, (0.04, 6e-3, 1.5e-3)),
    ];
    let within = frames.map(|(name, number, most)| {
        let animation = Animation::load(name).unwrap().with_size(160, 90).unwrap();
        let scene = animation.frame(number).unwrap();
        let everywhere = ((0.0, 0.0), f64::INFINITY);
        against_samples(
            &format!("{name} {number}"),
            &scene,
            (2048, 90),
            everywhere,
            most,
        )
    });
    assert!(within.iter().all(|is_within| *is_within));
}

/// Guards against a mean over a pixel in which the direct image is at the camera itself: seen from within the disk's
/// plane it is all of a quarter turn.
#[test]
fn from_within_the_disks_plane_partly_covered_pixels_have_light() {
    let scene = Scene::from_toml(
        "[camera]\nposition = [194.8559017795181, -286.8514912411658, 0.0]\n\
         focus = [3.7471370285745422, 2.4733563504943194, 4.601416000952595]\n\
         up = [0.7007695744552487, 0.2, 1.0]\nfov = 2.018172187793837\n\
         [disk]\ninner = 3.0\nouter = 3.965706792551636\n[disk.light]\nmodel = \"bolometric\"\n\
         [image]\nwidth = 206\nheight = 89\n",
    )
    .unwrap();
    let everywhere = ((0.0, 0.0), f64::INFINITY);
    assert!(against_samples(
        "in the plane",
        &scene,
        (4096, 1),
        everywhere,
        (0.02, 1e-3, 1e-3)
    ));
}
