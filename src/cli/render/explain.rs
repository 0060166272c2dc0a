//! `darkness render --explain`: what a picture needs, and what it does not.

use std::fmt::Write as _;
use std::path::Path;

use bytesize::ByteSize;

use super::super::frame_range::FrameRange;
use super::super::method::Method;
use super::super::misuse::misuse;
use super::super::progress::Report;
use super::super::stdio::print;
use super::super::threads::start_threads;
use super::args::RenderArgs;
use super::{draw, form, memory, options, sky};
use crate::isoradial::{EscapeCurve, Isoradials, RadiusMap};
use crate::render::Form;
use crate::render::needs::{Candidate, Needs};
use crate::scene::{Animation, ImageSize, Scene, Sky, StarSource, View};
use crate::sky::SkySource;

/// Prints what one frame needs.
///
/// # Errors
/// Several frames, a scene or a table that is refused, or a standard output that cannot be written.
pub(super) fn run(
    args: &RenderArgs,
    animation: &Animation,
    frames: &FrameRange,
    report: Report,
) -> anyhow::Result<()> {
    if args.frames.is_some() && frames.iter().nth(1).is_some() {
        return Err(misuse(
            "--explain describes one frame; choose one with --frames",
        ));
    }
    let scene = animation.frame(frames.iter().next().unwrap_or(1))?;
    let form = form::expected(args, animation)?;
    let needs = Needs::new(&scene, &View::new(&scene), form);
    let needed = needs.table().map(|candidate| candidate.name);
    let checked = args.method.check(needed)?;
    start_threads(args.threads.threads)?;
    let method = options::method(args, checked, report)?;
    let table = args.method.table_path(needed);
    let curves = draw::curves(&needs, &method);
    let shows_disk = form.needs_map() && scene.disk().is_some();
    let map = shows_disk.then(|| draw::map(&curves, &method));
    let drawn = (&curves, map.as_ref(), form);
    let mut text = text(&scene, &needs, drawn, &method, table.as_deref());
    if form.needs_escape(&scene) {
        let curve = draw::escape_curve(&View::new(&scene), &method);
        text.push_str(&escape_line(&curve));
    }
    if let Some(sky) = scene.sky().filter(|_| form.shows_light()) {
        sky::check_files(Some(sky))?;
        let frame = memory::of_frame(scene.image(), form);
        let source = sky::read(sky, frame, args.max_memory, report)?;
        text.push_str(&sky_lines(sky, &source));
    }
    push_line(&mut text, "not needed", &not_needed(&scene, form));
    print(&text)?;
    Ok(())
}

/// The lines of the explanation.
fn text(
    scene: &Scene,
    needs: &Needs,
    (curves, map, form): (&Isoradials, Option<&RadiusMap>, Form),
    method: &Method,
    path: Option<&Path>,
) -> String {
    let mut text = String::new();
    let mut line = |label: &str, line: String| push_line(&mut text, label, &line);
    let ImageSize { width, height } = scene.image();
    let tolerance = scene.tolerance();
    line(
        "picture",
        format!("{width} × {height}, edges to be right to {tolerance:?} pixels"),
    );
    let sensitivity = figure(needs.sensitivity);
    line(
        "edges",
        format!("move by at most {sensitivity} pixels for each radian of error in an angle"),
    );

    let mut bytes_read = 0;
    if let (Method::Table(table), Some(path)) = (method, path) {
        let (metadata, path) = (table.metadata(), path.display());
        let (name, error) = (&metadata.spec.name, metadata.measured_error);
        line("table", format!("{name} ({path}), error {error:.1e} rad"));
        bytes_read = table.bytes().len();
    } else {
        line(
            "table",
            "none is good enough; the curves are drawn from exact angles".into(),
        );
    }
    for candidate in &needs.tables {
        line("", judgement(candidate, needs));
    }

    let mut label = "orders";
    for order in curves.orders() {
        let (number, nodes) = (order.number(), order.nodes());
        let thickness = figure(order.thickness());
        line(
            label,
            format!("{number}: at most {thickness} pixels thick, {nodes} nodes"),
        );
        label = "";
    }
    if curves.orders().is_empty() {
        let why = if scene.disk().is_some() {
            "none: the disk is not in the picture"
        } else {
            "none: the scene has no disk"
        };
        line(label, why.into());
    }
    if let Some(thin) = curves.left_out() {
        let thickness = figure(thin.thickness);
        line(
            "",
            format!(
                "{} and up are left out, at most {thickness} pixels thick",
                thin.order
            ),
        );
    }

    let (bytes, nodes) = (curves.bytes(), curves.nodes());
    let pixels = u64::from(width) * u64::from(height) * form.bytes() as u64;
    line(
        "bytes",
        format!(
            "{bytes_read} of the table, {bytes} of curves with {nodes} nodes, {pixels} of pixels"
        ),
    );
    let error = curves.error();
    line(
        "edge error",
        format!(
            "at most {} pixels: {} between nodes, {} from the angles, {} from rounding",
            figure(error.total()),
            figure(error.interpolation),
            figure(error.angles),
            figure(error.rounding)
        ),
    );
    if let Some(map) = map {
        line(
            "map",
            format!(
                "of the radius: {} nodes, {} bytes, radii right to {} of themselves",
                map.nodes(),
                map.bytes(),
                figure(map.error())
            ),
        );
    }
    text
}

/// Adds a line to an explanation.
fn push_line(text: &mut String, label: &str, line: &str) {
    let _ = writeln!(text, "{label:<12}{line}");
}

/// The line of the escape curve.
fn escape_line(curve: &EscapeCurve) -> String {
    let (octaves, nodes, bytes) = (curve.octaves(), curve.nodes(), curve.bytes());
    let mut text = String::new();
    let line = format!("{octaves} octaves towards the critical ray: {nodes} nodes, {bytes} bytes");
    push_line(&mut text, "escape", &line);
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
    match (scene.disk().is_some(), form.needs_map()) {
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

/// How far a table moves the edges, and whether that is good enough.
fn judgement(candidate: &Candidate, needs: &Needs) -> String {
    let chosen = needs.table().map(|table| table.name) == Some(candidate.name);
    let verdict = match (candidate.is_enough, chosen) {
        (false, _) if candidate.displacement <= 0.5 * needs.curve_spec.tolerance => {
            "enough for edges, not for light and data"
        }
        (false, _) => "not enough",
        (true, true) => "enough",
        (true, false) => "more than enough",
    };
    format!(
        "{}: up to {} pixels, {verdict}",
        candidate.name,
        figure(candidate.displacement)
    )
}

/// A number with two significant digits.
fn figure(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if (1e-3..1e5).contains(&value) {
        let digits = (1.0 - libm::floor(libm::log10(value))).max(0.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.1e}")
    }
}
