//! Guards against files of data that other programs do not read, or read otherwise: OpenEXR's and NumPy's own readers,
//! and OpenImageIO's tools.
//!
//! A reader that is not installed is skipped, unless `DARKNESS_TOOLS` names it.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use tempfile::tempdir;

use crate::harness::{done, tool_prints};
use crate::tools;

const READER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reader/read_frame.py");

/// A small frame with light.
const LIT: [&str; 4] = ["render", "lit", "--size", "96x54"];

/// What the reader prints of a file: texts by their names, and channels by theirs.
fn read(here: &Path, file: &str) -> (BTreeMap<String, String>, BTreeMap<String, String>) {
    let text = String::from_utf8(tool_prints(here, &["python3", READER, file])).unwrap();
    let (mut texts, mut channels) = (BTreeMap::new(), BTreeMap::new());
    for line in text.lines() {
        if let Some((name, text)) = line.split_once(": ") {
            texts.insert(name.to_owned(), text.to_owned());
        } else {
            let (name, values) = line.split_once(' ').unwrap();
            channels.insert(name.to_owned(), values.to_owned());
        }
    }
    (texts, channels)
}

#[test]
fn openexr_and_numpy_read_the_same_layers() {
    if !(tools::has_module("numpy") && tools::has_module("OpenEXR")) {
        return;
    }
    let folder = tempdir().unwrap();
    let here = folder.path();
    let layers = "coverage,order,radius,azimuth,redshift,emission_cosine,temperature,colour";
    for file in ["all.exr", "all.npz"] {
        let options = ["--layers", layers, "-o", file];
        done(here, &[&LIT[..], &options].concat());
    }
    let (exr_texts, exr) = read(here, "all.exr");
    let (npz_texts, npz) = read(here, "all.npz");
    for (texts, software) in [(&exr_texts, "software"), (&npz_texts, "Software")] {
        assert_eq!(
            texts[software],
            concat!("darkness ", env!("CARGO_PKG_VERSION"))
        );
        assert_eq!(texts["darkness:frame"], "1");
        assert_eq!(texts["darkness:scene"].len(), 64);
        assert_eq!(texts["darkness:table"], exr_texts["darkness:table"]);
    }
    assert_eq!(exr.len(), 7 + 4);
    assert_eq!(npz.len(), 7 + 3);
    for layer in layers.split(',').filter(|layer| *layer != "colour") {
        let (exr, npz) = (&exr[&format!("disk.{layer}")], &npz[layer]);
        assert!(exr.starts_with("float32 54x96 "), "{exr}");
        if layer == "order" {
            assert_eq!(npz.replace("int8", "float32"), *exr);
        } else {
            assert_eq!(npz, exr, "{layer}");
        }
    }
    for (i, channel) in ["R", "G", "B"].iter().enumerate() {
        assert_eq!(exr[*channel], npz[&format!("colour.{i}")]);
    }
    assert!(exr["A"].starts_with("float32 54x96 "));

    // What is there if no layer is named.
    for (scene, file, names) in [
        ("lit", "f.exr", &["A", "B", "G", "R", "disk.coverage"][..]),
        (
            "lit",
            "f.npz",
            &["colour.0", "colour.1", "colour.2", "coverage"],
        ),
        ("classic", "f.exr", &["disk.coverage"]),
        ("classic", "f.npz", &["coverage"]),
    ] {
        done(here, &["render", scene, "--size", "96x54", "-o", file]);
        assert!(read(here, file).1.keys().eq(names), "{scene} {file}");
    }
}

#[test]
fn openimageio_reads_channels_attributes_and_values() {
    if !(tools::has("iinfo") && tools::has("oiiotool")) {
        return;
    }
    let folder = tempdir().unwrap();
    let here = folder.path();
    done(here, &[&LIT[..], &["-o", "f.exr"]].concat());
    let run = |line: &[&str]| String::from_utf8(tool_prints(here, line)).unwrap();
    let told = run(&["iinfo", "-v", "f.exr"]);
    for words in [
        "96 x   54, 5 channel, float openexr",
        "channel list: R, G, B, A, disk.coverage",
        "chromaticities: 0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329",
        "compression: \"zip\"",
        concat!("software: \"darkness ", env!("CARGO_PKG_VERSION"), "\""),
        "darkness:frame: \"1\"",
        "oiio:subimages: 1",
    ] {
        assert!(told.contains(words), "no {words} in:\n{told}");
    }

    // The last channel is the coverage, in rows from the top. It is that of the mask.
    let data = run(&["oiiotool", "--dumpdata", "f.exr"]);
    let pixels = data.lines().filter(|line| line.contains("Pixel ("));
    let coverage = pixels.map(|line| line.rsplit(' ').next().unwrap().parse::<f32>().unwrap());
    let coverage: Vec<f32> = coverage.collect();
    done(
        here,
        &["render", "classic", "--size", "96x54", "-o", "f.raw"],
    );
    let mask = fs::read(here.join("f.raw")).unwrap();
    assert_eq!(coverage.len(), mask.len());
    for (coverage, grey) in coverage.into_iter().zip(mask) {
        let scaled = coverage * 255.0;
        assert!(
            (scaled - f32::from(grey)).abs() < 0.501,
            "{scaled} and {grey}"
        );
    }
}
