//! Linear Rec. 709: the primaries and the white of sRGB and of high-definition video.
//!
//! Recommendation ITU-R BT.709-6, section 1: red (0.64, 0.33), green (0.30, 0.60), blue (0.15, 0.06), white D65
//! (0.3127, 0.3290). The matrices follow from these eight numbers by SMPTE RP 177-1993 and are not rounded to the four
//! digits that some standards print.

/// From X, Y, Z to red, green, blue.
const FROM_XYZ: [[f64; 3]; 3] = [
    [
        3.240_969_941_904_521_3,
        -1.537_383_177_570_093_5,
        -0.498_610_760_293_003_3,
    ],
    [
        -0.969_243_636_280_879_8,
        1.875_967_501_507_720_7,
        0.041_555_057_407_175_61,
    ],
    [
        0.055_630_079_696_993_61,
        -0.203_976_958_888_976_57,
        1.056_971_514_242_878_6,
    ],
];

/// The luminance of red, green and blue.
const LUMINANCE: [f64; 3] = [
    0.212_639_005_871_510_36,
    0.715_168_678_767_755_9,
    0.072_192_315_360_733_71,
];

/// Returns linear red, green and blue of the CIE 1931 tristimulus values `xyz`. What lies outside the gamut has
/// negative components; nothing is clipped.
pub fn linear_rgb(xyz: [f64; 3]) -> [f64; 3] {
    FROM_XYZ.map(|row| dot(row, xyz))
}

/// Returns the luminance Y of linear red, green and blue.
pub fn luminance(rgb: [f64; 3]) -> f64 {
    dot(LUMINANCE, rgb)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(found: [f64; 3], expected: [f64; 3]) {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{found} ≠ {expected}");
        }
    }

    #[test]
    fn white_and_primaries_are_those_of_the_standard() {
        let xyz = |x: f64, y: f64| [x / y, 1.0, (1.0 - x - y) / y];
        assert_close(linear_rgb(xyz(0.3127, 0.3290)), [1.0; 3]);
        for (i, (x, y)) in [(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)]
            .into_iter()
            .enumerate()
        {
            let mut primary = [0.0; 3];
            primary[i] = 1.0;
            assert_close(linear_rgb(xyz(x, y).map(|v| v * LUMINANCE[i])), primary);
        }
    }

    #[test]
    fn luminance_is_y() {
        for xyz in [[0.3, 0.5, 0.2], [1.0, 0.1, 0.0], [0.2, 0.4, 0.9]] {
            assert!((luminance(linear_rgb(xyz)) - xyz[1]).abs() < 1e-15);
        }
    }
}
