//! The light of a star as a camera near the hole sees it.
//!
//! A static camera at the inverse radius u0 sees all frequencies times `g = 1/√(1 − u0)`. Radiance over the cube of the
//! frequency is invariant, so that a black body of T is seen as a black body of g T: with X, Y and Z of
//! [`black_body`], a star of magnitude m without the hole sends
//!
//! ```text
//! Rec. 709 of (X, Y, Z)(g T) / Y(T) · 10^(−0.4 m) · 2^exposure
//! ```
//!
//! The magnification of its images comes on top. Magnitudes are visual, and Y stands for the visual band.

use crate::light::{black_body, rec709};

use super::star::Star;

/// The first temperature of the table. Catalogues have stars from 100 K.
const FIRST: f32 = 64.0;

const OCTAVES: u32 = 24;
const CELL_BITS: u32 = 5;
const CELLS: u32 = OCTAVES << CELL_BITS;
const SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - CELL_BITS;

/// hc/λk of 830 nm, in kelvin: Y(T) falls as exp(−WIEN/T) at low temperatures.
const WIEN: f64 = 17_335.0;

/// Brighter light counts as about this bright, so that 32-bit sums over stars stay finite.
const BRIGHTEST: f64 = 1e36;

/// The light of stars at one frequency shift, as a table over the temperature.
///
/// An octave of the temperature is cut into 32 cells with a quadratic for each of four functions in each cell: the
/// logarithm of `Y(gT)/Y(T)` without `(1 − 1/g) WIEN/T`, and red, green and blue over Y(gT). The result is right to
/// 1e-5 of the luminance from 100 K to 1e9 K.
#[derive(Debug, Clone)]
pub struct StarColours {
    /// `(1 − 1/g) WIEN`.
    wien: f64,
    /// The logarithm of the exposure's factor.
    exposure: f64,
    cells: Vec<[[f32; 3]; 4]>,
}

impl StarColours {
    /// Computes the table for the shift factor g, which is above 0 and at most 1e8, and an exposure in stops.
    pub fn new(shift_factor: f64, exposure: f64) -> Self {
        let wien = (1.0 - 1.0 / shift_factor) * WIEN;
        let functions = |temperature: f64| {
            let xyz = black_body::xyz(shift_factor * temperature);
            let [red, green, blue] = rec709::linear_rgb(xyz).map(|colour| colour / xyz[1]);
            let ratio = xyz[1] / black_body::xyz(temperature)[1];
            [libm::log(ratio) - wien / temperature, red, green, blue]
        };
        let node = |bits: u32| f64::from(f32::from_bits(bits));
        let first = FIRST.to_bits();
        let mut at_start = functions(node(first));
        let cells = (0..CELLS)
            .map(|index| {
                let start = first + (index << SHIFT);
                let middle = functions(node(start + (1 << (SHIFT - 1))));
                let end = functions(node(start + (1 << SHIFT)));
                let cell = std::array::from_fn(|i| quadratic(at_start[i], middle[i], end[i]));
                at_start = end;
                cell
            })
            .collect();
        Self {
            wien,
            exposure: exposure * std::f64::consts::LN_2,
            cells,
        }
    }

    /// Returns the star's irradiance without magnification, as linear red, green and blue of Rec. 709.
    ///
    /// A star of magnitude 0 has luminance 1 at g = 1 and an exposure of 0. Reddish stars have a negative blue.
    #[inline]
    pub fn light(&self, star: &Star) -> [f32; 3] {
        let last = FIRST.to_bits() + (CELLS << SHIFT) - 1;
        let bits = star.temperature.to_bits().clamp(FIRST.to_bits(), last);
        let cell = &self.cells[((bits - FIRST.to_bits()) >> SHIFT) as usize];
        let t = (bits & ((1 << SHIFT) - 1)) as f32 / (1 << SHIFT) as f32;
        let [logarithm, red, green, blue] = cell.map(|[a, b, c]| a + t * (b + t * c));
        let exponent =
            f64::from(logarithm) + self.wien / f64::from(star.temperature) + self.exposure;
        let irradiance = (f64::from(star.irradiance) * libm::exp(exponent)).min(BRIGHTEST) as f32;
        [red * irradiance, green * irradiance, blue * irradiance]
    }
}

/// Returns the coefficients, constant term first, of the quadratic with these values at 0, ½ and 1.
fn quadratic(start: f64, middle: f64, end: f64) -> [f32; 3] {
    [
        start,
        4.0 * middle - 3.0 * start - end,
        2.0 * (start + end) - 4.0 * middle,
    ]
    .map(|coefficient| coefficient as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const SHIFTS: [f64; 10] = [0.9, 1.0, 1.02, 1.2, 1.5, 2.0, 3.0, 10.0, 1e4, 1e8];

    /// The formula of the module's documentation, over `scale`.
    fn exact(star: &Star, g: f64, scale: f64) -> [f64; 3] {
        let temperature = f64::from(star.temperature);
        let scale = f64::from(star.irradiance) * scale / black_body::xyz(temperature)[1];
        rec709::linear_rgb(black_body::xyz(g * temperature)).map(|colour| colour * scale)
    }

    #[test]
    fn table_agrees() {
        for g in SHIFTS {
            let colours = StarColours::new(g, -1.5);
            let (mut worst, mut worst_temperature) = (0.0_f64, 0.0);
            for i in 0..=160_000 {
                let temperature = 100.0 * libm::exp(f64::from(i) * 1e-4);
                let star = Star::at(DVec3::X, 2.0, temperature.min(1e9));
                let exact = exact(&star, g, libm::exp2(-1.5));
                let bright = rec709::luminance(exact);
                let found = colours.light(&star).map(f64::from);
                if !(1e-30..1e36).contains(&bright) {
                    continue;
                }
                let size = exact.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
                let mut error = (rec709::luminance(found) / bright - 1.0).abs();
                for (found, exact) in found.into_iter().zip(exact) {
                    error = error.max((found - exact).abs() / size);
                }
                if error > worst {
                    (worst, worst_temperature) = (error, temperature);
                }
            }
            println!("g = {g}: {worst:.1e} at {worst_temperature} K");
            assert!(worst < 1e-5, "g = {g}: {worst} at {worst_temperature} K");
        }
    }

    #[test]
    fn magnitude_is_luminance_without_shift() {
        let colours = StarColours::new(1.0, 2.0);
        for (magnitude, temperature) in [(0.0, 5800.0), (-1.0, 100.0), (5.0, 1e9), (10.0, 3e4)] {
            let light = colours.light(&Star::at(DVec3::X, magnitude, temperature));
            let expected = 4.0 * libm::exp10(-0.4 * magnitude);
            let found = rec709::luminance(light.map(f64::from));
            assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
        }
    }

    #[test]
    fn all_light_is_finite() {
        for g in SHIFTS {
            for exposure in [-200.0, 0.0, 200.0] {
                let colours = StarColours::new(g, exposure);
                for magnitude in [-60.0, 0.0, 60.0] {
                    for temperature in [100.0, 1000.0, 5800.0, 1e5, 1e9] {
                        let star = Star::at(DVec3::X, magnitude, temperature);
                        let light = colours.light(&star);
                        assert!(light.iter().all(|c| c.is_finite()), "{g} {light:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_shift_makes_red_stars_brighter_and_bluer() {
        let star = Star::at(DVec3::X, 0.0, 3000.0);
        let [rest, shifted] = [1.0, 1.5].map(|g| StarColours::new(g, 0.0).light(&star));
        assert!(shifted[1] > 4.0 * rest[1]);
        assert!(shifted[2] / shifted[0] > 2.0 * rest[2] / rest[0]);
    }
}
