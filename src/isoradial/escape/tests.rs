use core::f64::consts::PI;

use super::*;
use crate::orbit::exact::Exact;

fn slope_scale(radius: f64) -> f64 {
    (1.0 / radius) * ((radius - 1.0) / radius).sqrt()
}

/// Cameras far away, near, on and inside the photon sphere, at the horizon.
const RADII: [f64; 8] = [1e15, 1e6, 30.0, 3.0, 1.5, 1.3, 1.01, 1.0001];

/// Rays from next to the critical ray to straight away from the hole: ψ, as cosine and sine.
fn rays(curve: &EscapeCurve) -> Vec<(f64, f64)> {
    let critical = libm::atan2(1.0, curve.critical());
    let longest = PI - critical;
    let mut rays = Vec::new();
    for i in 1..400 {
        let delta = longest * libm::exp2(-0.1 * f64::from(i));
        for psi in [critical + delta, PI - 0.37 * delta] {
            rays.push((libm::cos(psi), libm::sin(psi)));
        }
    }
    rays
}

#[test]
fn the_curve_is_the_methods_angles() {
    for radius in RADII {
        let (u0, scale) = (1.0 / radius, slope_scale(radius));
        let curve = EscapeCurve::new(u0, scale, &Exact);
        let (mut worst, mut count) = (0.0_f64, 0);
        for (z, s) in rays(&curve) {
            let Some(found) = curve.at(z, s) else {
                continue;
            };
            let excess = scale * (z / s - curve.critical());
            let w = scale * z / s;
            let delta = excess * (2.0 * scale * curve.critical() + excess);
            let truth = Exact.to_end(&Orbit::with_delta(u0, w, delta));
            // A ray is known to the rounding of z and s: this far apart are the angles of two neighbours.
            let rounding = 8.0 * f64::EPSILON * found.rate;
            let off = (found.angle - truth).abs() - rounding;
            worst = worst.max(off);
            count += 1;
        }
        println!("r = {radius}: {worst:e} of {count}");
        assert!(
            count > 500 && worst < EscapeCurve::INTERPOLATION_ERROR,
            "r = {radius}: {worst:e} of {count}"
        );
    }
}

#[test]
fn the_rate_is_the_differences_of_angles() {
    for radius in RADII {
        let curve = EscapeCurve::new(1.0 / radius, slope_scale(radius), &Exact);
        let critical = libm::atan2(1.0, curve.critical());
        let at = |psi: f64| curve.at(libm::cos(psi), libm::sin(psi)).unwrap();
        let mut worst = 0.0_f64;
        for i in 0..30 {
            let delta = (PI - critical) * libm::exp2(-0.9 * f64::from(i) - 0.05);
            // Richardson's extrapolation of central differences.
            let step = 0.02 * delta.min(PI - critical - delta);
            let psi = critical + delta;
            let slope = |step: f64| (at(psi - step).angle - at(psi + step).angle) / (2.0 * step);
            let truth = (4.0 * slope(0.5 * step) - slope(step)) / 3.0;
            let rounding = 8.0 * f64::EPSILON * psi.max(at(psi).angle / truth) / step;
            worst = worst.max((at(psi).rate / truth - 1.0).abs() - rounding);
        }
        println!("r = {radius}: {worst:e}");
        assert!(worst < 1e-7, "r = {radius}: {worst:e}");
    }
}

#[test]
fn images_are_the_rays_of_their_angles() {
    for radius in RADII {
        let curve = EscapeCurve::new(1.0 / radius, slope_scale(radius), &Exact);
        let (mut worst, mut worst_rate) = (0.0_f64, 0.0_f64);
        for i in 1..2000 {
            let angle = 0.02 * f64::from(i);
            let image = curve.image(angle);
            let Some(found) = curve.at(image.cosine, image.sine) else {
                // The last rays are not told apart from the critical one by a direction's rounding.
                assert!(angle > 25.0, "{angle}");
                continue;
            };
            let rounding = 4.0 * f64::EPSILON * found.rate;
            if rounding > 1e-3 {
                continue;
            }
            worst = worst.max((found.angle - angle).abs() - rounding);
            worst_rate = worst_rate.max((image.rate / found.rate - 1.0).abs() - rounding);
            assert!((image.cosine * image.cosine + image.sine * image.sine - 1.0).abs() < 1e-14);
        }
        println!("r = {radius}: {worst:e} {worst_rate:e}");
        assert!(
            worst < 1e-10 && worst_rate < 1e-8,
            "r = {radius}: {worst:e} {worst_rate:e}"
        );
    }
}
