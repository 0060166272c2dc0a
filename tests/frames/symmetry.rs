//! Guards against a picture that depends on the direction of the axes or on which side is left, and against errors at
//! the places that are special in the arithmetic only: the photon sphere, the disk's plane and axis, the horizon,
//! infinity, and the line to the hole.

use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::{Adaptive, FixedStep, Scheme};
use darkness::orbit::invariants::{CRITICAL_E2, Orbit};
use darkness::orbit::{Event, EventKind, Fate, Orbits, Ray};
use darkness::render::mask::WHITE;
use darkness::scene::{Scene, View};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

use crate::methods::{by_curves, by_pixels, differing, sees_disk};
use crate::tables::table;

/// A camera at `position` that looks at `focus`, with +z up unless it looks along it.
fn scene(position: DVec3, focus: DVec3, fov: f64, size: (u32, u32)) -> Scene {
    let view = (focus - position).normalize();
    let up = if view.z.abs() > 0.99 {
        DVec3::Y
    } else {
        DVec3::Z
    };
    described(position, focus, up, fov, DVec3::Z, (3.0, 12.0), size)
}

fn described(
    position: DVec3,
    focus: DVec3,
    up: DVec3,
    fov: f64,
    normal: DVec3,
    (inner, outer): (f64, f64),
    (width, height): (u32, u32),
) -> Scene {
    let vector = |v: DVec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    let text = format!(
        "[camera]\nposition = {}\nfocus = {}\nup = {}\nfov = {fov:?}\n\
         [disk]\ninner = {inner:?}\nouter = {outer:?}\nnormal = {}\n\
         [image]\nwidth = {width}\nheight = {height}\n",
        vector(position),
        vector(focus),
        vector(up),
        vector(normal)
    );
    Scene::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The same camera and another disk.
fn with_disk(scene: &Scene, edges: (f64, f64)) -> Scene {
    let (camera, image) = (scene.camera(), scene.image());
    described(
        camera.position,
        camera.focus,
        camera.up,
        camera.fov_degrees,
        scene.disk().unwrap().normal,
        edges,
        (image.width, image.height),
    )
}

fn rotated(scene: &Scene, rotation: DQuat) -> Scene {
    let (camera, disk) = (scene.camera(), scene.disk().unwrap());
    let image = scene.image();
    described(
        rotation * camera.position,
        rotation * camera.focus,
        rotation * camera.up,
        camera.fov_degrees,
        rotation * disk.normal,
        (disk.inner, disk.outer),
        (image.width, image.height),
    )
}

/// Scenes of every kind, small; their heights are even, so that no row lies in the disk's plane, where turning by a
/// rounding turns all.
fn all_kinds() -> Vec<Scene> {
    let small = |name| Scene::builtin(name).unwrap().with_size(96, 54).unwrap();
    vec![
        small("classic"),
        small("edge-on"),
        small("face-on"),
        small("close-up"),
        small("inside"),
        small("photon-ring"),
        // Far away through a long lens.
        scene(
            DVec3::new(9.4e8, 0.0, 3.4e8),
            DVec3::new(1.0, -2.0, 0.5),
            1.6e-6,
            (96, 54),
        ),
        // Rolled, tilted, looking past the hole.
        described(
            DVec3::new(8.0, -6.0, 3.0),
            DVec3::new(0.5, 0.5, -0.3),
            DVec3::new(0.3, 0.2, 1.0),
            70.0,
            DVec3::new(0.2, -0.4, 1.0),
            (3.5, 15.0),
            (96, 54),
        ),
    ]
}

/// The frame by curves from the table, and that of the exact method pixel by pixel, are the same but on edges; so is
/// the table's pixel by pixel. Returns the exact one, on which both colours are to be seen.
fn checked_frame(name: &str, scene: &Scene) -> Vec<u8> {
    let lookup = table("standard").lookup();
    let exact = by_pixels(scene, &Exact);
    assert!(
        exact.contains(&WHITE) && exact.contains(&0),
        "{name}: only one colour"
    );
    for (method, frame) in [
        ("curves", by_curves(scene, &lookup)),
        ("pixels", by_pixels(scene, &lookup)),
    ] {
        // On the average 0.4 % of an edge's pixels have it within a thousandth of their centre.
        let count = differing(&format!("{name}, {method}"), scene, &exact, &frame);
        assert!(count <= 4, "{name}, {method}: {count} pixels differ");
    }
    exact
}

/// The rows from bottom to top.
fn flipped(frame: &[u8], width: u32) -> Vec<u8> {
    frame
        .chunks(width as usize)
        .rev()
        .flatten()
        .copied()
        .collect()
}

/// Each row from right to left.
fn mirrored(frame: &[u8], width: u32) -> Vec<u8> {
    frame
        .chunks(width as usize)
        .flat_map(|row| row.iter().rev())
        .copied()
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// Position, focus, up and normal turned together: the same picture. The turned numbers are rounded, so a pixel
    /// may change where an edge passes within a thousandth of a pixel.
    #[test]
    fn turning_the_whole_scene_changes_nothing(
        (x, y, z) in (-1.0..1.0, -1.0..1.0, -1.0..1.0),
        angle in 0.1..6.2,
    ) {
        let axis = DVec3::new(x, y, z);
        prop_assume!(axis.length() > 0.1);
        let rotation = DQuat::from_axis_angle(axis.normalize(), angle);
        let lookup = table("standard").lookup();
        for (k, scene) in all_kinds().iter().enumerate() {
            let turned = rotated(scene, rotation);
            let (before, after) = (by_curves(scene, &lookup), by_curves(&turned, &lookup));
            prop_assert!(before.contains(&WHITE) && before.contains(&0), "scene {k}");
            differing(&format!("scene {k} turned by {rotation}"), scene, &before, &after);
        }
    }
}

#[test]
fn left_and_right_are_alike_to_the_byte() {
    let lookup = table("standard").lookup();
    let classic = Scene::builtin("classic").unwrap();
    for (width, height) in [(320, 180), (321, 181)] {
        let scene = classic.clone().with_size(width, height).unwrap();
        for frame in [by_curves(&scene, &lookup), by_pixels(&scene, &lookup)] {
            assert!(frame.contains(&WHITE));
            assert!(frame == mirrored(&frame, width), "{width} × {height}");
        }
    }
}

#[test]
fn top_and_bottom_are_alike_to_the_byte_from_within_the_disks_plane() {
    let lookup = table("standard").lookup();
    for position in [
        DVec3::new(20.0, 0.0, 0.0),
        DVec3::new(2.0, 0.0, 0.0),
        DVec3::new(-9.0, 12.0, 0.0),
    ] {
        for (width, height) in [(160, 90), (161, 91)] {
            // The shadow's half-angle is 67° at r = 2.
            let scene = scene(position, DVec3::ZERO, 150.0, (width, height));
            for frame in [by_curves(&scene, &lookup), by_pixels(&scene, &lookup)] {
                assert!(frame.contains(&WHITE), "{position}");
                assert!(
                    frame == flipped(&frame, width),
                    "{position}, {width} × {height}"
                );
            }
        }
    }
}

#[test]
fn the_photon_sphere_is_a_place_like_any_other() {
    for radius in [
        1.5,
        1.5 - 1e-9,
        1.5 + 1e-9,
        1.5_f64.next_down(),
        1.5_f64.next_up(),
        1.5 - 1e-4,
        1.5 + 1e-4,
    ] {
        for place in [
            DVec3::new(0.8, 0.0, 0.6),
            DVec3::X,
            DVec3::Z,
            DVec3::new(0.36, -0.48, 0.8),
        ] {
            let position = place * radius;
            for (towards, focus) in [
                ("out", 2.0 * position),
                ("aside", position + DVec3::new(-0.3, 1.0, 0.2)),
            ] {
                // From within the plane the disk ahead is a line, and its images stand at the picture's sides.
                if towards == "out" && place == DVec3::X {
                    continue;
                }
                let name = format!("r = {radius:?} at {place}, looking {towards}");
                // The hole fills the half of the sky that these do not look at.
                checked_frame(&name, &scene(position, focus, 110.0, (96, 64)));
            }
        }
    }
}

/// Odd heights too: there a row of rays stays in the plane for ever.
#[test]
fn a_camera_in_the_disks_plane_sees_what_its_neighbours_see() {
    let places = [
        ("in the gap", 2.0),
        ("at the disk's inner edge, inside", 3.0_f64.next_down()),
        ("at its outer edge, outside", 12.0_f64.next_up()),
        ("outside", 13.0),
        ("far outside", 500.0),
    ];
    for (name, radius) in places {
        for (toward, focus) in [
            ("at the hole", DVec3::ZERO),
            ("aside", DVec3::new(1.0, 2.0, 0.0)),
        ] {
            let fov = if radius > 100.0 { 5.0 } else { 110.0 };
            for size in [(120, 80), (121, 81)] {
                let scene = scene(DVec3::new(radius, 0.0, 0.0), focus, fov, size);
                assert_eq!(View::new(&scene).n_p(), 0.0, "{name}");
                let frame = checked_frame(&format!("{name}, looking {toward}"), &scene);
                // The ray within the plane is the limit of the rays above and below it.
                let (width, middle) = (size.0 as usize, size.1 as usize / 2);
                if size.1 % 2 == 1 {
                    let view = View::new(&scene);
                    assert_eq!(view.pixel(0, size.1 / 2).ta, 0.0, "{name}");
                    for i in 0..width {
                        let (column, row) = (i as f64 + 0.5, middle as f64 + 0.5);
                        let near = [(-1e-3, 1e-6), (-1e-3, -1e-6), (1e-3, 1e-6), (1e-3, -1e-6)]
                            .map(|(dx, dy)| sees_disk(&scene, &view, column + dx, row + dy));
                        let white = frame[middle * width + i] == WHITE;
                        assert!(near.contains(&white), "{name}, looking {toward}: pixel {i}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_camera_on_the_disks_axis_sees_circles() {
    let out = 2.0 * DVec3::Z;
    for (height, focus, fov) in [
        (40.0, DVec3::ZERO, 60.0),
        (-40.0, DVec3::ZERO, 60.0),
        // The shadow's half-angle is 67° at r = 2; from inside the photon sphere the disk is seen looking out.
        (2.0, DVec3::ZERO, 150.0),
        (1.2, out, 110.0),
        (1e6, DVec3::ZERO, 2e-3),
    ] {
        for side in [80, 81] {
            let scene = scene(DVec3::Z * height, focus, fov, (side, side));
            assert_eq!(View::new(&scene).n_a(), 0.0);
            let frame = checked_frame(&format!("z = {height}"), &scene);
            let lookup = table("standard").lookup();
            let curves = by_curves(&scene, &lookup);
            for frame in [frame, curves] {
                assert!(
                    frame == mirrored(&frame, side) && frame == flipped(&frame, side),
                    "z = {height}"
                );
            }
        }
    }
}

/// From just above the horizon all that is not the hole is a window of half-angle `b_c √(1 − 1/r)/r` about the way
/// straight out (Synge 1966).
#[test]
fn a_camera_at_the_horizon_sees_the_window_close() {
    for above in [1e-12, 1e-9, 1e-4] {
        let half_angle = 1.5 * 3.0_f64.sqrt() * f64::sqrt(above);
        for place in [DVec3::new(0.8, 0.0, 0.6), DVec3::X, DVec3::Z] {
            let position = place * (1.0 + above);
            let fov = (2.5 * half_angle).to_degrees();
            let scene = scene(position, 2.0 * position, fov, (96, 96));
            let frame = checked_frame(&format!("r = 1 + {above:e} at {place}"), &scene);
            // Of 48 pixels from the middle to the edge 38.4 are within the window; the images of the disk come up to
            // it.
            let farthest = (0..96 * 96)
                .filter(|&k| frame[k] == WHITE)
                .map(|k| {
                    let (x, y) = ((k % 96) as f64 - 47.5, (k / 96) as f64 - 47.5);
                    (x * x + y * y).sqrt() / 38.4
                })
                .fold(0.0, f64::max);
            assert!(
                (0.9..1.03).contains(&farthest),
                "1 + {above:e} at {place}: out to {farthest}"
            );
        }
    }
}

#[test]
fn a_camera_at_infinity_resolves_the_rings() {
    let place = DVec3::new(0.96, -0.1, 0.2).normalize();
    for radius in [1e6_f64, 1e9, 1e12, 9e14] {
        for (focus, width_of_view) in [
            (DVec3::ZERO, 26.0_f64),
            // On the shadow's upper edge, where order 1 ends and order 2 begins.
            (DVec3::new(-0.5, 0.0, 2.55), 0.2),
        ] {
            let fov = (width_of_view / radius).to_degrees();
            let scene = scene(place * radius, focus, fov, (120, 90));
            checked_frame(
                &format!("r = {radius:e}, {width_of_view} radii across"),
                &scene,
            );
        }
    }
}

/// Through a wide lens the whole disk is a millionth of a pixel and smaller, wherever it lies: the curves may be off
/// by a thousandth of a pixel, and must not light one elsewhere.
#[test]
fn a_disk_too_far_for_the_lens_lights_nothing() {
    let lookup = table("standard").lookup();
    for (radius, outer) in [
        (1e6, 12.0),
        (1e9, 1e3),
        (1e12, 1e4),
        (1e12, 1e6),
        (9e14, 1e6),
    ] {
        for rise in [0.01, 0.1, 0.3] {
            let position = DVec3::new(1.0, 0.0, rise).normalize() * radius;
            let scene = with_disk(&scene(position, DVec3::ZERO, 50.0, (64, 46)), (3.0, outer));
            for (method, frame) in [
                ("pixels", by_pixels(&scene, &Exact)),
                ("curves", by_curves(&scene, &lookup)),
            ] {
                assert!(
                    !frame.contains(&WHITE),
                    "r = {radius:e}, disk to {outer:e}, {rise} up, {method}"
                );
            }
        }
    }
}

/// From so far the picture no longer changes with the distance but by its scale.
#[test]
fn far_pictures_are_the_same_at_every_distance() {
    let lookup = table("standard").lookup();
    let frame = |radius: f64| {
        let fov = (26.0 / radius).to_degrees();
        let scene = scene(
            DVec3::new(0.96, 0.0, 0.28) * radius,
            DVec3::ZERO,
            fov,
            (120, 90),
        );
        (by_curves(&scene, &lookup), scene)
    };
    let (near, scene) = frame(1e10);
    for radius in [1e11, 1e12, 1e13, 5e14] {
        // The shape changes with the camera's distance by a share of 12/r at most: far below a thousandth of a pixel.
        differing(&format!("r = {radius:e}"), &scene, &near, &frame(radius).0);
    }
}

#[test]
fn rays_straight_in_and_out_pass_every_radius_at_angle_zero() {
    let rk4 = FixedStep::new(Scheme::Rk4, 0.02);
    let (integrated, table) = (Adaptive::default(), table("standard"));
    let methods: [(&str, &dyn Orbits); 4] = [
        ("exact", &Exact),
        ("table", table),
        ("adaptive", &integrated),
        ("RK4", &rk4),
    ];
    let radii = [12.0, 1.2, 3.0, 30.0, 3.0, 6.0];
    let ascending = [1.2, 3.0, 6.0, 12.0, 30.0];
    for (name, method) in methods {
        for u in [
            1e-100,
            1e-15,
            0.01,
            0.1,
            1.0 / 3.0,
            0.5,
            2.0 / 3.0,
            0.9,
            1.0 - 1e-15,
        ] {
            for w in [f64::INFINITY, f64::NEG_INFINITY] {
                let events = method.follow(Ray::new(u, w).unwrap(), &radii).unwrap();
                let start = 1.0 / u;
                let mut told: Vec<(EventKind, f64)> = if w > 0.0 {
                    let met = ascending.iter().rev().filter(|&&radius| radius < start);
                    met.map(|&radius| (EventKind::Inbound, radius)).collect()
                } else {
                    let met = ascending.iter().filter(|&&radius| radius > start);
                    met.map(|&radius| (EventKind::Outbound, radius)).collect()
                };
                told.push(if w > 0.0 {
                    (EventKind::End(Fate::Capture), 1.0)
                } else {
                    (EventKind::End(Fate::Escape), f64::INFINITY)
                });
                let found: Vec<_> = events
                    .iter()
                    .map(|event| (event.kind, event.radius))
                    .collect();
                assert_eq!(found, told, "{name}, u0 = {u:?}, dudphi = {w}");
                assert!(
                    events.iter().all(|event| event.angle == 0.0),
                    "{name}, u0 = {u:?}, dudphi = {w}: {events:?}"
                );
            }
        }
    }
}

#[test]
fn the_middle_of_the_hole_is_black() {
    let lookup = table("standard").lookup();
    for position in [
        DVec3::new(29.5442, 0.0, 5.2094),
        DVec3::new(20.0, 0.0, 0.0),
        DVec3::new(0.0, 0.0, 40.0),
        DVec3::new(1.3, 0.2, 0.4),
        DVec3::new(-3e11, 4e11, 5e11),
    ] {
        let radius = position.length();
        let fov = if radius > 1e3 {
            (26.0 / radius).to_degrees()
        } else {
            60.0
        };
        let scene = scene(position, DVec3::ZERO, fov, (61, 41));
        let view = View::new(&scene);
        assert_eq!(
            view.pixel(30, 20).transverse(),
            0.0,
            "{position}: not straight at the hole"
        );
        for (method, frame) in [
            ("curves", by_curves(&scene, &lookup)),
            ("table", by_pixels(&scene, &lookup)),
            ("exact", by_pixels(&scene, &Exact)),
            ("integration", by_pixels(&scene, &Adaptive::default())),
        ] {
            assert_eq!(frame[20 * 61 + 30], 0, "{position}, {method}");
        }
    }
}

/// With one radius for an outer and an inner edge, two disks are one: an edge is where it is whatever lies on its
/// other side.
#[test]
fn neighbouring_disks_make_one() {
    let lookup = table("standard").lookup();
    for (k, scene) in all_kinds().iter().enumerate() {
        let disk = scene.disk().unwrap();
        let (inner, outer) = (disk.inner, disk.outer);
        let whole = by_curves(scene, &lookup);
        for between in [inner + 1e-3, 5.0, 8.0, outer - 1e-3] {
            let near = by_curves(&with_disk(scene, (inner, between)), &lookup);
            let far = by_curves(&with_disk(scene, (between, outer)), &lookup);
            let both: Vec<u8> = near.iter().zip(&far).map(|(&a, &b)| a.max(b)).collect();
            // The curves of one radius are the same for both disks but for their number of nodes: a sample within a
            // thousandth of a pixel of an edge may fall between, or come out otherwise.
            let count = both.iter().zip(&whole).filter(|(a, b)| a != b).count();
            assert!(
                count <= 1,
                "scene {k} split at {between}: {count} pixels differ"
            );
        }
    }
}

/// Rays at least a thousandth from critical, so that the last place of their numbers moves no angle by more than 1e3
/// of it.
fn generic_ray() -> impl Strategy<Value = (f64, f64)> {
    (0.01..0.95, -2.0..2.0).prop_filter("near critical", |&(u, w): &(f64, f64)| {
        let e2 = w * w + u * u * (1.0 - u);
        (e2 / CRITICAL_E2 - 1.0).abs() > 1e-3
    })
}

const RADII: [f64; 8] = [1.1, 1.3, 1.7, 2.5, 3.0, 6.0, 12.0, 30.0];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// e² is the same at every event; and a ray started anew from there, with nothing but its place and slope, has
    /// the rest of the same flight before it.
    #[test]
    fn every_event_is_on_the_same_orbit((u, w) in generic_ray()) {
        let ray = Ray::new(u, w).unwrap();
        let orbit = Orbit::new(ray);
        let events = Exact.follow(ray, &RADII).unwrap();
        let (end, passed) = events.split_last().unwrap();
        for event in passed {
            let u = 1.0 / event.radius;
            let point = orbit.point_at(u).unwrap();
            let e2 = point.slope * point.slope + u * u * (1.0 - u);
            // Ten roundings or so of terms no larger than e² (u²(1 − u) never is).
            prop_assert!((e2 - orbit.e2).abs() <= 8.0 * f64::EPSILON * orbit.e2, "{event:?}: {e2} {}", orbit.e2);

            // By a turning point the slope has lost digits, and says less of where on the orbit it is.
            if point.slope < 1e-3 {
                continue;
            }
            let slope = if event.kind == EventKind::Inbound { point.slope } else { -point.slope };
            let rest = Exact.follow(Ray::new(u, slope).unwrap(), &[]).unwrap();
            prop_assert_eq!(rest[0].kind, end.kind);
            // e² is off by 8 ε, Δ > 1e-3 e² by 8e3 ε: as many ε of angle. The slope, by 8 ε e²/slope: over u″ = u(1 −
            // 1.5 u) > 0.03 (or far from any turning point) less than 4e5 ε.
            let allowed = 3e-12 + 4.1e5 * f64::EPSILON;
            let difference = (event.angle + rest[0].angle - end.angle).abs();
            prop_assert!(difference <= allowed, "{event:?}: {difference:e}");
        }
    }

    /// At a fixed orbit angle u rises strictly with du/dφ (the page of `isoradial`): the steeper of two rays comes in
    /// to a radius earlier and goes out through it later. That is why an isoradial is a curve, and those of smaller
    /// radii lie at larger slopes.
    #[test]
    fn steeper_rays_come_in_earlier_and_go_out_later(
        (u, w) in generic_ray(),
        step in 1e-3..0.5,
    ) {
        let steeper = Ray::new(u, w + step).unwrap();
        let ray = Ray::new(u, w).unwrap();
        let table = table("standard");
        // The table's two angles are off by its tolerance each.
        let methods: [(&dyn Orbits, f64); 2] = [(&Exact, 0.0), (table, 2e-9)];
        for (method, slack) in methods {
            let (a, b) = (method.follow(ray, &RADII).unwrap(), method.follow(steeper, &RADII).unwrap());
            for first in &a {
                let same = |second: &&Event| (second.kind, second.radius) == (first.kind, first.radius);
                let Some(second) = b.iter().find(same) else { continue };
                match first.kind {
                    EventKind::Inbound => prop_assert!(second.angle < first.angle + slack, "{first:?}, {second:?}"),
                    EventKind::Outbound => prop_assert!(second.angle > first.angle - slack, "{first:?}, {second:?}"),
                    EventKind::End(_) => (),
                }
            }
        }
    }
}

/// Guards against a camera whose radius is an edge's own: whether a ray starts within the disk's radii then depends
/// on where it goes, and a neighbour some units in the last place away sees the same.
#[test]
fn a_camera_on_the_radius_of_an_edge_sees_what_its_neighbours_see() {
    let lookup = table("standard").lookup();
    for edge in [3.0, 12.0_f64] {
        for (x, z) in [(0.0, 1.0), (0.6, 0.8), (0.8, -0.6)] {
            for focus in ["[0, 0, 0]", "[30, 0, 1]", "[0.5, 9, 3]"] {
                let frames_at = |radius: f64| {
                    let text = format!(
                        "[camera]\nposition = [{:?}, 0, {:?}]\nfocus = {focus}\nup = [0, 1, 0.1]\nfov = 100\n\
                         [disk]\ninner = 3\nouter = 12\n[image]\nwidth = 90\nheight = 54\n",
                        x * radius,
                        z * radius
                    );
                    let scene = Scene::from_toml(&text).unwrap_or_else(|error| panic!("{error}"));
                    (
                        by_curves(&scene, &lookup),
                        by_pixels(&scene, &lookup),
                        by_pixels(&scene, &Exact),
                    )
                };
                let neighbour = frames_at(edge * (1.0 + 1e-12));
                for factor in [1.0, 1.0 + f64::EPSILON, 1.0 - f64::EPSILON, 1.0 - 1e-12] {
                    let frames = frames_at(edge * factor);
                    let name = format!("r = {edge} × {factor:?}, ({x}, {z}), focus {focus}");
                    assert!(frames.0 == neighbour.2, "{name}: curves");
                    assert!(frames.1 == neighbour.2, "{name}: table, pixel by pixel");
                    assert!(frames.2 == neighbour.2, "{name}: exact");
                }
            }
        }
    }
}
