//! Guards against a sky that some format, method or verb shows differently, and against files of a sky that a run reads
//! needlessly, does not tell of, or does not notice to have changed.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::io::Read as _;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

use exr::prelude::{Image as ExrImage, ReadChannels, ReadLayers};
use tempfile::{TempDir, tempdir};

use crate::harness::{
    PATTERN, darkness, done, files, listing, printed, refused, run, with_animation,
};
use crate::tools;

/// A panorama without a disk, and an animation of a panorama, a catalogue and a grid behind a lit disk.
const STILL: &str = "[camera]\nposition = [20, 0, 4]\nfov = 50\n[sky]\npanorama = \"sky.png\"\n\
    [image]\nwidth = 96\nheight = 54\n";
const MOVING: &str = "[camera]\nfov = 50\n[disk]\ninner = 3\nouter = 7\n\
    [disk.light]\nmodel = \"blackbody\"\ntemperature = 7000\n\
    [sky]\npanorama = \"sky.png\"\nstars = \"stars.csv\"\nstar_exposure = -6\ngrid = 30\n\
    [image]\nwidth = 96\nheight = 54\n\
    [animation]\nframes = 6\norbit = { radius = 20.0, inclination = 75.0, azimuth = [0.0, 360.0] }\n";

/// Writes a smooth panorama of 128 × 64 pixels.
fn write_panorama(path: &Path, blue: u8) {
    let pixel = |x: u32, y: u32| {
        let wave = 127.5 + 120.0 * libm::sin(f64::from(x) * std::f64::consts::TAU / 128.0);
        image::Rgb([wave as u8, (4 * y) as u8, blue])
    };
    image::RgbImage::from_fn(128, 64, pixel).save(path).unwrap();
}

/// A folder with both scenes, the files of their skies, and a table.
fn with_skies() -> TempDir {
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("still.toml"), STILL).unwrap();
    fs::write(here.join("moving.toml"), MOVING).unwrap();
    write_panorama(&here.join("sky.png"), 40);
    let mut stars = String::from("ra,dec,magnitude,temperature\n");
    for i in 0..200_u8 {
        let degrees = f64::from(i);
        let (longitude, latitude) = (1.8 * degrees, 0.8 * degrees - 80.0);
        stars.push_str(
            &[longitude, latitude, f64::from(i % 5), 5800.0]
                .map(|x| x.to_string())
                .join(","),
        );
        stars.push('\n');
    }
    fs::write(here.join("stars.csv"), stars).unwrap();
    done(here, &["table", "standard"]);
    folder
}

/// The channels of an `OpenEXR` file, and its texts.
fn channels(path: &Path) -> (BTreeMap<String, Vec<f32>>, String) {
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level();
    let read = read.all_channels().first_valid_layer().all_attributes();
    let image: ExrImage<_> = read.from_file(path).unwrap();
    let texts = format!("{:?}", image.layer_data.attributes.other);
    let channels = image.layer_data.channel_data.list.into_iter();
    let channels = channels.map(|channel| {
        let values = channel.sample_data.values_as_f32().collect();
        (channel.name.to_string(), values)
    });
    (channels.collect(), texts)
}

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
fn frames_record_the_files_of_the_sky_and_are_drawn_again_when_these_change() {
    let folder = with_skies();
    let here = folder.path();
    for extension in ["png", "exr", "npz"] {
        let pattern = format!("{extension}/f_#.{extension}");
        let drawn = || done(here, &["render", "moving.toml", "-o", &pattern]).1;
        let dry = || {
            printed(
                here,
                &["render", "moving.toml", "-o", &pattern, "--dry-run"],
            )
        };
        write_panorama(&here.join("sky.png"), 40);
        assert!(drawn().contains("6 frames of"));
        let out = here.join(extension);
        let first = files(&out);
        assert!(drawn().contains("all frames were finished before"));
        assert_eq!(dry().matches("finished").count(), 6);
        write_panorama(&here.join("sky.png"), 41);
        assert_eq!(dry().matches("to draw").count(), 6);
        assert!(drawn().contains("6 frames of"));
        assert!(files(&out) != first);
        // A star more, which is nowhere in the picture.
        let catalogue = fs::read_to_string(here.join("stars.csv")).unwrap();
        fs::write(here.join("stars.csv"), format!("{catalogue}0,0,50,5800\n")).unwrap();
        assert_eq!(dry().matches("to draw").count(), 6);
        fs::write(here.join("stars.csv"), catalogue).unwrap();
        assert_eq!(dry().matches("finished").count(), 6);
        write_panorama(&here.join("sky.png"), 40);
        drawn();
        assert!(files(&out) == first);
    }
    let bytes = fs::read(here.join("png/f_1.png")).unwrap();
    let key = b"darkness:sky\0";
    let at = bytes.windows(key.len()).position(|window| window == key);
    let text = &bytes[at.unwrap() + key.len()..][..129];
    assert!(
        text.iter()
            .all(|byte| byte.is_ascii_hexdigit() || *byte == b' ')
    );
    assert!(
        channels(&here.join("exr/f_1.exr"))
            .1
            .contains("darkness:sky")
    );
    // A scene without such files records nothing.
    done(
        here,
        &["render", "grid", "--size", "96x54", "-o", "grid.png"],
    );
    let grid = fs::read(here.join("grid.png")).unwrap();
    assert!(!grid.windows(12).any(|window| window == b"darkness:sky"));
}

/// Finished frames, lists of frames and data without light need no panorama to be decoded.
#[test]
fn a_panorama_is_decoded_only_to_be_drawn() {
    let folder = with_skies();
    let here = folder.path();
    fs::write(here.join("sky.png"), "no picture").unwrap();
    let render = ["render", "moving.toml"];
    printed(here, &[&render[..], &["-o", PATTERN, "--dry-run"]].concat());
    let data = ["--layers", "radius,sky", "-o", "f_#.npz"];
    done(here, &[&render[..], &data].concat());
    let words = ["panorama sky.png", "not a PNG"];
    refused(here, &[&render[..], &["-o", PATTERN]].concat(), 1, &words);
    fs::remove_file(here.join("sky.png")).unwrap();
    done(here, &[&render[..], &data].concat());
    let words = ["panorama sky.png", "cannot be read"];
    for options in [
        &["-o", PATTERN][..],
        &["-o", PATTERN, "--dry-run"],
        &["-o", "a.y4m"],
        &["--explain"],
    ] {
        refused(here, &[&render[..], options].concat(), 2, &words);
    }
}

#[test]
fn a_batch_with_a_sky_that_is_killed_and_run_again_gives_the_same_files() {
    let folder = with_skies();
    let here = folder.path();
    // Hard edges take less time.
    fs::write(
        here.join("moving.toml"),
        MOVING
            .replace("frames = 6", "frames = 60")
            .replace("[image]", "[image]\nantialias = false"),
    )
    .unwrap();
    let begun = Instant::now();
    done(here, &["render", "moving.toml", "-o", "whole/f_####.png"]);
    let time = begun.elapsed();
    let whole = files(&here.join("whole"));
    for moment in 0..6_u32 {
        let mut child = darkness(here, &["render", "moving.toml", "-q", "-o", PATTERN])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(time * moment / 7);
        child.kill().unwrap();
        child.wait().unwrap();
        fs::create_dir_all(here.join("out")).unwrap();
        for (name, file) in files(&here.join("out")) {
            assert!(name.starts_with('.') || file == whole[&name], "{name}");
        }
        let _ = fs::remove_file(here.join(format!("out/f_{:04}.png", moment + 1)));
    }
    done(here, &["render", "moving.toml", "-o", PATTERN]);
    assert!(files(&here.join("out")) == whole);
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

#[test]
fn jobs_name_the_files_of_the_sky() {
    let folder = with_skies();
    let here = folder.path();
    let openjd = printed(here, &["job", "openjd", "moving.toml"]);
    for (name, file) in [("Panorama", "sky.png"), ("Stars", "stars.csv")] {
        let parameter = format!(
            "\n  - name: {name}\n    type: PATH\n    objectType: FILE\n    dataFlow: IN\n    description: "
        );
        assert!(openjd.contains(&parameter), "{openjd}");
        assert!(
            openjd.contains(&format!("\n    default: \"{file}\"\n")),
            "{openjd}"
        );
    }
    let slurm = printed(here, &["job", "slurm", "moving.toml"]);
    assert!(
        slurm.contains("\n# All nodes read the scene's panorama too: sky.png\n"),
        "{slurm}"
    );
    assert!(slurm.contains("star catalogue too: stars.csv\n"), "{slurm}");
    // Of a scene elsewhere, they are elsewhere too, and no defaults.
    let scene = here.join("moving.toml");
    let openjd = printed(here, &["job", "openjd", scene.to_str().unwrap()]);
    let given = format!(" -p 'Panorama={}'", here.join("sky.png").display());
    assert!(openjd.contains(&given), "{openjd}");
    assert!(!openjd.contains("default: \"sky.png\""));
    // Data without light reads none of them.
    fs::write(
        here.join("data.toml"),
        MOVING.replace("[image]", "[image]\nlayers = [\"radius\"]"),
    )
    .unwrap();
    let openjd = printed(here, &["job", "openjd", "data.toml"]);
    assert!(!openjd.contains("Panorama"));
}

#[test]
fn a_file_of_the_sky_is_not_overwritten() {
    let folder = with_skies();
    let here = folder.path();
    for name in ["f_2.png", "still.png"] {
        fs::copy(here.join("sky.png"), here.join(name)).unwrap();
    }
    fs::write(here.join("a.toml"), STILL.replace("sky.png", "still.png")).unwrap();
    fs::write(here.join("b.toml"), MOVING.replace("sky.png", "f_2.png")).unwrap();
    let before = files(here);
    let words = ["panorama that is read"];
    refused(here, &["render", "a.toml", "-o", "still.png"], 2, &words);
    refused(
        here,
        &["render", "a.toml", "-o", "./tables/../still.png"],
        2,
        &words,
    );
    refused(here, &["render", "b.toml", "-o", "f_#.png"], 2, &words);
    refused(
        here,
        &["render", "b.toml", "-o", "f_2.png", "--format", "raw"],
        2,
        &words,
    );
    let words = ["star catalogue that is read"];
    refused(
        here,
        &["render", "b.toml", "-o", "stars.csv", "--format", "raw"],
        2,
        &words,
    );
    assert!(files(here) == before);
    // A frame's name that is a link to the panorama.
    fs::create_dir(here.join("out")).unwrap();
    std::os::unix::fs::symlink("../sky.png", here.join("out/f_0003.png")).unwrap();
    let render = ["render", "moving.toml", "-o", PATTERN];
    refused(
        here,
        &render,
        1,
        &["out/f_0003.png: made by another program"],
    );
    let (output, stderr) = run(here, &[&render[..], &["--overwrite"]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr.contains("3: out/f_0003.png") && stderr.contains("a link to"),
        "{stderr}"
    );
    assert!(fs::read(here.join("sky.png")).unwrap() == before["sky.png"]);
}

#[test]
fn scenes_without_a_sky_are_as_before() {
    let folder = with_animation(2);
    let here = folder.path();
    done(here, &["render", "small.toml", "-o", "f_#.png"]);
    let frame = fs::read(here.join("f_1.png")).unwrap();
    assert!(!frame.windows(12).any(|window| window == b"darkness:sky"));
    assert_eq!(
        listing(here),
        ["f_1.png", "f_2.png", "small.toml", "tables"]
    );
}
