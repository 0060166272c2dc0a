//! The colour of black bodies.
//!
//! CIE 1931 XYZ of Planck's radiance for the 2° standard observer,
//!
//! ```text
//! X(T) = 683 lm/W · Σ x̄(λ) 2hc²/λ⁵ / (exp(hc/λkT) − 1) Δλ,    λ = 360 nm to 830 nm by 1 nm
//! ```
//!
//! and likewise Y and Z, with the constants of CODATA 2018. The sums are not computed here. One curve holds them:
//! `ln(Y/T) + w/T`, with `w = hc/λk` of the longest wavelength, X/Y and Z/Y. These are smooth from the lowest
//! temperatures, where Y falls as exp(−w/T), to the highest, where Y grows as T (Rayleigh–Jeans). Over
//! `s = T/(T + 600 K)` each is a polynomial in each of 16 pieces, of which the last ends at infinite temperature.
//! `black_body_curve.py`, in the same folder, computes them from the colour matching functions of the Python package
//! `colour-science`.

use super::black_body_curve::{LOWEST, PIECES, SCALE, WIEN};

/// The start of the curve's axis.
const FIRST: f64 = LOWEST / (LOWEST + SCALE);

/// Returns X, Y and Z of a black body of `temperature` kelvin; Y is its luminance in cd/m².
///
/// Against the sums above the error is at most 1e-7 of Y, at every temperature. Below 50 K, where Y is less than 1e-140
/// cd/m², the result is zero.
pub fn xyz(temperature: f64) -> [f64; 3] {
    if temperature.is_nan() || temperature < LOWEST {
        return [0.0; 3];
    }
    let inverse = 1.0 / temperature;
    let s = 1.0 / (1.0 + SCALE * inverse);
    let place = (s - FIRST) * (PIECES.len() as f64 / (1.0 - FIRST));
    let index = (place as usize).min(PIECES.len() - 1);
    let x = 2.0 * (place - index as f64) - 1.0;
    let [logarithm, x_share, z_share] = PIECES[index].map(|polynomial| {
        let horner = |sum: f64, coefficient: &f64| sum * x + coefficient;
        polynomial.iter().rev().fold(0.0, horner)
    });
    let luminance = temperature * libm::exp(logarithm - WIEN * inverse);
    [luminance * x_share, luminance, luminance * z_share]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chromaticity([x, y, z]: [f64; 3]) -> [f64; 2] {
        [x / (x + y + z), y / (x + y + z)]
    }

    #[test]
    fn agrees_with_reference() {
        let text = include_str!("../../tests/reference/light/black_body.csv");
        let rows: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(rows.len(), 20);
        for row in rows {
            let row: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
            let found = xyz(row[0]);
            let [x, y] = chromaticity(found);
            // The reference has 8 digits, and 683.002 lm/W in place of 683.
            assert!(
                (x - row[1]).abs() < 3e-8 && (y - row[2]).abs() < 3e-8,
                "{row:?}: {x}, {y}"
            );
            assert!(
                (found[1] / row[3] * (683.002 / 683.0) - 1.0).abs() < 2e-7,
                "{row:?}"
            );
        }
    }

    #[test]
    fn is_continuous_and_grows() {
        let mut before = xyz(LOWEST);
        for i in 1..=200_000 {
            let temperature = LOWEST * libm::exp(f64::from(i) * 1e-4);
            let here = xyz(temperature);
            // The steepest is 50 K, as exp(−17335 K/T).
            assert!(
                here[1] > before[1] && here[1] < before[1] * 1.04,
                "{temperature} K"
            );
            let step = |i: usize| here[i] / here[1] - before[i] / before[1];
            assert!(
                step(0).abs() < 1e-3 && step(2).abs() < 1e-3,
                "{temperature} K"
            );
            before = here;
        }
    }

    #[test]
    fn ends_are_nothing_and_rayleigh_jeans() {
        for nothing in [f64::NAN, f64::NEG_INFINITY, -1.0, 0.0, 49.9] {
            assert_eq!(xyz(nothing), [0.0; 3]);
        }
        let [x, y, z] = xyz(LOWEST);
        assert!(y > 0.0 && x > 2.7 * y && z.abs() < 1e-8 * y);
        for (hot, hotter) in xyz(1e11).into_iter().zip(xyz(1e14)) {
            assert!((hotter / hot / 1e3 - 1.0).abs() < 2e-7);
        }
        assert!(
            xyz(f64::INFINITY)
                .iter()
                .all(|&value| value == f64::INFINITY)
        );
    }
}
