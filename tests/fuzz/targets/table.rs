//! Any bytes as a table's file.
#![no_main]

#[path = "../../common/fuzzed.rs"]
mod fuzzed;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzzed::table(bytes));
