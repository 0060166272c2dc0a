//! The sRGB transfer function, IEC 61966-2-1:1999, section 5.2, equations (5) and (6).

/// At most this much linear light is encoded in proportion to itself.
const LINEAR_UP_TO: f64 = 0.0031308;
/// The sRGB value up to which linear light is in proportion.
const LINEAR_CODES_UP_TO: f64 = 0.04045;

/// Returns the sRGB value of linear light `c`; both are in [0, 1], and what lies outside is clipped. NaN gives 0.
///
/// `12.92 c` up to 0.0031308, then `1.055 c^(1/2.4) − 0.055`.
pub fn encode(c: f64) -> f64 {
    if c > LINEAR_UP_TO {
        power_law(c.min(1.0))
    } else {
        12.92 * c.max(0.0)
    }
}

/// Returns the linear light of an sRGB value, as [`encode`] does the reverse; what lies outside [0, 1] is clipped.
pub fn decode(value: f64) -> f64 {
    if value > LINEAR_CODES_UP_TO {
        libm::pow((value.min(1.0) + 0.055) / 1.055, 2.4)
    } else {
        value.max(0.0) / 12.92
    }
}

fn power_law(c: f64) -> f64 {
    1.055 * libm::pow(c, 1.0 / 2.4) - 0.055
}

/// [`encode`] as a table, the same on every machine.
///
/// The power law is a cubic in each eighth of an octave. Its error is less than 1e-6: 0.0003 codes of 8 bits, 0.05
/// codes of 16 bits.
#[derive(Debug, Clone)]
pub struct SrgbEncoder {
    /// Polynomials in the cell's fraction, constant term first.
    cells: [[f32; 4]; Self::CELLS],
    /// For each cell of codes, the 8-bit code at its start.
    codes: [u8; Self::CODE_CELLS],
    /// The least light of the code after each 8-bit code.
    thresholds: [f32; 256],
}

impl SrgbEncoder {
    /// A power of two, so that a mask keeps the index within the array; 9 octaves of 8 cells are used.
    const CELLS: usize = 128;
    /// The bits of a number that tell its cell: those of its exponent and three of its mantissa.
    const SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - 3;
    /// The start of the first cell, below the end of the linear part.
    const FIRST: f32 = 1.0 / 512.0;
    /// The greatest number below 1.
    const LAST: f32 = 1.0 - f32::EPSILON / 2.0;

    /// The bits of a number that tell its cell of codes: no cell has more than two codes.
    const CODE_SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - 7;
    /// The bits of the start of the first cell of codes, 2⁻¹³: code 0 up to there.
    const FIRST_CODE: u32 = (127 - 13) << (f32::MANTISSA_DIGITS - 1);
    /// A power of two, as above; 13 octaves of 128 cells and one more are used.
    const CODE_CELLS: usize = 2048;

    /// Computes the cells: 289 powers, and 255 for the codes of 8 bits.
    pub fn new() -> Self {
        let first = Self::FIRST.to_bits() >> Self::SHIFT;
        let last = Self::LAST.to_bits() >> Self::SHIFT;
        let mut cells = [[0.0; 4]; Self::CELLS];
        for (cell, place) in cells.iter_mut().zip(first..=last) {
            let start = f64::from(f32::from_bits(place << Self::SHIFT));
            let end = f64::from(f32::from_bits((place + 1) << Self::SHIFT));
            let values = [0.0, 1.0, 2.0, 3.0].map(|i| power_law(start + (end - start) * i / 3.0));
            *cell = super::cubic::through(values).map(|c| c as f32);
        }
        // Code n + 1 begins at n + ½.
        let mut thresholds = [f32::INFINITY; 256];
        for (code, threshold) in thresholds[..255].iter_mut().enumerate() {
            *threshold = decode((code as f64 + 0.5) / 255.0) as f32;
        }
        let mut codes = [0; Self::CODE_CELLS];
        for (code, place) in codes.iter_mut().zip(Self::FIRST_CODE >> Self::CODE_SHIFT..) {
            let start = f32::from_bits(place << Self::CODE_SHIFT);
            *code = thresholds.partition_point(|&next| next <= start).min(255) as u8;
        }
        Self {
            cells,
            codes,
            thresholds,
        }
    }

    /// Returns the nearest 8-bit code of linear light `c`, clipped to 0 and 1; 0 for NaN.
    #[inline(always)]
    pub fn code8(&self, c: f32) -> u8 {
        let c = if c > 0.0 { c } else { 0.0 };
        self.code8_of_bits(if c < 1.0 { c } else { 1.0 }.to_bits())
    }

    /// Returns [`Self::code8`] of the number from 0 to 1 that has these bits.
    #[inline(always)]
    pub(super) fn code8_of_bits(&self, bits: u32) -> u8 {
        let bits = bits.max(Self::FIRST_CODE);
        let cell = (bits >> Self::CODE_SHIFT) - (Self::FIRST_CODE >> Self::CODE_SHIFT);
        let code = self.codes[cell as usize & (Self::CODE_CELLS - 1)];
        code + u8::from(f32::from_bits(bits) >= self.thresholds[usize::from(code)])
    }

    /// Returns the sRGB value of linear light `c`, as [`encode`] does, up to 1e-6.
    #[inline(always)]
    pub fn encode(&self, c: f32) -> f32 {
        if c > LINEAR_UP_TO as f32 {
            let bits = c.min(Self::LAST).to_bits();
            let place = (bits >> Self::SHIFT) - (Self::FIRST.to_bits() >> Self::SHIFT);
            let cell = self.cells[place as usize & (Self::CELLS - 1)];
            super::cubic::at(cell, super::cubic::fraction(bits, Self::SHIFT))
        } else {
            12.92 * c.max(0.0)
        }
    }
}

impl Default for SrgbEncoder {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_values() {
        for (linear, encoded) in [
            (0.0, 0.0),
            (0.001, 0.01292),
            (1.0, 1.0),
            (2.0, 1.0),
            (-1.0, 0.0),
        ] {
            assert!((encode(linear) - encoded).abs() < 1e-15);
        }
        // A linear value of 0.2140 is the middle grey of sRGB.
        assert!((encode(0.214041140482) - 0.5).abs() < 1e-10);
        assert_eq!(encode(f64::NAN), 0.0);
    }

    #[test]
    fn decoded_and_encoded_again() {
        assert_eq!((decode(0.0), decode(1.0)), (0.0, 1.0));
        assert_eq!(
            (decode(-0.5), decode(2.0), decode(f64::NAN)),
            (0.0, 1.0, 0.0)
        );
        for code in 0..=u16::MAX {
            let value = f64::from(code) / 65535.0;
            // The two branches of the standard's rounded numbers meet within 3e-8.
            assert!((encode(decode(value)) - value).abs() < 1e-7);
        }
    }

    #[test]
    fn table_agrees() {
        let encoder = SrgbEncoder::new();
        let mut worst = 0.0_f64;
        // Every 2⁻⁹ of an octave and a little more, from far below one code to beyond the end.
        for bits in (1e-8_f32.to_bits()..1.1_f32.to_bits()).step_by(16_381) {
            let c = f32::from_bits(bits);
            worst = worst.max((f64::from(encoder.encode(c)) - encode(f64::from(c))).abs());
        }
        assert!(worst < 5e-7, "{worst}");
    }

    #[test]
    fn each_code_encodes_its_own_light() {
        let encoder = SrgbEncoder::new();
        for code in 0..=u16::MAX {
            let value = f64::from(code) / 65535.0;
            let linear = if value <= 0.04045 {
                value / 12.92
            } else {
                libm::pow((value + 0.055) / 1.055, 2.4)
            };
            let found = encoder.encode(linear as f32) * 65535.0;
            assert!((found - f32::from(code)).abs() < 0.05);
        }
    }

    #[test]
    fn what_is_no_light_is_clipped() {
        let encoder = SrgbEncoder::new();
        for nothing in [f32::NAN, f32::NEG_INFINITY, -1.0, -0.0, 0.0] {
            assert_eq!(encoder.encode(nothing), 0.0);
        }
        for much in [1.0, 1.5, f32::MAX, f32::INFINITY] {
            assert!((encoder.encode(much) - 1.0).abs() < 5e-7);
        }
    }

    #[test]
    fn codes_are_the_nearest() {
        let encoder = SrgbEncoder::new();
        for i in 0..=200_000 {
            let c = (f64::from(i) / 200_000.0) as f32;
            let exact = 255.0 * encode(f64::from(c));
            let code = f64::from(encoder.code8(c));
            assert!((code - exact).abs() <= 0.5001, "{c}: {code}, not {exact}");
        }
        assert_eq!(
            [-1.0, 0.0, 1e-30, 2.0, f32::INFINITY].map(|c| encoder.code8(c)),
            [0, 0, 0, 255, 255]
        );
        assert_eq!(encoder.code8(f32::NAN), 0);
    }
}
