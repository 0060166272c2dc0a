//! Panoramas behind the hole, against 64 × 64 rays for each pixel.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use darkness::Renderer;
use darkness::isoradial::EscapeCurve;
use darkness::orbit::exact::Exact;
use darkness::render::batch::{DrawnFrame, FrameError};
use darkness::render::{Form, Pixels};
use darkness::scene::{
    Animation, Camera, ImageSize, Layer, LayerSet, Projection, Scene, Sky, SkyFile, View,
};
use darkness::sky::{Panorama, SkySource, place};

use crate::noise::{Random, one_over_f};
use crate::projections::seen_by;
use crate::tables::table;

/// Rays a side of a pixel.
const RAYS: u32 = 64;

/// A panorama of 1/f noise from 0 to 1, each channel by itself.
fn noise(height: usize) -> Panorama {
    let mut random = Random(7);
    let channels = [(); 3].map(|()| one_over_f(height, &mut random));
    let texels = (0..2 * height * height).flat_map(|i| channels.each_ref().map(|c| c[i] as f32));
    Panorama::from_linear(height, texels.collect())
}

fn sky() -> Sky {
    Sky {
        panorama: Some(SkyFile::new("of the test")),
        ..Sky::default()
    }
}

/// The scene of a camera without a disk.
fn scene(position: [f64; 3], focus: [f64; 3], fov: f64, (width, height): (u32, u32)) -> Scene {
    let camera = Camera {
        focus: focus.into(),
        up: [1.0, 0.3, 0.2].into(),
        ..Camera::at(position, fov)
    };
    Scene::without_disk(camera, sky(), ImageSize { width, height }).unwrap()
}

/// The same from near the hole, as a fisheye.
fn fisheye(fov: f64) -> Scene {
    let scene = scene([3.0, 1.0, 0.4], [0.0; 3], 60.0, (96, 54));
    seen_by(&scene, Projection::Fisheye, fov, 54)
}

/// The linear light of a scene.
fn light(scene: &Scene, source: &Arc<SkySource>) -> Vec<[f32; 3]> {
    let mut renderer = Renderer::new(table("standard")).with_sky(sky(), Arc::clone(source));
    let layers = LayerSet::default().with(Layer::Colour);
    let planes = renderer.render_layers(scene, layers).unwrap();
    planes[0].values.as_chunks::<3>().0.to_vec()
}

/// The mean of many rays through a pixel.
fn of_rays(view: &View, curve: &EscapeCurve, panorama: &Panorama, (i, j): (u32, u32)) -> [f64; 3] {
    let [p, a, b] = view.axes();
    let mut sum = [0.0; 3];
    let offset = |k: u32| (f64::from(k) + 0.5) / f64::from(RAYS);
    for row in 0..RAYS {
        for column in 0..RAYS {
            let (x, y) = (f64::from(i) + offset(column), f64::from(j) + offset(row));
            let ray = view.ray_at(view.x_at(x), view.y_at(y));
            let s = ray.transverse();
            let Some(escape) = curve.at(ray.z, s) else {
                continue;
            };
            let direction = p * libm::cos(escape.angle)
                + (a * ray.ta + b * ray.tb) * (libm::sin(escape.angle) / s);
            let (u, v) = place(direction);
            let texel = panorama.mean([u as f32, v as f32], [0.0; 2], [0.0; 2]);
            for (sum, c) in sum.iter_mut().zip(texel) {
                *sum += f64::from(c);
            }
        }
    }
    sum.map(|c| c / f64::from(RAYS * RAYS))
}

#[test]
fn a_pixel_is_the_mean_of_many_rays() {
    let height = 1024;
    let source = Arc::new(SkySource::new(Some(noise(height)), None, None));
    let panorama = source.panorama().unwrap();
    for (name, scene) in [
        ("whole", scene([30.0, 0.0, 4.0], [0.0; 3], 60.0, (96, 54))),
        ("ring", scene([30.0, 0.0, 4.0], [0.0; 3], 16.0, (96, 54))),
        (
            "edge",
            scene([30.0, 0.0, 4.0], [0.0, 2.6, 0.0], 3.0, (96, 54)),
        ),
        ("near", scene([2.0, 1.0, 0.3], [0.0; 3], 120.0, (96, 54))),
        (
            "away",
            scene([2.0, 1.0, 0.3], [4.0, 2.0, 0.6], 120.0, (96, 54)),
        ),
        (
            "inside",
            scene([1.2, 0.1, 0.3], [4.0, 2.0, 0.6], 150.0, (96, 54)),
        ),
        ("far", scene([1e6, 0.0, 1e5], [0.0; 3], 1e-3, (96, 54))),
        (
            "pole",
            scene([30.0, 0.0, 4.0], [30.0, 0.0, 14.0], 40.0, (96, 54)),
        ),
        ("dome", fisheye(180.0)),
        ("all round", fisheye(360.0)),
        (
            "sphere",
            seen_by(&fisheye(1.0), Projection::Equirectangular, 180.0, 54),
        ),
    ] {
        let width = scene.image().width;
        let view = View::new(&scene);
        let curve = EscapeCurve::new(view.u0(), view.slope_scale(), &Exact);
        let found = light(&scene, &source);
        let (mut sum, mut worst, mut count) = (0.0, (0.0_f64, (0, 0)), 0.0);
        for j in (0..54).step_by(3) {
            for i in (0..width).step_by(3) {
                if !view.shows((f64::from(i) + 0.5, f64::from(j) + 0.5)) {
                    continue;
                }
                let truth = of_rays(&view, &curve, panorama, (i, j));
                let pixel = found[(j * width + i) as usize];
                for (found, truth) in pixel.iter().zip(truth) {
                    let off = f64::from(*found) - truth;
                    sum += off * off;
                    count += 1.0;
                    if off.abs() > worst.0 {
                        worst = (off.abs(), (i, j));
                    }
                }
            }
        }
        let rms = f64::sqrt(sum / count);
        println!("{name}: rms {rms:.5}, worst {worst:?}");
        assert!(rms <= 0.01, "{name}: {rms}");
    }
}

/// Guards against a film that looks for the file of a sky that is in memory.
#[test]
fn a_film_has_the_sky_that_is_in_memory() {
    let source = Arc::new(SkySource::new(Some(noise(16)), None, None));
    let film = "[camera]\nfov = 40\n[sky]\npanorama = \"of the test\"\n\
                [image]\nwidth = 32\nheight = 18\n[animation]\nframes = 2\n\
                orbit = { radius = 20, inclination = 80, azimuth = [0, 90] }\n";
    let film = Animation::from_toml(film).unwrap();
    let renderer = Renderer::new(table("standard")).with_sky(sky(), source);
    let lit = AtomicUsize::new(0);
    let done = |frame: DrawnFrame<'_>| {
        let (pixels, _) = frame.pixels?;
        if let Pixels::Rgb8(bytes) = pixels {
            lit.fetch_add(
                usize::from(bytes.iter().any(|&byte| byte > 0)),
                Ordering::Relaxed,
            );
        }
        Ok::<(), FrameError>(())
    };
    renderer
        .render_frames(&film, Form::Rgb8, [1, 2].into_iter(), done)
        .unwrap();
    assert_eq!(lit.into_inner(), 2);
}
