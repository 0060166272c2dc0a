//! Cameras given by angles, turned, or changed on the command line.

use std::fs;
use std::path::Path;

use darkness::scene::{Animation, Scene};
use image::GrayImage;

use crate::harness::{done, printed, refused, with_draft};

const REST: &str =
    "[disk]\ninner = 3\nouter = 12\n[image]\nwidth = 96\nheight = 54\nantialias = false\n";

/// The picture that the program makes of a scene with options.
fn picture(folder: &Path, scene: &str, options: &[&str]) -> GrayImage {
    let args = [&["render", scene, "--table", "a.table", "-o", "-"], options].concat();
    image::load_from_memory(&done(folder, &args).0)
        .unwrap()
        .into_luma8()
}

#[test]
fn a_scene_by_angles_is_the_scene_by_position_and_options_change_either() {
    let folder = with_draft();
    let here = folder.path();
    let write = |name, camera| fs::write(here.join(name), format!("[camera]\n{camera}\n{REST}"));
    write(
        "angles.toml",
        "radius = 30\ninclination = 80\nazimuth = 40\nfov = 30",
    )
    .unwrap();
    let toml = Scene::load(here.join("angles.toml")).unwrap().to_toml();
    assert!(toml.starts_with("[camera]\nposition = ["), "{toml}");
    fs::write(here.join("position.toml"), toml).unwrap();
    let angles = picture(here, "angles.toml", &[]);
    assert!(angles == picture(here, "position.toml", &[]));
    write(
        "other.toml",
        "position = [0, 0, 20]\nup = [0, 0, 1]\nfov_horizontal = 90",
    )
    .unwrap();
    let changes = [
        "--radius",
        "30",
        "--inclination",
        "80",
        "--azimuth=40",
        "--fov",
        "30",
    ];
    assert!(angles == picture(here, "other.toml", &changes));
    // One angle leaves the others; face-on is possible although the scene's `up` is +z.
    let face_on = picture(here, "angles.toml", &["--inclination", "0"]);
    assert!(face_on != angles);
    assert!(
        face_on
            == picture(
                here,
                "position.toml",
                &["--set", "camera.inclination=0", "--set", "camera.up="]
            )
    );
    let classic = ["--size", "96x54", "--antialias", "false"];
    let face_on = picture(
        here,
        "classic",
        &[&classic[..], &["--inclination", "0"]].concat(),
    );
    assert_eq!(
        face_on.get_pixel(48 + 12, 27),
        face_on.get_pixel(48, 27 + 12)
    );
}

#[test]
fn the_orbits_angles_are_changed_where_there_is_an_orbit() {
    let folder = with_draft();
    let here = folder.path();
    let toml = Animation::load("orbit").unwrap().to_toml();
    let lower = toml.replace("inclination = 80.0", "inclination = 60.0");
    assert_ne!(lower, toml);
    fs::write(here.join("lower.toml"), lower).unwrap();
    let small = ["--frames", "30", "--size", "96x54"];
    let changed = [&small[..], &["--inclination", "60"]].concat();
    assert!(picture(here, "lower.toml", &small) == picture(here, "orbit", &changed));
}

#[test]
fn a_positive_roll_turns_the_picture_clockwise() {
    let folder = with_draft();
    let here = folder.path();
    let square = ["--size", "90x90", "--antialias", "false"];
    let level = picture(here, "classic", &square);
    for (roll, turned) in [
        ("90", image::imageops::rotate90(&level)),
        ("-90", image::imageops::rotate270(&level)),
        ("180", image::imageops::rotate180(&level)),
    ] {
        let roll = format!("camera.roll={roll}");
        let rolled = picture(here, "classic", &[&square[..], &["--set", &roll]].concat());
        let differ = rolled.pixels().zip(turned.pixels()).filter(|(a, b)| a != b);
        assert!(differ.count() <= 4, "{roll}");
    }
    assert!(image::imageops::rotate180(&level) != level);
}

#[test]
fn a_horizontal_field_of_view_stays_when_the_size_changes() {
    let folder = with_draft();
    let here = folder.path();
    let camera = "[camera]\nradius = 30\ninclination = 80\nfov_horizontal = 40\n";
    fs::write(here.join("wide.toml"), format!("{camera}{REST}")).unwrap();
    let square = picture(here, "wide.toml", &["--size", "96x96"]);
    assert!(square == picture(here, "wide.toml", &["--size", "96x96", "--fov", "40"]));
}

#[test]
fn any_key_can_be_set() {
    let folder = with_draft();
    let here = folder.path();
    let small = ["--size", "96x54", "--frames", "60"];
    let with = |options: &[&str]| picture(here, "approach", &[&small[..], options].concat());
    let keyframe = printed(here, &["scene", "approach"]);
    let frame = keyframe
        .lines()
        .find_map(|line| line.strip_prefix("frame = ").filter(|frame| *frame != "1"))
        .unwrap();
    let nearer = format!("animation.keyframe.{frame}.position=[9, 0, 3]");
    assert!(with(&[]) != with(&["--set", &nearer]));
    let lit = [
        "--set",
        "disk.light.model=bolometric",
        "--size",
        "8x8",
        "-o",
        "lit.png",
    ];
    done(here, &[&["render"], &lit[..]].concat());
    assert_eq!(
        image::open(here.join("lit.png")).unwrap().color(),
        image::ColorType::Rgb8
    );
}

#[test]
fn what_excludes_each_other_or_is_not_allowed_is_refused_with_key_and_option() {
    let folder = with_draft();
    let here = folder.path();
    for (options, words) in [
        (
            &["--fov", "200"][..],
            &["--fov 200: a flat picture's field of view", "180"][..],
        ),
        (&["--radius", "0.5"], &["--radius 0.5", "horizon"]),
        (&["--inclination", "nan"], &["--inclination", "finite"]),
        (
            &["--set", "camera.fov=9", "--fov", "9"],
            &["--fov 9", "--set camera.fov=9 sets this too"],
        ),
        (
            &["--set", "camera.position=[9,0,1]", "--azimuth", "9"],
            &["--azimuth 9", "sets this too"],
        ),
        (&["--set", "camera.fvo=9"], &["--set camera.fvo=9", "`fvo`"]),
        (
            &["--set", "camera.fov=wide"],
            &["--set camera.fov=wide", "a number", "camera.fov"],
        ),
        (
            &["--set", "disk.light.temperature=1"],
            &["--set disk.light.temperature=1", "model is missing"],
        ),
        (
            &["--set", "image.width.x=1"],
            &["--set image.width.x=1", "width is no table"],
        ),
        (&["--set", "camera.fov"], &["KEY=VALUE"]),
        (&["--set", "=9"], &["KEY=VALUE"]),
        (
            &["--tolerance", "0"],
            &["--tolerance 0", "an edge's largest error"],
        ),
    ] {
        refused(here, &[&["render"], options].concat(), 2, words);
    }
    for (options, words) in [
        (
            &["--fov", "9"][..],
            &["--fov 9", "keyframes set the fov"][..],
        ),
        (
            &["--radius", "9"],
            &["--radius 9", "keyframes set the position"],
        ),
        (
            &["--set", "animation.keyframe.7.fov=9"],
            &["no keyframe at frame 7"],
        ),
    ] {
        refused(here, &[&["render", "approach"], options].concat(), 2, words);
    }
    refused(
        here,
        &["render", "orbit", "--set", "camera.position=[9,0,1]"],
        2,
        &["--set camera.position=[9,0,1]", "animation.orbit sets"],
    );
    for (camera, words) in [
        (
            "radius = 30\ninclination = 9\nposition = [9, 0, 1]\nfov = 9",
            ["camera.position", "both given"],
        ),
        (
            "radius = 30\nfov = 9",
            ["camera.inclination is missing", "line 1"],
        ),
        (
            "azimuth = 30\nfov = 9",
            ["camera.radius is missing", "line 1"],
        ),
        (
            "position = [9, 0, 1]\nfov = 9\nfov_horizontal = 9",
            ["camera.fov_horizontal", "both given"],
        ),
        (
            "position = [9, 0, 1]\nfov_horizontal = 180",
            ["camera.fov_horizontal = 180", "below 180"],
        ),
        (
            "radius = 30\ninclination = 0\nup = [0, 0, 1]\nroll = 5\nfov = 9",
            ["camera.up", "parallel"],
        ),
        (
            "radius = 30\ninclination = 0\nroll = inf\nfov = 9",
            ["camera.roll", "finite"],
        ),
    ] {
        fs::write(here.join("bad.toml"), format!("[camera]\n{camera}\n{REST}")).unwrap();
        refused(here, &["render", "bad.toml"], 2, &words);
    }
}
