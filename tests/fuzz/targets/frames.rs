//! Any bytes as a range of frames.
#![no_main]

#[path = "../../common/fuzzed.rs"]
mod fuzzed;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzzed::frames(bytes));
