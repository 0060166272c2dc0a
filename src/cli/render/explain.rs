//! `darkness render --explain`: what a picture needs, and what it does not.

use std::path::Path;

use bytesize::ByteSize;

use super::super::frame_range::FrameRange;
use super::super::method::Method;
use super::super::progress::Report;
use super::super::stdio::print;
use super::super::threads::start_threads;
use super::args::RenderArgs;
use super::figures::{Figures, figure, push_line};
use super::{form, memory, options, sky};
use crate::quotation::beginning;
use crate::render::Form;
use crate::render::needs::{Candidate, Needs};
use crate::scene::{Animation, ImageSize, Projection, Scene, Sky, StarSource};
use crate::sky::SkySource;

/// The most frames that are looked at.
const MOST_FRAMES: usize = 1000;

/// Prints what the frames need: of each figure the range, and the frame in which it is greatest.
///
/// # Errors
/// A scene or a table that is refused, or a standard output that cannot be written.
pub(super) fn run(
    args: &RenderArgs,
    animation: &Animation,
    frames: &FrameRange,
    report: Report,
) -> anyhow::Result<()> {
    let form = form::expected(args, animation)?;
    let looked_at = looked_at(frames);
    let first = animation.check(looked_at[0])?;
    for &number in &looked_at[1..] {
        animation.check(number)?;
    }
    let sky = first.sky().filter(|_| form.shows_light());
    sky::check_files(sky)?;
    // One table serves all frames.
    let needs = Needs::of_animation(animation, form)?;
    let needed = needs.table().map(|candidate| candidate.name);
    let checked = args.method.check(needed)?;
    start_threads(args.threads.threads)?;
    let method = options::method(args, checked, report)?;
    let table = args.method.table_path(needed);

    let mut figures = Figures::default();
    for &number in &looked_at {
        figures.add(number, &animation.frame(number)?, form, &method);
    }
    let mut text = String::new();
    push_line(&mut text, "picture", &picture(&first));
    if !animation.is_still() {
        push_line(&mut text, "frames", &frame_line(frames, &looked_at));
    }
    text.push_str(&table_lines(
        (animation, first.disk().is_some()),
        &needs,
        &method,
        table.as_deref(),
    ));
    text.push_str(&figures.lines(&first, form));
    if let Some(sky) = sky {
        let frame = memory::of_frame(first.size(), form);
        let source = sky::read(sky, frame, args.max_memory, report)?;
        text.push_str(&sky_lines(sky, &source));
    }
    push_line(&mut text, "not needed", &not_needed(&first, form));
    print(&text)?;
    Ok(())
}

/// The frames that are looked at: all, or evenly spaced ones.
fn looked_at(frames: &FrameRange) -> Vec<i64> {
    let all: Vec<i64> = frames.iter().take(MOST_FRAMES + 1).collect();
    if all.len() <= MOST_FRAMES {
        return all;
    }
    let (first, span) = (all[0], frames.last() - all[0]);
    let number = |place| first + span * place as i64 / (MOST_FRAMES - 1) as i64;
    let numbers = (0..MOST_FRAMES).filter_map(|place| frames.above(number(place) - 1));
    let mut numbers: Vec<i64> = numbers.collect();
    numbers.dedup();
    numbers
}

/// What the picture is to be.
fn picture(scene: &Scene) -> String {
    let ImageSize { width, height } = scene.image();
    let mut size = format!("{width} × {height}");
    if let Some(part) = scene.crop() {
        size = format!(
            "{} × {} from column {} and row {} of {size}",
            part.width, part.height, part.left, part.top
        );
    }
    let projection = scene.camera().projection;
    if projection != Projection::Perspective {
        size = format!("{size}, {}", projection.name());
    }
    if scene.disk().is_none() {
        return size;
    }
    let tolerance = scene.tolerance();
    let half = figure(0.5 * tolerance);
    format!(
        "{size}, edges to be right to {tolerance:?} pixels: {half} for the table, {half} for the curves"
    )
}

/// Which frames the figures are of.
fn frame_line(frames: &FrameRange, looked_at: &[i64]) -> String {
    let which = match looked_at {
        [only] => return format!("{only}"),
        _ if frames.iter().nth(MOST_FRAMES).is_none() => format!("{frames}"),
        _ => format!(
            "{} of {}, evenly spaced",
            looked_at.len(),
            beginning(&frames.to_string(), 40)
        ),
    };
    format!("{which}; each figure's range, and the frame in which it is greatest")
}

/// The table that is used, and which would do.
fn table_lines(
    (animation, has_disk): (&Animation, bool),
    needs: &Needs,
    method: &Method,
    path: Option<&Path>,
) -> String {
    let mut text = String::new();
    let line = match (method, path) {
        (Method::Table(table), Some(path)) => {
            let (metadata, path) = (table.metadata(), path.display());
            let (name, error) = (&metadata.spec.name, metadata.measured_error);
            let bytes = table.bytes().len();
            format!("{name} ({path}), error {error:.1e} rad, {bytes} bytes")
        }
        _ => "none is good enough; the curves are drawn from exact angles".into(),
    };
    push_line(&mut text, "table", &line);
    for candidate in &needs.tables {
        push_line(&mut text, "", &judgement(candidate, needs, has_disk));
    }
    if has_disk && animation.frames() > 1 {
        let line = format!(
            "one table for all frames: of {} of them edges move most in frame {}, which decides",
            animation.frames().min(Needs::SAMPLED),
            needs.frame
        );
        push_line(&mut text, "", &line);
    }
    text
}

/// The lines of what a sky holds.
fn sky_lines(sky: &Sky, source: &SkySource) -> String {
    let mut text = String::new();
    if let (Some(file), Some(panorama)) = (&sky.panorama, source.panorama()) {
        let line = format!(
            "{}: {} × {} pixels, {} levels, {} of memory",
            file.path.display(),
            panorama.width(),
            panorama.height(),
            panorama.levels(),
            ByteSize(panorama.bytes())
        );
        push_line(&mut text, "panorama", &line);
    }
    if let (Some(stars), Some(field)) = (&sky.stars, source.stars()) {
        let from = match &stars.source {
            StarSource::File(file) => file.path.display().to_string(),
            StarSource::Synthetic { seed, .. } => format!("a random field, seed {seed}"),
        };
        let limit = match stars.magnitude_limit {
            Some(limit) => format!("up to magnitude {limit}"),
            None => "of all magnitudes".into(),
        };
        let count = field.stars.len();
        push_line(
            &mut text,
            "stars",
            &format!("{from}: {count} stars {limit}"),
        );
    }
    if let Some(step) = source.grid() {
        let line = format!("a line every {step} degrees of longitude and latitude");
        push_line(&mut text, "grid", &line);
    }
    text
}

/// What the picture does without.
fn not_needed(scene: &Scene, form: Form) -> String {
    let mut without = vec!["a ray for each pixel"];
    match (scene.disk().is_some(), form.needs_map(scene)) {
        (false, _) => without.push("no map of the radius, since there is no disk"),
        (true, false) => {
            without.push("no map of the radius, since the picture shows only where the disk is");
        }
        (true, true) => {}
    }
    match (scene.sky().is_some(), form.shows_light()) {
        (false, _) => without.push("no panorama, stars or grid, since there is no sky"),
        (true, false) => {
            without.push("no panorama, stars or grid, since the picture shows no light");
        }
        (true, true) => {}
    }
    if !form.needs_escape(scene) {
        without.push("no escape curve, since the picture shows nothing of the sky");
    }
    without.push("spin and thickness are not modelled");
    without.join("; ")
}

/// Tells a table's error, and whether it is good enough. With a disk it is told as a displacement of edges.
fn judgement(candidate: &Candidate, needs: &Needs, has_disk: bool) -> String {
    let chosen = needs.table().map(|table| table.name) == Some(candidate.name);
    let half = 0.5 * needs.curve_spec.tolerance;
    let moves_edges = candidate.displacement > half;
    let verdict = match (candidate.is_enough, chosen) {
        (false, _) if !has_disk => "not enough",
        (false, _) if !moves_edges => "enough for edges, not for light and data",
        (false, _) => &format!("more than {}, not enough", figure(half)),
        (true, true) => "enough",
        (true, false) => "more than enough",
    };
    let error = if has_disk {
        format!("up to {} pixels", figure(candidate.displacement))
    } else {
        format!("up to {:.1e} rad", candidate.error)
    };
    format!("{}: {error}, {verdict}", candidate.name)
}
