//! What pixels see of the disk, against references in long double: which image, radius, azimuth, redshift and emission
//! cosine, by each pixel's own ray.

use core::cell::Cell;
use core::f64::consts::{PI, TAU};

use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::Adaptive;
use darkness::orbit::{EventKind, Fate, Orbits, Ray};
use darkness::render::pixelwise;
use darkness::scene::{Disk, ImageSize, Scene, View};
use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use crate::any_scene::any_scene;
use crate::light_references::{Reference, SCENES, Seen, Worst, reference};
use crate::tables::table;

fn seen(scene: &Scene, view: &View, orbits: &impl Orbits, pixel: (u32, u32)) -> Seen {
    let sight = pixelwise::sight(scene, view, orbits, pixel).unwrap();
    let sees = pixelwise::sees(scene, view, orbits, pixel).unwrap();
    assert_eq!(sees, sight.is_some(), "{pixel:?}");
    if let Some(sight) = sight {
        return Seen::Disk(sight);
    }
    let pixel = view.pixel(pixel.0, pixel.1);
    let ray = Ray::new(view.u0(), view.dudphi(pixel)).unwrap();
    let end = orbits.follow(ray, &[]).unwrap()[0];
    if end.kind == EventKind::End(Fate::Capture) {
        return Seen::Hole;
    }
    let [p, a, b] = view.axes();
    let across = (a * pixel.ta + b * pixel.tb) / pixel.transverse();
    Seen::Sky((p * libm::cos(end.angle) + across * libm::sin(end.angle)).to_array())
}

/// Compares every row of every reference, or every `step`th: the same kind and order, azimuths within 1e-12, everything
/// else within `most`.
fn compare(name: &str, orbits: &impl Orbits, most: f64, step: usize) {
    for scene_name in SCENES {
        let Reference { scene, rows } = reference(scene_name);
        let view = View::new(&scene);
        let (mut worst, mut lit, mut sky) = (Worst::default(), 0, 0.0_f64);
        for &(pixel, known) in rows.iter().step_by(step) {
            let found = seen(&scene, &view, orbits, pixel);
            match (found, known) {
                (Seen::Disk(found), Seen::Disk(known)) => {
                    assert_eq!(found.order, known.order, "{name}, {scene_name}: {pixel:?}");
                    worst.add(&found, &known);
                    lit += 1;
                }
                (Seen::Sky(found), Seen::Sky(known)) => {
                    let off = (0..3).fold(0.0, |off: f64, i| off.max((found[i] - known[i]).abs()));
                    sky = sky.max(off);
                }
                _ => assert_eq!(found, known, "{name}, {scene_name}: {pixel:?}"),
            }
        }
        println!(
            "{name}, {scene_name}: {lit} lit of {}, {worst:?}, directions {sky:e}",
            rows.len()
        );
        assert!(lit > 250 / step, "{scene_name}: {lit} lit pixels");
        let most_of_all = worst.radius.max(worst.redshift).max(worst.cosine);
        assert!(most_of_all <= most, "{name}, {scene_name}: {worst:?}");
        assert!(worst.azimuth <= 1e-12, "{name}, {scene_name}: {worst:?}");
        assert!(
            sky <= most,
            "{name}, {scene_name}: directions off by {sky:e}"
        );
    }
}

/// The largest relative error of a radius on these disks, r ≤ 15, where an angle has an error of 1e-9:
/// `|du/dφ| r` is at most `e r`, and the rays past the hole have e ≤ 0.385.
const BY_ANGLES_TO_1E_9: f64 = 0.385 * 15.0 * 1e-9;

#[test]
fn exact_sights_equal_the_references() {
    compare("exact", &Exact, 1e-12, 1);
}

#[test]
fn sights_from_the_standard_table_equal_the_references() {
    compare("standard", table("standard"), BY_ANGLES_TO_1E_9, 1);
}

#[test]
fn sights_by_integration_equal_the_references() {
    compare("adaptive", &Adaptive::default(), BY_ANGLES_TO_1E_9, 7);
}

/// A direction that a picture shows, by the definitions and in the scene's own axes.
struct Naive {
    normal: DVec3,
    p: DVec3,
    /// The direction of d's part across p̂.
    t: DVec3,
    /// The sine of the angle between d and p̂.
    sine: f64,
    /// `−r0 n·(p̂ × d)/√(1 − u0)`.
    lambda: f64,
    impact_parameter: f64,
}

impl Naive {
    fn new(scene: &Scene, view: &View, (i, j): (u32, u32)) -> Self {
        let camera = scene.camera();
        let f = (camera.focus - camera.position).normalize();
        let right = f.cross(camera.up.normalize()).normalize();
        let up = right.cross(f);
        let (x, y) = (view.x_at(f64::from(i) + 0.5), view.y_at(f64::from(j) + 0.5));
        let d = (f + right * x + up * y).normalize();
        let p = camera.position.normalize();
        let across = d - p * d.dot(p);
        let normal = scene.disk().unwrap().normal.normalize();
        let scale = view.radius() / (1.0 - 1.0 / view.radius()).sqrt();
        Self {
            normal,
            p,
            t: across.normalize(),
            sine: across.length(),
            lambda: -scale * normal.dot(p.cross(d)),
            impact_parameter: scale * across.length(),
        }
    }

    /// The first angle above 0 at which the ray is in the disk's plane.
    fn first_crossing(&self) -> f64 {
        let (p, t) = (self.normal.dot(self.p), self.normal.dot(self.t));
        if p == 0.0 {
            return PI;
        }
        let angle = libm::atan2(-p, t);
        if angle > 0.0 { angle } else { angle + PI }
    }

    fn azimuth(&self, angle: f64) -> f64 {
        let place = self.p * libm::cos(angle) + self.t * libm::sin(angle);
        let n = self.normal;
        let off_x = (n - DVec3::X).length().min((n + DVec3::X).length());
        let from = if off_x < 1e-6 { DVec3::Y } else { DVec3::X };
        let zero = (from - n * n.dot(from)).normalize();
        libm::atan2(place.dot(n.cross(zero)), place.dot(zero))
    }
}

fn any_normal() -> impl Strategy<Value = DVec3> {
    let component = || -1.0..1.0_f64;
    let any = (component(), component(), component());
    prop_oneof![
        4 => any.prop_map(DVec3::from),
        1 => Just(DVec3::X),
        1 => Just(DVec3::new(-3.0, 1e-7, 0.0)),
        1 => Just(DVec3::new(2.0, 0.0, 1e-4)),
        1 => Just(-DVec3::Z),
        1 => Just(DVec3::Y),
    ]
}

/// Any scene, the disk turned in any way: the ray is on the disk at the angle of its order and not at lower ones, and
/// azimuth, redshift and emission cosine follow from the definitions.
#[test]
fn sights_are_what_the_definitions_say() {
    let turned = proptest::option::of(any_normal());
    let lit = [const { Cell::new(0) }; 3];
    let config = ProptestConfig {
        cases: 1_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let result = TestRunner::new(config).run(&(any_scene(), turned), |((_, scene), normal)| {
        let disk = Disk {
            normal: normal.unwrap_or(scene.disk().unwrap().normal),
            ..*scene.disk().unwrap()
        };
        let size = ImageSize {
            width: 8,
            height: 6,
        };
        let Ok(scene) = Scene::new(*scene.camera(), disk, size) else {
            return Ok(());
        };
        let view = View::new(&scene);
        let place = match view.n_p().abs() {
            0.0 => 0,
            1.0 => 1,
            _ => 2,
        };
        for pixel in (0..8).flat_map(|i| (0..6).map(move |j| (i, j))) {
            let seen = check_by_definition(&scene, &view, pixel)?;
            lit[place].update(|count| count + u32::from(seen));
        }
        Ok(())
    });
    println!("lit pixels from the disk's plane, its axis, elsewhere: {lit:?}");
    result.unwrap_or_else(|error| panic!("{error}"));
    assert!(lit.iter().all(|count| count.get() > 20), "{lit:?}");
}

/// Checks what a pixel sees by the definitions, up to the rounding of their vectors. Returns whether it sees the disk;
/// leaves out pixels so near to an edge or to the disk's plane that this rounding decides.
fn check_by_definition(
    scene: &Scene,
    view: &View,
    pixel: (u32, u32),
) -> Result<bool, TestCaseError> {
    let naive = Naive::new(scene, view, pixel);
    let Ok(ray) = Ray::new(view.u0(), view.dudphi(view.pixel(pixel.0, pixel.1))) else {
        return Ok(false);
    };
    let found = pixelwise::sight(scene, view, &Exact, pixel).unwrap();
    let sees = pixelwise::sees(scene, view, &Exact, pixel).unwrap();
    prop_assert_eq!(found.is_some(), sees);

    // The rounding of d̂, and what it and that of n do to the crossing's angle.
    let rounding = 1e-14 * (1.0 + 1.0 / naive.sine);
    let (p, t) = (naive.normal.dot(naive.p), naive.normal.dot(naive.t));
    let blur = rounding / libm::hypot(p, t) + 1e-12;
    let first = naive.first_crossing();
    let at_ends = p != 0.0 && (first < 10.0 * blur || first > PI - 10.0 * blur);
    if blur > 1e-3 || at_ends {
        return Ok(false);
    }
    let disk = scene.disk().unwrap();
    let (u_inner, u_outer) = (1.0 / disk.inner, 1.0 / disk.outer);
    let mut known = None;
    for k in 0..8 {
        let angle = first + f64::from(k) * PI;
        let Some(u) = Exact.u_at_angle(ray, angle).unwrap() else {
            break;
        };
        if (u - u_inner).abs() <= blur || (u - u_outer).abs() <= blur {
            return Ok(false);
        }
        if u_outer < u && u < u_inner {
            known = Some((k, angle, u));
            break;
        }
    }
    let (Some((order, angle, u)), Some(found)) = (known, found) else {
        prop_assert!(
            known.is_none() && found.is_none(),
            "{known:?}, but {found:?}"
        );
        return Ok(false);
    };
    prop_assert_eq!(found.order, order);
    prop_assert!((found.u - u).abs() <= blur, "{} for {}", found.u, u);
    prop_assert!((0.0..TAU).contains(&found.azimuth));
    let azimuth = (found.azimuth - naive.azimuth(angle)).rem_euclid(TAU);
    let azimuth = azimuth.min(TAU - azimuth);
    prop_assert!(azimuth <= 4.0 * blur, "{} off by {azimuth}", found.azimuth);

    let velocity = (0.5 * found.u * found.u * found.u).sqrt();
    let (b, lambda) = (naive.impact_parameter, naive.lambda);
    let clock_rate = (1.0 - 1.0 / view.radius()).sqrt();
    // At a camera close to the horizon 1 − 1/r has few digits.
    let by_radius = f64::EPSILON / (view.radius() - 1.0);
    let allowed = 1e-12 + by_radius + rounding * velocity * b;
    let energy = (1.0 - 1.5 * found.u).sqrt() / (1.0 - velocity * lambda);
    let g = found.redshift * clock_rate / energy;
    prop_assert!((g - 1.0).abs() <= allowed, "{g} within {allowed:e}");
    let across = found.emission_cosine / (found.u * energy);
    let error = (across * across - (b * b - lambda * lambda)).abs();
    let allowed = b * b * (2.0 * allowed + by_radius + 4.0 * rounding);
    prop_assert!(error <= allowed, "{across}² is not {b}² − {lambda}²");
    Ok(true)
}
