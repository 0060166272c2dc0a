//! `darkness render` of one picture.

use std::fs;

use darkness::scene::builtins;
use tempfile::tempdir;

use super::SMALL;
use crate::harness::{done, listing, printed, refused, with_draft};

#[test]
fn render_works_at_once_in_an_empty_folder_and_leaves_nothing_else() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let (stdout, stderr) = done(here, &["render"]);
    assert!(stdout.is_empty());
    for words in [
        "tables/standard.table is not there yet",
        "classic.png: 1920 × 1080, table standard (error ",
    ] {
        assert!(stderr.contains(words), "{stderr}");
    }
    assert_eq!(listing(here), ["classic.png", "tables"]);
    assert_eq!(listing(&here.join("tables")), ["standard.table"]);
    let picture = image::open(here.join("classic.png")).unwrap().into_luma8();
    assert_eq!(picture.dimensions(), (1920, 1080));
    let white = picture.pixels().filter(|pixel| pixel.0 == [255]).count();
    assert!(
        (200_000..1_600_000).contains(&white),
        "{white} white pixels"
    );

    // The second time the table exists, and -q prints nothing.
    let before = fs::read(here.join("classic.png")).unwrap();
    let (_, stderr) = done(here, &["render", "-q"]);
    assert_eq!(stderr, "");
    assert_eq!(fs::read(here.join("classic.png")).unwrap(), before);
}

/// `--explain` tells of the map and of the pixels' bytes in the form that the file holds.
#[test]
fn the_map_is_told_of_where_the_output_needs_it() {
    let folder = with_draft();
    let here = folder.path();
    let pixels = 96 * 54;
    // A disk that is white everywhere, before a sky.
    let white = printed(here, &["scene", "classic"]) + "[sky]\ngrid = 15\n";
    fs::write(here.join("white.toml"), white).unwrap();
    for (options, bytes, has_map) in [
        (&["white.toml"][..], 3, false),
        (&["white.toml", "--format", "exr"], 20, false),
        (&["white.toml", "--layers", "colour,redshift"], 20, true),
        (&["classic"], 1, false),
        (&["lit"], 3, true),
        (&["lit", "--bits", "16"], 6, true),
        (&["lit", "--layers", "coverage,order"], 8, false),
        (&["classic", "--layers", "radius"], 4, true),
        (&["classic", "--format", "exr"], 4, false),
        (&["lit", "--format", "exr"], 20, true),
    ] {
        let explain = ["render", "--explain", "--table", "a.table", "--size", SMALL];
        let told = printed(here, &[&explain[..], options].concat());
        let pixels = format!(" {} of pixels\n", bytes * pixels);
        assert!(told.contains(&pixels), "no {pixels} in:\n{told}");
        assert_eq!(told.contains("\nmap         of the radius: "), has_map);
        assert_eq!(told.contains("no map of the radius"), !has_map);
        assert!(!told.contains("colour"), "{told}");
    }
    assert_eq!(listing(here), ["a.table", "white.toml"]);
}

/// Without a disk `--explain` tells what holds for the sky, and speaks of no edges.
#[test]
fn without_a_disk_no_edges_are_explained() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let explain = ["render", "--explain", "--size", SMALL, "grid"];
    let told = |options: &[&str]| printed(here, &[&explain[..], options].concat());
    let sky = told(&[]);
    for words in [
        "picture     96 × 54\n",
        "draft: up to 1.0e-6 rad, not enough\n",
        "standard: up to 1.0e-9 rad, enough\n",
        "fine: up to 1.0e-12 rad, more than enough\n",
        "\norders      none: the scene has no disk\n",
        "\nbytes       15552 of pixels\n",
        " bytes, directions right to ",
        "\ngrid        a line every ",
        "no map of the radius, since there is no disk; spin and thickness are",
    ] {
        assert!(sky.contains(words), "no {words} in:\n{sky}");
    }
    let nothing = told(&["--layers", "coverage"]);
    assert!(!nothing.contains("\nescape"), "{nothing}");
    for told in [sky, nothing] {
        assert!(!told.contains("edge"), "{told}");
        assert!(!told.contains("curves"), "{told}");
    }
}

/// `--explain` of an animation tells of each figure its range and the frame in which it is greatest, and of the table
/// that all frames are drawn with.
#[test]
fn all_frames_that_are_asked_for_are_explained() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    // For its first frame alone the draft table would do.
    let approach = ["render", "approach", "--size", SMALL, "--tolerance", "1e-4"];
    let explain = |frames: &str| {
        let options = ["--explain", "--frames", frames];
        printed(here, &[&approach[..], &options].concat())
    };
    let explained = explain("1-96");
    for words in [
        "for the table, 5.0e-5 for the curves\n",
        "\nframes      1-96; each figure's range",
        "one table for all frames: of 9 of them edges move most in frame ",
    ] {
        assert!(explained.contains(words), "no {words:?} in:\n{explained}");
    }
    // The least and the greatest value of a figure, and its frame, are what single frames have.
    let single: Vec<String> = (1..=96)
        .map(|number| explain(&number.to_string()))
        .collect();
    for (label, words) in [
        ("edges ", "at most "),
        ("orders ", "0: at most "),
        ("edge error ", "at most "),
    ] {
        let after = |text: &str| {
            let line = text.lines().find(|line| line.starts_with(label)).unwrap();
            line.split_once(words).unwrap().1.to_owned()
        };
        let range = after(&explained);
        let (least, rest) = range.split_once(" to ").unwrap();
        let (most, rest) = rest.split_once(" (frame ").unwrap();
        let frame: usize = rest.split_once(')').unwrap().0.parse().unwrap();
        let value = |text: &str| -> f64 { after(text).split(' ').next().unwrap().parse().unwrap() };
        let [least, most] = [least, most].map(|figure| figure.parse::<f64>().unwrap());
        let values: Vec<f64> = single.iter().map(|text| value(text)).collect();
        assert_eq!(
            values.iter().copied().fold(f64::INFINITY, f64::min),
            least,
            "{label}"
        );
        assert_eq!(values.iter().copied().fold(0.0, f64::max), most, "{label}");
        assert_eq!(values[frame - 1], most, "{label}");
    }
    let one = explain("1");
    assert!(
        one.contains("\ntable       standard (tables/standard.table)"),
        "{one}"
    );
    let options = ["--frames", "1", "-o", "f_#.png"];
    let (_, stderr) = done(here, &[&approach[..], &options].concat());
    assert!(stderr.contains("table standard ("), "{stderr}");
}

/// The picture decides the table: the draft table for a small picture, none if even the fine table is too coarse.
/// `--explain` says which and why, and draws nothing.
#[test]
fn a_picture_takes_the_smallest_table_that_is_good_enough() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (tolerance, name) in [("0.001", "draft"), ("1e-5", "standard"), ("1e-8", "fine")] {
        let size = ["--size", SMALL, "--tolerance", tolerance];
        let (_, stderr) = done(here, &[&["render"][..], &size].concat());
        let words = [
            format!("tables/{name}.table is not there yet"),
            format!("96 × 54, table {name} (error "),
        ];
        for words in words {
            assert!(stderr.contains(&words), "{stderr}");
        }
        let explain = [&["render", "--explain"][..], &size].concat();
        let explained = printed(here, &explain);
        for words in [
            "96 × 54, edges to be right to ",
            " for the table, ",
            &format!("{name} (tables/{name}.table), error "),
            "orders      0: ",
            "and up are left out",
            "edge error  ",
        ] {
            assert!(explained.contains(words), "no {words} in:\n{explained}");
        }
    }
    // Light and data need the standard table's accuracy whatever the edges do.
    for lit in [&["lit"][..], &["classic", "--layers", "radius"]] {
        let explain = ["render", "--explain", "--size", SMALL];
        let explained = printed(here, &[&explain[..], lit].concat());
        for words in [
            "table       standard (tables/standard.table), error ",
            " pixels, enough for edges, not for light and data\n",
            " pixels, enough\n",
        ] {
            assert!(explained.contains(words), "no {words} in:\n{explained}");
        }
    }
    let finest = ["render", "--size", SMALL, "--tolerance", "1e-10"];
    let (_, stderr) = done(here, &finest);
    assert!(stderr.contains("exact curves"), "{stderr}");
    fs::remove_file(here.join("classic.png")).unwrap();
    done(here, &[&finest[..], &["--explain"]].concat());
    assert_eq!(listing(here), ["tables"]);
    assert_eq!(
        listing(&here.join("tables")),
        ["draft.table", "fine.table", "standard.table"]
    );

    // A table that is named is used all the same, with a warning.
    let coarse = ["--table", "tables/draft.table", "--tolerance", "1e-6"];
    let (_, stderr) = done(here, &[&["render", "--size", SMALL][..], &coarse].concat());
    assert!(
        stderr.contains("the standard table is good enough"),
        "{stderr}"
    );
}

#[test]
fn tolerances_that_make_no_sense_are_refused_as_misuse() {
    let folder = tempdir().unwrap();
    for (args, words) in [
        (&["--tolerance", "0"][..], "--tolerance 0: an edge's"),
        (&["--tolerance", "-1"], "--tolerance -1: an edge's"),
        (&["--tolerance", "nan"], "--tolerance NaN: an edge's"),
        (&["--size", "0x9"], "--size 0x9: a picture's side"),
        (&["--tolerance", "2"], "at most 1 pixel"),
        (
            &["--tolerance", "0.1", "--method", "exact"],
            "--tolerance needs --method table",
        ),
        (
            &["--explain", "--method", "integrate"],
            "--explain needs --method table",
        ),
        (
            &["--antialias", "true", "--method", "exact"],
            "--antialias needs --method table",
        ),
        (&["--explain", "-o", "x.png"], "--explain"),
    ] {
        refused(folder.path(), &[&["render"], args].concat(), 2, &[words]);
    }
    assert!(listing(folder.path()).is_empty());
}

#[test]
fn other_methods_need_no_table_and_draw_the_same_picture() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for args in [
        &["render", "--method", "exact", "-o", "e.png"][..],
        &["render", "--method", "integrate", "-o", "i.png"],
        &[
            "render",
            "--method=integrate",
            "--integrate-tolerance=1e-5",
            "-o",
            "j.PNG",
        ],
    ] {
        let others = ["--size", SMALL, "--table", "missing.table"];
        done(here, &[args, &others].concat());
    }
    assert_eq!(listing(here), ["e.png", "i.png", "j.PNG"]);
    let hard = ["--antialias", "false", "--size", SMALL, "-o", "t.png"];
    done(here, &[&["render"][..], &hard].concat());
    let pixels = |name: &str| image::open(here.join(name)).unwrap().into_luma8();
    for name in ["i.png", "j.PNG", "t.png"] {
        let pairs = pixels("e.png").into_raw().into_iter();
        let pairs = pairs.zip(pixels(name).into_raw());
        // A pixel whose centre is on an edge to the last digit may be either colour.
        let different = pairs.filter(|(a, b)| a != b).count();
        assert!(different <= 1, "{name}: {different} pixels differ");
    }
}

#[test]
fn the_picture_can_go_to_the_standard_output() {
    let folder = with_draft();
    let here = folder.path();
    let draw = |to: &str| {
        let args = ["render", "--table", "a.table", "--size", SMALL, "-o", to];
        done(here, &args).0
    };
    assert_eq!(draw("x.png"), b"");
    assert_eq!(draw("-"), fs::read(here.join("x.png")).unwrap());
    assert_eq!(listing(here), ["a.table", "x.png"]);
}

#[test]
fn render_checks_where_the_picture_goes_before_any_work() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::create_dir(here.join("folder.png")).unwrap();
    fs::write(here.join("file"), "").unwrap();
    let before = listing(here);
    for (output, code, words) in [
        ("x.jpg", 2, &["x.jpg", ".png"][..]),
        ("x", 2, &[".png"]),
        ("folder.png", 1, &["folder.png is a folder"]),
        ("file/x.png", 1, &["file/x.png", "file is not a folder"]),
    ] {
        refused(here, &["render", "-o", output], code, words);
    }
    // Nobody may write here, not even root, who may write anywhere else.
    #[cfg(target_os = "linux")]
    refused(
        here,
        &["render", "-o", "/proc/x.png"],
        1,
        &["/proc/x.png", "cannot be written"],
    );
    assert_eq!(listing(here), before, "something was written");
}

#[test]
fn missing_folders_of_an_output_are_made() {
    let folder = with_draft();
    let here = folder.path();
    let small = ["render", "--table", "a.table", "--size", SMALL, "-o"];
    done(here, &[&small[..], &["stills/of/x.png"]].concat());
    done(here, &[&small[..], &["films/x.y4m"]].concat());
    assert_eq!(listing(&here.join("stills/of")), ["x.png"]);
    assert_eq!(listing(&here.join("films")), ["x.y4m"]);
    // None is made for a picture that is not drawn.
    refused(here, &[&small[..], &["no/x.jpg"]].concat(), 2, &[".png"]);
    let one_file = ["chart", "--quick", "-o", "no/a.svg", "--csv", "./no/a.svg"];
    refused(here, &one_file, 2, &["name the same file"]);
    assert_eq!(listing(here), ["a.table", "films", "stills"]);
}

#[test]
fn render_does_not_write_over_what_it_reads() {
    let folder = with_draft();
    let here = folder.path();
    fs::rename(here.join("a.table"), here.join("table.png")).unwrap();
    fs::write(here.join("scene.png"), builtins()[0].toml()).unwrap();
    let before = fs::read(here.join("table.png")).unwrap();
    let args = ["render", "--table", "table.png", "-o", "./table.png"];
    refused(here, &args, 2, &["table.png", "the table"]);
    // Here the scene's default picture has the name of the scene itself.
    let args = ["render", "--table", "table.png", "scene.png"];
    refused(here, &args, 2, &["scene.png", "the scene"]);
    assert_eq!(fs::read(here.join("table.png")).unwrap(), before);
    assert_eq!(listing(here), ["scene.png", "table.png"]);
}
