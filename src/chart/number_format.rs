//! Numbers as readers expect them in sentences and on axes.

/// Formats a count with a comma between groups of three digits.
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

/// Formats a number below 1 with two significant digits, rounded up so that it remains an upper bound.
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

/// Formats a positive number with two significant digits, and digits before the point in groups of three.
pub(super) fn two_significant(value: f64) -> String {
    let decimals = 1 - libm::floor(libm::log10(value)) as i32;
    let scale = libm::pow(10.0, f64::from(decimals));
    let rounded = (value * scale).round() / scale;
    if rounded < 10.0 {
        format!("{rounded:.*}", decimals.max(0) as usize)
    } else {
        grouped(rounded.round() as usize)
    }
}

/// Formats an axis label: powers of ten as `10⁻⁹`, except between 0.1 and 100, and other numbers with up to three
/// decimals.
pub(super) fn axis_label(value: f64) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = libm::log10(value);
    if (-1.1..2.1).contains(&exponent) || (exponent - exponent.round()).abs() > 1e-6 {
        let decimals = format!("{value:.3}");
        return decimals
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned();
    }
    let digits = (exponent.round() as i32).to_string();
    let raised = digits.bytes().map(|digit| match digit {
        b'0'..=b'9' => RAISED[usize::from(digit - b'0')],
        _ => '⁻',
    });
    format!("10{}", raised.collect::<String>())
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
        let two = [1.13, 4512.0, 12.6, 0.278, 995.0, 9.96].map(two_significant);
        assert_eq!(two, ["1.1", "4,500", "13", "0.28", "1,000", "10"]);
    }

    #[test]
    fn axis_labels_are_powers_of_ten_or_short_decimals() {
        let labels = [1e-12, 1e3, 1.0, 100.0, 0.1, 1.25, 10.0].map(axis_label);
        assert_eq!(labels, ["10⁻¹²", "10³", "1", "100", "0.1", "1.25", "10"]);
    }
}
