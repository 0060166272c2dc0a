//! Guards against values that are not numbers, panics, and bytes that depend on the threads, at the ends of what a
//! scene may say.

use std::sync::Arc;

use darkness::Renderer;
use darkness::scene::{
    Camera, ImageSize, Layer, LayerSet, Scene, Sky, SkyFile, StarSource, Stars, View,
};
use darkness::sky::{Panorama, SkySource, StarColours, StarField};
use glam::DVec3;

use crate::noise::Random;
use crate::sky_views::position;
use crate::tables::table;

fn noise() -> Panorama {
    let mut random = Random(3);
    let texels = (0..6 * 64 * 64).map(|_| random.number() as f32).collect();
    Panorama::from_linear(64, texels)
}

fn scene(position: DVec3, focus: DVec3, fov: f64, (width, height): (u32, u32), sky: &Sky) -> Scene {
    let camera = Camera {
        focus,
        up: DVec3::new(0.3, 0.2, 1.0),
        ..Camera::at(position, fov)
    };
    Scene::without_disk(camera, sky.clone(), ImageSize { width, height }).unwrap()
}

/// Bits of the layers of light and directions, which are checked, and the bytes of the picture.
fn drawn(scene: &Scene, source: &Arc<SkySource>, threads: usize) -> (Vec<u32>, Vec<u8>) {
    let draw = || {
        let mut renderer = Renderer::new(table("standard"))
            .with_sky(scene.sky().unwrap().clone(), Arc::clone(source));
        let layers: LayerSet = [Layer::Colour, Layer::Sky, Layer::SkyUv]
            .into_iter()
            .collect();
        let planes = renderer.render_layers(scene, layers).unwrap();
        let bytes = renderer.render_rgb(scene).unwrap().into_raw();
        (planes, bytes)
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    let (planes, bytes) = pool.install(draw);
    let mut bits = Vec::new();
    for plane in &planes {
        let channels = plane.layer.channels();
        for pixel in plane.values.chunks(channels) {
            let finite = pixel.iter().filter(|value| value.is_finite()).count();
            // The hole has no direction.
            let none = plane.layer != Layer::Colour && pixel.iter().all(|value| value.is_nan());
            assert!(finite == channels || none, "{:?}: {pixel:?}", plane.layer);
            bits.extend(pixel.iter().map(|value| value.to_bits()));
        }
    }
    (bits, bytes)
}

/// Draws a scene on one thread and on two.
fn check(name: &str, scene: &Scene, source: &Arc<SkySource>) -> f64 {
    let one = drawn(scene, source, 1);
    let two = drawn(scene, source, 2);
    assert!(one == two, "{name}: the bytes depend on the threads");
    let pixels = (scene.image().width * scene.image().height) as usize;
    let light = one.0[..3 * pixels]
        .iter()
        .map(|&bits| f64::from(f32::from_bits(bits)));
    let sum: f64 = light.sum();
    sum / (3 * pixels) as f64
}

fn full(grid: f64) -> (Sky, Arc<SkySource>) {
    let sky = Sky {
        panorama: Some(SkyFile::new("of the test")),
        stars: Some(Stars::new(StarSource::File(SkyFile::new("of the test")))),
        grid: Some(grid),
        rotation: [10.0, 20.0, 30.0],
        ..Sky::default()
    };
    let stars = StarField::synthetic(5000, 1, None);
    let source = SkySource::new(Some(noise()), Some(stars), Some(grid));
    (sky, Arc::new(source))
}

#[test]
fn extreme_cameras_have_finite_skies() {
    let (sky, source) = full(15.0);
    for radius in [1.0001, 1.2, 1.5, 30.0, 1e6, 1e15] {
        let position = position(radius);
        let across = position.any_orthonormal_vector() * radius;
        for (name, focus) in [
            ("the hole", DVec3::ZERO),
            ("away", position * 2.0),
            ("across", position + across),
            ("near the hole", across * 1e-3),
        ] {
            for fov in [1e-3, 0.1, 40.0, 120.0, 179.0] {
                for size in [(1, 1), (1, 500), (65, 37), (130, 34)] {
                    let name = format!("r = {radius}, {name}, fov {fov}, {size:?}");
                    let scene = scene(position, focus, fov, size, &sky);
                    for antialias in [true, false] {
                        check(&name, &scene.clone().with_antialias(antialias), &source);
                    }
                }
            }
        }
    }
}

#[test]
fn extreme_settings_have_finite_skies() {
    for grid in [1.0, 90.0] {
        let (sky, source) = full(grid);
        for radius in [1.0001, 3.0, 1e6] {
            let position = position(radius);
            for star_radius in [5e-324, 1e-300, 1e-6, 0.01] {
                for (exposure, stars_exposure) in [(100.0, 100.0), (-100.0, -100.0), (0.0, 100.0)] {
                    let mut sky = sky.clone();
                    sky.exposure = exposure;
                    let stars = sky.stars.as_mut().unwrap();
                    stars.radius = star_radius;
                    stars.exposure = stars_exposure;
                    stars.magnitude_limit = Some(-30.0);
                    // At the horizon the sky is a small disk, away from the hole.
                    let focus = if radius > 1.5 {
                        DVec3::ZERO
                    } else {
                        position * 2.0
                    };
                    let scene = scene(position, focus, 90.0, (65, 37), &sky);
                    let name = format!("r = {radius}, {grid}, {star_radius:e}, {exposure}");
                    for stops in [-100.0, 0.0, 100.0] {
                        let scene = scene.clone().with_exposure(stops).unwrap();
                        let mean = check(&name, &scene, &source);
                        assert!(mean.is_finite() && mean > 0.0, "{name}: {mean}");
                    }
                }
            }
        }
    }
}

#[test]
fn no_stars_and_very_bright_ones() {
    use darkness::sky::Star;
    let (sky, _) = full(15.0);
    for radius in [1.0001, 30.0, 1e15] {
        let position = position(radius);
        let p = position.normalize();
        for stars in [
            vec![],
            vec![Star::at(-p, -60.0, 1e9)],
            vec![Star::at(p, -60.0, 100.0)],
            vec![Star::at(-p, 60.0, 100.0)],
            vec![Star::at(DVec3::Z, -90.0, 5000.0); 100],
        ] {
            let name = format!("r = {radius}, {:?}", stars.first());
            let source = Arc::new(SkySource::new(None, Some(StarField { stars }), None));
            for (focus, fov) in [
                (DVec3::ZERO, 60.0),
                (position * 2.0, 60.0),
                (DVec3::ZERO, 1e-3),
            ] {
                check(&name, &scene(position, focus, fov, (65, 37), &sky), &source);
            }
        }
    }
}

#[test]
fn magnitude_limits_leave_out_stars() {
    let all = StarField::synthetic(1000, 1, None).stars.len();
    assert_eq!(all, 1000);
    for (limit, least, most) in [(-30.0, 0, 0), (3.0, 1, 999), (1e300, 1000, 1000)] {
        let count = StarField::synthetic(1000, 1, Some(limit)).stars.len();
        assert!((least..=most).contains(&count), "{limit}: {count}");
    }
}

#[test]
fn at_the_horizon_stars_are_shifted_a_hundredfold() {
    let (sky, _) = full(15.0);
    let position = position(1.0001);
    let scene = scene(position, position * 2.0, 60.0, (64, 36), &sky);
    let view = View::new(&scene);
    let factor = 1.0 / view.clock_rate();
    println!("shift factor {factor}");
    // √(r/(r − 1)) of r = 1.0001.
    assert!((factor - 10_001.0_f64.sqrt()).abs() < 1e-6, "{factor}");
    let star = darkness::sky::Star::at(position.normalize(), 0.0, 5000.0);
    let source = SkySource::new(None, Some(StarField { stars: vec![star] }), None);
    let source = Arc::new(source);
    let shifted = check("shifted", &scene, &source);
    let mut without = sky.clone();
    without.stars.as_mut().unwrap().shift = false;
    let plain = check(
        "not shifted",
        &scene.clone().with_sky(Some(without)).unwrap(),
        &source,
    );
    let green = |factor: f64| {
        let [r, g, b] = StarColours::new(factor, 0.0).light(&star).map(f64::from);
        r + g + b
    };
    let ratio = green(factor) / green(1.0);
    println!("light {} and {ratio}", shifted / plain);
    assert!((shifted / plain / ratio - 1.0).abs() < 1e-4);
}
