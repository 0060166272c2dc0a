//! Finds the zero of a function between two places where its signs differ.

/// Newton's method stops after a step shorter than this share of the place to which it leads. Its error is then that
/// step squared times |f″/2f′|. For a radius that a ray grazes at an angle d from its turning point that factor is
/// 1/2d, so that the error is below 1e-16 down to d = 1e-6; nearer than that the equation's own rounding is larger.
const LAST_STEP: f64 = 1e-11;

/// The most iterations: bisection alone comes from any bracket down to neighbouring numbers in fewer.
const MAX_ITERATIONS: u32 = 128;

/// Returns the x between `low` and `high` where f(x) = 0. `f` returns its value and its derivative. Where `rising`, it
/// is negative at `low` and positive at `high`; otherwise the other way round.
///
/// Uses Newton's method, with a bisection in place of each step that leaves the bracket or is not half as long as the
/// step before it, as in `rtsafe` of Press et al., *Numerical Recipes*, §9.4.
pub(super) fn bracketed(
    low: f64,
    high: f64,
    rising: bool,
    mut f: impl FnMut(f64) -> (f64, f64),
) -> f64 {
    let (mut low, mut high) = (low, high);
    // Starts at the low end, so that a zero close to it keeps its relative precision. The first step may be any within
    // the bracket.
    let mut x = low;
    let mut previous = 4.0 * (high - low);
    for _ in 0..MAX_ITERATIONS {
        let (value, slope) = f(x);
        if value == 0.0 {
            return x;
        }
        if (value < 0.0) == rising {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let trusted = (newton - x).abs() < 0.5 * previous && low <= newton && newton <= high;
        let next = if trusted {
            newton
        } else {
            low + 0.5 * (high - low)
        };
        previous = (next - x).abs();
        x = next;
        if previous <= x.abs() * if trusted { LAST_STEP } else { f64::EPSILON } {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_simple_and_nearly_double_zeros() {
        let root = bracketed(0.0, 2.0, true, |x| (x * x - 2.0, 2.0 * x));
        assert!((root - core::f64::consts::SQRT_2).abs() < 4e-16);
        // Zeros at 1 ± 1e-5, the bracket's end where the slope vanishes.
        let root = bracketed(0.0, 1.0, true, |x| {
            (1e-10 - (1.0 - x) * (1.0 - x), 2.0 * (1.0 - x))
        });
        assert!((root - (1.0 - 1e-5)).abs() < 1e-15, "{root:?}");
    }

    #[test]
    fn holds_its_bracket_where_newton_would_leave_it() {
        // Newton's method alone diverges on a cube root.
        let f = |x: f64| {
            (
                libm::cbrt(x - 0.3),
                1.0 / (3.0 * libm::cbrt((x - 0.3) * (x - 0.3))),
            )
        };
        let root = bracketed(-1.0, 1.0, true, f);
        assert!((root - 0.3).abs() < 1e-15, "{root:?}");
    }

    #[test]
    fn keeps_relative_precision_near_zero() {
        let root = bracketed(0.0, 1.0, false, |x| (1e-300 - x, -1.0));
        assert!((root - 1e-300).abs() <= 1e-311, "{root:e}");
    }
}
