//! The file of one picture that is drawn elsewhere: the one that `darkness render` makes of its scene.

use super::super::method::{Method, hex};
use super::form;
use super::format::Format;
use super::origin::FrameOrigin;
use super::{exr, png, sky};
use crate::render::{Form, Pixels};
use crate::scene::{Animation, Layer, Scene};

/// Returns the pixels of a scene's OpenEXR file.
///
/// # Errors
/// None of a scene that is checked.
pub(in crate::cli) fn exr_form(scene: &Scene) -> anyhow::Result<Form> {
    form::of(&Animation::from_toml(&scene.to_toml())?, Format::Exr)
}

/// Returns the file of a scene's picture: OpenEXR for layers, else PNG. The sky is named as in the scene's text.
///
/// # Errors
/// A file of the sky that cannot be read, or not enough memory.
pub(in crate::cli) fn encode(
    scene: &Scene,
    pixels: Pixels<'_>,
    method: &Method,
) -> anyhow::Result<Vec<u8>> {
    let shows_light = match pixels {
        Pixels::Rgb8(_) | Pixels::Rgb16(_) => true,
        Pixels::Grey8(_) | Pixels::Grey16(_) => false,
        Pixels::Planes(planes) => planes.iter().any(|plane| plane.layer == Layer::Colour),
    };
    let origin = FrameOrigin {
        scene: hex(scene.to_toml().as_bytes()),
        table: method.fingerprint(),
        sky: sky::fingerprint(scene.sky().filter(|_| shows_light))?,
        frame: 1,
    };
    let size = scene.image();
    Ok(match pixels {
        Pixels::Planes(planes) => exr::encode(planes, (size, scene.region()), &origin)?,
        Pixels::Grey8(_) => png::encode(pixels, size, !scene.antialias(), &origin)?,
        _ => png::encode(pixels, size, false, &origin)?,
    })
}
