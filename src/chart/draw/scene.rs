//! The third panel: a frame's time against its edges' displacement, order by order, and against its wrong pixels.

use super::DrawError;
use super::axis::{Axis, Plot, heading};
use super::canvas::{BELOW, Canvas, LEFT_OF, RIGHT_OF};
use super::labels::{self, Label};
use super::style::{BLACK, GREY, LIGHT, Look, Marker, bold, plain, words};
use crate::chart::methods::Method;
use crate::chart::scene::{Frame, Point};

const WIDTH: f64 = 890.0;
const HEIGHT: f64 = 290.0;
const WRONG_HEIGHT: f64 = 150.0;

/// Between the three plots.
const APART: f64 = 14.0;

/// Height of the strips for what no logarithm has: lost edges above, no wrong pixel below.
const STRIP: f64 = 22.0;

/// A method's points, by falling time.
struct Series<'a> {
    look: Look,
    points: Vec<&'a Point>,
}

fn series(frame: &Frame) -> Vec<Series<'_>> {
    Method::ALL
        .iter()
        .map(|&method| {
            let mut points: Vec<_> = frame
                .points
                .iter()
                .filter(|point| point.method == method)
                .collect();
            points.sort_by(|a, b| b.milliseconds.total_cmp(&a.milliseconds));
            Series {
                look: Look::of(method),
                points,
            }
        })
        .collect()
}

/// Draws the panel below and to the right of `at`.
pub(super) fn draw(canvas: &Canvas<'_>, frame: &Frame, at: (f64, f64)) -> Result<(), DrawError> {
    let (left, top) = at;
    let (width, height) = frame.size;
    let caption = [
        &*format!(
            "{} at {width} × {height}, asked to be right to {:?} pixels. Tables, grids (of the standard table's size) and exact draw isoradial curves to several tolerances;",
            frame.name, frame.tolerance
        ),
        "Euler, RK4 and adaptive step every pixel's ray (timed on an even sample of pixels). Largest displacement of an edge at 33 angles; crosses at the top: an edge was lost.",
    ];
    heading(
        canvas,
        (left - 56.0, top),
        "Scene: what a frame costs, and how far its edges are off",
        &caption,
    )?;
    let all = series(frame);
    let top = top + 72.0;
    let each = (WIDTH - 2.0 * APART) / 3.0;
    let errors = frame
        .points
        .iter()
        .flat_map(|point| &point.orders)
        .filter_map(|order| order.error.map(|error| error.max));
    let y = Axis::about(
        errors.map(|error| error.max(1e-13)),
        (top + HEIGHT, top + STRIP),
    );
    let times = || frame.points.iter().map(|point| point.milliseconds);
    for (order, title) in ["direct image", "first ring", "second ring"]
        .into_iter()
        .enumerate()
    {
        let from = left + order as f64 * (each + APART);
        let plot = Plot {
            x: Axis::about(times(), (from, from + each)),
            y,
        };
        displacements(canvas, &plot, &all, order, frame.tolerance)?;
        let middle = from + 0.5 * each;
        canvas.text(title, (middle, top - 15.0), bold(12.0, BLACK), BELOW)?;
        if order == 0 {
            let centre = (from - 50.0, top + 0.5 * HEIGHT);
            canvas.upward_text("displacement (pixels)", centre, words(13.0, BLACK))?;
        }
    }
    let top = top + HEIGHT + 36.0;
    let plot = Plot {
        x: Axis::about(times(), (left, left + WIDTH)),
        y: Axis {
            decades: (-6.0, 0.0),
            pixels: (top + WRONG_HEIGHT - STRIP, top),
        },
    };
    wrong_pixels(canvas, &plot, &all, frame)
}

/// One order's plot.
fn displacements(
    canvas: &Canvas<'_>,
    plot: &Plot,
    all: &[Series<'_>],
    order: usize,
    asked: f64,
) -> Result<(), DrawError> {
    plot.frame(canvas, true, order == 0)?;
    let (left, top, right, _) = plot.corners();
    let asked = plot.y.at(asked);
    canvas.line(&[(left, asked), (right, asked)], plain(BLACK, 0.8))?;
    if order == 0 {
        let words = words(11.0, BLACK);
        canvas.text("asked", (right - 4.0, asked - 7.0), words, LEFT_OF)?;
    }
    let strip = top - 0.5 * STRIP;
    canvas.line(
        &[
            (left, top),
            (left, top - STRIP),
            (right, top - STRIP),
            (right, top),
        ],
        plain(GREY, 1.0),
    )?;
    let mut labels = Vec::new();
    for Series { look, points } in all {
        let mut line = Vec::new();
        for point in points {
            let x = plot.x.at(point.milliseconds);
            let Some(found) = point.orders.get(order) else {
                continue;
            };
            if found.failures > 0 {
                canvas.marker(Marker::Cross, (x, strip), 3.4, look.colour)?;
            }
            if let Some(error) = found.error {
                line.push((x, plot.y.at(error.max)));
            }
        }
        canvas.line(&line, look.pen(1.4))?;
        for &at in &line {
            canvas.marker(look.marker, at, 3.4, look.colour)?;
        }
        labels.push(Label {
            words: look.short.into(),
            colour: look.colour,
            line,
        });
    }
    labels::place(canvas, plot, &labels, &[])
}

/// The plot of wrong pixels, as a share of those compared.
fn wrong_pixels(
    canvas: &Canvas<'_>,
    plot: &Plot,
    all: &[Series<'_>],
    frame: &Frame,
) -> Result<(), DrawError> {
    plot.frame(canvas, false, true)?;
    let (left, top, right, bottom) = plot.corners();
    let zero = bottom + 0.5 * STRIP;
    let below = Plot {
        y: Axis {
            decades: plot.y.decades,
            pixels: (bottom + STRIP, top),
        },
        ..*plot
    };
    for decade in plot.x.ticks(44.0) {
        let x = plot.x.at_decade(f64::from(decade));
        canvas.line(&[(x, bottom), (x, bottom + STRIP)], plain(LIGHT, 0.8))?;
        let label = super::axis::power_of_ten(decade);
        canvas.text(&label, (x, bottom + STRIP + 5.0), words(12.0, BLACK), BELOW)?;
    }
    canvas.line(
        &[
            (left, bottom),
            (left, bottom + STRIP),
            (right, bottom + STRIP),
            (right, bottom),
        ],
        plain(GREY, 1.0),
    )?;
    canvas.text("none", (left - 6.0, zero), words(12.0, BLACK), LEFT_OF)?;
    let mut labels = Vec::new();
    for Series { look, points } in all {
        let line: Vec<_> = points
            .iter()
            .map(|point| {
                let pixels = &point.pixels;
                let share = pixels.failures as f64 / pixels.count.max(1) as f64;
                let y = if share > 0.0 { plot.y.at(share) } else { zero };
                (plot.x.at(point.milliseconds), y)
            })
            .collect();
        canvas.line(&line, look.pen(1.4))?;
        for &at in &line {
            canvas.marker(look.marker, at, 3.4, look.colour)?;
        }
        labels.push(Label {
            words: look.short.into(),
            colour: look.colour,
            line,
        });
    }
    labels::place(canvas, &below, &labels, &[])?;
    below.names(
        canvas,
        "time of a frame, one thread (milliseconds)",
        "wrong pixels (share)",
    )?;
    let compared = format!(
        "of {} pixels compared with their own exact rays; fewer of slow methods (see the CSV)",
        frame.compared
    );
    canvas.text(
        &compared,
        (left + 8.0, top + 12.0),
        words(12.0, GREY),
        RIGHT_OF,
    )
}
