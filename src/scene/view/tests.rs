//! The view against a direct computation, in the cases where that one loses its digits against known angles, and
//! under changes of the whole scene that must change nothing.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3};
use proptest::prelude::*;

use super::*;

struct Setup {
    position: DVec3,
    focus: DVec3,
    up: DVec3,
    normal: DVec3,
    fov: f64,
}

impl Setup {
    fn scene(&self) -> Scene {
        let vector = |v: DVec3| format!("{:?}", v.to_array());
        Scene::from_toml(&format!(
            "[camera]\nposition = {}\nfocus = {}\nup = {}\nfov = {:?}\n\
             [disk]\ninner = 3.0\nouter = 12.0\nnormal = {}\n[image]\nwidth = 64\nheight = 36\n",
            vector(self.position),
            vector(self.focus),
            vector(self.up),
            self.fov,
            vector(self.normal),
        ))
        .unwrap()
    }

    fn view(&self) -> View {
        View::new(&self.scene())
    }

    fn turned(&self, by: DMat3) -> Self {
        Self {
            position: by * self.position,
            focus: by * self.focus,
            up: by * self.up,
            normal: by * self.normal,
            fov: self.fov,
        }
    }
}

fn rolled() -> Setup {
    Setup {
        position: DVec3::new(8.0, -6.0, 3.0),
        focus: DVec3::new(0.5, 0.5, -0.3),
        up: DVec3::new(0.3, 0.2, 1.0),
        normal: DVec3::new(0.2, -0.4, 1.0),
        fov: 70.0,
    }
}

/// Asserts that every pixel's ray is the one of the definition, computed without further thought.
fn assert_as_defined(setup: &Setup) {
    let view = setup.view();
    let p = setup.position.normalize();
    let n = setup.normal.normalize();
    let f = (setup.focus - setup.position).normalize();
    let right = f.cross(setup.up).normalize();
    let up = right.cross(f);
    let tangent = libm::tan(setup.fov * PI / 360.0);
    for j in 0..36 {
        for i in 0..64 {
            let x = (2.0 * (f64::from(i) + 0.5) / 64.0 - 1.0) * tangent * 64.0 / 36.0;
            let y = (1.0 - 2.0 * (f64::from(j) + 0.5) / 36.0) * tangent;
            let d = f + right * x + up * y;
            let z = -d.dot(p);
            let t = d + p * z;
            let ray = view.pixel(i, j);
            let s = ray.transverse();
            assert!((ray.z - z).abs() < 1e-14, "{ray:?} {z}");
            assert!((s - t.length()).abs() < 1e-14, "{ray:?} {t}");
            assert!(
                (view.n_a() * ray.ta - n.dot(t)).abs() < 1e-14,
                "{ray:?} {t}"
            );
            assert!(
                (view.n_a() * ray.tb - n.dot(t.cross(p))).abs() < 1e-14,
                "{ray:?} {t}"
            );

            let u0: f64 = 1.0 / setup.position.length();
            let slope = u0 * (1.0 - u0).sqrt() * z / t.length();
            assert!((view.dudphi(ray) - slope).abs() < 1e-13 * slope.abs().max(1.0));

            // At φ₁ the ray's plane is cut by the disk's: the unit vector of that angle is ⟂ n.
            let angle = view.plane_crossing(ray.ta, s);
            let there = p * libm::cos(angle) + t / t.length() * libm::sin(angle);
            assert!(
                (0.0..PI).contains(&angle) && there.dot(n).abs() < 1e-13,
                "{angle}"
            );
        }
    }
}

#[test]
fn ordinary_views_are_as_defined() {
    assert_as_defined(&rolled());
    assert_as_defined(&Setup {
        position: DVec3::new(29.5442, 0.0, 5.2094),
        focus: DVec3::ZERO,
        up: DVec3::Z,
        normal: DVec3::Z,
        fov: 30.0,
    });
    assert_as_defined(&Setup {
        normal: -rolled().normal,
        ..rolled()
    });
    // Looking out, the focus farther than the camera; and at a focus very near to it.
    assert_as_defined(&Setup {
        position: DVec3::new(1.3, 0.0, 0.25),
        focus: DVec3::new(3.0, 0.0, 0.4),
        ..rolled()
    });
    assert_as_defined(&Setup {
        focus: DVec3::new(8.0625, -6.125, 3.0625),
        ..rolled()
    });
}

#[test]
fn a_far_cameras_long_lens_keeps_its_digits() {
    // p̂ = (0.6, 0, 0.8), â = (−0.8, 0, 0.6), b̂ = (0, −1, 0); the focus is 2.08 from the line to the hole, along −â.
    let far = Setup {
        position: DVec3::new(0.6e12, 0.0, 0.8e12),
        focus: DVec3::new(2.6, 0.0, 0.0),
        up: DVec3::Z,
        normal: DVec3::Z,
        fov: 1e-10,
    };
    let view = far.view();
    let half_height = 1e-10 * PI / 360.0;
    let offset = -2.08 / (1e12 - 1.56);
    for (i, j) in [(0, 0), (63, 0), (31, 17), (5, 35)] {
        let ray = view.pixel(i, j);
        let ta = offset + half_height * (1.0 - (2.0 * f64::from(j) + 1.0) / 36.0);
        let tb = -half_height * (2.0 * f64::from(i) + 1.0 - 64.0) / 36.0;
        assert!(
            (ray.ta - ta).abs() < 1e-15 * half_height.max(ta.abs()),
            "{ray:?} {ta}"
        );
        assert!(
            (ray.tb - tb).abs() < 1e-15 * half_height.max(tb.abs()),
            "{ray:?} {tb}"
        );
        assert!((ray.z - 1.0).abs() < 4.0 * f64::EPSILON);
    }
    assert!((view.n_p() - 0.8).abs() < 1e-15 && (view.n_a() - 0.6).abs() < 1e-15);
    assert_eq!(view.u0(), 1e-12);
}

#[test]
fn a_far_camera_looking_sideways_sees_nothing_inward() {
    let view = Setup {
        position: DVec3::new(1e15, 0.0, 0.0),
        focus: DVec3::new(1e15, 1e300, 0.0),
        up: DVec3::Z,
        normal: DVec3::new(1e300, 0.0, 1e-300),
        fov: 1e-9,
    }
    .view();
    let centre = view.ray_at(0.0, 0.0);
    assert_eq!((centre.z.abs(), centre.transverse()), (0.0, 1.0));
    assert_eq!((view.n_p(), view.n_a()), (1.0, 0.0));
}

#[test]
fn a_symmetric_scene_has_exactly_symmetric_rays() {
    let view = View::new(&Scene::builtin("classic").unwrap());
    let (w, h) = (view.width(), view.height());
    for (i, j) in [(0, 0), (700, 3), (959, 539), (100, 1079)] {
        let (left, right) = (view.pixel(i, j), view.pixel(w - 1 - i, j));
        assert_eq!(
            left,
            PixelRay {
                tb: -right.tb,
                ..right
            }
        );
        assert_eq!(
            view.y_at(f64::from(j) + 0.5),
            -view.y_at(f64::from(h - 1 - j) + 0.5)
        );
    }
}

#[test]
fn a_camera_in_the_disks_plane_is_no_crossing() {
    let edge = Setup {
        position: DVec3::new(10.0, 20.0, 0.0),
        normal: DVec3::Z * 0.3,
        ..rolled()
    }
    .view();
    assert_eq!(edge.n_p(), 0.0);
    for ta in [-0.5, -0.0, 0.0, 0.3] {
        assert_eq!(edge.plane_crossing(ta, 0.5), 0.0);
    }
    let tilted = Setup {
        position: DVec3::new(14.0, 7.0, 0.1),
        normal: DVec3::new(-0.3, 0.6, 0.0),
        ..rolled()
    }
    .view();
    assert_eq!(tilted.n_p(), 0.0);
}

#[test]
fn the_first_crossing_is_never_pi() {
    for height in [1e-300, 1e-20, 1e-16, 1e-12] {
        for normal in [DVec3::Z, DVec3::NEG_Z] {
            let view = Setup {
                position: DVec3::new(20.0, 0.0, height),
                normal,
                ..rolled()
            }
            .view();
            let towards = if normal.z > 0.0 { 1.0 } else { -1.0 };
            let late = view.plane_crossing(towards, 1.0);
            assert!(late == 0.0 || (late > 3.0 && late < PI), "{late}");
            let soon = view.plane_crossing(-towards, 1.0);
            assert!(soon > 0.0 && soon < 1e-12, "{soon}");
        }
    }
}

#[test]
fn above_the_pole_every_crossing_is_a_quarter_turn_away() {
    let view = View::new(&Scene::builtin("face-on").unwrap());
    for (i, j) in [(0, 0), (17, 900), (539, 540)] {
        let ray = view.pixel(i, j);
        assert_eq!(view.plane_crossing(ray.ta, ray.transverse()), FRAC_PI_2);
    }
}

#[test]
fn near_the_pole_the_frame_stays_orthogonal() {
    for lean in [1e-15, 1e-12, 1e-8, 1e-4] {
        let view = Setup {
            normal: rolled().position + DVec3::new(lean, lean, -lean),
            ..rolled()
        }
        .view();
        let ray = view.pixel(3, 30);
        let length = view.x_at(3.5) * view.x_at(3.5) + view.y_at(30.5) * view.y_at(30.5) + 1.0;
        let sum = ray.z * ray.z + ray.ta * ray.ta + ray.tb * ray.tb;
        assert!((sum / length - 1.0).abs() < 1e-14, "{lean}: {sum} {length}");
    }
}

proptest! {
    #[test]
    fn turning_the_whole_scene_changes_no_ray(
        axis in (-1.0..1.0, -1.0..1.0, 0.1..1.0),
        angle in -3.0..3.0,
        far in 0.0..10.0,
        (i, j) in (0_u32..64, 0_u32..36),
    ) {
        let setup = Setup { position: rolled().position * libm::exp10(far), ..rolled() };
        let axis = DVec3::from(axis).normalize();
        let (here, there) = (setup.view(), setup.turned(DMat3::from_axis_angle(axis, angle)).view());
        let (a, b) = (here.pixel(i, j), there.pixel(i, j));
        prop_assert!((a.z - b.z).abs() < 1e-14, "{a:?} {b:?}");
        prop_assert!((a.ta - b.ta).abs() < 1e-14, "{a:?} {b:?}");
        prop_assert!((a.tb - b.tb).abs() < 1e-14, "{a:?} {b:?}");
        prop_assert!((here.u0() / there.u0() - 1.0).abs() < 1e-14);
        prop_assert!((here.n_p() - there.n_p()).abs() < 1e-14 && (here.n_a() - there.n_a()).abs() < 1e-14);
    }
}
