//! Guards against saved views that are not what was seen, files that are lost, and scenes that are not read again.

use std::fs;
use std::path::Path;

use darkness::Scene;

use crate::display::{
    SIZE_OPTION, Window, can_show, drawn, read, steered, wait_until, with_tables,
};
use crate::process::done;

/// Waits for a file that the window writes, and returns its bytes.
fn written(window: &Window, name: &str) -> Vec<u8> {
    let path = window.folder.path().join(name);
    let is_whole = || fs::metadata(&path).is_ok_and(|metadata| metadata.len() > 0);
    wait_until(name, is_whole);
    fs::read(path).unwrap()
}

/// Renders a saved scene, and returns the picture's file.
fn rendered(folder: &Path, scene: &str, picture: &str) -> Vec<u8> {
    done(folder, &["render", scene, "-o", picture]);
    fs::read(folder.join(picture)).unwrap()
}

#[test]
fn a_saved_view_is_rendered_to_the_picture_that_was_seen() {
    if !can_show() {
        return;
    }
    for (name, keys) in [
        ("classic", ""),
        ("classic", "l"),
        ("stars", ""),
        ("lit", "comma"),
        ("luminet", ""),
    ] {
        let folder = with_tables();
        fs::write(folder.path().join("view-0001.toml"), "mine").unwrap();
        let window = Window::open_in(folder, &[name, SIZE_OPTION]);
        window.shows_what("a picture", |picture| {
            picture.bytes.iter().any(|&byte| byte > 0)
        });
        if !keys.is_empty() {
            window.hand(&format!("key {keys}"));
        }
        window.drag(1, (160, 90), (167, 79));
        window.drag(3, (160, 90), (150, 95));
        window.hand("click 4 click 4 key bracketright");
        window.hand("key s key p");
        let toml = written(&window, "view-0002.toml");
        let picture = written(&window, "view-0001.png");
        let here = window.folder.path();
        assert!(Scene::from_toml(str::from_utf8(&toml).unwrap()).is_ok());
        assert_eq!(fs::read(here.join("view-0001.toml")).unwrap(), b"mine");
        assert!(
            rendered(here, "view-0002.toml", "again.png") == picture,
            "{name} {keys}"
        );
        // Once the message about the file is gone.
        window.shows(&read(&here.join("again.png")));
    }
}

#[test]
fn pictures_of_layers_hold_the_false_colours_or_the_layer_itself() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    window.shows(&drawn(&steered("lit", |_| {})));
    window.hand("key l l l l l key p");
    written(&window, "view-0001.png");
    let colours = read(&window.folder.path().join("view-0001.png"));
    assert!(
        colours
            .bytes
            .chunks(3)
            .any(|pixel| pixel[2] > pixel[1] && pixel[1] > 0)
    );

    let window = Window::open_in(with_tables(), &["lit", SIZE_OPTION, "--picture-format=exr"]);
    window.shows(&drawn(&steered("lit", |_| {})));
    window.hand("key p");
    let light = written(&window, "view-0001.exr");
    window.hand("key l l l l l key p key s");
    let redshift = written(&window, "view-0002.exr");
    written(&window, "view-0001.toml");
    let here = window.folder.path();
    assert!(rendered(here, "view-0001.toml", "again.exr") == redshift);
    fs::write(here.join("lit.toml"), steered("lit", |_| {}).to_toml()).unwrap();
    assert!(rendered(here, "lit.toml", "lit.exr") == light);
}

#[test]
fn a_scene_that_changes_is_read_again_and_what_is_wrong_with_it_is_told() {
    if !can_show() {
        return;
    }
    let folder = with_tables();
    let path = folder.path().join("mine.toml");
    let scene = steered("lit", |_| {});
    fs::write(&path, scene.to_toml()).unwrap();
    let window = Window::open_in(folder, &["mine.toml"]);
    let first = drawn(&scene);
    window.shows(&first);
    // An error is written over the last good picture.
    let path = window.folder.path().join("mine.toml");
    fs::write(&path, "[camera]\nposition = [30, 0, 0.5]\nfov = \"wide\"\n").unwrap();
    let told = window.shows_what("an error", |picture| *picture != first);
    let upper = 3 * 320 * 20;
    assert!(told.bytes[..upper] == first.bytes[..upper]);
    let smaller = scene.to_toml().replace("outer = 12.0", "outer = 9.0");
    fs::write(&path, &smaller).unwrap();
    window.shows(&drawn(&Scene::from_toml(&smaller).unwrap()));
}
