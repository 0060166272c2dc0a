//! Frames as a user gets them: drawn by the program itself, which follows each pixel's ray by itself where it finds that
//! its curves do not reach a view.

use std::fs;

use assert_cmd::cargo::cargo_bin_cmd;
use darkness::scene::Scene;
use tempfile::{TempDir, tempdir};

/// A folder with the standard table in it.
pub(crate) struct Program {
    folder: TempDir,
}

/// A picture, and how it came about.
pub(crate) struct Drawn {
    pub(crate) pixels: Vec<u8>,
    /// Whether from curves, or else each pixel by itself.
    pub(crate) by_curves: bool,
}

impl Program {
    pub(crate) fn new() -> Self {
        let program = Self {
            folder: tempdir().unwrap(),
        };
        program.run(&["table", "standard"]);
        program
    }

    /// Runs the program to its end, and returns what it says.
    fn run(&self, args: &[&str]) -> String {
        let mut command = cargo_bin_cmd!("darkness");
        command
            .current_dir(self.folder.path())
            .env_remove("DARKNESS_TABLE")
            .args(args);
        let output = command.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{args:?}: {said}");
        said
    }

    pub(crate) fn draw(&self, scene: &Scene) -> Drawn {
        let (file, picture) = (
            self.folder.path().join("scene.toml"),
            self.folder.path().join("scene.png"),
        );
        // What a pixel's centre sees can be compared with its ray.
        fs::write(&file, scene.with_antialias(false).to_toml()).unwrap();
        let said = self.run(&["render", "scene.toml"]);
        let pixels = image::open(&picture).unwrap().to_luma8().into_raw();
        Drawn {
            pixels,
            by_curves: !said.contains("followed by itself"),
        }
    }
}
