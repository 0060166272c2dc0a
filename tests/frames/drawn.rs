//! Frames as a user gets them: the program draws them, and evaluates each pixel's own ray where its curves are not
//! accurate enough for a view.

use std::fs;

use darkness::scene::Scene;
use tempfile::{TempDir, tempdir};

use crate::process::done;

/// A folder with the standard table in it.
pub(crate) struct Program {
    folder: TempDir,
}

/// A picture, and the method that drew it.
pub(crate) struct Drawn {
    pub(crate) pixels: Vec<u8>,
    /// True if it was drawn from curves, false if pixel by pixel.
    pub(crate) by_curves: bool,
}

impl Program {
    pub(crate) fn new() -> Self {
        let program = Self {
            folder: tempdir().unwrap(),
        };
        done(program.folder.path(), &["table", "standard"]);
        program
    }

    pub(crate) fn draw(&self, scene: &Scene) -> Drawn {
        let (file, picture) = (
            self.folder.path().join("scene.toml"),
            self.folder.path().join("scene.png"),
        );
        // Hard edges: a pixel shows what its centre sees, and can be compared with its ray.
        fs::write(&file, scene.clone().with_antialias(false).to_toml()).unwrap();
        let (_, said) = done(self.folder.path(), &["render", "scene.toml"]);
        let pixels = image::open(&picture).unwrap().to_luma8().into_raw();
        Drawn {
            pixels,
            by_curves: !said.contains("followed by itself"),
        }
    }
}
