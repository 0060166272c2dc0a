//! The files of a sky: when they are read, what tells of them, and that they stay whole.

use std::fs;
use std::process::Stdio;
use std::time::Instant;

use super::{MOVING, STILL, channels, with_skies, write_panorama};
use crate::harness::{
    PATTERN, darkness, done, files, listing, printed, refused, run, with_animation,
};

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
