//! Guards against what fuzzers found, and against the loss of what they reached: every kept input is tried again.

use std::fs;
use std::path::Path;

use crate::fuzzed;

/// Tries all inputs that were kept for one target.
fn replay(target: &str, try_one: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fuzz/corpus")
        .join(target);
    let entries =
        fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut tried = 0;
    for entry in entries {
        let path = entry.unwrap().path();
        let bytes = fs::read(&path).unwrap();
        let tried_one = std::panic::catch_unwind(|| try_one(&bytes));
        assert!(tried_one.is_ok(), "{} fails", path.display());
        tried += 1;
    }
    assert!(tried >= 10, "{tried} inputs in {}", folder.display());
}

#[test]
fn tables() {
    replay("table", fuzzed::table);
}

#[test]
fn scenes() {
    replay("scene", fuzzed::scene);
}

#[test]
fn ranges_of_frames() {
    replay("frames", fuzzed::frames);
}

#[test]
fn lists_of_rays() {
    replay("rays", fuzzed::rays);
}
