//! Values of cameras, disks and pictures that are refused, and the sentences that say why.

use super::super::Scene;
use super::*;

const GOOD: &str = "[camera]\nposition = [20.0, 0.0, 5.0]\nfocus = [0.0, 0.0, 0.0]\nup = [0.0, 0.0, 1.0]\n\
                    fov = 40.0\n[disk]\ninner = 3.0\nouter = 12.0\nnormal = [0.0, 0.0, 1.0]\n\
                    [image]\nwidth = 64\nheight = 36\nantialias = false\ntolerance = 0.001\n";

/// The good scene with the keys' values replaced.
fn changed(changes: &[(&str, &str)]) -> Result<Scene, SceneError> {
    let mut lines: Vec<String> = GOOD.lines().map(str::to_owned).collect();
    for (key, value) in changes {
        let line = lines
            .iter_mut()
            .find(|line| line.starts_with(&format!("{key} =")))
            .unwrap();
        *line = format!("{key} = {value}");
    }
    Scene::from_toml(&lines.join("\n"))
}

/// Asserts that the change is refused by a sentence that holds all of `words`.
fn refused(changes: &[(&str, &str)], words: &[&str]) {
    let message = changed(changes)
        .expect_err(&format!("{changes:?}"))
        .to_string();
    for word in words {
        assert!(message.contains(word), "{changes:?}: {message}");
    }
}

#[test]
fn the_good_scene_is_good() {
    assert!(changed(&[]).is_ok());
}

#[test]
fn numbers_that_are_not_finite() {
    for (key, full) in [
        ("position", "camera.position"),
        ("focus", "camera.focus"),
        ("up", "camera.up"),
    ] {
        refused(&[(key, "[20.0, nan, 5.0]")], &[full, "NaN", "finite"]);
    }
    refused(
        &[("normal", "[0.0, 0.0, inf]")],
        &["disk.normal", "inf", "finite"],
    );
    refused(&[("fov", "nan")], &["camera.fov", "NaN"]);
    refused(&[("inner", "-inf")], &["disk.inner", "-inf"]);
    refused(&[("outer", "inf")], &["disk.outer", "inf"]);
}

#[test]
fn cameras_at_the_horizon_or_too_far() {
    for position in [
        "[0.0, 0.0, 0.0]",
        "[0.5, 0.0, 0.1]",
        "[0.6, 0.8, 0.0]",
        "[1.0, 0.0, 0.0]",
        "[1e-300, 0, 0]",
    ] {
        refused(&[("position", position)], &["camera.position", "horizon"]);
    }
    assert!(changed(&[("position", "[1.0000000000000002, 0, 0]")]).is_ok());
    refused(
        &[("position", "[1e15, 1.0e9, 0.0]")],
        &["camera.position", "1e15"],
    );
    refused(
        &[("position", "[1e300, 1e300, 0.0]")],
        &["camera.position", "1e15"],
    );
    assert!(changed(&[("position", "[1e15, 0.0, 0.0]")]).is_ok());
}

#[test]
fn cameras_in_the_disks_matter() {
    for position in ["[3.0, 0.0, 0.0]", "[0.0, -12.0, 0.0]", "[5.0, 0.0, 4e-15]"] {
        refused(
            &[("position", position)],
            &["camera.position", "disk.inner", "disk.outer", "plane"],
        );
    }
    for position in ["[2.9, 0.0, 0.0]", "[12.1, 0.0, 0.0]", "[5.0, 0.0, 1e-14]"] {
        assert!(changed(&[("position", position)]).is_ok(), "{position}");
    }
    refused(
        &[
            ("position", "[1.0, 4.0, 0.5]"),
            ("normal", "[4e300, -1e300, 0.0]"),
        ],
        &["camera.position"],
    );
}

#[test]
fn cameras_that_look_nowhere() {
    refused(
        &[("focus", "[20.0, 0.0, 5.0]")],
        &["camera.focus", "camera.position"],
    );
    refused(
        &[("focus", "[20.000000000000004, 0.0, 5.0]")],
        &["camera.focus", "camera.position"],
    );
    assert!(changed(&[("focus", "[20.0000000000001, 0.0, 5.0]")]).is_ok());
    assert!(changed(&[("focus", "[1.7e308, 1.7e308, 1.7e308]")]).is_ok());
}

#[test]
fn pictures_without_an_upward_direction() {
    refused(
        &[("position", "[0.0, 0.0, 40.0]")],
        &["camera.up", "parallel"],
    );
    refused(&[("up", "[-4.0, 0.0, -1.0]")], &["camera.up", "parallel"]);
    refused(
        &[("up", "[4.0, 0.0, 1.000000000000001]")],
        &["camera.up", "parallel"],
    );
    assert!(changed(&[("up", "[4.0, 0.0, 1.0000000000001]")]).is_ok());
    refused(&[("up", "[0, 0, 0]")], &["camera.up", "zero"]);
}

#[test]
fn directions_have_any_length_but_zero() {
    refused(&[("normal", "[0.0, -0.0, 0.0]")], &["disk.normal", "zero"]);
    assert!(
        changed(&[
            ("up", "[0.0, 1e-300, 0.0]"),
            ("normal", "[1e300, 0.0, 1e300]")
        ])
        .is_ok()
    );
    assert!(
        changed(&[
            ("up", "[0.0, 5e-324, 0.0]"),
            ("normal", "[1.7e308, 0.0, 1.7e308]")
        ])
        .is_ok()
    );
}

#[test]
fn fields_of_view() {
    for fov in ["0.0", "-30.0", "180.0", "1e300"] {
        refused(&[("fov", fov)], &["camera.fov", "180"]);
    }
    assert!(changed(&[("fov", "1e-9")]).is_ok());
}

#[test]
fn disks() {
    refused(
        &[("inner", "2.9999999")],
        &["disk.inner", "ISCO", "3 Schwarzschild radii", "stable"],
    );
    refused(&[("inner", "-5.0")], &["disk.inner", "ISCO"]);
    refused(&[("outer", "3.0")], &["disk.outer", "disk.inner"]);
    refused(&[("outer", "2.0")], &["disk.outer", "disk.inner"]);
}

#[test]
fn without_a_disk_its_place_is_free() {
    let sky_in_place = |toml: &str| {
        let (camera, rest) = toml.split_once("[disk]").unwrap();
        let image = &rest[rest.find("[image]").unwrap()..];
        Scene::from_toml(&format!("{camera}[sky]\n{image}"))
    };
    assert!(sky_in_place(GOOD).is_ok());
    let inside = GOOD.replace("[20.0, 0.0, 5.0]", "[5.0, 0.0, 0.0]");
    assert!(sky_in_place(&inside).is_ok() && Scene::from_toml(&inside).is_err());
    let horizon = sky_in_place(&GOOD.replace("[20.0, 0.0, 5.0]", "[0.5, 0.0, 0.0]"));
    assert!(horizon.unwrap_err().to_string().contains("horizon"));
}

#[test]
fn pictures() {
    for (key, full) in [("width", "image.width"), ("height", "image.height")] {
        for value in ["0", "-1", "1000001", "9223372036854775807"] {
            refused(&[(key, value)], &[full, value, "1000000"]);
        }
    }
    assert!(changed(&[("width", "1000000"), ("height", "1000000")]).is_ok());
}

#[test]
fn parts_of_pictures() {
    let cropped = |crop: &str| {
        let toml = format!("{GOOD}crop = {crop}\n");
        Scene::from_toml(&toml).map_err(|error| error.to_string())
    };
    for (crop, words) in [
        ("[60, 0, 5, 5]", "beyond the picture of 64 × 36 pixels"),
        ("[0, 30, 5, 7]", "beyond the picture"),
        ("[-1, 0, 5, 5]", "beyond the picture"),
        ("[1, 0, 9223372036854775807, 5]", "beyond the picture"),
        ("[0, 0, 0, 5]", "at least one column and one row"),
        ("[0, 0, 5, -5]", "at least one column and one row"),
    ] {
        let message = cropped(crop).unwrap_err();
        assert!(
            message.starts_with(&format!("image.crop = {crop}: ")) && message.contains(words),
            "{message}"
        );
    }
    let message = cropped("[0, 0, 5]").unwrap_err();
    assert!(
        message.contains("four whole numbers, [left, top, width, height]; this one has 3"),
        "{message}"
    );
    let message = cropped("[0, 0, 5, 1.5]").unwrap_err();
    assert!(message.contains("expected a whole number"), "{message}");
    let scene = cropped("[60, 0, 4, 36]").unwrap();
    assert_eq!(
        (scene.size().width, scene.size().height, scene.image().width),
        (4, 36, 64)
    );
    assert!(scene.to_toml().ends_with("\ncrop = [60, 0, 4, 36]\n"));
    assert_eq!(Scene::from_toml(&scene.to_toml()).unwrap(), scene);
    // A part that the new size does not have is refused.
    assert!(scene.clone().with_size(63, 36).is_err() && scene.with_size(65, 36).is_ok());
}

#[test]
fn tolerances() {
    for tolerance in ["0.0", "-0.001", "1.5", "nan", "inf"] {
        refused(
            &[("tolerance", tolerance)],
            &["image.tolerance", "pixel", "0.001"],
        );
    }
    for tolerance in ["1.0", "1", "1e-12", "5e-324"] {
        assert!(changed(&[("tolerance", tolerance)]).is_ok(), "{tolerance}");
    }
}
