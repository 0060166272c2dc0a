//! Lengths and directions without overflow and underflow.
//!
//! A direction may have any length, so the squares in its norm may leave the range of f64. Each vector is first divided
//! by a power of two near its largest component. This is exact: a dot or cross product of scaled vectors is zero
//! exactly where that of the given vectors is.

use glam::DVec3;

/// The bits of an f64's exponent.
const EXPONENT_BITS: u64 = 0x7ff0_0000_0000_0000;

/// `(v / scale, scale)`, `scale` the power of two that brings the largest component into [1, 2) (below 1 where that
/// component is subnormal).
pub(super) fn scaled(v: DVec3) -> (DVec3, f64) {
    // Clearing the mantissa leaves the power of two, or 0 for a subnormal.
    let scale =
        f64::from_bits(v.abs().max_element().to_bits() & EXPONENT_BITS).max(f64::MIN_POSITIVE);
    (v / scale, scale)
}

/// The length |v|; infinite only where it is beyond the range of f64.
pub(super) fn norm(v: DVec3) -> f64 {
    let (v, scale) = scaled(v);
    v.length() * scale
}

/// v / |v|; the zero vector stays zero.
pub(super) fn direction(v: DVec3) -> DVec3 {
    if v == DVec3::ZERO {
        return v;
    }
    let (v, _) = scaled(v);
    // A division, since multiplying by a rounded reciprocal would round twice.
    v / v.length()
}

/// The cosine of the angle between two vectors that are not zero; exactly 0 where the dot product of the given
/// components is.
pub(super) fn cosine(v: DVec3, w: DVec3) -> f64 {
    let (v, _) = scaled(v);
    let (w, _) = scaled(w);
    v.dot(w) / (v.length() * w.length())
}

/// The cross product of the directions of two vectors that are not zero; exactly 0 where that of the given components
/// is.
pub(super) fn unit_cross(v: DVec3, w: DVec3) -> DVec3 {
    let (v, _) = scaled(v);
    let (w, _) = scaled(w);
    v.cross(w) / (v.length() * w.length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_at_the_ends_of_the_range() {
        assert_eq!(norm(DVec3::new(3e-310, 4e-310, 0.0)), 5e-310);
        assert_eq!(norm(DVec3::new(0.0, -3e307, 4e307)), 5e307);
        assert_eq!(norm(DVec3::new(5e-324, 0.0, 0.0)), 5e-324);
        assert_eq!(norm(DVec3::ZERO), 0.0);
        assert_eq!(norm(DVec3::splat(f64::MAX)), f64::INFINITY);
    }

    #[test]
    fn directions_at_the_ends_of_the_range() {
        for size in [5e-324, 1e-300, 1.0, 1e300, f64::MAX] {
            assert_eq!(direction(DVec3::new(0.0, -size, 0.0)), DVec3::NEG_Y);
            let diagonal = direction(DVec3::splat(size));
            assert!(
                (diagonal.length() - 1.0).abs() < 4.0 * f64::EPSILON,
                "{diagonal}"
            );
        }
        assert_eq!(direction(DVec3::ZERO), DVec3::ZERO);
    }

    #[test]
    fn right_and_straight_angles_are_exact() {
        let v = DVec3::new(0.1, 0.7, 0.3);
        assert_eq!(cosine(v * 1024.0, DVec3::new(0.7, -0.1, 0.0)), 0.0);
        assert_eq!(unit_cross(v, v * 0.25), DVec3::ZERO);
        assert_eq!(unit_cross(DVec3::X * 1e300, DVec3::Y * 1e-300), DVec3::Z);
    }
}
