//! Guards against a wrong pixel: frames by curves and by pixels are compared with the reference masks, and the three
//! methods with each other on every scene.

use std::path::{Path, PathBuf};

use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::Adaptive;
use darkness::render::mask::WHITE;
use darkness::scene::{Scene, builtins};

use crate::methods::{by_curves, by_pixels, differing};
use crate::tables::table;

/// The value in a reference mask for pixels that may be either colour: moving the sample by a thousandth of a pixel
/// changes the answer.
const EITHER: u8 = 128;

/// The scene files beside the reference's masks; those of shares (`coverage-*`) are another test's.
fn mask_scenes() -> Vec<(PathBuf, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/masks");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .filter(|path| {
            !path
                .file_name()
                .unwrap()
                .to_string_lossy()
                .starts_with("coverage-")
        })
        .collect();
    paths.sort();
    assert_eq!(paths.len(), 6, "masks in {}", folder.display());
    paths
        .into_iter()
        .map(|path| {
            let scene = Scene::load(&path).unwrap_or_else(|error| panic!("{error}"));
            (path, scene)
        })
        .collect()
}

#[test]
fn not_one_pixel_differs_from_the_reference() {
    let lookup = table("standard").lookup();
    for (path, scene) in mask_scenes() {
        let known = image::open(path.with_extension("png")).unwrap().to_luma8();
        let size = scene.image();
        assert_eq!(
            known.dimensions(),
            (size.width, size.height),
            "{}",
            path.display()
        );
        let known = known.into_raw();
        let certain = known.iter().filter(|&&value| value != EITHER).count();
        // A mask of such pixels alone would accept any frame.
        assert!(
            known.contains(&WHITE) && known.contains(&0),
            "{}",
            path.display()
        );
        assert!(
            certain * 100 > known.len() * 99,
            "{}: {certain} pixels are known",
            path.display()
        );
        for (method, frame) in [
            ("curves", by_curves(&scene, &lookup)),
            ("pixels", by_pixels(&scene, &lookup)),
        ] {
            let wrong: Vec<_> = (0..known.len())
                .filter(|&k| known[k] != EITHER && frame[k] != known[k])
                .map(|k| (k % size.width as usize, k / size.width as usize))
                .collect();
            assert!(
                frame.iter().all(|value| [0, WHITE].contains(value)),
                "{}, {method}: a grey pixel",
                path.display()
            );
            assert!(
                wrong.is_empty(),
                "{}, {method}: {} pixels differ, the first at {:?}",
                path.display(),
                wrong.len(),
                wrong[0]
            );
        }
    }
}

/// A small copy of every scene with a disk: the reference's and the program's own.
fn small_scenes() -> Vec<(String, Scene)> {
    let from_files = mask_scenes()
        .into_iter()
        .map(|(path, scene)| (path.file_name().unwrap().display().to_string(), scene));
    let own = builtins().iter().map(|builtin| {
        let name = builtin.name();
        (name.to_owned(), Scene::builtin(name).unwrap())
    });
    from_files
        .chain(own)
        .filter(|(_, scene)| scene.disk().is_some())
        .map(|(name, scene)| {
            let square = scene.image().width == scene.image().height;
            let (width, height) = if square { (160, 160) } else { (240, 136) };
            (name, scene.with_size(width, height).unwrap())
        })
        .collect()
}

#[test]
fn the_methods_agree_on_every_scene() {
    let lookup = table("standard").lookup();
    let scenes = small_scenes();
    assert_eq!(scenes.len(), 22);
    for (name, scene) in scenes {
        let exact = by_pixels(&scene, &Exact);
        assert!(
            exact.contains(&WHITE) && exact.contains(&0),
            "{name}: nothing to compare"
        );
        for (method, frame) in [
            ("curves from the table", by_curves(&scene, &lookup)),
            ("curves from the exact method", by_curves(&scene, &Exact)),
            ("the table, pixel by pixel", by_pixels(&scene, &lookup)),
            ("integration", by_pixels(&scene, &Adaptive::default())),
        ] {
            let count = differing(&format!("{name}, {method}"), &scene, &exact, &frame);
            assert_eq!(count, 0, "{name}, {method}: pixels differ");
        }
    }
}
