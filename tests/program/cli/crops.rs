//! `darkness render --crop`.

use std::fs;

use image::GenericImageView;
use tempfile::tempdir;

use super::SMALL;
use crate::harness::{done, files, finish, printed, refused, tool, with_animation};
use crate::tools;

/// Tiles of a picture of 96 × 54 pixels: left, top, width and height.
const TILES: [[u32; 4]; 4] = [
    [0, 0, 50, 31],
    [50, 0, 46, 31],
    [0, 31, 50, 23],
    [50, 31, 46, 23],
];

fn crop([left, top, width, height]: [u32; 4]) -> String {
    format!("{left},{top},{width},{height}")
}

#[test]
fn crops_reassemble_to_the_picture() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (scene, options) in [
        ("classic", &[][..]),
        ("classic", &["--antialias", "false"]),
        ("lit", &["--bits", "16"]),
        ("grid", &[]),
        ("lit", &["--method", "exact"]),
    ] {
        let render = |options_of_one: &[&str]| {
            let first = ["render", scene, "--size", SMALL];
            done(here, &[&first[..], options, options_of_one].concat());
        };
        render(&["-o", "whole.png"]);
        let whole = image::open(here.join("whole.png")).unwrap();
        for tile in TILES {
            render(&["--crop", &crop(tile), "-o", "tile.png"]);
            let part = image::open(here.join("tile.png")).unwrap();
            let [left, top, width, height] = tile;
            assert_eq!(
                (part.dimensions(), part.color()),
                ((width, height), whole.color())
            );
            assert!(
                part.as_bytes() == whole.crop_imm(left, top, width, height).as_bytes(),
                "{scene} {tile:?}"
            );
        }
    }
}

/// A film's frames, a pipe's and an array's are those of the crop too.
#[test]
fn crops_of_films_and_arrays_are_parts_of_the_whole() {
    let folder = with_animation(3);
    let here = folder.path();
    let [left, top, width, height] = [10, 5, 60, 40];
    let part = crop([left, top, width, height]);
    done(here, &["render", "small.toml", "-o", "whole.raw"]);
    done(
        here,
        &["render", "small.toml", "--crop", &part, "-o", "part.raw"],
    );
    let (whole, film) = (
        fs::read(here.join("whole.raw")).unwrap(),
        fs::read(here.join("part.raw")).unwrap(),
    );
    let expected: Vec<u8> = whole
        .chunks(96 * 54)
        .flat_map(|frame| {
            let rows = frame.chunks(96).skip(top as usize).take(height as usize);
            rows.flat_map(|row| &row[left as usize..][..width as usize])
        })
        .copied()
        .collect();
    assert!(film == expected);
    let y4m = [
        "render",
        "small.toml",
        "--crop",
        &part,
        "--format",
        "y4m",
        "-o",
        "-",
    ];
    let (stream, _) = done(here, &y4m);
    assert!(stream.starts_with(b"YUV4MPEG2 W60 H40 "));
    done(
        here,
        &[
            "render", "lit", "--size", SMALL, "--crop", &part, "-o", "part.npz",
        ],
    );
    if tools::has_module("numpy") {
        let shape = "import numpy; print(numpy.load('part.npz')['colour'].shape)";
        let (told, _) = finish(&mut tool(here, &["python3", "-c", shape]));
        assert_eq!(told, b"(40, 60, 3)\n");
    }
}

/// The crop of an EXR file is its data window, and the whole picture its display window.
#[test]
fn a_crop_of_an_exr_file_is_its_data_window() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let lit = ["render", "lit", "--size", SMALL];
    done(here, &[&lit[..], &["-o", "whole.exr"]].concat());
    done(
        here,
        &[&lit[..], &["--crop", "30,20,40,33", "-o", "part.exr"]].concat(),
    );
    if tools::has_module("OpenEXR") && tools::has_module("numpy") {
        let program = "import OpenEXR, numpy\n\
            whole, part = OpenEXR.File('whole.exr'), OpenEXR.File('part.exr')\n\
            for name in ['dataWindow', 'displayWindow']:\n    \
                print(*[list(map(int, corner)) for corner in part.header()[name]])\n\
            for name, channel in part.channels().items():\n    \
                cut = whole.channels()[name].pixels[20:53, 30:70]\n    \
                assert numpy.array_equal(channel.pixels, cut, equal_nan=True), name\n";
        let (told, _) = finish(&mut tool(here, &["python3", "-c", program]));
        assert_eq!(
            String::from_utf8(told).unwrap(),
            "[30, 20] [69, 52]\n[0, 0] [95, 53]\n"
        );
    }
    if tools::has("oiiotool") {
        let (told, _) = finish(&mut tool(here, &["oiiotool", "--info", "-v", "part.exr"]));
        let told = String::from_utf8(told).unwrap();
        assert!(
            told.contains("origin: x=30, y=20") && told.contains("full/display size: 96 x 54"),
            "{told}"
        );
    }
}

/// Frames of a crop are kept when the same command runs again, and no frame of another crop is.
#[test]
fn a_rerun_draws_what_is_missing_of_a_crop() {
    let folder = with_animation(12);
    let here = folder.path();
    let run = |part: &str| {
        let args = ["render", "small.toml", "--crop", part, "-o", "out/f_##.png"];
        done(here, &args).1
    };
    run("10,5,60,40");
    let whole = files(&here.join("out"));
    fs::remove_file(here.join("out/f_07.png")).unwrap();
    let told = run("10,5,60,40");
    assert!(
        told.contains("11 were finished before") && told.contains("60 × 40"),
        "{told}"
    );
    assert!(files(&here.join("out")) == whole);
    assert!(!run("11,5,60,40").contains("finished before"));
    assert!(files(&here.join("out")) != whole);
}

#[test]
fn crops_that_make_no_sense_are_refused_with_what_to_change() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (part, words) in [
        (
            "640,360,320",
            &["four whole numbers", "LEFT,TOP,WIDTH,HEIGHT"][..],
        ),
        ("0,0,10,10,10", &["four whole numbers"]),
        ("0,0,10.5,10", &["four whole numbers"]),
        ("a,0,10,10", &["four whole numbers"]),
        (
            "90,0,7,10",
            &["--crop 90,0,7,10: ", "beyond the picture of 96 × 54 pixels"],
        ),
        ("0,50,7,10", &["--crop 0,50,7,10: ", "beyond the picture"]),
        ("-1,0,7,10", &["--crop -1,0,7,10: ", "beyond the picture"]),
        (
            "0,0,0,10",
            &["--crop 0,0,0,10: ", "at least one column and one row"],
        ),
        (
            "0,0,10,-3",
            &["--crop 0,0,10,-3: ", "at least one column and one row"],
        ),
    ] {
        refused(here, &["render", "--size", SMALL, "--crop", part], 2, words);
    }
    let odd = ["render", "orbit", "--crop", "0,0,11,10", "-o", "f.y4m"];
    refused(here, &odd, 2, &["11 × 10", "--crop of 12 by 10 pixels"]);
    let large = ["render", "--size", "200000x200000", "--crop"];
    refused(
        here,
        &[&large[..], &["0,0,100000,100000"]].concat(),
        2,
        &["--crop", "--max-memory"],
    );
    assert!(files(here).is_empty());
    // The whole of that picture would not fit the memory, nor the disk.
    done(
        here,
        &[&large[..], &["100000,90000,64,64", "-o", "part.png"]].concat(),
    );
    assert_eq!(
        image::open(here.join("part.png")).unwrap().dimensions(),
        (64, 64)
    );
}

#[test]
fn explain_tells_of_the_crop() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let explain = ["render", "--explain", "--size", SMALL];
    let whole = printed(here, &explain);
    let part = printed(here, &[&explain[..], &["--crop", "30,20,40,33"]].concat());
    assert!(
        part.contains("40 × 33 from column 30 and row 20 of 96 × 54, edges"),
        "{part}"
    );
    assert!(part.contains(" 1320 of pixels\n"), "{part}");
    // The curves are the whole picture's.
    let orders = |told: &str| told.lines().filter(|line| line.contains("nodes")).count();
    assert_eq!(orders(&part), orders(&whole));
}

/// An outline of a crop shows that part of the whole outline.
#[test]
fn a_crop_of_an_svg_file_is_its_view_box() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let part = ["--size", SMALL, "--set", "image.crop=[30,20,40,33]"];
    for (verb, out) in [("render", "f.svg"), ("isoradials", "g.svg")] {
        let scene = printed(here, &["scene", "classic"]);
        let scene = scene.replace("1920", "96").replace("1080", "54");
        fs::write(here.join("whole.toml"), &scene).unwrap();
        fs::write(here.join("part.toml"), scene + "crop = [30, 20, 40, 33]\n").unwrap();
        let of = |scene: &str| {
            done(here, &[verb, scene, "-o", out]);
            fs::read_to_string(here.join(out)).unwrap()
        };
        let (whole, part) = (of("whole.toml"), of("part.toml"));
        let cut = "width=\"40\" height=\"33\" viewBox=\"30 20 40 33\"";
        assert_eq!(
            whole.replacen("width=\"96\" height=\"54\" viewBox=\"0 0 96 54\"", cut, 1),
            part
        );
    }
    done(here, &[&["render"], &part[..], &["-o", "h.svg"]].concat());
}
