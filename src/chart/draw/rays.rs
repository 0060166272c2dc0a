//! The first panel: time against error.

use super::DrawError;
use super::axis::{Axis, Plot, heading};
use super::canvas::{ABOVE, Canvas, LEFT_OF, RIGHT_OF};
use super::labels::{self, Label};
use super::style::{GREY, LIGHT, Look, plain, words};
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

/// Draws the panel below and to the right of `at`; returns where it ends.
pub(super) fn draw(canvas: &Canvas<'_>, rays: &Rays, at: (f64, f64)) -> Result<f64, DrawError> {
    let (left, top) = at;
    let caption = format!(
        "The angle to the first crossing of one radius, for {} rays of cameras at r = 1.05 … 1000 in all directions, radii 3 … 30 (evenly in log r). One thread, medians. Marker: 99th percentile of the error against the exact method; whisker: median to largest. Hollow: crossings were missed. Exact: against itself, in two parts.",
        rays.count
    );
    let title = "Rays: what one swept angle costs";
    let top = heading(canvas, (left - 56.0, top), title, &caption)? + 44.0;
    let all: Vec<_> = Method::ALL
        .iter()
        .map(|&method| (Look::of(method), points(&rays.points, method)))
        .collect();
    let every = || all.iter().flat_map(|(_, points)| points);
    let bottom = top + HEIGHT;
    let plot = Plot {
        x: Axis::about(every().map(|p| p.nanoseconds), (left, left + WIDTH)),
        y: Axis::about(every().flat_map(|p| [p.p50, p.max]), (bottom, top)),
    };
    plot.frame(canvas, &plot.x.ticks(44.0), true)?;
    ratios(canvas, &plot, rays)?;
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
            lines: vec![
                points
                    .iter()
                    .map(|p| plot.at(p.nanoseconds, p.p99))
                    .collect(),
            ],
        })
        .collect();
    labels::place(canvas, plot.corners(), &labels, &whiskers)?;
    pareto_note(canvas, (left + 12.0, bottom - 34.0))?;
    Ok(bottom + 40.0)
}

/// Says what the broad grey line is.
fn pareto_note(canvas: &Canvas<'_>, (x, y): (f64, f64)) -> Result<(), DrawError> {
    canvas.line(&[(x, y), (x + 26.0, y)], plain(LIGHT, 9.0))?;
    let lines = [
        "Pareto front: no other setting",
        "without failures is both faster",
        "and more accurate",
    ];
    for (i, line) in lines.into_iter().enumerate() {
        let at = (x + 34.0, y + 14.0 * i as f64 - 2.0);
        canvas.text(line, at, words(11.0, GREY), RIGHT_OF)?;
    }
    Ok(())
}

/// The axis above: how many times as fast as the baseline.
fn ratios(canvas: &Canvas<'_>, plot: &Plot, rays: &Rays) -> Result<(), DrawError> {
    let baseline = rays
        .points
        .iter()
        .find(|point| point.time.is_some_and(|time| time.ratio_to_rk4 == 1.0));
    let Some(time) = baseline.and_then(|point| point.time) else {
        return Ok(());
    };
    let (_, top, right, _) = plot.corners();
    for (ratio, label) in [
        (100.0, "100 ×"),
        (10.0, "10 ×"),
        (1.0, "1 ×"),
        (0.1, "0.1 ×"),
        (0.01, "0.01 ×"),
        (1e-3, "0.001 ×"),
    ] {
        let decade = libm::log10(time.nanoseconds / ratio);
        if decade <= plot.x.decades.0 || decade >= plot.x.decades.1 {
            continue;
        }
        let x = plot.x.at_decade(decade);
        canvas.line(&[(x, top - 4.0), (x, top)], plain(GREY, 1.0))?;
        canvas.text(label, (x, top - 6.0), words(12.0, GREY), ABOVE)?;
    }
    let words_at = (right, top - 29.0);
    let told = format!(
        "times as fast as RK4 in steps of {:.3} (error 10⁻⁶)",
        rays.baseline_step
    );
    canvas.text(&told, words_at, words(12.0, GREY), LEFT_OF)
}
