//! The light that a ray brings from the disk.
//!
//! One number tells it, whatever the disk's light: the *amplitude* `y = g² √(F/F_max)`, the square root of the observed
//! flux of all wavelengths together, `y² = g⁴ F/F_max`. Its parts are the redshift g and [`flux::signed_root`]. A ring
//! that shines as a black body has the temperature `T_peak (F/F_max)^(1/4)`, and a shifted black body is a black body
//! of g times its temperature, so that what is seen has `T = T_peak √y`.
//!
//! [`flux::signed_root`]: super::flux::signed_root

use super::rec709::{linear_rgb, luminance};
use super::{black_body, cubic};
use crate::scene::Light;

/// Linear light as a function of the amplitude y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radiance(Source);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    /// The temperature of the hottest ring, in kelvin, and what multiplies its luminance to give 1.
    BlackBody {
        peak: f64,
        scale: f64,
    },
    Grey,
    White,
}

impl Radiance {
    /// The light of the disk's rings. A black body's temperature is at least 50 K; scenes allow 100 K and more.
    pub fn new(light: Light) -> Self {
        Self(match light {
            Light::BlackBody { temperature } => Source::BlackBody {
                peak: temperature,
                scale: 1.0 / black_body::xyz(temperature)[1],
            },
            Light::Bolometric => Source::Grey,
        })
    }

    /// The light of a disk that shines evenly: 1 in each colour, whatever the amplitude.
    pub fn white() -> Self {
        Self(Source::White)
    }

    /// Returns linear red, green and blue of Rec. 709 at the amplitude `y`; nothing where y is not positive. The
    /// hottest ring at rest (y = 1) has luminance 1. Deep reds have a negative blue, and some a negative green.
    ///
    /// The luminance is right to 1e-7 (black bodies) or exact (bolometric, red = green = blue = y²).
    pub fn rgb(&self, y: f64) -> [f64; 3] {
        if y.is_nan() || y <= 0.0 {
            return [0.0; 3];
        }
        match self.0 {
            Source::BlackBody { peak, scale } => {
                linear_rgb(black_body::xyz(peak * y.sqrt()).map(|value| value * scale))
            }
            Source::Grey => [y * y; 3],
            Source::White => [1.0; 3],
        }
    }

    /// An upper bound of d ln(luminance)/d ln y at `y`.
    pub(crate) fn slope(&self, y: f64) -> f64 {
        match self.0 {
            // exp(−w/T) falls with the Wien exponent of the longest visible wavelength at low temperatures, of the
            // middle of the visible at high ones; T ∝ √y halves the slope.
            Source::BlackBody { peak, .. } => 0.5 + 0.5 * 25_000.0 / (peak * y.sqrt()),
            Source::Grey => 2.0,
            Source::White => 0.0,
        }
    }
}

/// [`Radiance`] as a table: a few nanoseconds a value.
///
/// An octave of y is cut into 4 to 1024 cells, as steeply as the light falls there, with a cubic for each colour in
/// each cell. The luminance is right to 1e-5 from 1e-30 to 1e35 times the hottest ring's. Less than 1e-36 is nothing,
/// more than 1e36 counts as about that, and so do amplitudes above 2⁶⁰, which no camera can see that is farther from
/// the horizon than the rounding of its radius.
#[derive(Debug, Clone)]
pub struct RadianceTable {
    /// The start of the first octave.
    first: f32,
    /// The end of the last octave.
    end: f32,
    octaves: Vec<Octave>,
    /// Red, green, blue.
    cells: Vec<[[f32; 4]; 3]>,
}

#[derive(Debug, Clone, Copy)]
struct Octave {
    /// The index of its first cell.
    base: u32,
    /// The bits of a number that do not tell its cell.
    shift: u32,
}

const MANTISSA: u32 = f32::MANTISSA_DIGITS - 1;

impl RadianceTable {
    /// Computes the table.
    pub fn new(radiance: &Radiance) -> Self {
        const GREATEST: f32 = (1_u64 << 60) as f32;
        /// The cubics of what is larger would overflow.
        const HUGE: f64 = 1e36;
        let luminance = |y: f32| luminance(radiance.rgb(f64::from(y)));
        let (mut first, mut end) = (1.0, 2.0);
        while luminance(first) > 1.0 / HUGE && first > f32::MIN_POSITIVE {
            first *= 0.5;
        }
        while luminance(end) < HUGE && end < GREATEST {
            end *= 2.0;
        }
        let octave_count = (end.to_bits() - first.to_bits()) >> MANTISSA;
        let mut table = Self {
            first,
            end,
            octaves: Vec::with_capacity(octave_count as usize),
            cells: Vec::new(),
        };
        let mut start = f64::from(first);
        let rgb = |y: f64| {
            let rgb = radiance.rgb(y);
            let size = rgb.iter().fold(HUGE, |size, c| size.max(c.abs()));
            rgb.map(|c| c * (HUGE / size))
        };
        let mut at_start = rgb(start);
        for _ in 0..octave_count {
            // A cubic through four equidistant values of y^s over a cell of the relative width h is wrong by
            // s⁴h⁴/(24 · 81) at most: 6e-6 for h = 1/(3s).
            let cell_bits = ((3.0 * radiance.slope(start)) as u32)
                .next_power_of_two()
                .ilog2()
                .clamp(2, 10);
            table.octaves.push(Octave {
                base: table.cells.len() as u32,
                shift: MANTISSA - cell_bits,
            });
            let width = start / f64::from(1_u32 << cell_bits);
            for i in 0..1_u32 << cell_bits {
                let third = |k: f64| rgb(start + width * (f64::from(i) + k / 3.0));
                let values = [at_start, third(1.0), third(2.0), third(3.0)];
                let colour =
                    |c: usize| cubic::through(values.map(|value| value[c])).map(|c| c as f32);
                table.cells.push([colour(0), colour(1), colour(2)]);
                at_start = values[3];
            }
            start *= 2.0;
        }
        table
    }

    /// The amplitude below which there is nothing.
    pub(super) fn first(&self) -> f32 {
        self.first
    }

    /// The amplitude from which on nothing changes.
    pub(super) fn end(&self) -> f32 {
        self.end
    }

    /// Returns what [`Radiance::rgb`] returns.
    #[inline]
    pub fn rgb(&self, y: f32) -> [f32; 3] {
        if y.is_nan() || y < self.first {
            return [0.0; 3];
        }
        let bits = y.to_bits().min(self.end.to_bits() - 1);
        let octave = self.octaves[((bits - self.first.to_bits()) >> MANTISSA) as usize];
        let within = (bits & ((1 << MANTISSA) - 1)) >> octave.shift;
        let t = cubic::fraction(bits, octave.shift);
        self.cells[(octave.base + within) as usize].map(|colour| cubic::at(colour, t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{DisplayTransform, Palette};
    use crate::scene::Tone;

    fn lights() -> impl Iterator<Item = Light> {
        [100.0, 300.0, 1000.0, 2500.0, 7000.0, 1e5, 1e7, 1e9]
            .map(|temperature| Light::BlackBody { temperature })
            .into_iter()
            .chain([Light::Bolometric])
    }

    #[test]
    fn the_hottest_ring_has_luminance_one() {
        for light in lights() {
            let rgb = Radiance::new(light).rgb(1.0);
            assert!((luminance(rgb) - 1.0).abs() < 1e-14, "{light:?}");
        }
        assert_eq!(Radiance::new(Light::Bolometric).rgb(0.5), [0.25; 3]);
    }

    #[test]
    fn a_ring_seen_at_half_its_temperature() {
        let radiance = Radiance::new(Light::BlackBody {
            temperature: 7000.0,
        });
        let half = luminance(radiance.rgb(0.25));
        let expected = black_body::xyz(3500.0)[1] / black_body::xyz(7000.0)[1];
        assert!((half / expected - 1.0).abs() < 1e-14);
    }

    #[test]
    fn table_agrees() {
        for light in lights() {
            let radiance = Radiance::new(light);
            let table = RadianceTable::new(&radiance);
            let mut worst = [0.0_f64; 2];
            for bits in (1e-38_f32.to_bits()..table.end.to_bits()).step_by(7_919) {
                let y = f32::from_bits(bits);
                let exact = radiance.rgb(f64::from(y));
                let bright = luminance(exact);
                if !(1e-30..1e35).contains(&bright) {
                    continue;
                }
                let found = table.rgb(y).map(f64::from);
                worst[0] = worst[0].max((luminance(found) / bright - 1.0).abs());
                let size = exact.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
                for (found, exact) in found.into_iter().zip(exact) {
                    worst[1] = worst[1].max((found - exact).abs() / size);
                }
            }
            println!("{light:?}: {worst:?} {} cells", table.cells.len());
            assert!(worst[0] < 1e-5 && worst[1] < 1e-5, "{light:?}: {worst:?}");
        }
    }

    #[test]
    fn white_is_one_everywhere() {
        let table = RadianceTable::new(&Radiance::white());
        for y in [f32::MIN_POSITIVE, 1e-30, 0.3, 1.0, 1e10, f32::INFINITY] {
            assert_eq!(table.rgb(y), [1.0; 3], "{y}");
        }
        assert_eq!(table.rgb(0.0), [0.0; 3]);
        let display = DisplayTransform::new(0.0, Tone::None);
        let palette = Palette::new(&table, &display);
        assert_eq!([0.0, 0.3, 1e20].map(|y| palette.rgb8(y)[0]), [0, 255, 255]);
    }

    #[test]
    fn what_is_not_positive_is_dark_and_all_else_finite() {
        for light in lights() {
            let radiance = Radiance::new(light);
            let table = RadianceTable::new(&radiance);
            for y in [f32::NAN, f32::NEG_INFINITY, -1.0, -0.0, 0.0] {
                assert_eq!(radiance.rgb(f64::from(y)), [0.0; 3]);
                assert_eq!(table.rgb(y), [0.0; 3]);
            }
            for y in [
                f32::MIN_POSITIVE,
                1e-30,
                1.0,
                1e10,
                1e30,
                f32::MAX,
                f32::INFINITY,
            ] {
                assert!(table.rgb(y).iter().all(|c| c.is_finite()), "{light:?} {y}");
            }
        }
    }
}
