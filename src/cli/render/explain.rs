//! `darkness render --explain`: what a picture needs, and what it does not.

use std::io::{self, Write};
use std::path::Path;

use super::super::frame_range::FrameRange;
use super::super::method::Method;
use super::super::misuse::misuse;
use super::super::progress::Report;
use super::super::stdio::StdoutError;
use super::super::threads::start_threads;
use super::args::RenderArgs;
use super::{draw, options};
use crate::isoradial::Isoradials;
use crate::render::needs::{Candidate, Needs};
use crate::scene::{Animation, Scene};

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
    let needs = draw::needs(&scene);
    let needed = needs.table().map(|candidate| candidate.name);
    let checked = args.method.check(needed)?;
    start_threads(args.threads.threads)?;
    let method = options::method(args, checked, report)?;
    let table = args.method.table_path(needed);
    let curves = draw::curves(&needs, &method);
    let mut stdout = io::stdout().lock();
    print(
        &mut stdout,
        &scene,
        &needs,
        &curves,
        &method,
        table.as_deref(),
    )
    .and_then(|()| stdout.flush())
    .map_err(StdoutError)?;
    Ok(())
}

fn print(
    out: &mut impl Write,
    scene: &Scene,
    needs: &Needs,
    curves: &Isoradials,
    method: &Method,
    path: Option<&Path>,
) -> io::Result<()> {
    let size = scene.image();
    writeln!(
        out,
        "picture     {} × {}, edges to be right to {:?} pixels",
        size.width,
        size.height,
        scene.tolerance()
    )?;
    writeln!(
        out,
        "edges       move by {} pixels at most for each radian that an angle is off by",
        figure(needs.sensitivity)
    )?;
    let read = if let (Method::Table(table), Some(path)) = (method, path) {
        let metadata = table.metadata();
        writeln!(
            out,
            "table       {} ({}), error {:.1e} rad",
            metadata.spec.name,
            path.display(),
            metadata.measured_error
        )?;
        table.bytes().len()
    } else {
        writeln!(
            out,
            "table       none is good enough, the curves are drawn from exact angles"
        )?;
        0
    };
    for candidate in &needs.tables {
        writeln!(out, "            {}", judgement(candidate, needs))?;
    }
    for (i, order) in curves.orders().iter().enumerate() {
        writeln!(
            out,
            "{}{}: {} pixels thick at most, {} nodes",
            if i == 0 {
                "orders      "
            } else {
                "            "
            },
            order.number(),
            figure(order.thickness()),
            order.nodes()
        )?;
    }
    if curves.orders().is_empty() {
        writeln!(out, "orders      none: the disk is not in the picture")?;
    }
    if let Some(thin) = curves.left_out() {
        writeln!(
            out,
            "            {} and up are left out, {} pixels thick or less",
            thin.order,
            figure(thin.thickness)
        )?;
    }
    writeln!(
        out,
        "bytes       {read} of the table, for {} of curves with {} nodes, for {} of picture",
        curves.bytes(),
        curves.nodes(),
        u64::from(size.width) * u64::from(size.height)
    )?;
    let error = curves.error();
    writeln!(
        out,
        "edge error  {} pixels at most: {} between nodes, {} from the angles, {} from rounding",
        figure(error.total()),
        figure(error.interpolation),
        figure(error.angles),
        figure(error.rounding)
    )?;
    writeln!(
        out,
        "not needed  a ray for each pixel; spin, thickness, colour and sky, which nothing here models"
    )
}

/// How far a table moves the edges, and whether that is good enough.
fn judgement(candidate: &Candidate, needs: &Needs) -> String {
    let chosen = needs.table().map(|table| table.name) == Some(candidate.name);
    let verdict = match (candidate.is_enough, chosen) {
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
