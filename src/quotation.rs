//! Somebody else's text within a message: short, and nothing in it that a terminal obeys.

/// What stands for a character in a message of one line.
pub(crate) fn printable(c: char) -> char {
    match c {
        '\t' => ' ',
        c if c.is_control() => char::REPLACEMENT_CHARACTER,
        c => c,
    }
}

/// A text of one line, the beginning of it if it has more characters than that.
pub(crate) fn beginning(line: &str, longest: usize) -> String {
    let mut text: String = line.chars().take(longest).map(printable).collect();
    if line.chars().nth(longest).is_some() {
        text.push('…');
    }
    text
}
