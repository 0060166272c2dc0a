//! Guards against wrong footprints, panoramas that darken or brighten, and seams.

use core::f64::consts::PI;

use darkness::Renderer;
use darkness::isoradial::EscapeCurve;
use darkness::orbit::exact::Exact;
use darkness::scene::{Camera, Disk, Layer, LayerSet, Light, PixelRay, Scene, Sky, SkyFile, View};
use darkness::sky::{Orientation, Panorama, SkySource, direction};
use glam::DVec3;

use crate::sky_views::{ExactRays, light_of, looking, position};
use crate::tables::table;

fn with_panorama(rotation: [f64; 3]) -> Sky {
    Sky {
        panorama: Some(SkyFile::new("of the test")),
        rotation,
        ..Sky::default()
    }
}

/// A panorama of a function of the direction.
fn panorama(height: usize, of: impl Fn(DVec3) -> [f64; 3]) -> SkySource {
    let mut texels = Vec::new();
    for j in 0..height {
        for i in 0..2 * height {
            let u = (i as f64 + 0.5) / (2 * height) as f64;
            let v = 1.0 - (j as f64 + 0.5) / height as f64;
            texels.extend(of(direction(u, v)).map(|c| c as f32));
        }
    }
    SkySource::new(Some(Panorama::from_linear(height, texels)), None, None)
}

#[test]
fn the_axes_of_footprints_are_the_differences_of_exact_rays() {
    let lookup = table("standard").lookup();
    for radius in [1e15, 1e6, 30.0, 3.0, 1.5, 1.2, 1.01, 1.0001] {
        let rays = ExactRays::new(radius);
        let exact = EscapeCurve::new(rays.u0, rays.slope_scale, &Exact);
        let of_table = EscapeCurve::new(rays.u0, rays.slope_scale, &lookup);
        let (mut worst, mut across) = ([0.0_f64; 2], [0.0_f64; 2]);
        for i in 0..300 {
            // From a 2e-6th of the way from the critical ray to straight away from the hole.
            let delta = (PI - rays.critical) * libm::exp2(-0.063 * f64::from(i));
            for psi in [rays.critical + delta, PI - 0.5 * delta] {
                let (z, s) = (libm::cos(psi), libm::sin(psi));
                if psi >= PI {
                    continue;
                }
                let rate = rays.rate(psi);
                let swept = rays.swept(z, s).unwrap();
                for (i, curve) in [&exact, &of_table].into_iter().enumerate() {
                    let found = curve.at(z, s).unwrap();
                    worst[i] = worst[i].max((found.rate / rate - 1.0).abs());
                    // It is 0 at each half turn: over the length of the axes.
                    let off = (libm::sin(found.angle) - libm::sin(swept)).abs() / s;
                    across[i] = across[i].max(off / (libm::sin(swept) / s).abs().max(rate));
                }
            }
        }
        println!("r = {radius}: rates {worst:?}, across {across:?}, exact and table");
        assert!(
            worst.into_iter().chain(across).all(|off| off < 1e-6),
            "r = {radius}"
        );
    }
}

/// Where the hole is in a picture.
fn hole(view: &View) -> Option<(f64, f64)> {
    view.place_of(PixelRay {
        z: 1.0,
        ta: 0.0,
        tb: 0.0,
    })
}

/// Whether a pixel sees nothing of the shadow, even if it were a little larger.
fn sees_no_shadow(view: &View, critical: f64, (i, j): (usize, usize)) -> bool {
    let (x, y) = (i as f64 + 0.5, j as f64 + 0.5);
    if hole(view).is_some_and(|hole| (hole.0 - x).abs() < 0.51 && (hole.1 - y).abs() < 0.51) {
        return false;
    }
    (0..=32).all(|k| {
        let along = 0.51 * (f64::from(k) / 16.0 - 1.0);
        [(along, -0.51), (along, 0.51), (-0.51, along), (0.51, along)]
            .into_iter()
            .all(|(dx, dy)| {
                let ray = view.ray_at(view.x_at(x + dx), view.y_at(y + dy));
                ray.z < critical * ray.transverse()
            })
    })
}

/// Cameras: places, where they look, and fields of view.
fn views() -> Vec<(String, DVec3, DVec3, f64)> {
    let mut views = Vec::new();
    for radius in [30.0, 3.0, 1.5, 1.2, 1.01, 1.0001, 1e6, 1e15] {
        let position = position(radius);
        let p = position.normalize();
        let t = p.any_orthonormal_vector();
        let psi = ExactRays::new(radius).critical;
        let at = |angle: f64| t * libm::sin(angle) - p * libm::cos(angle);
        for (name, towards, fov) in [
            (
                "the hole",
                at(0.1 * psi),
                (4.0 * psi).to_degrees().min(140.0),
            ),
            ("its edge", at(psi), (0.5 * psi).to_degrees()),
            ("its edge nearer", at(psi), 1e-3 * psi.to_degrees()),
            ("away", at(PI - 0.01), 120.0),
            ("wide", at(0.5 * psi + 0.2), 150.0),
        ] {
            let name = format!("r = {radius}, {name}");
            views.push((name, position, towards, fov));
        }
    }
    views
}

#[test]
fn a_uniform_panorama_is_a_uniform_sky() {
    let colour = [0.25_f32, 0.5, 1.0];
    let sky = with_panorama([12.0, 34.0, 56.0]);
    let mut failures = Vec::new();
    let (mut of_all, mut pixels) = (0.0_f32, 0);
    for (name, position, towards, fov) in views() {
        // With the hole's direction between pixels, and on a pixel's centre.
        for size in [(150, 75), (151, 75)] {
            let scene = looking(position, towards, fov, size, &sky);
            let view = View::new(&scene);
            let critical = ExactRays::new(view.radius()).critical;
            let kappa = libm::cos(critical) / libm::sin(critical);
            for antialias in [true, false] {
                let source = panorama(64, |_| colour.map(f64::from));
                let scene = scene.clone().with_antialias(antialias);
                let (_, light) = light_of(Renderer::new(table("standard")), &scene, source);
                let mut worst = (0.0_f32, (0, 0));
                for (index, pixel) in light.iter().enumerate() {
                    let at = (index % size.0 as usize, index / size.0 as usize);
                    assert!(
                        pixel.iter().all(|c| (0.0..1.0001).contains(c)),
                        "{name}: {pixel:?}"
                    );
                    if !sees_no_shadow(&view, kappa, at) {
                        continue;
                    }
                    pixels += 1;
                    for (found, c) in pixel.iter().zip(colour) {
                        let off = (found / c - 1.0).abs();
                        if off > worst.0 {
                            worst = (off, at);
                        }
                    }
                }
                of_all = of_all.max(worst.0);
                if worst.0 > 1e-4 {
                    failures.push(format!(
                        "{name}, {size:?}: {worst:?}, hole {:?}",
                        hole(&view)
                    ));
                }
            }
        }
    }
    println!("worst {of_all:.1e} of {pixels} pixels");
    assert!(failures.is_empty() && pixels > 900_000, "{failures:#?}");
}

#[test]
fn pixels_at_the_edge_of_the_shadow_are_covered_in_part() {
    // A uniform sky shows the share of the pixel that sees it.
    let sky = with_panorama([12.0, 34.0, 56.0]);
    let mut failures = Vec::new();
    for (name, position, towards, fov) in views() {
        let scene = looking(position, towards, fov, (151, 75), &sky);
        let view = View::new(&scene);
        let critical = ExactRays::new(view.radius()).critical;
        let kappa = libm::cos(critical) / libm::sin(critical);
        let source = panorama(16, |_| [1.0; 3]);
        let (_, light) = light_of(Renderer::new(table("standard")), &scene, source);
        let (mut worst, mut at_worst) = (0.0_f64, (0, 0, 0.0, 0.0));
        for (index, pixel) in light.iter().enumerate() {
            let (i, j) = (index % 151, index / 151);
            if sees_no_shadow(&view, kappa, (i, j)) {
                continue;
            }
            let mut seen = 0;
            for k in 0..64 * 64 {
                let x = i as f64 + (f64::from(k % 64) + 0.5) / 64.0;
                let y = j as f64 + (f64::from(k / 64) + 0.5) / 64.0;
                let ray = view.ray_at(view.x_at(x), view.y_at(y));
                seen += i32::from(ray.z < kappa * ray.transverse());
            }
            let share = f64::from(seen) / 4096.0;
            let off = (f64::from(pixel[0]) - share).abs();
            if off > worst {
                (worst, at_worst) = (off, (i, j, f64::from(pixel[0]), share));
            }
        }
        println!("{name}: {worst:.4} {at_worst:?}");
        // Half a line of the rays counted, and an edge that is taken as straight.
        if worst > 0.015 {
            failures.push(format!("{name}: {worst}, {at_worst:?}"));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn a_disk_before_a_sky_covers_it_by_its_share() {
    let colour = [0.25_f32, 0.5, 1.0];
    let sky = with_panorama([0.0; 3]);
    for radius in [30.0, 5.0] {
        let camera = Camera::at(position(radius), if radius > 6.0 { 60.0 } else { 110.0 });
        let size = darkness::scene::ImageSize {
            width: 160,
            height: 90,
        };
        for light in [
            None,
            Some(Light::BlackBody {
                temperature: 7000.0,
            }),
        ] {
            for antialias in [true, false] {
                let plain = Scene::new(camera, Disk::new(3.0, 12.0), size)
                    .and_then(|scene| scene.with_light(light))
                    .unwrap()
                    .with_antialias(antialias);
                let layers: LayerSet = [Layer::Coverage, Layer::Colour].into_iter().collect();
                let over = plain.clone().with_sky(Some(sky.clone())).unwrap();
                let source = panorama(16, |_| colour.map(f64::from));
                let mut renderer = Renderer::new(table("standard"))
                    .with_sky(sky.clone(), std::sync::Arc::new(source));
                let planes = renderer.render_layers(&over, layers).unwrap();
                let pixels = planes[1].values.as_chunks::<3>().0;
                let black = plain.with_sky(Some(Sky::default())).unwrap();
                let alone = renderer.render_layers(&black, layers).unwrap();
                let disk = alone[1].values.as_chunks::<3>().0;
                let view = View::new(&over);
                let critical = ExactRays::new(radius).critical;
                let kappa = libm::cos(critical) / libm::sin(critical);
                let (mut worst, mut partial) = (0.0_f32, 0);
                for (index, (pixel, disk)) in pixels.iter().zip(disk).enumerate() {
                    let share = planes[0].values[index];
                    if !sees_no_shadow(&view, kappa, (index % 160, index / 160)) {
                        continue;
                    }
                    partial += i32::from(share > 0.0 && share < 1.0);
                    for ((found, disk), c) in pixel.iter().zip(disk).zip(colour) {
                        worst = worst.max((found - disk - (1.0 - share) * c).abs());
                    }
                }
                println!("r = {radius}, {light:?}, {antialias}: {worst:.1e}, {partial} partial");
                assert!(worst < 1e-4 && (partial > 100) == antialias);
            }
        }
    }
}

/// Light of low spherical harmonics.
fn harmonics(d: DVec3) -> [f64; 3] {
    [
        0.5 + 0.3 * d.x + 0.15 * d.y * d.z,
        0.5 + 0.25 * d.z + 0.2 * (d.x * d.x - d.y * d.y),
        0.5 + 0.2 * d.y - 0.2 * d.x * d.z,
    ]
}

/// The mean of the light over a pixel by 4 × 4 nodes of Gauss.
fn mean_of_rays(
    view: &View,
    curve: &EscapeCurve,
    sky: Orientation,
    at: (usize, usize),
) -> [f64; 3] {
    let nodes = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let [p, a, b] = view.axes();
    let mut sum = [0.0; 3];
    for (dx, wx) in nodes {
        for (dy, wy) in nodes {
            let x = view.x_at(at.0 as f64 + 0.5 + 0.5 * dx);
            let y = view.y_at(at.1 as f64 + 0.5 + 0.5 * dy);
            let ray = view.ray_at(x, y);
            let s = ray.transverse();
            let angle = curve.at(ray.z, s).unwrap().angle;
            let t = (a * ray.ta + b * ray.tb) / s;
            let direction = sky.to_sky(p * libm::cos(angle) + t * libm::sin(angle));
            for (sum, c) in sum.iter_mut().zip(harmonics(direction)) {
                *sum += 0.25 * wx * wy * c;
            }
        }
    }
    sum
}

/// Bilinear texels of the harmonics are off by 2 (π/512)²/8, and a float by half of its last place.
const ROUNDING: f64 = 1e-5;

#[test]
fn there_are_no_seams() {
    let size = (290, 163);
    let (width, height) = (290, 163);
    let mut failures = Vec::new();
    for (name, position, towards, fov) in views() {
        if position.length() > 1e7 {
            continue;
        }
        for (turned, rotation) in [
            ("as it is", [0.0; 3]),
            // The pole in the picture's centre; the seam through it.
            ("pole ahead", {
                let DVec3 { x, y, z } = towards;
                [
                    20.0,
                    libm::asin(x).to_degrees(),
                    libm::atan2(-y, z).to_degrees(),
                ]
            }),
            ("seam ahead", {
                let (u, _) = darkness::sky::place(towards);
                [360.0 * (0.5 - u) + 180.0, 0.0, 0.0]
            }),
        ] {
            let sky = with_panorama(rotation);
            let scene = looking(position, towards, fov, size, &sky);
            let view = View::new(&scene);
            let curve = EscapeCurve::new(view.u0(), view.slope_scale(), &Exact);
            let orientation = Orientation::new(rotation);
            let (_, light) = light_of(
                Renderer::new(table("standard")),
                &scene,
                panorama(512, harmonics),
            );
            // What is off in each pixel, and its footprint, where that is below half a radian.
            let off: Vec<Option<([f64; 3], f64)>> = (0..width * height)
                .map(|index| {
                    let at = (index % width, index / width);
                    let (x, y) = (at.0 as f64 + 0.5, at.1 as f64 + 0.5);
                    let ray = view.ray_at(view.x_at(x), view.y_at(y));
                    let rate = curve.at(ray.z, ray.transverse())?.rate;
                    let footprint = rate.max(1.0) * view.pixel_side();
                    if footprint > 0.5 || !sees_no_shadow(&view, curve.critical(), at) {
                        return None;
                    }
                    let truth = mean_of_rays(&view, &curve, orientation, at);
                    let off = core::array::from_fn(|c| f64::from(light[index][c]) - truth[c]);
                    Some((off, footprint))
                })
                .collect();
            // The error of a pixel, and its jump to the next one, over the footprint; but for rounding.
            let (mut worst, mut jump) = ((0.0_f64, (0, 0)), (0.0_f64, (0, 0)));
            for index in 0..width * height {
                let at = (index % width, index / width);
                let Some((here, footprint)) = off[index] else {
                    continue;
                };
                for c in 0..3 {
                    let share = (here[c].abs() - ROUNDING) / footprint;
                    if share > worst.0 {
                        worst = (share, at);
                    }
                    let next = [(at.0 + 1 < width, 1), (at.1 + 1 < height, width)];
                    for (_, step) in next.into_iter().filter(|next| next.0) {
                        let Some((there, _)) = off[index + step] else {
                            continue;
                        };
                        let share = ((there[c] - here[c]).abs() - ROUNDING) / footprint;
                        if share > jump.0 {
                            jump = (share, at);
                        }
                    }
                }
            }
            let text = format!("{name}, {turned}: off by {worst:?}, jumps {jump:?}");
            println!("{text}");
            // A place may be off by a fiftieth of a footprint, along which the light changes by half of it at most.
            if worst.0 > 0.01 || jump.0 > 0.01 {
                failures.push(text);
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}
