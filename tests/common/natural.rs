//! Exact arithmetic on the squares and cubes of floating-point numbers. It gives signs that no rounding can change, and
//! shares no code with the library.

use std::cmp::Ordering;

/// A natural number of any size, in digits of 32 bits, the lowest first; the highest is not 0.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Natural(Vec<u32>);

impl Natural {
    fn new(value: u64) -> Self {
        Self::trimmed(vec![value as u32, (value >> 32) as u32])
    }

    fn trimmed(mut digits: Vec<u32>) -> Self {
        while digits.last() == Some(&0) {
            digits.pop();
        }
        Self(digits)
    }

    fn shifted(&self, bits: usize) -> Self {
        let power = Self::trimmed([vec![0; bits / 32], vec![1 << (bits % 32)]].concat());
        self.times(&power)
    }

    fn plus(&self, other: &Self) -> Self {
        let mut carry = 0;
        let mut digits = Vec::new();
        for i in 0..=self.0.len().max(other.0.len()) {
            let digit = |n: &Self| u64::from(n.0.get(i).copied().unwrap_or(0));
            carry += digit(self) + digit(other);
            digits.push(carry as u32);
            carry >>= 32;
        }
        Self::trimmed(digits)
    }

    /// self − other; other must not be larger.
    fn minus(&self, other: &Self) -> Self {
        let mut borrow = 0;
        let mut digits = Vec::new();
        for i in 0..self.0.len() {
            let digit = |n: &Self| i64::from(n.0.get(i).copied().unwrap_or(0));
            let difference = digit(self) - digit(other) - borrow;
            borrow = i64::from(difference < 0);
            digits.push((difference + (borrow << 32)) as u32);
        }
        assert_eq!(borrow, 0, "a negative difference");
        Self::trimmed(digits)
    }

    fn times(&self, other: &Self) -> Self {
        let mut digits = vec![0_u32; self.0.len() + other.0.len() + 1];
        for (i, &a) in self.0.iter().enumerate() {
            let mut carry = 0;
            for (j, &b) in other.0.iter().enumerate() {
                carry += u64::from(a) * u64::from(b) + u64::from(digits[i + j]);
                digits[i + j] = carry as u32;
                carry >>= 32;
            }
            digits[i + other.0.len()] = carry as u32;
        }
        Self::trimmed(digits)
    }

    fn compared(&self, other: &Self) -> Ordering {
        let by_length = self.0.len().cmp(&other.0.len());
        by_length.then_with(|| self.0.iter().rev().cmp(other.0.iter().rev()))
    }

    /// The number times `2^exponent`, to a relative error of 2⁻⁵², from its three highest digits (65 bits or more).
    fn scaled(&self, exponent: i32) -> f64 {
        let count = self.0.len();
        let lowest = count.saturating_sub(3);
        let head = self.0[lowest..]
            .iter()
            .rev()
            .fold(0.0, |sum, &digit| sum * 4_294_967_296.0 + f64::from(digit));
        let lowest = i32::try_from(lowest).expect("a number of less than 2³¹ digits");
        libm::ldexp(head, 32 * lowest + exponent)
    }
}

/// `|x| = m 2^e` exactly.
fn parts(x: f64) -> (u64, i32) {
    let bits = x.abs().to_bits();
    let (exponent, fraction) = ((bits >> 52) as i32, bits & ((1 << 52) - 1));
    if exponent == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, exponent - 1075)
    }
}

/// `sign·factor·x^power`.
pub(crate) type Term = (i32, f64, u32);

/// `Σ factor·x^power` over terms of power 0 to 3: its sign exactly, its size to 2⁻⁵².
pub(crate) fn sum(terms: &[Term]) -> f64 {
    let scale = terms.iter().map(|&(_, x, _)| -parts(x).1).max();
    let scale = scale.unwrap_or(0).max(0);
    let (mut plus, mut minus) = (Natural::new(0), Natural::new(0));
    for &(factor, x, power) in terms {
        let (mantissa, exponent) = parts(x);
        let whole = Natural::new(mantissa).shifted((scale + exponent) as usize);
        let mut term = Natural::new(u64::from(factor.unsigned_abs()));
        for _ in 0..power {
            term = term.times(&whole);
        }
        term = term.shifted((3 - power) as usize * scale as usize);
        if (factor > 0) == (x > 0.0 || power % 2 == 0) {
            plus = plus.plus(&term);
        } else {
            minus = minus.plus(&term);
        }
    }
    match plus.compared(&minus) {
        Ordering::Equal => 0.0,
        Ordering::Greater => plus.minus(&minus).scaled(-3 * scale),
        Ordering::Less => -minus.minus(&plus).scaled(-3 * scale),
    }
}

/// `Δ = w² + u²(1 − u) − 4/27` of a ray with finite slope w: its sign exactly. It is never 0, since 4/27 has no end
/// in binary digits.
pub(crate) fn distance_from_critical(u: f64, w: f64) -> f64 {
    sum(&[(27, w, 2), (27, u, 2), (-27, u, 3), (-4, 1.0, 0)]) / 27.0
}

/// `(du/dφ)²` at inverse radius `at` on the orbit that starts at (u, w); negative where the orbit does not reach it.
pub(crate) fn squared_slope(u: f64, w: f64, at: f64) -> f64 {
    sum(&[(1, w, 2), (1, u, 2), (-1, u, 3), (-1, at, 2), (1, at, 3)])
}

/// The smallest non-negative slope at u for which `Δ > 0`: the boundary between capture and escape.
pub(crate) fn critical_slope(u: f64) -> f64 {
    let (mut below, mut above) = (0_u64, 1.0_f64.to_bits());
    while above - below > 1 {
        let middle = below.midpoint(above);
        if distance_from_critical(u, f64::from_bits(middle)) > 0.0 {
            above = middle;
        } else {
            below = middle;
        }
    }
    f64::from_bits(above)
}
