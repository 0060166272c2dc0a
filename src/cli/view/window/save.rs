//! Views as files: scenes, and pictures.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::super::super::render::picture;
use super::super::PictureFormat;
use super::painter::{Look, ViewPainter};
use super::shown::Shown;
use crate::output::write_whole;
use crate::render::Pixels;
use crate::scene::{Scene, SkyFile, StarSource};

/// Writes the scene of a view into the current folder, and returns the file's name.
///
/// # Errors
/// The file cannot be written.
pub(super) fn scene(scene: &Scene) -> anyhow::Result<PathBuf> {
    let text = here(scene)?.to_toml();
    write_new("toml", text.as_bytes())
}

/// Writes a picture of what is looked at, and returns the file's name.
///
/// # Errors
/// It cannot be drawn, or the file cannot be written.
pub(super) fn picture(
    look: Look<'_>,
    format: PictureFormat,
    painter: &mut ViewPainter<'_>,
) -> anyhow::Result<PathBuf> {
    let scene = here(look.scene)?;
    if format == PictureFormat::Exr {
        let form = picture::exr_form(&scene)?;
        let encode = |pixels: Pixels<'_>, method: &_| picture::encode(&scene, pixels, method);
        let file = painter.draw_as(look.scene, form, encode)?;
        return write_new("exr", &file);
    }
    let is_as_rendered = look.order.is_none() && !matches!(look.shown, Shown::Channel(..));
    let file = if is_as_rendered {
        let encode = |pixels: Pixels<'_>, method: &_| picture::encode(&scene, pixels, method);
        painter.draw_as(look.scene, look.shown.form(), encode)?
    } else {
        let size = scene.image();
        let mut pixels = vec![0; size.width as usize * size.height as usize];
        let at_rest = Look {
            coarseness: None,
            ..look
        };
        painter.paint(at_rest, &mut pixels)?;
        let bytes: Vec<u8> = pixels
            .iter()
            .flat_map(|&pixel| [(pixel >> 16) as u8, (pixel >> 8) as u8, pixel as u8])
            .collect();
        picture::encode(&scene, Pixels::Rgb8(&bytes), painter.method()?)?
    };
    write_new("png", &file)
}

/// Returns the scene with the files of its sky named from the current folder, in which it is saved.
///
/// # Errors
/// A path that is no text.
fn here(scene: &Scene) -> anyhow::Result<Scene> {
    let Some(mut sky) = scene.sky().cloned() else {
        return Ok(scene.clone());
    };
    let stars = sky.stars.as_mut().map(|stars| &mut stars.source);
    let catalogue = stars.and_then(|source| match source {
        StarSource::File(file) => Some(file),
        StarSource::Synthetic { .. } => None,
    });
    for file in sky.panorama.iter_mut().chain(catalogue) {
        let path = file.path.to_str().ok_or_else(|| {
            let path = file.path.display();
            anyhow::anyhow!("{path}: this name is no text, and a scene cannot hold it")
        })?;
        *file = SkyFile::new(path);
    }
    Ok(scene.clone().with_sky(Some(sky))?)
}

/// Writes a file that was not there: `view-0001`, or with the next number that is free.
///
/// # Errors
/// It cannot be written.
fn write_new(extension: &str, bytes: &[u8]) -> anyhow::Result<PathBuf> {
    write_new_in(Path::new(""), extension, bytes)
}

fn write_new_in(folder: &Path, extension: &str, bytes: &[u8]) -> anyhow::Result<PathBuf> {
    let mut number = 1_u32;
    loop {
        let path = folder.join(format!("view-{number:04}.{extension}"));
        let failed = |error: io::Error| {
            anyhow::anyhow!("{}: the file cannot be written: {error}", path.display())
        };
        // Takes the name: no other file is replaced below.
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                number += 1;
                continue;
            }
            Err(error) => return Err(failed(error)),
        }
        if let Err(error) = write_whole(&path, |file| file.write_all(bytes)) {
            let _ = fs::remove_file(&path);
            return Err(failed(error));
        }
        return Ok(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Sky, Stars};

    #[test]
    fn numbers_count_on_and_no_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = |number: u32| folder.path().join(format!("view-{number:04}.toml"));
        fs::write(path(2), "mine").unwrap();
        for number in [1, 3, 4] {
            assert_eq!(
                write_new_in(folder.path(), "toml", b"new").unwrap(),
                path(number)
            );
            assert_eq!(fs::read(path(number)).unwrap(), b"new");
        }
        assert_eq!(fs::read(path(2)).unwrap(), b"mine");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
        let missing = folder.path().join("missing");
        let error = write_new_in(&missing, "png", b"").unwrap_err().to_string();
        assert!(error.contains("view-0001.png"), "{error}");
    }

    #[test]
    fn files_of_a_sky_are_named_from_the_current_folder() {
        let sky = Sky {
            panorama: Some(SkyFile {
                name: "night.exr".into(),
                path: "skies/night.exr".into(),
            }),
            stars: Some(Stars::new(StarSource::File(SkyFile {
                name: "../stars.csv".into(),
                path: "skies/../stars.csv".into(),
            }))),
            ..Sky::default()
        };
        let scene = Scene::builtin("lit").unwrap().with_sky(Some(sky)).unwrap();
        let text = here(&scene).unwrap().to_toml();
        assert!(text.contains("panorama = \"skies/night.exr\""), "{text}");
        assert!(text.contains("stars = \"skies/../stars.csv\""), "{text}");
    }
}
