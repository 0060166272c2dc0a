//! Guards against bytes that depend on the number of threads or on the processor. The program is run with one thread,
//! with two, and with the C library kept from its code for FMA and AVX2.

use std::fs;
use std::path::Path;

use tempfile::tempdir;

use crate::harness::{REFERENCE_RAYS, darkness, finish};

/// Ways to run the program that must give the same bytes: threads, and settings of the C library.
const WAYS: [(&str, Option<&str>); 3] = [
    ("1", None),
    ("2", None),
    ("2", Some("glibc.cpu.hwcaps=-FMA,-AVX2")),
];

/// Runs the program in one of the ways, and returns its standard output.
fn run(folder: &Path, (threads, tunables): (&str, Option<&str>), args: &[&str]) -> Vec<u8> {
    let mut command = darkness(folder, args);
    command
        .env_remove("GLIBC_TUNABLES")
        .env("RAYON_NUM_THREADS", threads);
    if args[0] != "trace" {
        command.args(["--threads", threads]);
    }
    if let Some(tunables) = tunables {
        command.env("GLIBC_TUNABLES", tunables);
    }
    finish(&mut command).0
}

/// Runs the program in every way, asserts that the output is the same, and returns it.
fn same_bytes(folder: &Path, args: &[&str]) -> Vec<u8> {
    let [first, others @ ..] = WAYS;
    let expected = run(folder, first, args);
    assert!(!expected.is_empty(), "{args:?} printed nothing");
    for way in others {
        assert!(
            run(folder, way, args) == expected,
            "{args:?}: other bytes with {way:?} than with {first:?}"
        );
    }
    expected
}

#[test]
fn tables_pictures_and_angles_do_not_depend_on_threads_or_processor() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let tables = WAYS.map(|way| {
        run(
            here,
            way,
            &["table", "standard", "--force", "-o", "a.table"],
        );
        fs::read(here.join("a.table")).unwrap()
    });
    assert!(tables.iter().all(|table| *table == tables[0]));

    let draw = ["render", "--size", "128x72", "-o", "-"];
    for scene in ["classic", "photon-ring"] {
        for method in ["table", "exact", "integrate"] {
            let options = [scene, "--table", "a.table", "--method", method];
            let picture = same_bytes(here, &[&draw[..], &options].concat());
            assert!(picture.starts_with(b"\x89PNG"));
        }
    }
    // Frames whose cameras are computed with sines, cosines and arcs.
    for scene in ["orbit", "approach", "tilt"] {
        let options = [scene, "--table", "a.table", "--frames", "17-180x41"];
        let film = same_bytes(here, &[&draw[..], &options, &["--format", "raw"]].concat());
        assert_eq!(film.len(), 4 * 128 * 72);
    }
    for method in ["table", "exact", "integrate"] {
        let options = ["--table", "a.table", "--method", method];
        let trace = ["trace", REFERENCE_RAYS];
        let rows = same_bytes(here, &[&trace[..], &options].concat());
        assert!(rows.len() > 500_000, "only {} bytes", rows.len());
    }
}
