//! Numbers over time, through given values at given times.
//!
//! The smooth interpolant is a piecewise cubic Hermite polynomial with the slopes of Fritsch & Butland (1984), SIAM J.
//! Sci. Stat. Comput. 5, 300. Between two times it stays within the interval of their values; its slope is 0 where the
//! values turn, and at the first and the last time.

use crate::scene::file::Interpolation;

/// `N` independent numbers over time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Track<const N: usize> {
    times: Vec<f64>,
    values: Vec<[f64; N]>,
    /// The slopes at the times; empty for linear motion.
    slopes: Vec<[f64; N]>,
}

impl<const N: usize> Track<N> {
    /// A track through at least one value, at rising times.
    pub(super) fn new(keys: &[(f64, [f64; N])], interpolation: Interpolation) -> Self {
        let times: Vec<f64> = keys.iter().map(|key| key.0).collect();
        let values: Vec<[f64; N]> = keys.iter().map(|key| key.1).collect();
        let slopes = match interpolation {
            Interpolation::Linear => Vec::new(),
            Interpolation::Smooth => (0..keys.len())
                .map(|k| core::array::from_fn(|i| slope(&times, |k| values[k][i], k)))
                .collect(),
        };
        Self {
            times,
            values,
            slopes,
        }
    }

    /// The same; without keys, a track that stays at `value`.
    pub(super) fn or_still(
        keys: &[(f64, [f64; N])],
        value: [f64; N],
        interpolation: Interpolation,
    ) -> Self {
        if keys.is_empty() {
            Self::new(&[(1.0, value)], interpolation)
        } else {
            Self::new(keys, interpolation)
        }
    }

    /// The value at a time.
    pub(super) fn at(&self, time: f64) -> [f64; N] {
        let Segment { first, span, share } = match segment(&self.times, time) {
            Ok(segment) => segment,
            Err(key) => return self.values[key],
        };
        let (from, to) = (self.values[first], self.values[first + 1]);
        core::array::from_fn(|i| {
            let (from, to) = (from[i], to[i]);
            let change = to - from;
            let value = match self.slopes.get(first..first + 2) {
                None => from + change * share,
                Some(slopes) => {
                    let (a, b) = (span * slopes[0][i], span * slopes[1][i]);
                    let (square, cube) = (3.0 * change - 2.0 * a - b, a + b - 2.0 * change);
                    from + share * (a + share * (square + share * cube))
                }
            };
            // Only rounding can take it outside.
            value.clamp(from.min(to), from.max(to))
        })
    }
}

/// A time between two of several times.
pub(super) struct Segment {
    /// The index of the earlier time.
    pub(super) first: usize,
    /// The time between them.
    pub(super) span: f64,
    /// The share of the span that has passed.
    pub(super) share: f64,
}

/// Finds the two times on either side of `time`.
///
/// # Errors
/// The index of the time that it equals, or beyond which it is.
pub(super) fn segment(times: &[f64], time: f64) -> Result<Segment, usize> {
    let after = times.partition_point(|&key| key <= time);
    if after == 0 {
        return Err(0);
    }
    let first = after - 1;
    if after == times.len() || times[first] == time {
        return Err(first);
    }
    let span = times[after] - times[first];
    Ok(Segment {
        first,
        span,
        share: (time - times[first]) / span,
    })
}

/// The slope at time k: 0 at the ends and where the values turn, else Fritsch & Butland's mean of the slopes on either
/// side (their equation for unequal spacings, as in Fritsch's PCHIP).
fn slope(times: &[f64], value: impl Fn(usize) -> f64, k: usize) -> f64 {
    if k == 0 || k + 1 == times.len() {
        return 0.0;
    }
    let (before, after) = (times[k] - times[k - 1], times[k + 1] - times[k]);
    let to = (value(k) - value(k - 1)) / before;
    let from = (value(k + 1) - value(k)) / after;
    if to * from <= 0.0 {
        return 0.0;
    }
    let (first, second) = (2.0 * after + before, after + 2.0 * before);
    (first + second) / (first / to + second / from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(values: &[(f64, f64)]) -> Vec<(f64, [f64; 1])> {
        values
            .iter()
            .map(|&(time, value)| (time, [value]))
            .collect()
    }

    #[test]
    fn it_goes_through_its_keys_and_stays_beyond_them() {
        let keys = keys(&[(1.0, 60.0), (10.0, 7.0), (14.0, 7.0), (40.0, 1.2)]);
        for interpolation in [Interpolation::Smooth, Interpolation::Linear] {
            let track = Track::new(&keys, interpolation);
            for &(time, value) in &keys {
                assert_eq!(track.at(time), value);
            }
            assert_eq!(track.at(0.0), [60.0]);
            assert_eq!(track.at(1e9), [1.2]);
            // Between equal values not a bit moves.
            assert_eq!(track.at(12.3), [7.0]);
        }
    }

    #[test]
    fn it_is_monotone_and_its_slope_has_no_jumps() {
        let keys = keys(&[(1.0, 60.0), (10.0, 30.0), (11.0, 5.0), (40.0, 1.2)]);
        let track = Track::new(&keys, Interpolation::Smooth);
        let times: Vec<f64> = (0..=40_000).map(|i| 1e-3 * f64::from(i)).collect();
        let values: Vec<f64> = times.iter().map(|&time| track.at(time)[0]).collect();
        assert!(values.is_sorted_by(|a, b| a >= b));
        let slopes: Vec<f64> = values
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) / 1e-3)
            .collect();
        // The second derivative is below 250 everywhere: 6 times the change over the square of the span, at most.
        for pair in slopes.windows(2) {
            assert!((pair[1] - pair[0]).abs() < 0.25, "{pair:?}");
        }
        assert!(slopes[999].abs() < 1e-9 && slopes[39_998].abs() < 1e-3);
    }

    #[test]
    fn linear_is_linear() {
        let track = Track::new(&keys(&[(1.0, 0.0), (5.0, 8.0)]), Interpolation::Linear);
        assert_eq!(track.at(2.5), [3.0]);
    }

    #[test]
    fn smooth_between_two_is_the_smooth_step() {
        let track = Track::new(&keys(&[(0.0, 0.0), (1.0, 1.0)]), Interpolation::Smooth);
        for share in [0.1, 0.25, 0.5, 0.9] {
            let expected = share * share * (3.0 - 2.0 * share);
            assert!((track.at(share)[0] - expected).abs() < 1e-15);
        }
    }
}
