//! From linear light to the values of a picture.
//!
//! Four steps, in this order:
//!
//! 1. *Exposure*: light times 2 to the power of the exposure, in stops.
//! 2. *Gamut*: a colour outside Rec. 709 has a negative component. It is moved along constant luminance towards grey
//!    until that component is 0.
//! 3. *Tone*: [`Tone::Neutral`] compresses highlights, [`Tone::None`] clips them.
//! 4. *Encoding* as sRGB ([`srgb`]).
//!
//! The neutral tone is the highlight part of the [Khronos PBR Neutral tone mapper]. Up to 0.8 light stays as it is.
//! Above, its largest component p becomes `1 − 0.04/(p − 0.6)`, with the same value and slope at 0.8, and the colour
//! fades to a grey of that size, so that the hue stays and what is very bright is white. The other part of that tone
//! mapper takes away up to 0.04 of all light, the reflection of a white room on a plastic surface. A disk that shines
//! by itself has none, so that this part is left out (F₉₀ = 0 in the specification's terms).
//!
//! [Khronos PBR Neutral tone mapper]: https://github.com/KhronosGroup/ToneMapping/blob/main/PBR_Neutral/README.md

use super::rec709::luminance;
use super::srgb::{self, SrgbEncoder};
use crate::scene::Tone;

/// How linear light is displayed.
#[derive(Debug, Clone)]
pub struct DisplayTransform {
    /// 2 to the power of the exposure.
    scale: f64,
    tone: Tone,
    encoder: SrgbEncoder,
}

impl DisplayTransform {
    /// The display of light at an `exposure` in stops, −100 to 100.
    pub fn new(exposure: f64, tone: Tone) -> Self {
        Self {
            scale: libm::exp2(exposure),
            tone,
            encoder: SrgbEncoder::new(),
        }
    }

    /// Returns the sRGB values, in [0, 1], of linear red, green and blue of Rec. 709.
    pub fn encode(&self, rgb: [f64; 3]) -> [f64; 3] {
        self.displayed(rgb).map(srgb::encode)
    }

    /// Returns [`Self::encode`] in 8 bits, rounded to the nearest code up to 0.001 codes.
    #[inline(always)]
    pub fn rgb8(&self, rgb: [f32; 3]) -> [u8; 3] {
        let scaled = rgb.map(|c| c * self.scale as f32);
        // What is in the gamut and below the highlights is only encoded. Bits of numbers that are not negative are in
        // the order of the numbers, and before those of negative ones.
        let bits = scaled.map(f32::to_bits);
        if bits.iter().all(|&bits| bits <= (START as f32).to_bits()) {
            return bits.map(|bits| self.encoder.code8_of_bits(bits));
        }
        self.displayed(rgb.map(f64::from))
            .map(|c| self.encoder.code8(c as f32))
    }

    /// Returns [`Self::encode`] in 16 bits, rounded to the nearest code up to 0.05 codes.
    #[inline(always)]
    pub fn rgb16(&self, rgb: [f32; 3]) -> [u16; 3] {
        self.values(rgb).map(|value| (value * 65535.0 + 0.5) as u16)
    }

    /// Returns [`Self::encode`] up to 1e-6.
    #[inline(always)]
    pub(super) fn values(&self, rgb: [f32; 3]) -> [f32; 3] {
        self.displayed(rgb.map(f64::from))
            .map(|c| self.encoder.encode(c as f32))
    }

    /// The first three steps. What is above 1 is left to the encoding to clip.
    #[inline(always)]
    fn displayed(&self, rgb: [f64; 3]) -> [f64; 3] {
        let rgb = in_gamut(rgb.map(|c| c * self.scale));
        match self.tone {
            Tone::Neutral => compress_highlights(rgb),
            Tone::None => rgb,
        }
    }
}

/// Highlights begin above this much light.
const START: f64 = 0.8;

/// Moves a colour with a negative component towards the grey of its luminance. Without luminance it is black.
#[inline(always)]
fn in_gamut(rgb: [f64; 3]) -> [f64; 3] {
    let least = rgb[0].min(rgb[1]).min(rgb[2]);
    if least >= 0.0 {
        return rgb;
    }
    let grey = luminance(rgb).max(0.0);
    // grey + (c − grey) share, with the share at which the least component is exactly 0.
    let share = grey / (grey - least);
    rgb.map(|c| (c - least) * share)
}

/// The specification's compression and desaturation, with `K_s` = 0.8 and `K_d` = 0.15.
#[inline(always)]
fn compress_highlights(rgb: [f64; 3]) -> [f64; 3] {
    const DESATURATION: f64 = 0.15;
    let peak = rgb[0].max(rgb[1]).max(rgb[2]);
    if peak <= START {
        return rgb;
    }
    let compressed = 1.0 - (1.0 - START) * (1.0 - START) / (peak + 1.0 - 2.0 * START);
    let kept = 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    let scale = compressed / peak * kept;
    rgb.map(|c| c * scale + compressed * (1.0 - kept))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn red_outside_the_gamut_keeps_its_luminance() {
        let rgb = [0.9, 0.1, -0.05];
        let found = in_gamut(rgb);
        assert!((luminance(found) - luminance(rgb)).abs() < 1e-15);
        assert!(
            found.iter().all(|&c| c >= 0.0) && found[2] < 1e-15,
            "{found:?}"
        );
        // On the straight line from the colour to its grey.
        let grey = luminance(rgb);
        let share = |i: usize| (found[i] - grey) / (rgb[i] - grey);
        assert!((share(0) - share(1)).abs() < 1e-14 && (share(0) - share(2)).abs() < 1e-14);
        assert_eq!(in_gamut([0.3, 0.2, 0.1]), [0.3, 0.2, 0.1]);
        assert_eq!(in_gamut([-0.3, -0.2, 0.0]), [0.0; 3]);
    }

    #[test]
    fn neutral_tone_is_that_of_the_specification_above_its_start() {
        assert_eq!(compress_highlights([0.8, 0.3, 0.1]), [0.8, 0.3, 0.1]);
        // Without the offset: p = 2, p_n = 1 − 0.04/1.4, g = 1/(0.15 (p − p_n) + 1).
        let compressed = 1.0 - 0.04 / 1.4;
        let g = 1.0 / (0.15 * (2.0 - compressed) + 1.0);
        let expected = [2.0, 1.0, 0.0].map(|c| c * compressed / 2.0 * g + compressed * (1.0 - g));
        let found = compress_highlights([2.0, 1.0, 0.0]);
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn neutral_tone_is_smooth_at_its_start_and_ends_in_white() {
        let step = 1e-6;
        let above = compress_highlights([0.8 + step; 3])[0];
        assert!(((above - 0.8) / step - 1.0).abs() < 1e-4);
        let mut before = 0.0;
        for i in 0..400 {
            let grey = compress_highlights([libm::exp2(f64::from(i) * 0.25); 3])[0];
            assert!(grey >= before && grey <= 1.0);
            before = grey;
        }
        let white = compress_highlights([1e9, 1e8, 0.0]);
        assert!(white.iter().all(|&c| c > 0.9999 && c <= 1.0), "{white:?}");
    }

    #[test]
    fn exposure_is_in_stops() {
        let [dark, bright] = [0.0, 1.0].map(|exposure| DisplayTransform::new(exposure, Tone::None));
        assert_eq!(
            dark.encode([0.5, 0.25, 0.125]),
            bright.encode([0.25, 0.125, 0.0625])
        );
        // Without a tone, what is above 1 is clipped.
        assert_eq!(
            bright.encode([0.6, 0.125, 0.0]),
            dark.encode([1.0, 0.25, 0.0])
        );
    }

    #[test]
    fn codes_are_the_nearest() {
        let mut worst = [0.0_f64; 2];
        for tone in [Tone::None, Tone::Neutral] {
            for exposure in [-100.0, -3.3, 0.0, 100.0] {
                let display = DisplayTransform::new(exposure, tone);
                for i in 0..40_000_u32 {
                    // A spread of colours, some outside the gamut, over 20 stops.
                    let part = |k: u32| f64::from(i.wrapping_mul(k) % 1009) / 1009.0;
                    let size = libm::exp2(16.0 * part(7) - 12.0 - exposure);
                    let rgb = [part(1), part(31), part(577) - 0.1].map(|c| (c * size) as f32);
                    let exact = display.encode(rgb.map(f64::from));
                    for (c, exact) in exact.into_iter().enumerate() {
                        let errors = [
                            f64::from(display.rgb8(rgb)[c]) - 255.0 * exact,
                            f64::from(display.rgb16(rgb)[c]) - 65535.0 * exact,
                        ];
                        worst = [0, 1].map(|i| worst[i].max(errors[i].abs()));
                    }
                }
            }
        }
        assert!(worst[0] < 0.501 && worst[1] < 0.55, "{worst:?}");
    }
}
