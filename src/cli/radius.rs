//! A radius on the command line.

use crate::orbit::MIN_U;

/// Reads a radius that an option gives.
pub(super) fn radius(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(radius) if radius > 1.0 && radius <= 1.0 / MIN_U => Ok(radius),
        _ => Err(
            "a radius is a number above 1, the horizon, and at most 1e100, in Schwarzschild radii"
                .into(),
        ),
    }
}
