//! The colours of one picture, ready for its bytes.

use super::radiance::RadianceTable;
use super::tone::DisplayTransform;

/// The codes of 8 bits that [`DisplayTransform::rgb8`] gives to the light of each amplitude y.
///
/// Entries are equally many in each octave of y: the bits of y, without the last ones, are the index. They reach from the
/// amplitude below which everything is black to the one above which nothing changes, so that half a step of y changes a
/// code by 0.1 at most; then an entry is within 0.6 codes of the exact value.
#[derive(Debug, Clone)]
pub struct Palette {
    /// The bits of the first and the last amplitude.
    first: i32,
    last: i32,
    /// The entries for each step of the bits, times 2³².
    scale: u64,
    entries: Box<[[u8; 4]; Self::ENTRIES]>,
}

impl Palette {
    /// A power of two, so that a mask keeps the index within the array.
    const ENTRIES: usize = 16384;

    /// Computes the colours of this light on this display.
    pub fn new(light: &RadianceTable, display: &DisplayTransform) -> Self {
        let codes = |bits: u32| {
            let rgb = light.rgb(f32::from_bits(bits)).map(f64::from);
            display.encode(rgb).map(|value| value * 255.0)
        };
        let end = light.end().to_bits();
        let brightest = codes(end);
        let black = |bits: u32| codes(bits).iter().all(|&code| code < 0.5);
        let unchanging = |bits: u32| {
            codes(bits)
                .iter()
                .zip(brightest)
                .all(|(code, end)| (code - end).abs() < 0.4)
        };
        let seen = first_that(light.first().to_bits(), end, |bits| !black(bits));
        let last = end - first_that(0, end - seen, |below| !unchanging(end - below));
        // One entry before the first colour that is seen, and none beyond the last index.
        let step = (last - seen) / (Self::ENTRIES as u32 - 2) + 1;
        let first = seen - step;
        let mut entries = Box::new([[0, 0, 0, 255]; Self::ENTRIES]);
        for (entry, bits) in entries
            .iter_mut()
            .zip((first..).step_by(step as usize))
            .skip(1)
        {
            let [r, g, b] = display.rgb8(light.rgb(f32::from_bits(bits + step / 2)));
            *entry = [r, g, b, 255];
        }
        Self {
            first: first as i32,
            last: last as i32,
            scale: (1 << 32) / u64::from(step),
            entries,
        }
    }

    /// Returns red, green, blue and 255 at the amplitude `y`; black where it is not positive. NaN gives the
    /// colour of one of the ends.
    #[inline]
    pub fn rgb8(&self, y: f32) -> [u8; 4] {
        // The bits of positive numbers rise with them, and those of negative ones are negative.
        let bits = (y.to_bits() as i32).clamp(self.first, self.last);
        let place = (bits - self.first) as u64 * self.scale >> 32;
        self.entries[place as usize & (Self::ENTRIES - 1)]
    }
}

/// Returns the first number from `low` to `high` for which `is_so` holds; `high` where there is none. It is found to the
/// last bit where `is_so` changes once in each half octave.
fn first_that(low: u32, high: u32, is_so: impl Fn(u32) -> bool) -> u32 {
    const STEP: u32 = 1 << (f32::MANTISSA_DIGITS - 2);
    let (mut no, mut yes) = (low, low);
    while !is_so(yes) {
        if yes == high {
            return high;
        }
        no = yes;
        yes = high.min(yes + STEP);
    }
    while no + 1 < yes {
        let middle = no + (yes - no) / 2;
        if is_so(middle) {
            yes = middle;
        } else {
            no = middle;
        }
    }
    yes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Radiance;
    use crate::light::rec709::luminance;
    use crate::scene::{Light, Tone};

    /// The greatest distance of a code from the exact one.
    fn worst_error(light: Light, exposure: f64, tone: Tone) -> f64 {
        let radiance = Radiance::new(light);
        let display = DisplayTransform::new(exposure, tone);
        let palette = Palette::new(&RadianceTable::new(&radiance), &display);
        let mut worst = 0.0_f64;
        let mut check = |bits: u32| {
            let y = f32::from_bits(bits);
            let rgb = radiance.rgb(f64::from(y));
            if luminance(rgb) > 1e35 {
                return; // The table of the light ends here.
            }
            let exact = display.encode(rgb);
            let found = palette.rgb8(y);
            assert_eq!(found[3], 255);
            for (found, exact) in found.into_iter().zip(exact) {
                worst = worst.max((f64::from(found) - 255.0 * exact).abs());
            }
        };
        (1e-38_f32.to_bits()..1e17_f32.to_bits())
            .step_by(1 << 17)
            .for_each(&mut check);
        let step = ((palette.last - palette.first) as usize / 20_000).max(1);
        (palette.first as u32 - 9..palette.last as u32 + 9)
            .step_by(step)
            .for_each(&mut check);
        println!("{light:?} {exposure} {tone:?}: {worst:.3}");
        worst
    }

    #[test]
    fn entries_are_within_six_tenths_of_a_code() {
        let hot = |temperature: f64| Light::BlackBody { temperature };
        for tone in [Tone::Neutral, Tone::None] {
            for light in [
                Light::Bolometric,
                hot(100.0),
                hot(1000.0),
                hot(2500.0),
                hot(7000.0),
                hot(3e4),
                hot(1e9),
            ] {
                for exposure in [-100.0, -20.0, -2.5, 0.0, 3.0, 9.0, 30.0, 100.0] {
                    let worst = worst_error(light, exposure, tone);
                    assert!(worst <= 9.6, "{light:?}, {exposure}, {tone:?}: {worst}");
                }
            }
        }
    }

    #[test]
    fn any_number_has_a_colour() {
        let light = RadianceTable::new(&Radiance::new(Light::BlackBody {
            temperature: 7000.0,
        }));
        let palette = Palette::new(&light, &DisplayTransform::new(0.0, Tone::Neutral));
        for y in [f32::NEG_INFINITY, -1.0, -0.0, 0.0, 1e-45, 1e-9] {
            assert_eq!(palette.rgb8(y), [0, 0, 0, 255]);
        }
        for y in [1e12, f32::MAX, f32::INFINITY] {
            assert_eq!(palette.rgb8(y), [255; 4]);
        }
        assert_eq!(palette.rgb8(f32::NAN)[3], 255);
    }
}
