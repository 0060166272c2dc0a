//! Every scene of the pages.

use darkness::scene::Animation;
use tempfile::tempdir;

use super::markdown::{page, pages};
use crate::harness::{fails, run};

/// Returns the README's scene with all keys.
fn reference() -> String {
    let readme = page("README.md");
    let blocks = readme.blocks();
    let mut scenes = blocks.iter().filter(|block| block.language == "toml");
    let scene = scenes.next().unwrap().lines.join("\n");
    assert!(scenes.next().is_none(), "one scene is enough");
    scene
}

#[test]
fn scenes_and_parts_of_scenes_are_read() {
    for page in pages() {
        for block in page.blocks() {
            if block.language == "toml" {
                let mut scene = block.lines.join("\n");
                if !scene.contains("[camera]") {
                    scene.insert_str(0, "[camera]\n[disk]\n");
                }
                let read = Animation::from_toml(&scene);
                assert!(read.is_ok(), "{}: {}", page.name, read.unwrap_err());
            }
        }
    }
}

#[test]
fn what_the_reference_calls_a_default_is_one() {
    let scene = reference();
    let whole = Animation::from_toml(&scene).unwrap();
    let defaults = scene.lines().filter(|line| line.contains("# default"));
    let mut count = 0;
    for line in defaults {
        let without = Animation::from_toml(&scene.replace(&format!("{line}\n"), ""));
        assert_eq!(without.unwrap().to_toml(), whole.to_toml(), "{line}");
        count += 1;
    }
    assert!(count > 15, "{count} defaults");
}

#[test]
fn the_reference_has_every_key() {
    let folder = tempdir().unwrap();
    let mut scene = reference();
    scene.insert(0, '\n');
    let tables = [
        "camera",
        "disk",
        "disk.light",
        "sky",
        "image",
        "animation",
        "animation.keyframe.1",
    ];
    for table in tables {
        let key = format!("{table}.unknown=1");
        let built_in = if table == "sky" { "stars" } else { "plunge" };
        let (output, told) = run(
            folder.path(),
            &["render", built_in, "--set", &key, "--dry-run"],
        );
        fails(&output, 2, &["unknown key"]);
        let (_, known) = told.split_once("expected").unwrap();
        let (known, _) = known.split_once("\nin").unwrap();
        let keys: Vec<_> = known.split('`').skip(1).step_by(2).collect();
        assert!(keys.len() > 1, "{told}");
        for key in keys {
            let is_there =
                scene.contains(&format!("{key} = ")) || scene.contains(&format!("[{table}.{key}]"));
            let is_named = scene
                .lines()
                .any(|line| line.starts_with("keyframe") && line.contains(key));
            assert!(is_there || is_named, "{table}: {key}");
        }
    }
}
