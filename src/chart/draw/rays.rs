//! The first panel: time against error.

use super::DrawError;
use super::axis::{Axis, Plot, heading};
use super::canvas::{Canvas, RIGHT_OF};
use super::labels::{self, Label};
use super::style::{BLACK, GREY, LIGHT, Look, plain, words};
use crate::chart::methods::Method;
use crate::chart::rays::Rays;
use crate::chart::{Measurement, pareto};

const WIDTH: f64 = 890.0;
const HEIGHT: f64 = 480.0;

/// A point of the plot: time, and the errors of which a quantile of 0 is drawn at the bottom.
struct Point {
    nanoseconds: f64,
    p50: f64,
    p99: f64,
    max: f64,
    failures: u64,
}

fn points(rows: &[Measurement], method: Method) -> Vec<Point> {
    let of = rows.iter().filter(|row| row.method == method);
    let mut points: Vec<Point> = of
        .filter_map(|row| {
            let (time, error) = (row.time?, row.error?);
            Some(Point {
                nanoseconds: time.nanoseconds,
                p50: error.p50,
                p99: error.p99,
                max: error.max,
                failures: row.failures,
            })
        })
        .collect();
    points.sort_by(|a, b| b.p99.total_cmp(&a.p99));
    points
}

/// Draws the panel below and to the right of `at`.
pub(super) fn draw(canvas: &Canvas<'_>, rays: &Rays, at: (f64, f64)) -> Result<(), DrawError> {
    let (left, top) = at;
    let caption = [
        &*format!(
            "The angle to the first crossing of one radius: {} rays of cameras at r = 1.05 … 1000 in all directions, radii 3 … 30 (evenly in log r). One thread; medians.",
            rays.count
        ),
        "Marker: 99th percentile of the error against the exact method; whisker: median to largest. Hollow: some crossings were missed. Exact: against itself, in two parts.",
    ];
    heading(
        canvas,
        (left - 56.0, top),
        "Rays: what one swept angle costs",
        &caption,
    )?;
    let all: Vec<_> = Method::ALL
        .iter()
        .map(|&method| (Look::of(method), points(&rays.points, method)))
        .collect();
    let every = || all.iter().flat_map(|(_, points)| points);
    let top = top + 68.0;
    let bottom = top + HEIGHT;
    let plot = Plot {
        x: Axis::about(every().map(|p| p.nanoseconds), (left, left + WIDTH)),
        y: Axis::about(every().flat_map(|p| [p.p50, p.max]), (bottom, top)),
    };
    plot.frame(canvas, true, true)?;
    plot.names(
        canvas,
        "time per ray (nanoseconds)",
        "error of the angle (radians)",
    )?;

    let best = every()
        .filter(|p| p.failures == 0)
        .map(|p| (p.nanoseconds, p.p99));
    let front: Vec<_> = pareto::front(best.collect())
        .into_iter()
        .map(|(time, error)| plot.at(time, error))
        .collect();
    canvas.line(&front, plain(LIGHT, 9.0))?;

    let mut whiskers = Vec::new();
    for (look, points) in &all {
        let line: Vec<_> = points
            .iter()
            .map(|p| plot.at(p.nanoseconds, p.p99))
            .collect();
        for p in points {
            let (from, to) = (plot.at(p.nanoseconds, p.p50), plot.at(p.nanoseconds, p.max));
            canvas.line(&[from, to], plain(look.colour, 0.7))?;
            whiskers.push(from);
            whiskers.push(to);
        }
        canvas.line(&line, look.pen(1.6))?;
        for (p, &at) in points.iter().zip(&line) {
            canvas.marker(look.marker, at, 4.2, look.colour)?;
            if p.failures > 0 {
                canvas.marker(super::style::Marker::Disc, at, 2.0, super::canvas::PAPER)?;
            }
        }
    }
    let labels: Vec<_> = all
        .iter()
        .map(|(look, points)| Label {
            words: look.label.into(),
            colour: look.colour,
            line: points
                .iter()
                .map(|p| plot.at(p.nanoseconds, p.p99))
                .collect(),
        })
        .collect();
    labels::place(canvas, &plot, &labels, &whiskers)?;
    let note = (left + 12.0, bottom - 14.0);
    canvas.line(
        &[(note.0, note.1), (note.0 + 26.0, note.1)],
        plain(LIGHT, 9.0),
    )?;
    canvas.text(
        "Pareto front: no other setting without failures is both faster and more accurate",
        (note.0 + 34.0, note.1),
        words(12.0, GREY),
        RIGHT_OF,
    )?;
    let _ = BLACK;
    Ok(())
}
