//! Guards against an outline that puts a pixel on the wrong side of an edge: whole frames against the same frames with
//! each pixel's own ray, over the built-in and random scenes.

use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::render::mask::{render, render_every_pixel};
use darkness::scene::{Scene, View, builtins};
use proptest::prelude::*;

use crate::tables::table;

fn frames(scene: &Scene) -> (Vec<u8>, Vec<u8>) {
    let view = View::new(scene);
    let spec = CurveSpec::new(scene, &view, scene.tolerance());
    let curves = Isoradials::new(&spec, &table("standard").lookup());
    (
        render(&view, &curves).unwrap(),
        render_every_pixel(&view, &curves).unwrap(),
    )
}

#[test]
fn built_in_scenes_equal_each_pixel_s_own_ray() {
    for builtin in builtins() {
        let scene = Scene::builtin(builtin.name()).unwrap();
        for (width, height) in [(641, 359), (67, 1), (1, 131)] {
            let (filled, single) = frames(&scene.clone().with_size(width, height).unwrap());
            assert!(filled == single, "{} at {width} × {height}", builtin.name());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_scenes_equal_each_pixel_s_own_ray(
        log_r in 0.01..6.0_f64,
        direction in (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64),
        // Half of the cameras in the disk's plane, where φ₁ jumps, or nearly so.
        flat in prop_oneof![Just(0.0), Just(1e-9), Just(1.0), Just(1.0)],
        aim in (-6.0..6.0_f64, -6.0..6.0_f64, -6.0..6.0_f64),
        fov_log in -3.0..2.2_f64,
        // From a thread to a plain.
        width_log in -6.0..2.5_f64,
        aimed in 0..4_u8,
    ) {
        let r = libm::exp(log_r);
        let (x, y, z) = (direction.0, direction.1, direction.2 * flat);
        let length = (x * x + y * y + z * z).sqrt();
        prop_assume!(length > 0.1);
        let place = |factor: f64| {
            let share = factor / length;
            format!("[{:e}, {:e}, {:e}]", share * x, share * y, share * z)
        };
        let focus = match aimed {
            0 => place(3.0 * r),
            // The photon ring's neighbourhood, through a lens of its own.
            1 => format!("[{}, {}, {}]", 2.6 * -y / length, 2.6 * x / length, 0.1 * aim.2),
            _ => format!("[{}, {}, {}]", aim.0, aim.1, aim.2),
        };
        let outer = 3.0 + libm::exp(width_log * core::f64::consts::LN_10);
        let text = format!(
            "[camera]\nposition = {}\nfocus = {focus}\nup = [0.1, 0.2, 1.0]\nfov = {}\n\
             [disk]\ninner = 3.0\nouter = {outer}\n\
             [image]\nwidth = 150\nheight = 90\n",
            place(r),
            libm::exp(fov_log * core::f64::consts::LN_10).min(170.0),
        );
        // What stands in the disk or looks nowhere is refused by the scene itself.
        if let Ok(scene) = Scene::from_toml(&text) {
            let (filled, single) = frames(&scene);
            let differing = filled.iter().zip(&single).filter(|(a, b)| a != b).count();
            prop_assert_eq!(differing, 0, "{}", text);
        }
    }
}

/// A scene's text, from what makes it hard.
fn text(position: &str, focus: &str, up: &str, fov: &str, disk: &str, size: &str) -> String {
    format!(
        "[camera]\nposition = [{position}]\nfocus = [{focus}]\nup = [{up}]\nfov = {fov}\n[disk]\n{disk}\n\
         [image]\n{size}\n"
    )
}

/// Guards against rows that are inverted from a place on: where several edges begin beyond the picture's left side,
/// where they pass one pixel's centre, and where every pixel's centre lies on an edge, in a picture of one row along
/// the disk's plane.
#[test]
fn rows_keep_their_side_of_every_edge() {
    for text in [
        text(
            "24.48935813699975, 46.27946028676325, 7.234710250976937",
            "2.8150780102783024, -1.3612042197242502, -0.14436863331693495",
            "0.01918616480680016, 0.14450695752495724, -0.9893177600280337",
            "1.2440618442160334",
            "inner = 3.0\nouter = 141.74515726581174",
            "width = 70\nheight = 72",
        ),
        text(
            "-92.6369736665973, -234.68434534553984, 5.060455971962888",
            "-0.07706849445611397, 0.03096705766736818, 0.026060974378149915",
            "0.767692361862926, 0.2, 1.0",
            "1.4757062891931167",
            "inner = 3.0\nouter = 9.870364443768901",
            "width = 92\nheight = 53",
        ),
        text(
            "24.667324332657957, 0.0, 8.665726654606678e-12",
            "0.0, 0.6270067332209188, 0.0",
            "0.0, 0.0, 1.0",
            "0.2685175514854031",
            "inner = 3.0\nouter = 5.468600319028125",
            "width = 117\nheight = 1",
        ),
    ] {
        let (filled, single) = frames(&Scene::from_toml(&text).unwrap());
        assert!(filled == single, "{text}");
    }
}

/// Guards against an outline without end: the camera stands on the disk's rim to the last digit, where the curve of the
/// rim is rounding.
#[test]
fn a_camera_on_the_rim_is_drawn_pixel_by_pixel() {
    let text = text(
        "30.710711600147206, 153.99060948604247, 2.2467977375584153e-13",
        "88.43259304855835, 86.54372327842007, -129.51971882691298",
        "0.45619631929321136, 0.2, 1.0",
        "140.40338372200674",
        "inner = 8.456930168537372\nouter = 157.02310535991273",
        "width = 35\nheight = 75",
    );
    let (filled, single) = frames(&Scene::from_toml(&text).unwrap());
    assert!(filled == single);
}
