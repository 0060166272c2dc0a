//! Reading files: tables that are damaged, foreign or crafted, and bytes of any kind.

#[path = "../common/fuzzed.rs"]
mod fuzzed;

mod corpora;
mod table_file;
