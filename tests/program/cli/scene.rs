//! `darkness scene`, and files that are not scenes.

use std::fs;

use darkness::scene::builtins;
use tempfile::tempdir;

use super::SMALL;
use crate::harness::{done, listing, printed, refused, run, with_draft};

#[test]
fn bad_scenes_are_refused_with_their_name() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    refused(here, &["render", "clasic"], 2, &["clasic", "edge-on"]);
    refused(
        here,
        &["render", "orbt"],
        2,
        &["orbt is neither", "did you mean orbit?"],
    );
    refused(
        here,
        &["scene", "lit_orbit"],
        2,
        &["did you mean lit-orbit?"],
    );
    refused(
        here,
        &["render", "."],
        2,
        &["scene file .", "it is a folder"],
    );
    refused(here, &["job", "slurm", "no.toml"], 2, &["no.toml"]);
    fs::write(here.join("a.png"), b"\x89PNG\r\n").unwrap();
    let words = ["a.png", "not a text", "-o a.png"];
    refused(here, &["render", "a.png"], 2, &words);
    refused(
        here,
        &["render", "b.exr"],
        2,
        &["b.exr is neither", "-o b.exr"],
    );
    fs::remove_file(here.join("a.png")).unwrap();
    let text = builtins()[0].toml().replace("inner = 3.0", "inner = 2.0");
    fs::write(here.join("mine.toml"), text).unwrap();
    refused(
        here,
        &["render", "mine.toml"],
        2,
        &["mine.toml", "disk.inner = 2.0", "ISCO"],
    );
    assert_eq!(listing(here), ["mine.toml"]);
}

#[test]
fn scenes_are_listed_and_a_printed_one_renders_the_same_picture() {
    let folder = with_draft();
    let here = folder.path();
    let list = printed(here, &["scene"]);
    assert_eq!(list.lines().count(), builtins().len());
    for scene in builtins() {
        let name = scene.name();
        assert!(list.contains(name) && list.contains(scene.description()));
        let toml = printed(here, &["scene", name]);
        assert_eq!(toml, scene.toml());
        let file = format!("my {name}.toml");
        fs::write(here.join(&file), toml).unwrap();
        let [theirs, mine] = [name, &file].map(|scene| {
            let args = ["render", scene, "--table", "a.table", "--size", SMALL];
            let one = ["--frames", "1", "-o", "-"];
            done(here, &[&args[..], &one].concat()).0
        });
        assert_eq!(theirs, mine);
    }
    refused(
        here,
        &["scene", "clasic"],
        2,
        &["clasic", "classic", "photon-ring"],
    );
}

/// What the scene's own text says of it.
#[test]
fn edge_on_is_its_own_mirror_image() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let edges = |antialias| {
        let options = ["--antialias", antialias, "--format", "raw", "-o", "-"];
        let mask = done(here, &[&["render", "edge-on"], &options[..]].concat()).0;
        let rows: Vec<&[u8]> = mask.chunks(1920).collect();
        let pairs = rows.iter().zip(rows.iter().rev());
        let pairs = pairs.flat_map(|(above, below)| above.iter().zip(*below));
        let apart = pairs.map(|(above, below)| above.abs_diff(*below)).max();
        // Where the disk itself would be, beside the hole and within its outer edge, there is nothing.
        assert!(rows[539][1..300].iter().all(|&grey| grey == 0));
        apart
    };
    assert_eq!(edges("false"), Some(0));
    assert_eq!(edges("true"), Some(1));
}

#[test]
fn files_that_are_not_scenes_are_refused_in_a_sentence() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let scene = builtins()[0].toml();
    let longer = scene.replacen("0.0,", "0.0, 1.0,", 1);
    assert_ne!(longer, scene);
    for (text, word) in [
        (longer, "three numbers"),
        (scene.replace("outer = 12.0", "outer = 1e101"), "disk.outer"),
        ("#".repeat((1 << 20) + 1), "1 MiB"),
    ] {
        fs::write(here.join("scene.toml"), text).unwrap();
        let (output, stderr) = run(here, &["render", "scene.toml"]);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(word), "{word}: {stderr}");
        assert!(stderr.len() < 2000, "{} bytes of error", stderr.len());
    }
}
