//! Numbers and pictures by chance, always the same.

use std::f64::consts::TAU;

/// A generator of numbers: `SplitMix64`.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Returns a number in [0, 1).
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Returns a picture of `2 height × height` whose amplitudes fall as 1/frequency, from 0 to 1. The height is a power of
/// two.
pub(crate) fn one_over_f(height: usize, random: &mut Random) -> Vec<f64> {
    let width = 2 * height;
    let signed = |i: usize, n: usize| if 2 * i > n { i as f64 - n as f64 } else { i as f64 } / n as f64;
    let mut rows: Vec<Vec<[f64; 2]>> = Vec::new();
    for j in 0..height {
        let amplitude = |i| libm::hypot(signed(i, width), signed(j, height)).recip();
        let row = (0..width).map(|i| {
            let (sin, cos) = libm::sincos(TAU * random.number());
            let amplitude = if i + j == 0 { 0.0 } else { amplitude(i) };
            [amplitude * cos, amplitude * sin]
        });
        rows.push(fourier(&row.collect::<Vec<_>>()));
    }
    let mut picture = vec![0.0; width * height];
    for i in 0..width {
        let column = fourier(&rows.iter().map(|row| row[i]).collect::<Vec<_>>());
        for (j, [real, _]) in column.into_iter().enumerate() {
            picture[j * width + i] = real;
        }
    }
    let (low, high) = picture
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), &x| {
            (low.min(x), high.max(x))
        });
    picture.iter().map(|x| (x - low) / (high - low)).collect()
}

/// Returns the Fourier transform; the length is a power of two.
fn fourier(values: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let n = values.len();
    if n == 1 {
        return values.to_vec();
    }
    let half = |parity| {
        fourier(
            &values
                .iter()
                .copied()
                .skip(parity)
                .step_by(2)
                .collect::<Vec<_>>(),
        )
    };
    let (even, odd) = (half(0), half(1));
    let mut result = vec![[0.0; 2]; n];
    for k in 0..n / 2 {
        let (sin, cos) = libm::sincos(TAU * k as f64 / n as f64);
        let ([a, b], [c, d]) = (even[k], odd[k]);
        let [c, d] = [c * cos - d * sin, c * sin + d * cos];
        result[k] = [a + c, b + d];
        result[k + n / 2] = [a - c, b - d];
    }
    result
}
