//! Fisheyes and equirectangular pictures on the command line.

use std::fs;

use image::GenericImageView;
use tempfile::tempdir;

use crate::harness::{done, printed, refused};

const DOME: &str = "camera.projection=fisheye";
const SPHERE: &str = "camera.projection=equirectangular";

/// Frames of a film are those that are drawn alone, and a film goes on where it was left.
#[test]
fn films_have_projections() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (projection, size) in [(DOME, "48x48"), (SPHERE, "96x48")] {
        let render = |options: &[&str]| {
            let film = ["render", "lit-orbit", "--size", size, "--set", projection];
            done(here, &[&film[..], options].concat()).1
        };
        render(&["--frames", "3", "-o", "one.png"]);
        render(&["--frames", "1-3", "-o", "f_#.png"]);
        let [one, three] = ["one.png", "f_3.png"].map(|name| fs::read(here.join(name)).unwrap());
        assert!(one == three, "{projection}");
        fs::remove_file(here.join("f_2.png")).unwrap();
        let told = render(&["--frames", "1-3", "-o", "f_#.png"]);
        assert!(told.contains("1 frame"), "{told}");
        (1..=3).for_each(|i| fs::remove_file(here.join(format!("f_{i}.png"))).unwrap());
    }
}

/// All that is beyond a fisheye's rim is black, and no data.
#[test]
fn beyond_the_rim_there_is_nothing() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let dome = ["render", "grid", "--size", "64x48", "--set", DOME];
    done(here, &[&dome[..], &["-o", "dome.png"]].concat());
    let picture = image::open(here.join("dome.png")).unwrap();
    let is_black = |(i, j): (u32, u32)| picture.get_pixel(i, j).0[..3] == [0; 3];
    let is_beyond = |&(i, j): &(u32, u32)| {
        let (x, y) = (f64::from(i) + 0.5 - 32.0, f64::from(j) + 0.5 - 24.0);
        x * x + y * y > 24.0 * 24.0
    };
    let all = (0..48).flat_map(|j| (0..64).map(move |i| (i, j)));
    let (beyond, within): (Vec<_>, Vec<_>) = all.partition(is_beyond);
    assert!(beyond.len() > 1200 && beyond.into_iter().all(is_black));
    assert!(within.into_iter().any(|pixel| !is_black(pixel)));
}

#[test]
fn explain_tells_the_projection() {
    let folder = tempdir().unwrap();
    let told = printed(
        folder.path(),
        &["render", "--explain", "--size", "64x64", "--set", DOME],
    );
    assert!(told.contains("64 × 64, fisheye, edges"), "{told}");
}

#[test]
fn what_a_projection_does_not_have_is_told() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let set = |rest: &[&'static str]| [&["render", "--set"], rest].concat();
    for (options, words) in [
        (set(&["camera.projection=dome"]), &["dome", "fisheye"][..]),
        (set(&[SPHERE]), &["twice as wide as high"]),
        (
            set(&[SPHERE, "--size", "64x32", "--fov", "40"]),
            &["--fov", "whole sphere"],
        ),
        (set(&[DOME, "--fov", "361"]), &["--fov", "360"]),
        (set(&[DOME, "-o", "x.svg"]), &["flat pictures only"]),
    ] {
        refused(here, &options, 2, words);
    }
    refused(
        here,
        &["isoradials", "--set", DOME],
        2,
        &["flat pictures only"],
    );
    let scene = printed(here, &["scene", "classic"]);
    let dome = scene.replace("fov = 30.0", "projection = \"fisheye\"");
    fs::write(here.join("dome.toml"), dome).unwrap();
    let pixel = ["trace", "--camera", "dome.toml", "--pixel", "0,0"];
    refused(here, &pixel, 2, &["--pixel 0,0", "rim"]);
    let middle = ["trace", "--camera", "dome.toml", "--pixel", "960,540"];
    assert!(printed(here, &middle).contains("capture"));
}
