//! Numbers in a sentence.

/// A count with its thousands set apart.
pub(super) fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut grouped = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// A number below 1 to two digits, rounded up: what nothing is above.
pub(super) fn two_digits(value: f64) -> String {
    if value <= 0.0 {
        return "0".into();
    }
    let digits = 1 - libm::floor(libm::log10(value)) as i32;
    let scale = libm::pow(10.0, f64::from(digits));
    let rounded = (value * scale).ceil() / scale;
    if digits > 6 {
        format!("{rounded:.1e}")
    } else {
        format!("{rounded:.*}", digits.max(0) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_bounds_are_written_for_readers() {
        assert_eq!(grouped(14640), "14,640");
        assert_eq!(grouped(212), "212");
        assert_eq!(grouped(1_000_000), "1,000,000");
        assert_eq!(two_digits(6.31e-4), "0.00064");
        assert_eq!(two_digits(0.5), "0.50");
        assert_eq!(two_digits(0.0), "0");
        assert_eq!(two_digits(3.21e-9), "3.3e-9");
    }
}
