//! A star field that looks like a night sky and needs no catalogue.
//!
//! * **Magnitudes.** The number of stars brighter than m is that of the whole sky,
//!   `log₁₀ N = 0.64 + 0.53 m − 0.004 m²`. It fits the counts of the Hipparcos catalogue (ESA 1997, SP-1200) from m = 1
//!   (15 stars) to m = 8 (40,858) within a fifth. A uniform space has 0.6 m; dust and the galaxy's shape bend the
//!   curve. The star of rank k, from 0, has a count N drawn uniformly from k + ½ to k + 1½: the first star has a
//!   magnitude of about −1, and a field of 5000 stars ends near m = 6, as the naked eye does.
//! * **Places.** Six stars in ten are uniform on the sphere. The others have a galactic latitude b with
//!   `sin b = 0.35 (U₁ + U₂ − U₃ − U₄)`, U uniform in 0 to 1, so that the sky is about 3.5 times as dense at the
//!   galactic equator as at its poles. The galactic pole is the real one: right ascension 192.85948°, declination
//!   27.12825°.
//! * **Temperatures.** 55 % are log-normal about 4700 K (σ = 0.18), 45 % about 9500 K (σ = 0.33): the orange giants and
//!   the blue-white stars that make up the visible sky. The normal distribution is the sum of four uniform numbers,
//!   which ends at 3.5 σ: all temperatures are between 2500 K and 30,000 K.

use std::f64::consts::TAU;

use glam::DVec3;

use super::star::{Star, StarField};

/// The galactic axes: two of the plane, and the pole.
const GALACTIC: [(f64, f64); 3] = [
    // The galactic pole's right ascension plus 90° is the ascending node of the galactic plane.
    (282.85948, 0.0),
    (12.85948, 62.87175),
    (192.85948, 27.12825),
];

impl StarField {
    /// Makes up `count` stars, from the brightest to the faintest, and drops those fainter than `magnitude_limit`.
    /// A star takes 32 bytes.
    ///
    /// The field depends on nothing but the arguments; a field of fewer stars with the same seed is its beginning.
    pub fn synthetic(count: u32, seed: u64, magnitude_limit: Option<f64>) -> Self {
        let magnitude_limit = magnitude_limit.unwrap_or(f64::INFINITY);
        let axes = GALACTIC
            .map(|(longitude, latitude)| Star::new(longitude, latitude, 0.0, 0.0).direction);
        let mut random = Random(seed);
        let stars = (0..count)
            .map(|rank| {
                let magnitude = magnitude_of_count(f64::from(rank) + 0.5 + random.uniform());
                (magnitude, random.direction(axes), random.temperature())
            })
            // Each star is fainter than the one before.
            .take_while(|&(magnitude, ..)| magnitude <= magnitude_limit)
            .map(|(magnitude, direction, temperature)| Star::at(direction, magnitude, temperature))
            .collect();
        Self { stars }
    }
}

/// Returns the magnitude m with `log₁₀ count = 0.64 + 0.53 m − 0.004 m²`, for counts up to 10¹⁸.
fn magnitude_of_count(count: f64) -> f64 {
    let missing = libm::log10(count) - 0.64;
    2.0 * missing / (0.53 + (0.53 * 0.53 - 4.0 * 0.004 * missing).sqrt())
}

/// `SplitMix64` (Steele, Lea & Flood 2014, *Fast splittable pseudorandom number generators*, OOPSLA, figure 17).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number from 0, inclusive, to 1, exclusive.
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 * f64::EPSILON * 0.5
    }

    /// Returns a number from −2 to 2 with a bell-shaped density and the standard deviation 1/√3.
    fn bell(&mut self) -> f64 {
        self.uniform() + self.uniform() - self.uniform() - self.uniform()
    }

    fn direction(&mut self, axes: [DVec3; 3]) -> DVec3 {
        let sin_latitude = if self.uniform() < 0.6 {
            2.0 * self.uniform() - 1.0
        } else {
            0.35 * self.bell()
        };
        let cos_latitude = (1.0 - sin_latitude * sin_latitude).sqrt();
        let (sin, cos) = libm::sincos(TAU * self.uniform());
        let across = axes[0] * cos + axes[1] * sin;
        (across * cos_latitude + axes[2] * sin_latitude).normalize()
    }

    fn temperature(&mut self) -> f64 {
        let (middle, deviation) = if self.uniform() < 0.55 {
            (4700.0, 0.18)
        } else {
            (9500.0, 0.33)
        };
        let normal = self.bell() * 3.0_f64.sqrt();
        middle * libm::exp(deviation * normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn magnitude(star: &Star) -> f64 {
        -2.5 * libm::log10(f64::from(star.irradiance))
    }

    #[test]
    fn generator_is_splitmix64() {
        // The first numbers of the seed 1234567, as other implementations give them.
        let mut random = Random(1_234_567);
        let numbers = [random.next(), random.next(), random.next()];
        assert_eq!(
            numbers,
            [
                6_457_827_717_110_365_317,
                3_203_168_211_198_807_973,
                9_817_491_932_198_370_423
            ]
        );
    }

    #[test]
    fn axes_are_orthogonal_and_right_handed() {
        let [x, y, z] = GALACTIC.map(|(l, b)| Star::new(l, b, 0.0, 0.0).direction);
        assert!(x.cross(y).distance(z) < 1e-12);
    }

    #[test]
    fn fields_are_the_same_everywhere_and_begin_alike() {
        let field = StarField::synthetic(20_000, 1, None);
        assert_eq!(field.stars.len(), 20_000);
        assert_eq!(StarField::synthetic(500, 1, None).stars, field.stars[..500]);
        assert_ne!(StarField::synthetic(500, 2, None).stars, field.stars[..500]);
        let mut hash = 0_u64;
        for star in &field.stars {
            let direction = star.direction.to_array().map(f64::to_bits);
            let light = [star.irradiance, star.temperature].map(|value| value.to_bits().into());
            for bits in direction.into_iter().chain(light) {
                hash = (hash ^ bits)
                    .wrapping_mul(0x0000_0100_0000_01b3)
                    .rotate_left(29);
            }
        }
        assert_eq!(hash, 0x2ed6_7440_5a1d_ea95, "{hash:#x}");
    }

    #[test]
    fn magnitudes_are_those_of_the_sky() {
        let field = StarField::synthetic(50_000, 7, None);
        let first = magnitude(&field.stars[0]);
        assert!((-1.9..-0.7).contains(&first), "{first}");
        assert!(
            field
                .stars
                .is_sorted_by(|a, b| a.irradiance >= b.irradiance)
        );
        // Hipparcos: stars brighter than 1, 2, … 8.
        for (m, count) in (1..).zip([15, 49, 172, 511, 1600, 4968, 15_328, 40_858]) {
            let limited = StarField::synthetic(50_000, 7, Some(f64::from(m)));
            assert_eq!(limited.stars[..], field.stars[..limited.stars.len()]);
            let ratio = limited.stars.len() as f64 / f64::from(count);
            assert!((0.8..1.2).contains(&ratio), "{m}: {ratio}");
        }
    }

    #[test]
    fn places_and_temperatures() {
        let stars = StarField::synthetic(100_000, 3, None).stars;
        let pole = Star::new(192.85948, 27.12825, 0.0, 0.0).direction;
        let share = |least: f64, most: f64| {
            let within = |star: &&Star| (least..most).contains(&star.direction.dot(pole).abs());
            stars.iter().filter(within).count() as f64 / (stars.len() as f64 * (most - least))
        };
        let ratio = share(0.0, 0.02) / share(0.8, 1.0);
        assert!((3.0..4.0).contains(&ratio), "{ratio}");
        let mean: DVec3 = stars.iter().map(|star| star.direction).sum::<DVec3>() / 100_000.0;
        assert!(mean.length() < 0.01, "{mean}");
        for star in &stars {
            assert!((star.direction.length() - 1.0).abs() < 1e-15);
            assert!((2500.0..30_000.0).contains(&star.temperature));
        }
    }
}
