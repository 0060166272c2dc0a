//! Guards against files of data and films that are written where the scene or the format cannot hold what is asked for,
//! that are left half, or that are taken for finished when they are damaged.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use darkness::scene::{Animation, Scene};
use tempfile::tempdir;

use crate::harness::{
    PROGRAM, darkness, done, fails, files, listing, printed, refused, with_animation,
};
use crate::tools;

#[test]
fn what_a_format_cannot_hold_is_refused_with_what_to_change() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let masks = ["render", "orbit"];
    let lit = ["render", "lit-orbit"];
    for (args, words) in [
        (
            &["--layers", "radius", "-o", "f_#.png"][..],
            &["no layers", ".exr"][..],
        ),
        (
            &["--layers", "radius", "-o", "f.mp4"],
            &["no layers", ".npz"],
        ),
        (
            &["--layers", "radius", "-o", "f.y4m"],
            &["no layers", ".npz"],
        ),
        (
            &["--layers", "radius,mass", "-o", "f_#.exr"],
            &["mass", "emission_cosine"],
        ),
        (&["--layers", "colour", "-o", "f_#.exr"], &["[disk.light]"]),
        (&["--exposure", "1"], &["[disk.light]"]),
        (&["--bits", "12"], &["8 or 16"]),
        (
            &["--bits", "16", "-o", "f.y4m"],
            &["--bits", "leave it out"],
        ),
        (
            &["--bits", "8", "-o", "f_#.exr"],
            &["--bits", "leave it out"],
        ),
        (
            &["--size", "97x54", "-o", "f.y4m"],
            &["4:2:0", "even", "98x54"],
        ),
        (
            &["--size", "96x55", "-o", "f.webm"],
            &["4:2:0", "even", "96x56"],
        ),
        (&["--format", "mp4", "-o", "-"], &["needs a file", "y4m"]),
        (&["--format", "exr", "-o", "-"], &["pipe", "--format y4m"]),
        (&["--format", "exr", "-o", "f_#.png"], &["expected .exr"]),
        (&["--format", "npz", "-o", "f.npz"], &["240 frames", "####"]),
    ] {
        refused(here, &[&masks[..], args].concat(), 2, words);
    }
    for (args, words) in [
        (
            &["--exposure", "1", "-o", "f_#.npz"][..],
            &["--exposure", "leave it out"][..],
        ),
        (&["--exposure", "101"], &["--exposure 101", "100"]),
        (&["--exposure", "nan"], &["--exposure NaN", "100"]),
        (
            &["--format", "y4m-gray", "-o", "f.y4m"],
            &["hold masks", "--format y4m"],
        ),
    ] {
        refused(here, &[&lit[..], args].concat(), 2, words);
    }
    let scene = Animation::load("lit-orbit").unwrap().to_toml();
    let write = |name: &str, line: &str| {
        fs::write(here.join(name), scene.replace("[image]", line)).unwrap();
    };
    write("wide.toml", "[image]\nbits = 16");
    write("data.toml", "[image]\nlayers = [\"radius\"]");
    for film in ["f.y4m", "f.raw", "f.mov"] {
        refused(
            here,
            &["render", "wide.toml", "-o", film],
            2,
            &["16", "image.bits = 8"],
        );
    }
    for output in ["f_#.png", "f.y4m", "f.raw", "f.webm"] {
        refused(
            here,
            &["render", "data.toml", "-o", output],
            2,
            &["no layers of data", ".exr or .npz"],
        );
    }
    assert_eq!(listing(here), ["data.toml", "wide.toml"]);
}

/// A sky is in colour, and has an exposure, whatever the disk.
#[test]
fn a_sky_is_no_mask() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    write_sky(here);
    let sky = ["render", "sky.toml"];
    let grey = ["--format", "y4m-gray", "-o", "f.y4m"];
    refused(
        here,
        &[&sky[..], &grey].concat(),
        2,
        &["hold masks", "[sky]"],
    );
    printed(
        here,
        &[&sky[..], &["--exposure", "1", "--dry-run"]].concat(),
    );
    let words = ["--exposure changes light", "a [sky]"];
    refused(here, &["render", "orbit", "--exposure", "1"], 2, &words);
    assert_eq!(listing(here), ["sky.toml"]);
}

/// Writes `sky.toml`: an animation of a black sky without a disk.
fn write_sky(folder: &Path) {
    let scene = Animation::load("orbit").unwrap().to_toml();
    let (camera, rest) = scene.split_once("[disk]").unwrap();
    let image = &rest[rest.find("[image]").unwrap()..];
    fs::write(folder.join("sky.toml"), format!("{camera}[sky]\n{image}")).unwrap();
}

#[test]
fn light_that_makes_no_sense_is_refused_with_what_to_change() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let scene = Scene::builtin("lit").unwrap().to_toml();
    let (model, kelvin) = ("model = \"blackbody\"\n", "temperature = 7000.0");
    let range = "100 to 1e9 kelvin";
    for (line, other, words) in [
        (
            kelvin,
            "temperature = 99.9",
            &["disk.light.temperature = 99.9", range][..],
        ),
        (
            kelvin,
            "temperature = nan",
            &["disk.light.temperature = NaN", range],
        ),
        (
            kelvin,
            "temperature = 1.1e9",
            &["disk.light.temperature = 1100000000", range],
        ),
        (
            model,
            "",
            &["disk.light.model is missing", "blackbody", "bolometric"],
        ),
        (
            model,
            "model = \"neon\"\n",
            &["`neon`", "`blackbody`", "`bolometric`"],
        ),
        (
            "[image]",
            "[image]\nexposure = 100.5",
            &["image.exposure = 100.5", "-100 to 100"],
        ),
        (
            "[image]",
            "[image]\nexposure = -inf",
            &["image.exposure = -inf", "-100 to 100"],
        ),
        (
            "[image]",
            "[image]\nbits = 10",
            &["image.bits = 10", "8 or 16"],
        ),
        (
            "[image]",
            "[image]\nlayers = [\"depth\"]",
            &[
                "depth",
                "coverage, order, radius, azimuth, redshift, emission_cosine, temperature, colour, sky, sky_uv",
            ],
        ),
    ] {
        assert_eq!(scene.matches(line).count(), 1, "{line}");
        fs::write(here.join("bad.toml"), scene.replace(line, other)).unwrap();
        for output in ["f.png", "f.exr", "f.npz", "f.y4m"] {
            let words = [&["bad.toml"], words].concat();
            refused(here, &["render", "bad.toml", "-o", output], 2, &words);
        }
    }
    assert_eq!(listing(here), ["bad.toml"]);
}

#[test]
fn a_frame_takes_the_memory_of_its_form() {
    let folder = with_animation(1);
    let here = folder.path();
    // 96 × 54 pixels of one float, and as much for the file.
    let limit = |bytes: u32| format!("{bytes}B");
    let args = |output: &'static str, limit: &str| {
        ["render", "small.toml", "-o", output, "--max-memory", limit].map(String::from)
    };
    for (output, bytes) in [("f.png", 2), ("f.exr", 8), ("f.npz", 8)] {
        let needed = 96 * 54 * bytes;
        let enough = args(output, &limit(needed));
        done(here, &enough.each_ref().map(String::as_str));
        let short = args(output, &limit(needed - 1));
        refused(
            here,
            &short.each_ref().map(String::as_str),
            2,
            &["--max-memory", "--size"],
        );
    }
}

#[test]
fn hard_masks_have_the_bits_that_are_asked_for() {
    let folder = with_animation(2);
    let here = folder.path();
    let depth = |bits: &[&str]| {
        let args = [
            "render",
            "small.toml",
            "--antialias",
            "false",
            "-o",
            "f_#.png",
        ];
        let (_, stderr) = done(here, &[&args[..], bits].concat());
        assert!(!stderr.contains("before"), "{stderr}");
        // Width and height come before the depth in the first chunk.
        fs::read(here.join("f_1.png")).unwrap()[24]
    };
    assert_eq!(depth(&[]), 1);
    assert_eq!(depth(&["--bits", "8"]), 8);
    assert_eq!(depth(&["--bits", "16"]), 16);
    assert_eq!(depth(&[]), 1);
}

/// Writes the animation of `small.toml` with light, and with hard edges, which take less time.
fn write_lit(here: &Path) {
    let light = "[disk.light]\nmodel = \"blackbody\"\ntemperature = 7000.0\n\n[image]";
    let mask = fs::read_to_string(here.join("small.toml")).unwrap();
    let hard = mask.replace("antialias = true", "antialias = false");
    assert_ne!(hard, mask);
    fs::write(here.join("lit.toml"), hard.replace("[image]", light)).unwrap();
}

#[test]
fn a_rerun_draws_frames_that_are_missing_damaged_or_of_another_scene() {
    let folder = with_animation(9);
    let here = folder.path();
    write_lit(here);
    for (scene, extension, other) in [
        ("small.toml", "exr", ["--layers", "order"]),
        ("small.toml", "npz", ["--layers", "order"]),
        ("lit.toml", "exr", ["--layers", "order"]),
        ("lit.toml", "npz", ["--layers", "order"]),
        ("lit.toml", "png", ["--exposure", "1"]),
        ("lit.toml", "png", ["--bits", "16"]),
    ] {
        let pattern = format!("{scene}_{extension}{}/f_##.{extension}", other[1]);
        let drawn = |args: &[&str]| {
            let all = [&["render", scene, "-o", &pattern], args].concat();
            done(here, &all).1
        };
        drawn(&[]);
        let out = here.join(&pattern).parent().unwrap().to_owned();
        let first = files(&out);
        assert_eq!(first.len(), 9);
        assert!(drawn(&[]).contains("all frames were finished before"));
        let name = |number: u32| format!("f_{number:02}.{extension}");
        fs::remove_file(out.join(name(1))).unwrap();
        for (number, part) in [(2, 3), (3, 5), (4, 7), (5, 8)] {
            // A bit of the head, of the values, and of the end.
            let mut damaged = first[&name(number)].clone();
            let place = (damaged.len() - 1) * part / 8;
            damaged[place] ^= 4;
            fs::write(out.join(name(number)), damaged).unwrap();
        }
        fs::write(out.join(name(6)), &first[&name(7)]).unwrap();
        let half = &first[&name(8)][..first[&name(8)].len() * 3 / 4];
        fs::write(out.join(name(8)), half).unwrap();
        let dry = done(here, &["render", scene, "-o", &pattern, "--dry-run"]).0;
        let dry = String::from_utf8(dry).unwrap();
        assert_eq!(dry.matches("to draw").count(), 7, "{dry}");
        assert!(drawn(&[]).contains("7 frames of"));
        assert!(files(&out) == first);
        assert!(drawn(&[&other[..], &["--frames", "1-2"]].concat()).contains("2 frames of"));
        assert!(drawn(&[]).contains("2 frames of") && files(&out) == first);
    }
}

#[test]
fn frames_of_a_batch_that_is_killed_and_run_again_are_the_same() {
    let folder = with_animation(200);
    let here = folder.path();
    write_lit(here);
    for (scene, extension) in [
        ("small.toml", "exr"),
        ("small.toml", "npz"),
        ("lit.toml", "exr"),
        ("lit.toml", "npz"),
        ("lit.toml", "png"),
    ] {
        let [whole, out] = ["whole", "out"].map(|kind| format!("{kind}_{scene}_{extension}"));
        let folder = here.join(&out);
        let [whole, out] = [whole, out].map(|folder| format!("{folder}/f_###.{extension}"));
        let begun = Instant::now();
        done(here, &["render", scene, "-o", &whole]);
        let time = begun.elapsed();
        let whole = files(here.join(&whole).parent().unwrap());
        for moment in 1..5_u32 {
            let mut child = darkness(here, &["render", scene, "-q", "-o", &out])
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            std::thread::sleep(time * moment / 6);
            child.kill().unwrap();
            child.wait().unwrap();
            fs::create_dir_all(&folder).unwrap();
            for (name, file) in files(&folder) {
                assert!(name.starts_with('.') || file == whole[&name], "{name}");
            }
            let _ = fs::remove_file(folder.join(format!("f_{moment:03}.{extension}")));
        }
        done(here, &["render", scene, "-o", &out]);
        assert!(files(&folder) == whole);
    }
}

/// Runs the program with a program of this text as the only `ffmpeg`.
fn with_ffmpeg(here: &Path, script: Option<&str>, args: &[&str]) -> Output {
    let bin = here.join("bin");
    fs::create_dir_all(&bin).unwrap();
    if let Some(script) = script {
        fs::write(bin.join("ffmpeg"), format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(bin.join("ffmpeg"), fs::Permissions::from_mode(0o755)).unwrap();
    }
    let path = if script.is_some() {
        format!("{}:/usr/bin:/bin", bin.display())
    } else {
        bin.display().to_string()
    };
    darkness(here, args).env("PATH", path).output().unwrap()
}

#[test]
fn a_film_without_ffmpeg_or_with_one_that_fails_leaves_nothing() {
    let folder = with_animation(50);
    let here = folder.path();
    let film = ["render", "small.toml", "-o", "a.mp4"];
    let before = listing(here);
    fails(
        &with_ffmpeg(here, None, &film),
        1,
        &["ffmpeg", "PATH", "apt install"],
    );
    for (script, words) in [
        // It ends before it reads, or after.
        (
            "echo first >&2; echo no space left >&2; exit 3",
            &["first; no space left", "3"][..],
        ),
        (
            "cat >/dev/null; echo unknown encoder >&2; exit 1",
            &["unknown encoder", "1"],
        ),
        ("echo half >a.mp4; kill -9 $$", &["ffmpeg failed", "9"]),
    ] {
        let script = format!("[ \"$1\" = -version ] && exit 0\n{script}");
        let output = with_ffmpeg(here, Some(&script), &film);
        fails(&output, 1, &[&["a.mp4"], words].concat());
        let _ = fs::remove_file(here.join("a.mp4"));
        let left: Vec<_> = listing(here)
            .into_iter()
            .filter(|name| name != "bin")
            .collect();
        assert_eq!(left, before);
    }
}

#[test]
fn a_quota_stops_ffmpeg_and_leaves_no_film() {
    if !tools::has("ffmpeg") {
        return;
    }
    let folder = with_animation(50);
    let here = folder.path();
    let before = listing(here);
    // Blocks of 512 bytes.
    let line = format!("ulimit -f 1; exec '{PROGRAM}' render small.toml -o a.mkv");
    let output = Command::new("sh")
        .args(["-c", &line])
        .current_dir(here)
        .output();
    fails(&output.unwrap(), 1, &["a.mkv", "ffmpeg failed"]);
    assert_eq!(listing(here), before);
}

#[test]
fn a_film_that_is_interrupted_leaves_neither_a_file_nor_a_process() {
    if !tools::has("ffmpeg") {
        return;
    }
    let folder = with_animation(20_000);
    let here = folder.path();
    let before = listing(here);
    let args = ["render", "small.toml", "-o", "a.mp4", "--progress", "none"];
    let child = darkness(here, &args)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while listing(here) == before {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
    // Its file appears before ffmpeg is started.
    std::thread::sleep(Duration::from_millis(200));
    let signal = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    assert!(signal.unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        output.status.code(),
        Some(143),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert_eq!(listing(here), before);
}
