//! The scene and the frames that the arguments ask for, checked.

use super::super::frame_range::FrameRange;
use super::super::method::{Checked, Method};
use super::super::misuse::misuse;
use super::super::progress::{Report, warn};
use super::args::RenderArgs;
use super::format::Format;
use super::memory;
use crate::render::Form;
use crate::scene::{Animation, ImageSize, LayerSet, SceneError};

/// The scene, with what the options change of it.
///
/// # Errors
/// The options contradict each other or the scene, or the scene is refused.
pub(super) fn animation(args: &RenderArgs) -> anyhow::Result<Animation> {
    for (given, flag) in [
        (args.tolerance.is_some(), "--tolerance"),
        (args.explain, "--explain"),
        (args.antialias == Some(true), "--antialias"),
        (args.timings, "--timings"),
        (args.require_table, "--require-table"),
    ] {
        if given && !args.method.is_table() {
            return Err(misuse(format!("{flag} needs --method table")));
        }
    }
    let mut animation = Animation::load(&args.scene).map_err(|error| with_hint(args, error))?;
    if let Some(size) = args.size {
        memory::check(args.max_memory, size, Form::Grey8)?;
        let ImageSize { width, height } = size;
        let sized = animation.with_size(width, height);
        animation = sized.map_err(|error| of_flag(&format!("--size {width}x{height}"), &error))?;
    }
    if let Some(antialias) = args.antialias {
        let drawn = animation.with_antialias(antialias);
        animation = drawn.map_err(|error| of_flag("--antialias", &error))?;
    }
    if let Some(pixels) = args.tolerance {
        let right = animation.with_tolerance(pixels);
        animation = right.map_err(|error| of_flag(&format!("--tolerance {pixels}"), &error))?;
    }
    if let Some(names) = &args.layers {
        let layers = LayerSet::from_names(names).and_then(|layers| animation.with_layers(layers));
        animation = layers.map_err(|error| of_layers(&error))?;
    }
    if let Some(bits) = args.bits {
        let wide = animation.with_bits(bits);
        animation = wide.map_err(|error| of_flag("--bits", &error))?;
    }
    if let Some(stops) = args.exposure {
        if !animation.shows_colour() {
            return Err(misuse(
                "--exposure changes light, and this scene has none; give it a [disk.light] or a [sky], or leave \
                 --exposure out",
            ));
        }
        let exposed = animation.with_exposure(stops);
        animation = exposed.map_err(|error| of_flag(&format!("--exposure {stops}"), &error))?;
    }
    memory::check(args.max_memory, animation.image(), Form::Grey8)?;
    Ok(animation)
}

/// The error of a value that is not allowed, of the option that gave it in place of the scene's key.
fn of_flag(flag: &str, error: &SceneError) -> anyhow::Error {
    match error {
        SceneError::Value { reason, .. } => misuse(format!("{flag}: {reason}")),
        _ => misuse(format!("{flag}: {error}")),
    }
}

/// The error of a layer that is not allowed.
fn of_layers(error: &SceneError) -> anyhow::Error {
    match error {
        SceneError::Value { value, .. } => of_flag(&format!("--layers {value}"), error),
        _ => of_flag("--layers", error),
    }
}

/// The error of a scene that cannot be read. Who gave an output's name there is told of `-o`.
fn with_hint(args: &RenderArgs, error: SceneError) -> anyhow::Error {
    let name = args.scene.display();
    let is_output = Format::of_extension(&args.scene).is_some();
    match error {
        SceneError::Unknown { .. } | SceneError::Read { .. } if is_output => misuse(format!(
            "{error}. To name the output, write -o before it: -o {name}"
        )),
        error => error.into(),
    }
}

/// All frames of the animation.
pub(super) fn all_frames(animation: &Animation) -> FrameRange {
    FrameRange::up_to(animation.frames())
}

/// The frames that are asked for and that the animation has. Prints which others are asked for.
///
/// # Errors
/// It has none of them.
pub(super) fn frames(args: &RenderArgs, animation: &Animation) -> anyhow::Result<FrameRange> {
    let all = all_frames(animation);
    let Some(asked) = &args.frames else {
        return Ok(all);
    };
    let frames = animation.frames();
    let Some(range) = asked.up_to_frame(frames) else {
        let number = asked.last();
        let error = SceneError::NoFrame { number, frames };
        return Err(misuse(format!("--frames {asked}: {error}")));
    };
    if asked.last() > frames {
        warn(format_args!(
            "--frames {asked}: the animation's frames are {all}; those beyond are left out"
        ));
    }
    Ok(range)
}

/// The method, with its table made where it is missing and may be made.
///
/// # Errors
/// The table cannot be made, or may not.
pub(super) fn method(
    args: &RenderArgs,
    checked: Checked,
    report: Report,
) -> anyhow::Result<Method> {
    if args.require_table {
        checked.without_making()
    } else {
        checked.ready(report)
    }
}
