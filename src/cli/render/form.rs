//! Which pixels a scene's frames have in a format.

use super::super::misuse::misuse;
use super::args::RenderArgs;
use super::format::Format;
use crate::render::Form;
use crate::scene::{Animation, ImageSize, Layer, LayerSet};

/// The pixels of the frames.
///
/// # Errors
/// The format cannot hold what the scene or the options ask for.
pub(super) fn checked(
    args: &RenderArgs,
    animation: &Animation,
    format: Format,
) -> anyhow::Result<Form> {
    let name = format.extension();
    if args.bits.is_some() && format != Format::Png {
        return Err(misuse(format!(
            "--bits is the size of a PNG picture's samples, and .{name} files have their own; leave it out"
        )));
    }
    if args.exposure.is_some() && format.has_layers() {
        return Err(misuse(format!(
            "--exposure changes pictures and films, and .{name} files hold light as it is; leave it out"
        )));
    }
    of(animation, format)
}

/// The pixels of an animation's frames, apart from what the options ask for.
///
/// # Errors
/// The format cannot hold them.
pub(super) fn of(animation: &Animation, format: Format) -> anyhow::Result<Form> {
    let (layers, bits) = (animation.layers(), animation.bits());
    let in_colour = animation.shows_colour();
    let name = format.extension();
    if format.has_layers() {
        return Ok(Form::Layers(with_defaults(layers, format, in_colour)));
    }
    if format == Format::Svg {
        return Err(misuse(
            "a .svg file holds the outline of one frame's disk and no pixels; write it with `darkness render -o`, one \
             frame at a time",
        ));
    }
    if !layers.is_empty() {
        return Err(misuse(format!(
            ".{name} files hold no layers of data; name a .exr or .npz file with -o, or leave out the layers"
        )));
    }
    if bits == 16 && format != Format::Png {
        return Err(misuse(format!(
            ".{name} films have 8 bits a sample, and the scene asks for 16; set image.bits = 8, or write .png or .exr \
             files"
        )));
    }
    if in_colour && format == Format::Y4mGray {
        return Err(misuse(
            "y4m-gray films hold masks, and this scene has colour; choose --format y4m, or remove [disk.light] and \
             [sky]",
        ));
    }
    let ImageSize { width, height } = animation.size();
    if format.shares_chroma() && (width % 2 == 1 || height % 2 == 1) {
        let (even_width, even_height) = (width + width % 2, height + height % 2);
        let advice = if animation.region().size() == animation.image() {
            format!("choose --size {even_width}x{even_height}")
        } else {
            format!("choose a --crop of {even_width} by {even_height} pixels")
        };
        return Err(misuse(format!(
            "{width} × {height}: in .{name} films 2 × 2 pixels share one sample of colour (4:2:0), so width and height \
             must be even; {advice}, or --format raw"
        )));
    }
    Ok(match (in_colour, bits) {
        (false, 16) => Form::Grey16,
        (false, _) => Form::Grey8,
        (true, 16) => Form::Rgb16,
        (true, _) => Form::Rgb8,
    })
}

/// The pixels of the frames before their file is known: layers that are asked for go into a file that holds them.
///
/// # Errors
/// Those of [`checked`].
pub(super) fn expected(args: &RenderArgs, animation: &Animation) -> anyhow::Result<Form> {
    let format = args.format.unwrap_or_else(|| Format::default_of(animation));
    checked(args, animation, format)
}

/// The layers of a file: those that the scene names, or else coverage, and colour where there is any. An OpenEXR file
/// with colour has alpha too.
fn with_defaults(layers: LayerSet, format: Format, in_colour: bool) -> LayerSet {
    let layers = match (layers.is_empty(), in_colour) {
        (false, _) => layers,
        (true, false) => LayerSet::default().with(Layer::Coverage),
        (true, true) => [Layer::Coverage, Layer::Colour].into_iter().collect(),
    };
    if format == Format::Exr && layers.has(Layer::Colour) {
        layers.with(Layer::Alpha)
    } else {
        layers
    }
}
