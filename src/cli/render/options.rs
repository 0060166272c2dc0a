//! The scene and the frames that the arguments ask for, checked.

use super::super::frame_range::FrameRange;
use super::super::method::{Checked, Method};
use super::super::misuse::misuse;
use super::super::progress::{Report, warn};
use super::args::RenderArgs;
use super::memory;
use crate::render::Form;
use crate::scene::{Animation, ImageSize, Override, SceneError};

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
    let animation = Animation::load_with(&args.scene, &overrides(args));
    let animation = animation.map_err(|error| match error {
        SceneError::Override { .. } => misuse(error.to_string()),
        error => error.into(),
    })?;
    if args.exposure.is_some() && !animation.shows_colour() {
        return Err(misuse(
            "--exposure changes light, and this scene has none; give it a [disk.light] or a [sky], or leave \
             --exposure out",
        ));
    }
    memory::check(args.max_memory, animation.image(), Form::Grey8)?;
    Ok(animation)
}

/// The values that the options give to keys of the scene.
fn overrides(args: &RenderArgs) -> Vec<Override> {
    let mut overrides = args.set.clone();
    let numbers = [
        ("radius", "camera.radius", args.radius),
        ("inclination", "camera.inclination", args.inclination),
        ("azimuth", "camera.azimuth", args.azimuth),
        ("fov", "camera.fov", args.fov),
        ("tolerance", "image.tolerance", args.tolerance),
        ("exposure", "image.exposure", args.exposure),
    ];
    overrides.extend(numbers.into_iter().filter_map(|(flag, key, number)| {
        let number = number?;
        Some(Override::new(format!("--{flag} {number}"), key, number))
    }));
    if let Some(ImageSize { width, height }) = args.size {
        for (key, side) in [("image.width", width), ("image.height", height)] {
            let flag = format!("--size {width}x{height}");
            overrides.push(Override::new(flag, key, i64::from(side)));
        }
    }
    let antialias = args.antialias.map(|smooth| ("antialias", smooth.into()));
    let bits = args.bits.map(|bits| ("bits", i64::from(bits).into()));
    let layers = args.layers.clone().map(|names| ("layers", names.into()));
    for (flag, value) in antialias.into_iter().chain(bits).chain(layers) {
        let (flag, key) = (format!("--{flag}"), format!("image.{flag}"));
        let value: toml::Value = value;
        overrides.push(Override::new(flag, &key, value));
    }
    overrides
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
