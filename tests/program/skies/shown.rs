//! What formats, methods and verbs show of a sky.

use std::fs;
use std::io::Read as _;
use std::path::Path;

use super::{STILL, channels, with_skies};
use crate::harness::{PATTERN, done, printed};
use crate::tools;

/// A file of a ZIP archive.
fn inflated(archive: &[u8], name: &str) -> Vec<u8> {
    let name = format!("{name}.npy");
    let at = archive
        .windows(name.len())
        .position(|window| window == name.as_bytes());
    let deflated = &archive[at.unwrap() + name.len()..];
    let mut bytes = Vec::new();
    flate2::read::DeflateDecoder::new(deflated)
        .read_to_end(&mut bytes)
        .unwrap();
    bytes
}

/// The pixels of a picture, as samples of 16 bits.
fn samples(path: &Path) -> Vec<u16> {
    image::open(path).unwrap().into_rgb16().into_raw()
}

#[test]
fn every_format_shows_the_sky() {
    let folder = with_skies();
    let here = folder.path();
    let render = |options: &[&str]| done(here, &[&["render", "moving.toml"], options].concat());
    render(&["-o", PATTERN]);
    render(&["-o", "wide/f_####.png", "--bits", "16"]);
    render(&["-o", "a.raw"]);
    render(&["-o", "a.y4m"]);
    let raw = fs::read(here.join("a.raw")).unwrap();
    assert_eq!(raw.len(), 6 * 3 * 96 * 54);
    assert!(
        fs::read(here.join("a.y4m"))
            .unwrap()
            .starts_with(b"YUV4MPEG2")
    );
    for (number, raw) in (1..=6).zip(raw.chunks_exact(3 * 96 * 54)) {
        let narrow = image::open(here.join(format!("out/f_{number:04}.png"))).unwrap();
        assert!(narrow.as_bytes() == raw);
        let wide = samples(&here.join(format!("wide/f_{number:04}.png")));
        for (&narrow, wide) in raw.iter().zip(wide) {
            // The dither of 8 bits, if any, is below a code.
            let off = (f64::from(narrow) - f64::from(wide) / 257.0).abs();
            assert!(off <= 1.0, "{narrow} {wide}");
        }
    }
    if tools::has("ffmpeg") {
        render(&["-o", "a.mp4"]);
        assert!(fs::metadata(here.join("a.mp4")).unwrap().len() > 1000);
    }
}

#[test]
fn data_of_a_sky_have_directions_places_and_no_gaps() {
    let folder = with_skies();
    let here = folder.path();
    let layers = ["--layers", "coverage,colour,sky,sky_uv", "--frames", "2"];
    let render = |output| {
        let args = ["render", "moving.toml", "-o", output];
        done(here, &[&args[..], &layers].concat());
    };
    render("f_#.exr");
    render("f_#.npz");
    let (exr, _) = channels(&here.join("f_2.exr"));
    let names: Vec<_> = exr.keys().map(String::as_str).collect();
    let all = [
        "A",
        "B",
        "G",
        "R",
        "disk.coverage",
        "sky.u",
        "sky.v",
        "sky.x",
        "sky.y",
        "sky.z",
    ];
    assert_eq!(names, all);
    assert!(exr["A"].iter().all(|&alpha| alpha == 1.0));
    assert!(exr["R"].iter().all(|red| red.is_finite()));
    let mut seen = 0;
    let names = ["sky.x", "sky.y", "sky.z", "sky.u", "sky.v"];
    let numbers = |i: usize| names.map(|name| f64::from(exr[name][i]));
    for [x, y, z, u, v] in (0..96 * 54).map(numbers) {
        let length = (x * x + y * y + z * z).sqrt();
        // The shadow has no direction.
        assert_eq!(length > 0.5, u.is_finite() && (u, v) != (0.0, 0.0));
        if length > 0.5 {
            seen += 1;
            assert!((length - 1.0).abs() < 1e-6);
            let expected = darkness::sky::place(glam::DVec3::new(x, y, z));
            assert!((u - expected.0).abs() < 1e-6 && (v - expected.1).abs() < 1e-6);
        }
    }
    assert!(seen > 96 * 54 / 2, "{seen}");
    let npz = fs::read(here.join("f_2.npz")).unwrap();
    for (array, names) in [
        ("sky", &["sky.x", "sky.y", "sky.z"][..]),
        ("sky_uv", &["sky.u", "sky.v"]),
    ] {
        let values = (0..96 * 54).flat_map(|i| names.iter().map(move |name| (i, name)));
        let values = values.flat_map(|(i, name)| exr[*name][i].to_le_bytes());
        assert!(
            inflated(&npz, array).ends_with(&values.collect::<Vec<u8>>()),
            "{array}"
        );
    }
    // The place is known where no disk, light or sky is.
    fs::write(
        here.join("dark.toml"),
        STILL.replace("[sky]\npanorama = \"sky.png\"", "[sky]"),
    )
    .unwrap();
    done(
        here,
        &[
            "render",
            "dark.toml",
            "--layers",
            "sky_uv",
            "-o",
            "dark.exr",
        ],
    );
    assert_eq!(channels(&here.join("dark.exr")).0.len(), 2);
}

#[test]
fn all_methods_show_the_same_sky() {
    let folder = with_skies();
    let here = folder.path();
    for scene in ["still.toml", "stars"] {
        let draw = |method: &str| {
            let name = format!("{method}.png");
            let args = [
                "render",
                scene,
                "--size",
                "96x54",
                "--antialias",
                "false",
                "--method",
                method,
                "-o",
                &name,
            ];
            done(here, &args);
            image::open(here.join(name)).unwrap().into_rgb8().into_raw()
        };
        let table = draw("table");
        assert!(table.iter().any(|&code| code > 20));
        for method in ["exact", "integrate"] {
            let off = table.iter().zip(draw(method)).map(|(a, b)| a.abs_diff(b));
            let most = off.max().unwrap();
            assert!(most <= 1, "{scene}, {method}: off by {most}");
        }
    }
}

#[test]
fn the_sky_is_explained_and_timed() {
    let folder = with_skies();
    let here = folder.path();
    let explained = |args: &[&str]| printed(here, &[&["render", "--explain"], args].concat());
    let told = explained(&["moving.toml"]);
    for words in [
        "\nescape      ",
        " octaves towards the critical ray: ",
        "\npanorama    sky.png: 128 × 64 pixels, 7 levels, ",
        "\nstars       stars.csv: 200 stars of all magnitudes\n",
        "\ngrid        a line every 30 degrees",
        "\nnot needed  a ray for each pixel; spin and thickness",
    ] {
        assert!(told.contains(words), "no {words} in:\n{told}");
    }
    let told = explained(&["moving.toml", "--layers", "sky"]);
    assert!(
        told.contains("\nescape  ") && !told.contains("\npanorama"),
        "{told}"
    );
    assert!(told.contains("no panorama, stars or grid, since the picture shows no light"));
    let told = explained(&["stars"]);
    assert!(
        told.contains("\nstars       a random field, seed 1: 60000 stars"),
        "{told}"
    );
    let told = explained(&["lit"]);
    assert!(
        !told.contains("\nescape") && told.contains("since there is no sky"),
        "{told}"
    );
    assert!(told.contains("no escape curve"));
    let (_, timings) = done(here, &["render", "still.toml", "--timings"]);
    assert!(timings.contains("    reading the sky\n"), "{timings}");
    let lit = ["render", "lit", "--size", "96x54", "--timings"];
    assert!(!done(here, &lit).1.contains("sky"));
}

/// A scene that is printed draws what its name does.
#[test]
fn built_in_skies_are_printed_as_scenes() {
    let folder = with_skies();
    let here = folder.path();
    let list = printed(here, &["scene"]);
    for name in ["grid", "stars", "flyby"] {
        assert!(
            list.lines()
                .any(|line| line.starts_with(&format!("{name} ")))
        );
        fs::write(here.join("mine.toml"), printed(here, &["scene", name])).unwrap();
        let draw = |scene, output| {
            let args = [
                "render", scene, "--size", "64x36", "-o", output, "--format", "raw",
            ];
            done(here, &[&args[..], &["--frames", "1"]].concat());
            fs::read(here.join(output)).unwrap()
        };
        assert!(draw(name, "a.raw") == draw("mine.toml", "b.raw"), "{name}");
    }
}
