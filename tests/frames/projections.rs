//! Guards against fisheyes and equirectangular pictures that show anything else than each pixel's own ray: across their
//! seams, at the poles and behind the camera.

use std::sync::Arc;

use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::render::{Plane, coverage, mask, pixelwise};
use darkness::scene::{Camera, Layer, LayerSet, Projection, Scene, View};
use darkness::sky::{Panorama, SkySource};
use darkness::{Renderer, Table};
use glam::{DMat3, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::any_scene::any_scene;
use crate::noise::{Random, one_over_f};
use crate::tables::table;

/// A scene as another picture, which is `height` pixels high.
pub(crate) fn seen_by(scene: &Scene, projection: Projection, fov: f64, height: u32) -> Scene {
    let (width, fov_degrees) = match projection {
        Projection::Equirectangular => (2 * height, 180.0),
        _ => (height + height / 8, fov),
    };
    let camera = |projection, fov_degrees| Camera {
        projection,
        fov_degrees,
        ..*scene.camera()
    };
    // A flat picture has any size.
    let flat = scene
        .clone()
        .with_camera(camera(Projection::Perspective, 60.0));
    let flat = flat.unwrap().with_size(width, height).unwrap();
    flat.with_camera(camera(projection, fov_degrees)).unwrap()
}

/// The same scene from a camera that looks in some direction, as a picture of another shape.
fn looking(scene: &Scene, direction: Option<[f64; 3]>, widening: f64) -> Scene {
    let mut camera = *scene.camera();
    if let Some(direction) = direction {
        camera.focus = camera.position + DVec3::from(direction) * scene.radius();
    }
    let size = scene.image();
    let width = match camera.projection {
        Projection::Equirectangular => size.width,
        _ => (f64::from(size.height) * widening) as u32,
    };
    let scene = scene.clone().with_size(width, size.height).unwrap();
    // A direction along the camera's upward one is none.
    scene.clone().with_camera(camera).unwrap_or(scene)
}

/// The scene's own direction, or any.
fn directions() -> impl Strategy<Value = Option<[f64; 3]>> {
    let part = || -1.0..1.0_f64;
    prop_oneof![Just(None), [part(), part(), part()].prop_map(Some)]
}

fn curves(scene: &Scene) -> (View, Isoradials) {
    let view = View::new(scene);
    let spec = CurveSpec::new(scene, &view, scene.tolerance());
    let curves = Isoradials::new(&spec, &table("standard").lookup());
    (view, curves)
}

fn projections() -> impl Strategy<Value = (Projection, f64)> {
    prop_oneof![
        (-2.0..2.5_f64).prop_map(|log| (Projection::Fisheye, libm::pow(10.0, log))),
        (200.0..=360.0_f64).prop_map(|fov| (Projection::Fisheye, fov)),
        Just((Projection::Fisheye, 360.0)),
        Just((Projection::Equirectangular, 180.0)),
        Just((Projection::Equirectangular, 180.0)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1500,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn hard_edges_equal_each_pixel_s_own_ray(
        (kind, scene) in any_scene(),
        (projection, fov) in projections(),
        direction in directions(),
        widening in 0.5..2.5_f64,
    ) {
        let scene = seen_by(&scene, projection, fov, scene.image().height);
        let scene = looking(&scene, direction, widening);
        let (view, curves) = curves(&scene);
        let drawn = mask::render(&view, &curves).unwrap();
        let single = mask::render_every_pixel(&view, &curves).unwrap();
        let differing = drawn.iter().zip(&single).filter(|(a, b)| a != b).count();
        prop_assert_eq!(differing, 0, "{:?}\n{}", kind, scene.to_toml());
    }

}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        rng_seed: RngSeed::Fixed(2),
        ..ProptestConfig::default()
    })]

    #[test]
    fn smooth_edges_are_the_mean_of_many_rays(
        (kind, scene) in any_scene(),
        (projection, fov) in projections(),
        direction in directions(),
    ) {
        const RAYS: u32 = 32;
        let height = 12;
        let scene = looking(&seen_by(&scene, projection, fov, height), direction, 1.2);
        let width = scene.image().width;
        let (view, curves) = curves(&scene);
        let drawn = coverage::render(&view, &curves).unwrap();
        let fine = scene.clone().with_size(RAYS * width, RAYS * height).unwrap();
        let fine = View::new(&fine);
        let many = mask::render_every_pixel(&fine, &curves).unwrap();
        for (place, drawn) in drawn.iter().enumerate() {
            let (i, j) = (place as u32 % width, place as u32 / width);
            // Whole pixels are shown or not.
            if !view.shows((f64::from(i) + 0.5, f64::from(j) + 0.5)) {
                continue;
            }
            let rays = (0..RAYS * RAYS).map(|ray| {
                let (column, row) = (i * RAYS + ray % RAYS, j * RAYS + ray / RAYS);
                let is_shown = fine.shows((f64::from(column) + 0.5, f64::from(row) + 0.5));
                is_shown.then(|| f64::from(many[(row * RAYS * width + column) as usize]))
            });
            let within: Vec<f64> = rays.flatten().collect();
            // What is beyond a rim counts where the picture goes on there.
            let is_cut = within.len() < (RAYS * RAYS) as usize;
            if is_cut && view.pixel_side() * f64::from(height) < 6.2 {
                continue;
            }
            let mean = within.iter().sum::<f64>() / within.len() as f64;
            let off = (mean - f64::from(*drawn)).abs() / 255.0;
            // Each row of rays counts an edge to half a ray, and a pixel may hold several edges.
            // Across a rim some rays are counted: 3 × 3 or 16 × 16.
            let most = if is_cut { 0.15 } else { 0.045 };
            prop_assert!(off < most, "{:?} {} {}: {} not {}\n{}", kind, i, j, drawn, mean, scene.to_toml());
        }
    }
}

/// The curves themselves against rays that are followed by another method.
#[test]
fn pictures_equal_exact_rays() {
    for name in ["classic", "face-on", "photon-ring", "flyby"] {
        let scene = Scene::builtin(name).unwrap();
        for (projection, fov) in [
            (Projection::Fisheye, 180.0),
            (Projection::Fisheye, 360.0),
            (Projection::Equirectangular, 180.0),
        ] {
            let scene = seen_by(&scene, projection, fov, 180);
            let (view, curves) = curves(&scene);
            let drawn = mask::render(&view, &curves).unwrap();
            let exact = pixelwise::render(&scene, &view, &Exact, &|| ()).unwrap();
            assert!(drawn == exact, "{name} {projection:?}");
        }
    }
}

/// The linear light of a scene's pixels.
fn light(scene: &Scene, table: &Table) -> Vec<[f64; 3]> {
    let layers = LayerSet::default().with(Layer::Colour);
    let planes = Renderer::new(table).render_layers(scene, layers).unwrap();
    let pixels = planes[0].values.as_chunks::<3>().0;
    pixels.iter().map(|light| light.map(f64::from)).collect()
}

/// Guards against light of partly covered pixels, of bent footprints and of shadows that is not the mean over the
/// pixel.
#[test]
fn smooth_light_is_the_mean_of_many_rays() {
    const RAYS: u32 = 12;
    let table = table("standard");
    let lit = Scene::builtin("lit").unwrap();
    for (projection, fov, height) in [
        (Projection::Perspective, 30.0, 60),
        (Projection::Fisheye, 30.0, 60),
        (Projection::Fisheye, 360.0, 180),
        (Projection::Equirectangular, 180.0, 120),
    ] {
        let scene = seen_by(&lit, projection, fov, height);
        let (width, view) = (scene.image().width, View::new(&scene));
        let found = light(&scene, table);
        let fine = scene.with_size(RAYS * width, RAYS * height).unwrap();
        let many = light(&fine.with_antialias(false), table);
        let (mut sum, mut worst, mut lit) = (0.0, 0.0_f64, 0);
        for (place, found) in found.iter().enumerate() {
            let (i, j) = (place as u32 % width, place as u32 / width);
            let mut mean = 0.0;
            for ray in 0..RAYS * RAYS {
                let (column, row) = (i * RAYS + ray % RAYS, j * RAYS + ray / RAYS);
                mean += many[(row * RAYS * width + column) as usize][1];
            }
            mean /= f64::from(RAYS * RAYS);
            let corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
            let shows = |(i, j): (u32, u32)| view.shows((i.into(), j.into()));
            if mean > 0.0 && corners.into_iter().all(shows) {
                let off = (found[1] - mean).abs();
                sum += off * off;
                worst = worst.max(off);
                lit += 1;
            }
        }
        let rms = (sum / f64::from(lit)).sqrt();
        println!("{projection:?} {fov}: {lit} pixels, rms {rms:.5}, worst {worst:.4}");
        assert!(
            lit > 100 && rms < 0.003 && worst < 0.08,
            "{projection:?} {fov}"
        );
    }
}

/// A scene with light and a panorama, seen as the whole sphere by a camera that is turned to the right about its upward
/// direction.
fn turned(height: u32, degrees: f64) -> Scene {
    let text = format!(
        "[camera]\nradius = 12\ninclination = 75\nprojection = \"equirectangular\"\n[disk]\n[disk.light]\n\
         model = \"bolometric\"\n[sky]\npanorama = \"of the test\"\n\
         [image]\nwidth = {}\nheight = {height}\n",
        2 * height
    );
    let scene = Scene::from_toml(&text).unwrap();
    let camera = *scene.camera();
    let ahead = (camera.focus - camera.position).normalize();
    let right = ahead.cross(camera.up).normalize();
    let up = right.cross(ahead);
    let turn = DMat3::from_axis_angle(up, -degrees.to_radians());
    let focus = camera.position + turn * (camera.focus - camera.position);
    let camera = Camera {
        focus,
        up,
        ..camera
    };
    scene.with_camera(camera).unwrap()
}

/// Guards against seams: a turned camera sees the same picture, moved along its rows.
#[test]
fn a_turn_moves_the_whole_sphere_along_its_rows() {
    let (height, width) = (90, 180);
    let noise = one_over_f(64, &mut Random(3));
    let texels = noise.iter().flat_map(|&c| [c as f32; 3]).collect();
    let panorama = Panorama::from_linear(64, texels);
    let source = Arc::new(SkySource::new(Some(panorama), None, None));
    let layers = [Layer::Coverage, Layer::Colour].into_iter().collect();
    let drawn = |scene: &Scene| {
        let sky = scene.sky().cloned().unwrap();
        let mut renderer = Renderer::new(table("standard")).with_sky(sky, Arc::clone(&source));
        renderer.render_layers(scene, layers).unwrap()
    };
    let whole = drawn(&turned(height, 0.0));
    for pixels in [1, 89, 90, 91, 120, 179] {
        // One pixel is two degrees.
        let moved = drawn(&turned(height, 2.0 * pixels as f64));
        let (mut worst, mut squares, mut worst_at_seam) = ([0.0_f32; 2], 0.0_f32, 0.0_f32);
        for place in 0..width * height as usize {
            let (i, j) = (place % width, place / width);
            let there = j * width + (i + width - pixels) % width;
            for (plane, (worst, channels)) in worst.iter_mut().zip([1, 3]).enumerate() {
                let value = |planes: &[Plane], place| planes[plane].values[channels * place];
                let off = (value(&whole, place) - value(&moved, there)).abs();
                *worst = worst.max(off);
                squares += off * off;
                let is_at_seam = [0, width - 1].contains(&i)
                    || [0, width - 1].contains(&(there % width))
                    || [0, height as usize - 1].contains(&j);
                if is_at_seam {
                    worst_at_seam = worst_at_seam.max(off);
                }
            }
        }
        let rms = (squares / (width * height as usize) as f32).sqrt();
        let told = format!("{pixels}: worst {worst:?}, at seams {worst_at_seam}, rms {rms}");
        println!("{told}");
        // Tiles begin at other pixels of the same sky, so that its mean is found in another way: that shows about the
        // panorama's poles, where pixels of two degrees are coarse.
        assert!(worst[0] < 0.004 && worst[1] < 0.1, "{told}");
        assert!(worst_at_seam < 0.01 && rms < 0.002, "{told}");
    }
}

/// Guards against stars that shine less, or more, where a picture is stretched: far from the hole the irradiance of all
/// of them is the same in every picture of the whole sphere, whatever is ahead.
#[test]
fn the_light_of_all_stars_is_the_same_in_every_picture_of_the_sphere() {
    let text = "[camera]\nradius = 1e6\ninclination = 75\nprojection = \"equirectangular\"\n[sky]\n\
                stars = { count = 3000, seed = 1 }\n[image]\nwidth = 360\nheight = 180\n";
    let sphere = Scene::from_toml(text).unwrap();
    let mut sums = Vec::new();
    for (projection, focus) in [
        (Projection::Equirectangular, DVec3::ZERO),
        (Projection::Equirectangular, DVec3::new(3e6, 1e6, 2e6)),
        (Projection::Fisheye, DVec3::ZERO),
        (Projection::Fisheye, DVec3::new(3e6, 1e6, 2e6)),
    ] {
        let camera = Camera {
            focus,
            ..*sphere.camera()
        };
        let scene = sphere.clone().with_camera(camera).unwrap();
        let scene = seen_by(&scene, projection, 360.0, 180);
        let (width, view) = (scene.image().width, View::new(&scene));
        let mut sum = 0.0;
        for (place, light) in light(&scene, table("standard")).iter().enumerate() {
            let (i, j) = (place as u32 % width, place as u32 / width);
            let corner = |column: u32, row: u32| {
                let ray = view.ray_at(view.x_at(column.into()), view.y_at(row.into()));
                DVec3::new(ray.z, ray.ta, ray.tb)
            };
            let [a, b, c, d] = [
                corner(i, j),
                corner(i + 1, j),
                corner(i + 1, j + 1),
                corner(i, j + 1),
            ];
            let solid_angle = 0.5 * (c - a).cross(d - b).length();
            sum += light[1] * solid_angle;
        }
        println!("{projection:?}: {sum}");
        sums.push(sum);
    }
    // A fisheye's rim cuts off the pixels that it passes.
    for sum in &sums {
        assert!((sum / sums[0] - 1.0).abs() < 0.005, "{sums:?}");
    }
}
