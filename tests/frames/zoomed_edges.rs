//! Guards against curves that claim to be right to a thousandth of a pixel and are not. Lenses of 1° to 1e-4° look at
//! an edge of the disk; it is located by the curves of each table and by exact rays.

use darkness::scene::{DEFAULT_TOLERANCE, Scene, View};
use glam::DVec3;

use crate::methods::{SeenByCurves, sees_disk};
use crate::tables::table;

const SIDE: u32 = 64;

const MIDDLE: f64 = 0.5 * SIDE as f64;

fn scene(position: DVec3, focus: DVec3, fov: f64) -> Scene {
    let vector = |v: DVec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    let text = format!(
        "[camera]\nposition = {}\nfocus = {}\nfov = {fov:?}\n[disk]\ninner = 3\nouter = 12\n\
         [image]\nwidth = {SIDE}\nheight = {SIDE}\n",
        vector(position),
        vector(focus)
    );
    Scene::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Returns where on a line the answer changes between two places, to `resolution`, or `None` if it is the same at both.
fn change(sees: impl Fn(f64) -> bool, (from, to): (f64, f64), resolution: f64) -> Option<f64> {
    let (mut low, mut high) = (from, to);
    let first = sees(low);
    if sees(high) == first {
        return None;
    }
    while high - low > resolution {
        let middle = 0.5 * (low + high);
        if sees(middle) == first {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

/// Cameras, each with a focus that lies on an edge of an image of the disk.
fn views() -> Vec<(DVec3, DVec3)> {
    let mut views = Vec::new();
    for k in 0..24 {
        let k = f64::from(k);
        let radius = [30.0, 7.0, 100.0, 2.0, 1.4, 1000.0][k as usize % 6];
        let position = DVec3::new(0.97 - 0.03 * k, 0.1, 0.2 + 0.03 * k).normalize() * radius;
        let (sin, cos) = libm::sincos(0.7 * k);
        let line = DVec3::new(cos, sin, 0.6 * sin * cos);
        let sees = |t: f64| {
            let scene = scene(position, line * t, 1.0);
            sees_disk(&scene, &View::new(&scene), MIDDLE, MIDDLE)
        };
        let edge = (10..200)
            .map(|i| 0.1 * f64::from(i))
            .find_map(|t| change(sees, (t, t + 0.1), 1e-14));
        views.extend(edge.map(|t| (position, line * t)));
    }
    views
}

#[test]
fn curves_that_claim_the_tolerance_are_right_to_a_thousandth_of_a_pixel() {
    let views = views();
    assert!(views.len() >= 18, "{} views", views.len());
    // The longest lens for which the curves of a table must do: a pixel is then more than a hundred times the angle
    // that the table may be off by.
    for (name, longest) in [("draft", 0.5), ("standard", 1e-3), ("fine", 1e-4)] {
        let (mut worst, mut located) = (0.0_f64, 0);
        for step in 0..=16 {
            let fov = libm::pow(10.0, -0.25 * f64::from(step));
            for &(position, focus) in &views {
                // Far cameras get longer lenses, so that the hole is as large in the picture.
                let scene = scene(position, focus, fov * (30.0 / position.length()).min(1.0));
                let view = View::new(&scene);
                let curves = SeenByCurves::new(&scene, &table(name).lookup());
                if !curves.reach() {
                    // The table's own error, on the curve that moves most.
                    assert!(
                        fov < 10.0 * longest,
                        "{name}, {focus} from {position}, {fov}°"
                    );
                    continue;
                }
                // How far apart both edges are across: the least of eight directions.
                let mut apart = f64::INFINITY;
                for i in 0..8 {
                    let (sin, cos) = libm::sincos(f64::from(i) * core::f64::consts::FRAC_PI_8);
                    let place = |t: f64| (MIDDLE + cos * t, MIDDLE + sin * t);
                    let span = (-8.0, 8.0);
                    let exact = change(
                        |t| sees_disk(&scene, &view, place(t).0, place(t).1),
                        span,
                        1e-7,
                    );
                    let found = change(|t| curves.see(place(t).0, place(t).1), span, 1e-7);
                    if let (Some(exact), Some(found)) = (exact, found) {
                        apart = apart.min((exact - found).abs());
                    }
                }
                if apart.is_finite() {
                    assert!(
                        apart <= DEFAULT_TOLERANCE,
                        "{name}, {focus} from {position}, {fov}°: {apart} pixels apart"
                    );
                    worst = worst.max(apart);
                    located += 1;
                }
            }
        }
        println!("{name}: {located} edges, {worst:e} pixels apart at most");
        assert!(located >= 60, "{name}: {located}");
    }
}
