//! Any bytes as a scene.
#![no_main]

#[path = "../../common/fuzzed.rs"]
mod fuzzed;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzzed::scene(bytes));
