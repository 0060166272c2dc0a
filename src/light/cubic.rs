//! Cubics in cells that the bits of a number tell.

/// Returns the coefficients, constant term first, of the cubic with these values at 0, 1/3, 2/3 and 1.
pub(super) fn through([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [
        a,
        -5.5 * a + 9.0 * b - 4.5 * c + d,
        9.0 * a - 22.5 * b + 18.0 * c - 4.5 * d,
        4.5 * (d - a) + 13.5 * (b - c),
    ]
}

/// Returns the cubic's value at `t`.
#[inline(always)]
pub(super) fn at([a, b, c, d]: [f32; 4], t: f32) -> f32 {
    a + t * (b + t * (c + t * d))
}

/// Returns the place in [0, 1) of a number with these `bits` within its cell, whose numbers differ in their `shift`
/// lowest bits only.
#[inline(always)]
pub(super) fn fraction(bits: u32, shift: u32) -> f32 {
    const MANTISSA: u32 = f32::MANTISSA_DIGITS - 1;
    let mantissa = (bits << (MANTISSA - shift)) & ((1 << MANTISSA) - 1);
    f32::from_bits(1.0_f32.to_bits() | mantissa) - 1.0
}
