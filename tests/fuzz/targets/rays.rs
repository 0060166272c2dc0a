//! Any bytes as a list of rays.
#![no_main]

#[path = "../../common/fuzzed.rs"]
mod fuzzed;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzzed::rays(bytes));
