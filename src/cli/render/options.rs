//! The scene and the frames that the arguments ask for, checked.

use super::super::frame_range::FrameRange;
use super::super::method::{Checked, Method};
use super::super::misuse::misuse;
use super::super::progress::{Report, warn};
use super::args::{Crop, RenderArgs};
use super::format::Format;
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
    let animation = match animation {
        Ok(animation) => animation,
        Err(error) => {
            // A size that no scene may have is too large for memory first.
            if let (Some(size), None) = (args.size, args.crop) {
                memory::check(args.max_memory, size, Form::Grey8)?;
            }
            return Err(with_hint(args, error));
        }
    };
    if args.exposure.is_some() && !animation.shows_colour() {
        return Err(misuse(
            "--exposure changes light, and this scene has none; give it a [disk.light] or a [sky], or leave \
             --exposure out",
        ));
    }
    memory::check(args.max_memory, animation.size(), Form::Grey8)?;
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
    if let Some(Crop(part)) = args.crop {
        let [left, top, width, height] = part;
        let flag = format!("--crop {left},{top},{width},{height}");
        overrides.push(Override::new(flag, "image.crop", part.to_vec()));
    }
    if let Some(smooth) = args.antialias {
        let flag = format!("--antialias {smooth}");
        overrides.push(Override::new(flag, "image.antialias", smooth));
    }
    if let Some(bits) = args.bits {
        let flag = format!("--bits {bits}");
        overrides.push(Override::new(flag, "image.bits", i64::from(bits)));
    }
    if let Some(names) = &args.layers {
        let flag = format!("--layers {}", names.join(","));
        overrides.push(Override::new(flag, "image.layers", names.clone()));
    }
    overrides
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
    FrameRange::all(animation.first(), animation.last())
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
    let (first, last) = (animation.first(), animation.last());
    let Some(range) = asked.within(first, last) else {
        let number = asked.last();
        let error = SceneError::NoFrame {
            number,
            first,
            last,
        };
        return Err(misuse(format!("--frames {asked}: {error}")));
    };
    if asked.last() > last || asked.first() < Some(first) {
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
