//! `darkness render --explain`: what a picture needs, and what it does not.

use std::io::{self, Write};
use std::path::Path;

use super::super::StdoutError;
use super::super::method::Method;
use crate::isoradial::Isoradials;
use crate::orbit::exact::Exact;
use crate::render::needs::{Candidate, Needs};
use crate::scene::Scene;

/// Prints what `scene` needs. `table` is the file that its angles are read from.
///
/// # Errors
/// The standard output does not take it.
pub(super) fn explain(
    scene: &Scene,
    needs: &Needs,
    method: &Method,
    table: Option<&Path>,
) -> anyhow::Result<()> {
    let curves = match method {
        Method::Table(table) => Isoradials::new(&needs.sight, &table.lookup()),
        _ => Isoradials::new(&needs.sight, &Exact),
    };
    let mut stdout = io::stdout().lock();
    print(&mut stdout, scene, needs, &curves, method, table)
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

/// What a table would do to the edges, and whether that is enough.
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

/// Two digits that mean something.
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
