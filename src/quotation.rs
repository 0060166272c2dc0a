//! Foreign text within a message: short, and without control characters.

/// Replaces a control character, for a message of one line.
pub(crate) fn printable(c: char) -> char {
    match c {
        '\t' => ' ',
        c if c.is_control() => char::REPLACEMENT_CHARACTER,
        c => c,
    }
}

/// The first `longest` characters of a line, without control characters.
pub(crate) fn beginning(line: &str, longest: usize) -> String {
    let mut text: String = line.chars().take(longest).map(printable).collect();
    if line.chars().nth(longest).is_some() {
        text.push('…');
    }
    text
}
