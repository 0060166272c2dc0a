//! What is read from files: tables that are damaged, foreign or crafted, and any bytes at all.

#[path = "../common/fuzzed.rs"]
mod fuzzed;

mod corpora;
mod table_file;
