//! Guards against bytes that depend on the number of threads or on the processor. The program is run with one thread,
//! with two, with three, and with the C library kept from its code for FMA and AVX2, or for all that came after SSE2.

use std::fs;
use std::path::Path;

use tempfile::tempdir;

use crate::harness::{REFERENCE_RAYS, darkness, finish};

/// Ways to run the program that must give the same bytes: threads, and settings of the C library.
const WAYS: [(&str, Option<&str>); 5] = [
    ("1", None),
    ("2", None),
    ("3", None),
    ("2", Some("glibc.cpu.hwcaps=-FMA,-AVX2")),
    (
        "3",
        Some("glibc.cpu.hwcaps=-FMA,-FMA4,-AVX,-AVX2,-AVX512F,-SSE4_1,-SSE4_2,-SSSE3,-ERMS"),
    ),
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

/// Runs the program in every way, asserts that the bytes are the same, and returns them: its standard output, or the
/// file that it writes.
fn same_bytes(folder: &Path, args: &[&str], file: Option<&str>) -> Vec<u8> {
    let bytes = |way| {
        let output = file.map(|file| ["-o", file]);
        let all = [args, output.as_slice().as_flattened()].concat();
        let printed = run(folder, way, &all);
        let Some(file) = file else {
            return printed;
        };
        let written = fs::read(folder.join(file)).unwrap();
        fs::remove_file(folder.join(file)).unwrap();
        written
    };
    let [first, others @ ..] = WAYS;
    let expected = bytes(first);
    assert!(!expected.is_empty(), "{args:?} wrote nothing");
    for way in others {
        assert!(
            bytes(way) == expected,
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
            let picture = same_bytes(here, &[&draw[..], &options].concat(), None);
            assert!(picture.starts_with(b"\x89PNG"));
        }
    }
    // Frames whose cameras are computed with sines, cosines and arcs.
    for scene in ["orbit", "approach", "tilt"] {
        let options = [scene, "--table", "a.table", "--frames", "17-180x41"];
        let film = same_bytes(
            here,
            &[&draw[..], &options, &["--format", "raw"]].concat(),
            None,
        );
        assert_eq!(film.len(), 4 * 128 * 72);
    }
    for method in ["table", "exact", "integrate"] {
        let options = ["--table", "a.table", "--method", method];
        let trace = ["trace", REFERENCE_RAYS];
        let rows = same_bytes(here, &[&trace[..], &options].concat(), None);
        assert!(rows.len() > 500_000, "only {} bytes", rows.len());
    }
    let paths = same_bytes(here, &["trace", REFERENCE_RAYS, "--paths", "9"], None);
    assert!(paths.len() > 1_000_000, "only {} bytes", paths.len());
}

#[test]
fn skies_do_not_depend_on_threads_or_processor() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    run(here, WAYS[0], &["table", "standard", "-o", "a.table"]);
    let noise = |x: u32, y: u32| image::Rgb([(37 * x) as u8, (59 * y) as u8, (x * y) as u8]);
    let panorama = image::RgbImage::from_fn(64, 32, noise);
    panorama.save(here.join("sky.png")).unwrap();
    let sky = "[camera]\nposition = [20, 0, 4]\nfov = 50\n[sky]\npanorama = \"sky.png\"\n\
        [image]\nwidth = 96\nheight = 54\n";
    fs::write(here.join("panorama.toml"), sky).unwrap();
    for scene in ["grid", "stars", "panorama.toml"] {
        for method in ["table", "exact", "integrate"] {
            let draw = [
                "render", scene, "--size", "96x54", "--table", "a.table", "--method", method,
            ];
            let picture = same_bytes(here, &draw, Some("frame.png"));
            assert!(picture.len() > 1000, "only {} bytes", picture.len());
            let layers = ["--layers", "colour,sky,sky_uv"];
            same_bytes(here, &[&draw[..], &layers].concat(), Some("frame.exr"));
        }
    }
    let film = "render flyby --size 96x54 --table a.table --frames 17-180x41";
    same_bytes(here, &film.split(' ').collect::<Vec<_>>(), Some("film.y4m"));
}

#[test]
fn light_does_not_depend_on_threads_or_processor() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    run(here, WAYS[0], &["table", "standard", "-o", "a.table"]);
    let layers = "coverage,order,radius,azimuth,redshift,emission_cosine,temperature,colour";
    for scene in ["lit", "rings"] {
        for method in ["table", "exact", "integrate"] {
            let draw = [
                "render", scene, "--size", "96x54", "--table", "a.table", "--method", method,
            ];
            let picture = same_bytes(here, &draw, Some("frame.png"));
            // Eight bits a sample, in colour.
            assert_eq!(picture[24..26], [8, 2]);
            let data = same_bytes(
                here,
                &[&draw[..], &["--layers", layers]].concat(),
                Some("frame.exr"),
            );
            assert!(data.len() > 10_000, "only {} bytes", data.len());
        }
    }
    let film = "render lit-orbit --size 96x54 --table a.table --frames 17-180x41";
    let film = same_bytes(here, &film.split(' ').collect::<Vec<_>>(), Some("film.y4m"));
    assert!(film.len() > 4 * 96 * 54 * 3 / 2);
}
