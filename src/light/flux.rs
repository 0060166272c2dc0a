//! The flux of a thin disk around a Schwarzschild hole, with no torque at the innermost stable orbit.
//!
//! Page & Thorne, *Disk-accretion onto a black hole. I*, Astrophysical Journal 191, 499 (1974), equations (11b) and
//! (15n) for a hole without spin. With R = 2r, the radius in units of GM/c²,
//!
//! ```text
//! F(R) = 3/(8π) Ṁ/M² · B(R) / (R^(5/2) (R − 3)),    B(R) = ∫ (σ² − 6)/(σ² − 3) dσ   from √6 to √R
//! ```
//!
//! The closed form of B subtracts a logarithm from √R − √6 and loses all digits at R = 6, where B has a double zero.
//! It is rewritten here. The logarithm is an inverse hyperbolic tangent, and with `v = √(u/2) = 1/√R`
//!
//! ```text
//! w = (1 − 3u) / ((1 + √6 v)(√2 − √3 v))
//! B = w² (2/v − √6 − √3 w q(w)),    q(w) = (artanh w − w)/w³
//! ```
//!
//! `w` is 0 at R = 6, grows to 1/√2 far out and falls to −1 at R = 3. The bracket is free of cancellation, and
//! `1 − 3u` is exact near u = 1/3, so that the square root of F is known to the last digits on both sides of R = 6.

/// The radius at which the flux is greatest, in Schwarzschild radii.
pub const PEAK_RADIUS: f64 = 4.775_464_038_971_934_8;

/// The greatest flux, in units of Ṁ/M² with G = c = 1.
pub const PEAK_FLUX: f64 = 1.367_811_081_982_986_5e-5;

/// `B / (R^(5/2) (R − 3))` at the peak: [`PEAK_FLUX`] without its factor 3/(8π).
const PEAK: f64 = 1.145_894_732_441_721_8e-4;

const SQRT_3: f64 = 1.732_050_807_568_877_3;
const SQRT_6: f64 = 2.449_489_742_783_178;

/// Returns `F/F_max` at the inverse radius `u`, in inverse Schwarzschild radii, `0 ≤ u ≤ 1/3`.
///
/// The relative error is at most 1e-14 (against 80 digits, R from 6(1 + 1e-9) to 1e9).
pub fn relative(u: f64) -> f64 {
    let root = signed_root(u);
    root * root
}

/// Returns `√(F/F_max)` with the sign of `1 − 3u`, for `0 ≤ u < 2/3`.
///
/// It is analytic through the innermost stable orbit, u = 1/3, where it changes its sign, so that it can be
/// interpolated across that orbit. The relative error is at most 5e-15.
pub fn signed_root(u: f64) -> f64 {
    let v = (0.5 * u).sqrt();
    // Both subtractions are exact from u = 1/4 to 2/5.
    let from_isco = (1.0 - 2.0 * u) - u;
    let w = from_isco / ((1.0 + SQRT_6 * v) * (core::f64::consts::SQRT_2 - SQRT_3 * v));
    let bracket = 2.0 - v * (SQRT_6 + SQRT_3 * w * artanh_remainder(w));
    w * (0.5 * u) * v * (bracket / ((1.0 - 1.5 * u) * PEAK)).sqrt()
}

/// Returns `(artanh w − w)/w³`, for `|w| < 1`.
///
/// Where the closed form cancels, the series Σ w^(2k)/(2k + 3), DLMF 4.38.5: its first term left out is below 1e-17.
fn artanh_remainder(w: f64) -> f64 {
    let z = w * w;
    if z < 1.0 / 64.0 {
        let series = |sum: f64, k: u32| sum * z + 1.0 / f64::from(2 * k + 3);
        (0..9).rev().fold(0.0, series)
    } else {
        (libm::atanh(w) - w) / (z * w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five-point Gauss–Legendre quadrature over `parts` equal parts of `from` to `to`.
    fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64, parts: u32) -> f64 {
        const NODES: [(f64, f64); 3] = [
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let half = 0.5 * (to - from) / f64::from(parts);
        let part = |i: u32| {
            let middle = from + half * f64::from(2 * i + 1);
            let pair = |x: f64| f(middle - half * x) + f(middle + half * x);
            half * (NODES[0].1 * f(middle)
                + NODES[1].1 * pair(NODES[1].0)
                + NODES[2].1 * pair(NODES[2].0))
        };
        (0..parts).map(part).sum()
    }

    #[test]
    fn all_energy_that_matter_loses_is_radiated() {
        // ∫ 4πR F E dR over R = 6 to ∞ is 1 − E(6), in v = 1/√R.
        let luminosity = |v: f64| {
            let r = 1.0 / (v * v);
            let energy = (1.0 - 2.0 / r) / (1.0 - 3.0 / r).sqrt();
            let flux = PEAK_FLUX * relative(2.0 * v * v);
            4.0 * core::f64::consts::PI * r * flux * energy * 2.0 / (v * v * v)
        };
        let radiated = integral(luminosity, 0.0, 1.0 / 6.0_f64.sqrt(), 64);
        let lost = 1.0 - (8.0_f64 / 9.0).sqrt();
        assert!((radiated - lost).abs() < 1e-14, "{radiated} ≠ {lost}");
    }

    #[test]
    fn agrees_with_values_of_many_digits() {
        let text = include_str!("../../tests/reference/light/flux.csv");
        let mut worst = [0.0_f64; 2];
        for line in text.lines().skip(2) {
            let row: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
            for (worst, (found, expected)) in worst
                .iter_mut()
                .zip([(relative(row[0]), row[1]), (signed_root(row[0]), row[2])])
            {
                *worst = worst.max((found / expected - 1.0).abs());
            }
        }
        assert!(worst[0] < 1e-14 && worst[1] < 5e-15, "{worst:?}");
    }

    #[test]
    fn is_greatest_at_the_peak() {
        let peak = 1.0 / PEAK_RADIUS;
        assert!((relative(peak) - 1.0).abs() < 1e-15);
        for beside in [peak * (1.0 - 1e-6), peak * (1.0 + 1e-6)] {
            assert!(relative(beside) < relative(peak));
        }
    }

    #[test]
    fn ends_are_finite() {
        assert_eq!(signed_root(0.0), 0.0);
        assert_eq!(signed_root(1e-300), 0.0);
        assert!(signed_root(0.6).is_finite() && signed_root(0.6) < 0.0);
        assert!(signed_root(1.0 / 3.0).abs() < 1e-15);
    }
}
