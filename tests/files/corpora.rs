//! Guards against the return of what fuzzers found, and against losing what they reached: every input that was kept is
//! tried again.

use std::io::Read;
use std::panic::catch_unwind;

use flate2::read::GzDecoder;

use crate::fuzzed;

/// All inputs, for every target: a tar file, compressed.
const CORPUS: &[u8] = include_bytes!("../fuzz/corpus.tar.gz");

/// The names and the bytes of a target's inputs.
///
/// A tar file is a header of 512 bytes for each file, and the file's bytes filled up to a multiple of 512. The header
/// has the name from byte 0 and the length, in octal digits, from byte 124. Zeros follow the last file.
fn inputs(target: &str) -> Vec<(String, Vec<u8>)> {
    let mut bytes = Vec::new();
    GzDecoder::new(CORPUS).read_to_end(&mut bytes).unwrap();
    let text = |field: &[u8]| {
        let field = field.split(|&byte| byte == 0).next().unwrap();
        String::from_utf8(field.to_vec()).unwrap()
    };
    let (mut inputs, mut rest) = (Vec::new(), &bytes[..]);
    while rest[0] != 0 {
        let (header, after) = rest.split_at(512);
        let length = usize::from_str_radix(text(&header[124..136]).trim(), 8).unwrap();
        let name = text(&header[..100]);
        if name.starts_with(&format!("corpus/{target}/")) {
            inputs.push((name, after[..length].to_vec()));
        }
        rest = &after[length.next_multiple_of(512)..];
    }
    inputs
}

/// Tries all inputs that were kept for one target.
fn replay(target: &str, count: usize, try_one: fn(&[u8])) {
    let inputs = inputs(target);
    assert_eq!(inputs.len(), count, "inputs for {target}");
    for (name, bytes) in inputs {
        let result = catch_unwind(|| try_one(&bytes));
        assert!(result.is_ok(), "{name} fails");
    }
}

#[test]
fn every_kept_table_is_refused_or_can_be_used() {
    replay("table", 106, fuzzed::table);
}

#[test]
fn every_kept_scene_is_refused_or_can_be_drawn() {
    replay("scene", 323, fuzzed::scene);
}

#[test]
fn every_kept_range_of_frames_is_refused_or_can_be_counted() {
    replay("frames", 66, fuzzed::frames);
}

#[test]
fn every_kept_list_of_rays_is_refused_or_can_be_followed() {
    replay("rays", 39, fuzzed::rays);
}
