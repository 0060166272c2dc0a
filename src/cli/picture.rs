//! Where a picture goes.

use std::ffi::OsString;
use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use super::{Misuse, StdoutError, target};
use crate::output::write_whole;
use crate::render::png;
use crate::scene::ImageSize;

/// Where a picture goes, checked.
#[derive(Debug)]
pub(super) enum Destination {
    Stdout,
    File(PathBuf),
}

impl Destination {
    /// The place that `-o` names, or else the scene's name with .png in the current folder.
    ///
    /// # Errors
    /// What stands in the way of a picture there.
    pub(super) fn new(output: Option<&Path>, scene: &Path) -> anyhow::Result<Self> {
        let path = output.map_or_else(|| default_name(scene), Path::to_owned);
        if path == Path::new("-") && io::stdout().is_terminal() {
            return Err(Misuse::PictureToTerminal.into());
        }
        Self::checked(path, "png", scene)
    }

    /// The place `path`, for a picture of that ending that is made of `scene`; - is the standard output.
    ///
    /// # Errors
    /// What stands in the way of a picture there.
    pub(super) fn checked(
        path: PathBuf,
        ending: &'static str,
        scene: &Path,
    ) -> anyhow::Result<Self> {
        if path == Path::new("-") {
            return Ok(Self::Stdout);
        }
        let has_ending = path
            .extension()
            .is_some_and(|its| its.eq_ignore_ascii_case(ending));
        if !has_ending {
            return Err(Misuse::Ending { path, ending }.into());
        }
        if target::same_file(&path, scene) {
            return Err(Misuse::OntoInput {
                option: target::OUTPUT,
                path,
                what: "scene",
            }
            .into());
        }
        target::check(&path, target::OUTPUT)?;
        Ok(Self::File(path))
    }

    /// Checks that the picture does not go over `table`.
    ///
    /// # Errors
    /// [`Misuse::OntoInput`]
    pub(super) fn spares(&self, table: &Path) -> Result<(), Misuse> {
        match self {
            Self::File(path) if target::same_file(path, table) => Err(Misuse::OntoInput {
                option: target::OUTPUT,
                path: path.clone(),
                what: "table",
            }),
            _ => Ok(()),
        }
    }

    /// Writes the picture as a grey PNG: a file whole or not at all.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write_png(&self, pixels: &[u8], size: ImageSize) -> anyhow::Result<()> {
        let ImageSize { width, height } = size;
        self.write(&png::encode(pixels, width, height)?)
    }

    /// Writes a picture's bytes: a file whole or not at all.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write(&self, bytes: &[u8]) -> anyhow::Result<()> {
        match self {
            Self::File(path) => write_whole(path, |file| file.write_all(bytes)).map_err(|error| {
                anyhow::anyhow!("{}: the picture cannot be written: {error}", path.display())
            }),
            Self::Stdout => {
                let mut stdout = io::stdout().lock();
                stdout
                    .write_all(bytes)
                    .and_then(|()| stdout.flush())
                    .map_err(StdoutError)?;
                Ok(())
            }
        }
    }
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stdout => write!(f, "standard output"),
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}

/// `mine.toml` gives `mine.png`, `classic` gives `classic.png`.
fn default_name(scene: &Path) -> PathBuf {
    let mut name = scene
        .file_stem()
        .map_or_else(|| OsString::from("picture"), OsString::from);
    name.push(".png");
    name.into()
}
