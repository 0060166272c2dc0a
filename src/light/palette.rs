//! The colours of one picture, ready for its bytes.

use super::radiance::RadianceTable;
use super::tone::DisplayTransform;

/// The 8-bit colours of one light on one display, by the amplitude y.
///
/// 20,000 to 40,000 entries (80 to 160 kB) stand at equal distances on an axis that is nearly ln y: the bits of y as an
/// integer, shifted. They reach from the amplitude below which all is black to the one above which nothing changes, so
/// that their distance follows from how fast the light rises. A code is within 0.6 of the exact one,
/// [`DisplayTransform::encode`] times 255; 0.5 of this is the rounding.
///
/// There is one exception, without a tone ([`Tone::None`]): where light of 1900 K is overexposed five times or more,
/// its blue enters the gamut there and rises by more than a code within an entry.
///
/// [`Tone::None`]: crate::scene::Tone::None
#[derive(Debug, Clone)]
pub struct Palette {
    /// The bits of the first amplitude.
    first: i32,
    /// The bits that do not tell the entry.
    shift: u32,
    entries: Vec<[u8; 4]>,
    /// The colour of all larger amplitudes.
    brightest: [u8; 4],
}

impl Palette {
    const LEAST_ENTRIES: u32 = 20_000;
    /// So many entries are interpolated where they differ by less than 0.4 codes: most of them, where it is dark, where
    /// it is nearly white, and where the codes rise slowly between.
    const BLOCK: usize = 8;

    /// Computes the colours of this light on this display.
    pub fn new(light: &RadianceTable, display: &DisplayTransform) -> Self {
        let rgb = |bits: u32| light.rgb(f32::from_bits(bits));
        let codes = |bits: u32| display.rgb8(rgb(bits));
        let end = light.end().to_bits();
        let brightest = codes(end);
        let seen = first_that(light.first().to_bits(), end, |bits| codes(bits) != [0; 3]);
        let last = end - first_that(0, end - seen, |below| codes(end - below) != brightest);
        let shift = ((last - seen) / Self::LEAST_ENTRIES).max(1).ilog2();
        let step = 1 << shift;
        // One entry before the first colour that is seen.
        let first = seen - step;
        let count = ((last - first) >> shift) as usize + 1;
        let entry = |place: usize| display.values(rgb(first + place as u32 * step + step / 2));
        let mut entries = vec![[0; 4]; count.next_multiple_of(Self::BLOCK)];
        let mut start = entry(0);
        for (block, colours) in entries
            .as_chunks_mut::<{ Self::BLOCK }>()
            .0
            .iter_mut()
            .enumerate()
        {
            let place = block * Self::BLOCK;
            let end = entry(place + Self::BLOCK);
            let flat = (0..3).all(|c| (end[c] - start[c]).abs() * 255.0 < 0.4);
            for (i, colour) in colours.iter_mut().enumerate() {
                let [r, g, b] = if flat {
                    let t = i as f32 / Self::BLOCK as f32;
                    [0, 1, 2].map(|c| start[c] + (end[c] - start[c]) * t)
                } else {
                    entry(place + i)
                }
                .map(|value| (value * 255.0 + 0.5) as u8);
                *colour = [r, g, b, 255];
            }
            start = end;
        }
        // The first entry stands for all that is not seen.
        entries[0] = [0, 0, 0, 255];
        entries.truncate(count);
        Self {
            first: first as i32,
            shift,
            entries,
            brightest: [brightest[0], brightest[1], brightest[2], 255],
        }
    }

    /// Returns red, green and blue at the amplitude `y`; black where it is not positive. NaN gives the colour of one of
    /// the ends.
    #[inline(always)]
    pub fn rgb8(&self, y: f32) -> [u8; 3] {
        // The bits of positive numbers rise with them, and those of negative ones are negative.
        let beyond_first = (y.to_bits() as i32).max(self.first) - self.first;
        let place = (beyond_first >> self.shift) as usize;
        let [r, g, b, _] = *self.entries.get(place).unwrap_or(&self.brightest);
        [r, g, b]
    }
}

/// Returns the first number from `low` to `high` for which `is_so` holds; `high` where there is none. It is found to
/// the last bit where `is_so` changes once in each half octave.
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

    /// The greatest distance of a code from the exact one, among places that are so many bits of y apart.
    fn worst_error(light: Light, display: &DisplayTransform, spacing: usize) -> f64 {
        let radiance = Radiance::new(light);
        let palette = Palette::new(&RadianceTable::new(&radiance), display);
        let exact = |y: f32| {
            display
                .encode(radiance.rgb(f64::from(y)))
                .map(|c| 255.0 * c)
        };
        let mut worst = 0.0_f64;
        for bits in (1e-19_f32.to_bits()..1e17_f32.to_bits()).step_by(spacing) {
            let y = f32::from_bits(bits);
            if luminance(radiance.rgb(f64::from(y))) > 1e35 {
                break; // The table of the light ends here.
            }
            for (found, exact) in palette.rgb8(y).into_iter().zip(exact(y)) {
                worst = worst.max((f64::from(found) - exact).abs());
            }
        }
        worst
    }

    #[test]
    fn codes_are_within_six_tenths() {
        let lights = [100.0, 1000.0, 2500.0, 7000.0, 3e4, 1e9]
            .map(|temperature| Light::BlackBody { temperature })
            .into_iter()
            .chain([Light::Bolometric]);
        for light in lights {
            for exposure in [-100.0, -20.0, -2.5, 0.0, 3.0, 9.0, 30.0, 100.0] {
                let display = DisplayTransform::new(exposure, Tone::Neutral);
                let worst = worst_error(light, &display, 9973);
                assert!(worst <= 0.6, "{light:?}, {exposure}: {worst}");
            }
        }
        let light = Light::BlackBody {
            temperature: 7000.0,
        };
        let worst = worst_error(light, &DisplayTransform::new(0.0, Tone::None), 997);
        assert!(worst <= 0.6, "{worst}");
    }

    #[test]
    fn any_number_has_a_colour() {
        let light = RadianceTable::new(&Radiance::new(Light::BlackBody {
            temperature: 7000.0,
        }));
        let palette = Palette::new(&light, &DisplayTransform::new(0.0, Tone::Neutral));
        for y in [f32::NEG_INFINITY, -1.0, -0.0, 0.0, 1e-45, 1e-9] {
            assert_eq!(palette.rgb8(y), [0; 3]);
        }
        for y in [1e12, f32::MAX, f32::INFINITY] {
            assert_eq!(palette.rgb8(y), [255; 3]);
        }
        assert!([[0; 3], [255; 3]].contains(&palette.rgb8(f32::NAN)));
    }
}
