use super::super::{ImageSize, View, builtins};
use super::*;

fn builtin(name: &str) -> Navigator {
    Navigator::new(&Scene::builtin(name).unwrap())
}

/// The scene `lit` with a camera at these angles.
fn at(radius: f64, inclination: f64, azimuth: f64) -> Navigator {
    let camera = Camera::at_angles(radius, inclination, azimuth, 40.0);
    let scene = Scene::builtin("lit").unwrap().with_camera(camera);
    Navigator::new(&scene.unwrap())
}

/// The same navigator, its camera computed.
fn computed(navigator: &Navigator) -> Navigator {
    Navigator {
        given: None,
        ..navigator.clone()
    }
}

#[test]
fn at_first_it_has_the_scenes_camera_and_then_one_like_it() {
    for builtin in builtins() {
        let scene = Scene::builtin(builtin.name()).unwrap();
        let navigator = Navigator::new(&scene);
        assert_eq!(navigator.camera(), *scene.camera());
        assert!(navigator.is_at_start());
        let again = scene.clone().with_camera(computed(&navigator).camera());
        let again = again.unwrap();
        let (before, after) = (View::new(&scene), View::new(&again));
        for (i, j) in [(0, 0), (700, 900), (1919, 1079)] {
            let ray = |view: &View| {
                let ray = view.pixel(i, j);
                let length = libm::sqrt(ray.z * ray.z + ray.transverse() * ray.transverse());
                let [outward, across, level] = view.axes();
                (across * ray.ta + level * ray.tb - outward * ray.z) / length
            };
            let away = (ray(&before) - ray(&after)).length();
            assert!(away < 1e-14, "{}: {away}", builtin.name());
        }
    }
}

#[test]
fn a_turn_is_one_of_azimuth_and_inclination_alone() {
    let mut navigator = at(20.0, 70.0, 10.0);
    navigator.turn(15.0, 5.0);
    let (turned, expected) = (navigator.camera(), at(20.0, 65.0, -5.0).camera());
    assert!((turned.position - expected.position).length() < 1e-13);
    assert!((turned.up - expected.up).length() < 1e-13);
    assert_eq!((turned.focus, turned.fov_degrees), (DVec3::ZERO, 40.0));
    assert!((navigator.inclination() - 65.0).abs() < 1e-12);
    assert!(!navigator.is_at_start());
}

#[test]
fn it_passes_over_both_poles_without_a_jump() {
    let mut navigator = at(20.0, 30.0, 40.0);
    let mut before = navigator.camera();
    for step in 0..720 {
        navigator.turn(0.0, 0.5);
        let camera = navigator.camera();
        let turned = libm::asin((camera.position - before.position).length() / 40.0).to_degrees();
        assert!((2.0 * turned - 0.5).abs() < 1e-3, "step {step}: {turned}");
        assert!((camera.up - before.up).length() < 0.01, "step {step}");
        before = camera;
    }
    let back = computed(&at(20.0, 30.0, 40.0)).camera();
    assert!((before.position - back.position).length() < 1e-12);
    assert!((before.up - back.up).length() < 1e-12);
}

#[test]
fn a_camera_over_a_pole_is_turned_upright_whatever_is_up() {
    let face_on = builtin("face-on");
    assert!(face_on.roll.abs() < 1e-9, "{}", face_on.roll);
    let mut navigator = face_on;
    let up = navigator.camera().up;
    navigator.turn(0.0, -1.0);
    let camera = navigator.camera();
    // Turned downwards in the picture, the camera has gone where up was; here it goes the other way.
    assert!(direction(camera.position).dot(direction(up)) < -0.01);
    assert!(camera.up.dot(direction(up)) > 0.99);
}

#[test]
fn a_rolled_camera_turns_as_it_is_dragged() {
    let scene = Scene::builtin("lit").unwrap();
    let rolled = scene.camera().rolled(90.0);
    let mut navigator = Navigator::new(&scene.clone().with_camera(rolled).unwrap());
    assert!((navigator.roll - 90.0).abs() < 1e-9);
    let before = navigator.camera();
    navigator.turn(2.0, 0.0);
    let right = direction(before.focus - before.position).cross(direction(before.up));
    let moved = direction(navigator.camera().position - before.position);
    assert!(moved.dot(right) < -0.99, "{moved}");
}

#[test]
fn almost_every_turn_keeps_the_radius_to_the_last_bit() {
    for radius in [1.001, 3.7, 29.99999, 12345.678] {
        let mut navigator = at(radius, 33.0, 0.0);
        let radius = navigator.radius();
        let mut kept = 0;
        for _ in 0..1000 {
            navigator.turn(0.37, 0.11);
            let there = norm(navigator.camera().position);
            assert!((there - radius).abs() < 4.0 * f64::EPSILON * radius);
            kept += u32::from(there == radius);
        }
        assert!(kept > 980, "{radius}: {kept}");
    }
}

#[test]
fn the_wheel_is_logarithmic_and_never_leads_into_the_hole() {
    let mut navigator = at(21.0, 60.0, 0.0);
    navigator.zoom(0.5);
    assert!((navigator.radius() - 11.0).abs() < 1e-12);
    for _ in 0..1000 {
        navigator.zoom(0.8);
    }
    assert!(navigator.radius() > 1.0 && navigator.radius() < 1.002);
    let scene = Scene::builtin("lit").unwrap();
    assert!(scene.with_camera(navigator.camera()).is_ok());
    for _ in 0..1000 {
        navigator.zoom(1.25);
    }
    assert!(navigator.radius() > 1e8 && navigator.radius() < 1e10);
}

#[test]
fn a_camera_in_the_disks_plane_stops_before_the_disk() {
    let scene = Scene::builtin("lit").unwrap();
    let disk = *scene.disk().unwrap();
    let mut outside = at(30.0, 90.0, 20.0);
    let mut inside = at(2.5, 90.0, 20.0);
    for _ in 0..100 {
        outside.zoom(0.9);
        inside.zoom(1.1);
        for navigator in [&outside, &inside] {
            assert!(scene.clone().with_camera(navigator.camera()).is_ok());
        }
    }
    assert!(outside.radius() > disk.outer && outside.radius() < disk.outer + 1e-6);
    assert!(inside.radius() < disk.inner && inside.radius() > disk.inner - 1e-6);
    // Outside the disk it passes through the plane.
    let mut free = at(30.0, 89.0, 20.0);
    free.turn(0.0, -2.0);
    assert!((free.inclination() - 91.0).abs() < 1e-9);
}

#[test]
fn a_camera_above_the_disk_stays_above() {
    let scene = Scene::builtin("lit").unwrap();
    let mut navigator = at(6.0, 80.0, 0.0);
    for _ in 0..50 {
        navigator.turn(1.0, -0.7);
        assert!(navigator.inclination() < 90.0);
        assert!(scene.clone().with_camera(navigator.camera()).is_ok());
    }
    assert!(navigator.inclination() > 89.98);
    // It may move over the disk and away from it.
    navigator.zoom(1.2);
    assert!((navigator.radius() - 7.0).abs() < 1e-12);
    navigator.turn(0.0, 0.1);
    assert!(navigator.inclination() < 89.95);
}

#[test]
fn looking_aside_moves_the_picture_as_it_is_dragged_and_comes_back() {
    let scene = Scene::builtin("photon-ring").unwrap();
    let size = ImageSize {
        width: 100,
        height: 100,
    };
    let scene = scene.with_size(size.width, size.height).unwrap();
    let mut navigator = Navigator::new(&scene);
    let pixel = navigator.fov_degrees() / 100.0;
    navigator.look(3.0 * pixel, 2.0 * pixel);
    let aside = scene.clone().with_camera(navigator.camera()).unwrap();
    let (before, after) = (View::new(&scene), View::new(&aside));
    // What was at (60, 60) is 3 pixels to the left of there, and 2 above.
    let (a, b) = (before.pixel(60, 60), after.pixel(57, 58));
    let side = before.pixel_side();
    assert!((a.ta - b.ta).abs() < 0.2 * side && (a.tb - b.tb).abs() < 0.2 * side);
    navigator.look(-3.0 * pixel, -2.0 * pixel);
    let back = scene.clone().with_camera(navigator.camera()).unwrap();
    let (a, b) = (before.pixel(60, 60), View::new(&back).pixel(60, 60));
    assert!((a.ta - b.ta).abs() < 1e-3 * side && (a.tb - b.tb).abs() < 1e-3 * side);
}

#[test]
fn the_view_may_turn_all_the_way_round() {
    let scene = Scene::builtin("stars").unwrap();
    let mut navigator = Navigator::new(&scene);
    let mut before = navigator.camera();
    for step in 0..800 {
        navigator.look(if step < 400 { 1.0 } else { 0.0 }, 1.0);
        let camera = navigator.camera();
        let view = |camera: &Camera| direction(camera.focus - camera.position);
        assert!(scene.clone().with_camera(camera).is_ok());
        assert!((view(&camera) - view(&before)).length() < 0.04, "{step}");
        assert!((camera.up - before.up).length() < 0.25, "{step}");
        before = camera;
    }
}

#[test]
fn the_field_of_view_stays_one_that_a_scene_may_have() {
    for (projection, fov, widest) in [
        (Projection::Perspective, 30.0, WIDEST_FOV),
        (Projection::Fisheye, 180.0, WIDEST_FISHEYE),
        (Projection::Equirectangular, 180.0, 180.0),
    ] {
        let scene = Scene::builtin("classic")
            .unwrap()
            .with_size(64, 32)
            .unwrap();
        let camera = Camera {
            projection,
            fov_degrees: fov,
            ..*scene.camera()
        };
        let scene = scene.with_camera(camera).unwrap();
        let mut navigator = Navigator::new(&scene);
        for factor in [0.5, 1.5] {
            for _ in 0..600 {
                navigator.scale_fov(factor);
            }
            assert!(scene.clone().with_camera(navigator.camera()).is_ok());
        }
        assert!((navigator.fov_degrees() - widest).abs() < 1e-9);
        assert_eq!(navigator.camera().position, scene.camera().position);
        navigator.turn(1.0, 1.0);
        assert_eq!(navigator.camera().projection, projection);
    }
}
