use super::*;
use crate::orbit::exact::Exact;
use crate::scene::{Camera, ImageSize, Sky};

/// The derivative at 0, by Richardson's extrapolation of central differences.
fn derivative(step: f64, at: impl Fn(f64) -> DVec3) -> DVec3 {
    let slope = |step: f64| (at(step) - at(-step)) / (2.0 * step);
    let [a, b, c] = [step, 0.5 * step, 0.25 * step].map(slope);
    let (ab, bc) = ((4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0);
    (16.0 * bc - ab) / 15.0
}

#[test]
fn footprints_are_differences_of_directions() {
    for radius in [1e6, 30.0, 3.0, 1.5, 1.2, 1.01, 1.0001] {
        let position = DVec3::new(0.62, -0.53, 0.41).normalize() * radius;
        let mut of_all = 0.0_f64;
        for (focus, fov) in [
            (DVec3::ZERO, 4.0 * 150.0 / (radius + 4.0)),
            (DVec3::ZERO, 20.0 / radius),
            (position * 2.0, 90.0),
            (position * 2.0, 1e-3),
            (position + position.any_orthonormal_vector() * radius, 60.0),
        ] {
            let camera = Camera {
                focus,
                up: DVec3::new(0.3, 0.2, 1.0),
                ..Camera::at(position, fov)
            };
            let sky = Sky {
                rotation: [10.0, 20.0, 30.0],
                ..Sky::default()
            };
            let size = ImageSize {
                width: 96,
                height: 54,
            };
            let scene = Scene::without_disk(camera, sky, size).unwrap();
            let view = View::new(&scene);
            let curve = EscapeCurve::new(view.u0(), view.slope_scale(), &Exact);
            let shader = SkyShader::new(&view, &curve, &scene);
            for i in 0..96 * 54 {
                // The picture's centre, straight to the hole or away from it, is among them.
                let (x, y) = (f64::from(i % 96), f64::from(i / 96));
                let Some(sight) = shader.at((x, y)) else {
                    continue;
                };
                let swept = shader.swept_per_pixel(&sight);
                if swept > 1.0 {
                    continue;
                }
                // Far from the shadow directions change slowly, and over a short way by not much more than rounding.
                let scale = (0.1 / swept).clamp(0.1, 2.0);
                let found = shader.footprint(&sight);
                let at = |place| shader.at(place).map_or(DVec3::NAN, |sight| sight.direction);
                let along_x = derivative(scale, |h| at((x + h, y)));
                let along_y = derivative(scale, |h| at((x, y + h)));
                let size = along_x.length().max(along_y.length());
                let off = (found.along_x - along_x)
                    .length()
                    .max((found.along_y - along_y).length());
                // Directions are rounded.
                let off = (off - 4.0 * f64::EPSILON / scale) / size;
                assert!(off < 1e-6, "r = {radius}, fov {fov}, {x} {y}: {off}");
                of_all = of_all.max(off);
            }
        }
        println!("r = {radius}: {of_all:.1e}");
    }
}
