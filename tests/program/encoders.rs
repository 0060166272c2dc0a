//! Guards against films that encoders take for another range or other colours: ffmpeg, SVT-AV1, x265, rav1e and vpxenc.
//!
//! A program that is not installed is skipped, unless `DARKNESS_TOOLS` names it.

use std::fs;
use std::path::Path;

use tempfile::tempdir;

use crate::harness::{done, tool_prints, with_animation};
use crate::tools;

/// A mask of which most is white, seen from above the disk.
const SCENE: &str = "[camera]\nposition = [1.0, 0.0, 10.0]\nfov = 60.0\n[disk]\ninner = 3.0\nouter = 12.0\n\
    [image]\nwidth = 320\nheight = 180\n";

/// What ffprobe says of a film's first stream, a line for each of the entries.
fn probed(here: &Path, film: &str) -> String {
    let entries = "stream=width,height,pix_fmt,color_range,color_space,color_transfer,color_primaries,r_frame_rate,\
                   nb_frames";
    let line = [
        "ffprobe",
        "-v",
        "error",
        "-show_entries",
        entries,
        "-of",
        "default=nw=1",
        film,
    ];
    String::from_utf8(tool_prints(here, &line)).unwrap()
}

fn assert_says(told: &str, entries: &[&str]) {
    for entry in entries {
        assert!(
            told.lines().any(|line| line == *entry),
            "no {entry} in: {told}"
        );
    }
}

/// What ffmpeg writes to its standard output.
fn ffmpeg(here: &Path, options: &[&str]) -> Vec<u8> {
    tool_prints(here, &[&["ffmpeg", "-v", "error"], options].concat())
}

/// The Y, U and V planes of a film's first frame, as ffmpeg decodes them.
fn decoded(here: &Path, film: &str) -> [Vec<u8>; 3] {
    let frame = ffmpeg(here, &["-i", film, "-frames:v", "1", "-f", "rawvideo", "-"]);
    assert_eq!(frame.len(), 320 * 180 * 3 / 2);
    let (luma, chroma) = frame.split_at(320 * 180);
    let (blue, red) = chroma.split_at(320 * 180 / 4);
    [luma, blue, red].map(<[u8]>::to_vec)
}

#[test]
fn ffmpeg_decodes_white_to_235_and_no_colour_to_128() {
    if !["ffmpeg", "ffprobe"].iter().all(|tool| tools::has(tool)) {
        return;
    }
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("white.toml"), SCENE).unwrap();
    done(here, &["render", "white.toml", "-o", "mask.raw"]);
    let mask = fs::read(here.join("mask.raw")).unwrap();
    for extension in ["y4m", "mp4", "mov", "mkv", "webm"] {
        let film = format!("film.{extension}");
        done(here, &["render", "white.toml", "-o", &film]);
        let told = probed(here, &film);
        assert_says(
            &told,
            &["pix_fmt=yuv420p", "color_range=tv", "r_frame_rate=24/1"],
        );
        if extension != "y4m" {
            let tags = [
                "color_space=bt709",
                "color_transfer=bt709",
                "color_primaries=bt709",
            ];
            assert_says(&told, &tags);
        }
        let [luma, blue, red] = decoded(here, &film);
        assert!(
            blue.iter().chain(&red).all(|&code| code == 128),
            "{extension}: colour"
        );
        if extension == "y4m" {
            let code = |grey: &u8| 16 + ((u32::from(*grey) * 219 + 127) / 255) as u8;
            assert!(luma.iter().eq(&mask.iter().map(code).collect::<Vec<_>>()));
        }
        // Blocks of nothing but white stay white to the last code.
        let is_white = |column: usize, row: usize| {
            (row - 16..row + 16).all(|row| mask[row * 320 + column - 16..][..32] == [255; 32])
        };
        let centres = (16..164).flat_map(|row| (16..304).map(move |column| (column, row)));
        let white: Vec<_> = centres
            .filter(|&(column, row)| is_white(column, row))
            .collect();
        assert!(white.len() > 1000, "{}", white.len());
        for (column, row) in white {
            assert_eq!(
                luma[row * 320 + column],
                235,
                "{extension}: {column}, {row}"
            );
        }
    }
}

#[test]
fn encoders_take_a_film_and_their_streams_say_the_range() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("white.toml"), SCENE).unwrap();
    done(here, &["render", "white.toml", "-o", "film.y4m"]);
    for line in [
        &[
            "SvtAv1EncApp",
            "--preset",
            "12",
            "-i",
            "film.y4m",
            "-b",
            "svt.ivf",
        ][..],
        &["x265", "--y4m", "film.y4m", "-o", "x265.hevc"],
        &["rav1e", "-s", "10", "film.y4m", "-o", "rav1e.ivf"],
        &[
            "vpxenc",
            "--codec=vp9",
            "--rt",
            "--cpu-used=8",
            "-o",
            "vpx.webm",
            "film.y4m",
        ],
    ] {
        if !tools::has(line[0]) || !tools::has("ffprobe") {
            continue;
        }
        tool_prints(here, line);
        let stream = line.iter().find(|word| {
            ["ivf", "hevc", "webm"]
                .iter()
                .any(|end| word.ends_with(end))
        });
        let stream = stream.unwrap();
        assert_says(
            &probed(here, stream),
            &["pix_fmt=yuv420p", "color_range=tv"],
        );
        let [luma, blue, red] = decoded(here, stream);
        assert!(
            blue.iter().chain(&red).all(|code| code.abs_diff(128) <= 1),
            "{stream}"
        );
        assert!(
            luma.iter().filter(|code| code.abs_diff(235) <= 1).count() > 30_000,
            "{stream}"
        );
    }
}

#[test]
fn the_commands_of_the_pages_make_films_with_the_right_range_and_colours() {
    if !["ffmpeg", "ffprobe"].iter().all(|tool| tools::has(tool)) {
        return;
    }
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (page, film) in [
        (include_str!("../../README.md"), "film.mp4"),
        (include_str!("../../docs/animations.md"), "orbit.mp4"),
    ] {
        let output = format!(" -o {film}");
        let line = page.lines().find(|line| line.contains(&output)).unwrap();
        let small = line.replace(" render ", " render --size 320x180 --frames 1-24 ");
        assert_ne!(small, line);
        tool_prints(here, &["sh", "-c", &small]);
        let entries = [
            "width=320",
            "height=180",
            "pix_fmt=yuv420p",
            "color_range=tv",
            "color_space=bt709",
            "color_transfer=bt709",
            "color_primaries=bt709",
            "r_frame_rate=24/1",
            "nb_frames=24",
        ];
        assert_says(&probed(here, film), &entries);
    }
    // Converted back to grey from 0 to 255, it equals the frame up to the film's compression.
    let options = "-i orbit.mp4 -vf scale=out_range=pc,format=gray -frames:v 1 -f rawvideo -";
    let film = ffmpeg(here, &options.split(' ').collect::<Vec<_>>());
    let options = "render orbit --size 320x180 --frames 1 --format raw -o -";
    let (frame, _) = done(here, &options.split(' ').collect::<Vec<_>>());
    assert_eq!(film.len(), frame.len());
    let apart: u32 = film
        .iter()
        .zip(&frame)
        .map(|(a, b)| u32::from(a.abs_diff(*b)))
        .sum();
    let mean = f64::from(apart) / frame.len() as f64;
    assert!(mean < 2.0, "{mean} greys apart");
    assert!(film.contains(&0) && film.contains(&255));
}

#[test]
fn ffmpeg_reads_a_film_to_the_last_bit() {
    if !tools::has("ffmpeg") {
        return;
    }
    let folder = with_animation(30);
    let here = folder.path();
    for options in [
        &["--format", "y4m-gray", "-o", "film.y4m"][..],
        &["-o", "frames.raw"],
    ] {
        done(here, &[&["render", "small.toml"], options].concat());
    }
    let read = ffmpeg(here, &["-i", "film.y4m", "-f", "rawvideo", "-"]);
    assert!(read == fs::read(here.join("frames.raw")).unwrap());
}
