//! The frame rate of a film.

use core::fmt;

use crate::scene::error::SceneError;

/// The most frames a second.
const FASTEST: f64 = 1000.0;

/// Frames a second, as a fraction, as video files store it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rate {
    /// The numerator.
    pub frames: u32,
    /// The denominator.
    pub seconds: u32,
}

impl Default for Rate {
    /// 24 frames a second.
    fn default() -> Self {
        Self {
            frames: 24,
            seconds: 1,
        }
    }
}

impl Rate {
    /// The fraction that `fps` stands for: 24000/1001, 30000/1001 and 60000/1001 for television's 23.976, 29.97 and
    /// 59.94, else `fps` rounded to a thousandth.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a rate outside 0.001 to 1000.
    pub fn new(fps: f64) -> Result<Self, SceneError> {
        let thousandths = libm::rint(fps * 1000.0);
        if !(1.0..=1000.0 * FASTEST).contains(&thousandths) {
            let reason = "the frame rate is 0.001 to 1000 frames a second; the default is 24";
            return Err(SceneError::value("animation.fps", fps, reason));
        }
        for whole in [24, 30, 48, 60, 120] {
            let television = f64::from(whole) / 1.001;
            // Within the last digit that is usually written.
            if (fps - television).abs() < 0.0006 * television / 24.0 {
                return Ok(Self {
                    frames: whole * 1000,
                    seconds: 1001,
                });
            }
        }
        let (mut a, mut b) = (thousandths as u32, 1000);
        while b != 0 {
            (a, b) = (b, a % b);
        }
        Ok(Self {
            frames: thousandths as u32 / a,
            seconds: 1000 / a,
        })
    }
}

impl fmt::Display for Rate {
    /// As `24:1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.frames, self.seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_the_fractions_that_people_mean() {
        for (fps, fraction) in [
            (24.0, "24:1"),
            (25.0, "25:1"),
            (12.5, "25:2"),
            (23.976, "24000:1001"),
            (23.98, "1199:50"),
            (29.97, "30000:1001"),
            (59.94, "60000:1001"),
            (30000.0 / 1001.0, "30000:1001"),
            (0.001, "1:1000"),
            (1000.0, "1000:1"),
        ] {
            assert_eq!(Rate::new(fps).unwrap().to_string(), fraction, "{fps}");
        }
        for fps in [0.0, -24.0, f64::NAN, f64::INFINITY, 1e-9, 1e300] {
            assert!(Rate::new(fps).is_err(), "{fps}");
        }
    }
}
