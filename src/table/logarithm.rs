//! The logarithm of a ratio, at the cost of one division.

/// Returns `ln(a/b)` for positive, normal a and b: `k ln 2 + 2 artanh(σ)`, `σ = (a − 2ᵏb)/(a + 2ᵏb)`, with the k that
/// brings `a/(2ᵏb)` between √½ and √2, so that `|σ| ≤ 0.1716` (DLMF 4.6.4, 4.37.24). The error is below 2 ε times the
/// larger of 1 and the result. For b = 0 the result is that of the smallest normal number.
#[inline(always)]
pub(crate) fn ln_ratio(a: f64, b: f64) -> f64 {
    // artanh σ / σ = 1 + z (1/3 + z/5 + z²/7 + …), z = σ² ≤ 0.02944. These are the coefficients of the best polynomial
    // of degree 6 for the bracket. Its error is 1.6e-16, which times z is below 5e-18.
    const C: [f64; 7] = [
        0.333_333_333_333_333_5,
        0.199_999_999_999_497_22,
        0.142_857_143_130_016_34,
        0.111_111_055_651_299_39,
        0.090_914_447_278_374_73,
        0.076_658_553_091_053_86,
        0.073_082_927_124_443_11,
    ];
    const MANTISSA: u64 = (1 << 52) - 1;
    const ONE: u64 = 1023 << 52;
    let (bits_a, bits_b) = (a.to_bits(), b.to_bits());
    let m_a = f64::from_bits(bits_a & MANTISSA | ONE);
    let m_b = f64::from_bits(bits_b & MANTISSA | ONE);
    let k = (bits_a >> 52) as i32 - (bits_b >> 52) as i32;
    // Both mantissas are in [1, 2), so that at most one doubling of the smaller is needed.
    let (too_large, too_small) = (
        m_a > core::f64::consts::SQRT_2 * m_b,
        m_b > core::f64::consts::SQRT_2 * m_a,
    );
    let p = if too_small { 2.0 * m_a } else { m_a };
    let q = if too_large { 2.0 * m_b } else { m_b };
    let k = k + i32::from(too_large) - i32::from(too_small);
    let sigma = (p - q) / (p + q);
    let z = sigma * sigma;
    let z2 = z * z;
    let z4 = z2 * z2;
    // Estrin's scheme: short chains.
    let low = (C[0] + C[1] * z) + (C[2] + C[3] * z) * z2;
    let tail = low + ((C[4] + C[5] * z) + C[6] * z2) * z4;
    f64::from(k) * core::f64::consts::LN_2 + 2.0 * (sigma + sigma * z * tail)
}

#[cfg(test)]
mod tests {
    use super::ln_ratio;

    #[test]
    fn agrees_with_the_logarithm() {
        let mut a = 1e-40;
        while a < 1e40 {
            for b in [1e-33, 0.3, 1.0, 1.41, 1.999_999, 2.0, 77.7] {
                let truth = libm::log(a) - libm::log(b);
                let got = ln_ratio(a, b);
                // The roundings of the two logarithms of libm, of this one, and of the difference.
                let allowed = 4.0
                    * f64::EPSILON
                    * truth
                        .abs()
                        .max(libm::log(a).abs())
                        .max(libm::log(b).abs())
                        .max(1.0);
                assert!(
                    (got - truth).abs() <= allowed,
                    "ln({a:e}/{b:e}) = {got}, not {truth}"
                );
            }
            a *= 1.0371;
        }
    }

    /// Near one the difference of the arguments is exact, so that the result keeps its digits.
    #[test]
    fn small_logarithms() {
        for k in 1..50 {
            let d = f64::from(k) * f64::EPSILON;
            assert!((ln_ratio(1.0 + d, 1.0) / d - 1.0).abs() < 1e-13);
        }
        assert_eq!(ln_ratio(0.7, 0.7), 0.0);
        assert!(ln_ratio(1.0, 0.0) > 700.0);
    }
}
