//! The README's pictures are those that the program draws.

use std::path::Path;

use image::RgbImage;
use tempfile::tempdir;

use super::markdown::{PROJECT, page};
use crate::harness::tool_prints;

#[allow(dead_code, reason = "its `main` is the example's")]
#[path = "../../../examples/strip.rs"]
mod strip;

/// Asserts that a picture of the project is the one given, to two greys of 255.
fn assert_is(name: &str, picture: &RgbImage) {
    let shown = image::open(Path::new(PROJECT).join(name))
        .unwrap()
        .into_rgb8();
    assert_eq!(shown.dimensions(), picture.dimensions(), "{name}");
    let samples = shown.as_raw().iter().zip(picture.as_raw());
    let most = samples.map(|(a, b)| a.abs_diff(*b)).max().unwrap();
    assert!(
        most <= 2,
        "{name} differs by {most}: run benches/gallery.sh"
    );
}

#[test]
fn pictures_are_those_of_the_script() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let script = page("benches/gallery.sh").text;
    let readme = page("README.md").text;
    let mut count = 0;
    for line in script
        .lines()
        .filter(|line| line.starts_with("darkness render "))
    {
        let (command, name) = line.split_once(" -o ").unwrap();
        tool_prints(here, &["sh", "-c", &format!("{command} -o picture.png")]);
        assert_is(
            name,
            &image::open(here.join("picture.png")).unwrap().into_rgb8(),
        );
        assert!(
            readme.contains(&format!("]({name})")),
            "{name} is not in the README"
        );
        count += 1;
    }
    assert_eq!(count, 7);
}

#[test]
fn the_film_strip_is_that_of_the_example() {
    assert_is("benches/gallery/plunge.png", &strip::strip().unwrap());
}
