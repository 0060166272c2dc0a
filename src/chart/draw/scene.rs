//! The third panel: a frame's time against its edges' displacement, order by order, and against its wrong pixels.

use super::DrawError;
use super::axis::{Axis, Plot, heading};
use super::canvas::{ABOVE, BELOW, Canvas, LEFT_OF};
use super::labels::{self, Label};
use super::style::{BLACK, GREY, Look, Marker, bold, plain, words};
use crate::chart::methods::Method;
use crate::chart::scene::{Frame, Point};

const WIDTH: f64 = 890.0;
const HEIGHT: f64 = 290.0;
const WRONG_HEIGHT: f64 = 150.0;

/// The orders that are drawn.
const TITLES: [&str; 3] = ["direct image", "first ring", "second ring"];

/// Between the three plots.
const APART: f64 = 14.0;

/// Height of the strips for what no logarithm has: lost edges above, no wrong pixel below.
const STRIP: f64 = 26.0;

/// Of a plot's width, what curves have; the methods that step every pixel have the rest.
const CURVES: f64 = 0.56;

/// Between both.
const GAP: f64 = 7.0;

/// A method's points, from coarse to fine.
struct Series<'a> {
    look: Look,
    label: &'static str,
    points: Vec<&'a Point>,
}

fn series(frame: &Frame) -> Vec<Series<'_>> {
    Method::ALL
        .iter()
        .map(|&method| {
            let of = frame.points.iter().filter(|point| point.method == method);
            let mut points: Vec<_> = of.collect();
            // By the knob: the more nodes, or the more time.
            points.sort_by(|a, b| {
                a.nodes
                    .cmp(&b.nodes)
                    .then(a.milliseconds.total_cmp(&b.milliseconds))
            });
            let look = Look::of(method);
            Series {
                look,
                label: look.short,
                points,
            }
        })
        .collect()
}

/// Two plots of one height side by side: frames from curves all take about as long, and the others a hundred times as
/// long.
#[derive(Clone, Copy)]
struct Pair {
    curves: Plot,
    steps: Plot,
}

impl Pair {
    fn new(frame: &Frame, (left, right): (f64, f64), y: Axis) -> Self {
        let times = |curves: bool| {
            let points = frame.points.iter();
            points
                .filter(move |point| point.nodes.is_some() == curves)
                .map(|point| point.milliseconds)
        };
        let border = left + CURVES * (right - left);
        let (low, high) = times(true)
            .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), time| {
                (low.min(time), high.max(time))
            });
        // To the right there is room for labels.
        let (low, high) = (libm::log10(0.97 * low), libm::log10(1.03 * high));
        let curves = Axis {
            decades: (low, high + 0.25 * (high - low)),
            pixels: (left, border),
        };
        let steps = Axis::about(times(false), (border + GAP, right));
        Self {
            curves: Plot { x: curves, y },
            steps: Plot { x: steps, y },
        }
    }

    fn x(&self, point: &Point) -> f64 {
        let plot = if point.nodes.is_some() {
            self.curves
        } else {
            self.steps
        };
        plot.x.at(point.milliseconds)
    }

    /// Left, top, right, bottom.
    fn corners(&self) -> labels::Rect {
        let (left, top, _, bottom) = self.curves.corners();
        (left, top, self.steps.x.pixels.1, bottom)
    }

    /// Along the border between both.
    fn border(&self) -> Vec<(f64, f64)> {
        let (_, top, right, bottom) = self.curves.corners();
        let rows = (top as i32..bottom as i32).step_by(4).map(f64::from);
        rows.map(|y| (right + 0.5 * GAP, y)).collect()
    }

    /// The frames, both reaching beyond the y axis to a strip above or below.
    fn frame(
        &self,
        canvas: &Canvas<'_>,
        ends: (f64, f64),
        y_labels: bool,
    ) -> Result<(), DrawError> {
        let mut steps = self.steps.x.ticks(30.0);
        // At the common border there is no room for two.
        steps.retain(|tick| tick.at > self.steps.x.pixels.0 + 12.0);
        let (left, right) = self.curves.x.pixels;
        let mut curves = self.curves.x.even_ticks(4.0);
        curves.retain(|tick| left + 10.0 < tick.at && tick.at < right - 8.0);
        let ticks = [curves, steps];
        for ((plot, ticks), labels) in [self.curves, self.steps]
            .into_iter()
            .zip(ticks)
            .zip([y_labels, false])
        {
            let y = Axis {
                decades: (0.0, 1.0),
                pixels: (ends.1, ends.0),
            };
            let whole = Plot { x: plot.x, y };
            whole.sides(canvas, &ticks)?;
            plot.rows(canvas, labels)?;
        }
        Ok(())
    }

    /// Draws every series; `y` tells where a point is, and whether it is lost.
    fn lines(
        &self,
        canvas: &Canvas<'_>,
        all: &[Series<'_>],
        y: impl Fn(&Point) -> Option<f64>,
    ) -> Result<Vec<Label>, DrawError> {
        let mut labels = Vec::new();
        for Series {
            look,
            label,
            points,
        } in all
        {
            let line: Vec<_> = points
                .iter()
                .filter_map(|point| Some((self.x(point), y(point)?)))
                .collect();
            canvas.line(&line, look.pen(1.4))?;
            for &at in &line {
                canvas.marker(look.marker, at, 3.4, look.colour)?;
            }
            labels.push(Label {
                words: (*label).into(),
                colour: look.colour,
                lines: vec![line],
            });
        }
        Ok(labels)
    }
}

/// Draws the panel below and to the right of `at`.
pub(super) fn draw(canvas: &Canvas<'_>, frame: &Frame, at: (f64, f64)) -> Result<(), DrawError> {
    let (left, top) = at;
    let (width, height) = frame.size;
    let caption = format!(
        "{} at {width} × {height}, edges asked to be right to {:?} pixels. Tables and exact draw isoradial curves, to several tolerances, and fill the frame between them (left of each plot); Euler, RK4 and adaptive step every pixel's ray (right; timed on an even sample of pixels). Upper plots: the largest displacement of an edge at {} angles. A cross at the top: an edge was lost.",
        frame.name, frame.tolerance, frame.places
    );
    let title = "Scene: what a frame costs, and how far its edges are off";
    let top = heading(canvas, (left - 56.0, top), title, &caption)? + 24.0;
    let all = series(frame);
    let each = (WIDTH - 2.0 * APART) / 3.0;
    let errors = frame
        .points
        .iter()
        .flat_map(|point| &point.orders[..TITLES.len()]);
    let errors = errors.filter_map(|order| order.error.map(|error| error.max.max(1e-13)));
    let y = Axis::about(errors, (top + HEIGHT, top + STRIP));
    for (order, title) in TITLES.into_iter().enumerate() {
        let from = left + order as f64 * (each + APART);
        let pair = Pair::new(frame, (from, from + each), y);
        displacements(canvas, &pair, &all, order, frame.tolerance)?;
        let middle = from + 0.5 * each;
        canvas.text(title, (middle, top - 5.0), bold(12.0, BLACK), ABOVE)?;
    }
    let centre = (left - 50.0, top + 0.5 * HEIGHT);
    canvas.upward_text(
        "displacement of an edge (pixels)",
        centre,
        words(13.0, BLACK),
    )?;
    let top = top + HEIGHT + 34.0;
    let shares = frame.points.iter().map(Point::wrong_share);
    let y = Axis::about(shares, (top + WRONG_HEIGHT - STRIP, top));
    let pair = Pair::new(frame, (left, left + WIDTH), y);
    wrong_pixels(canvas, &pair, &all, frame)
}

/// One order's plot.
fn displacements(
    canvas: &Canvas<'_>,
    pair: &Pair,
    all: &[Series<'_>],
    order: usize,
    asked: f64,
) -> Result<(), DrawError> {
    let (left, top, right, bottom) = pair.corners();
    pair.frame(canvas, (top - STRIP, bottom), order == 0)?;
    let asked = pair.curves.y.at(asked);
    canvas.line(&[(left, asked), (right, asked)], plain(BLACK, 0.8))?;
    canvas.text(
        "asked",
        (right - 4.0, asked - 7.0),
        words(11.0, BLACK),
        LEFT_OF,
    )?;
    let lost = |point: &Point| {
        point
            .orders
            .get(order)
            .is_some_and(|found| found.failures > 0)
    };
    for series in all {
        for point in series.points.iter().filter(|point| lost(point)) {
            let at = (pair.x(point), top - 0.5 * STRIP);
            canvas.marker(Marker::Cross, at, 3.4, series.look.colour)?;
        }
    }
    let labels = pair.lines(canvas, all, |point| {
        let error = point.orders.get(order)?.error?;
        Some(pair.curves.y.at(error.max))
    })?;
    let mut taken = pair.border();
    let line = (left as i32..right as i32).step_by(4);
    taken.extend(line.map(|x| (f64::from(x), asked)));
    labels::place(canvas, pair.corners(), &labels, &taken)
}

/// The plot of wrong pixels, as a share of those compared.
fn wrong_pixels(
    canvas: &Canvas<'_>,
    pair: &Pair,
    all: &[Series<'_>],
    frame: &Frame,
) -> Result<(), DrawError> {
    let (left, top, right, bottom) = pair.corners();
    pair.frame(canvas, (top, bottom + STRIP), true)?;
    let none = bottom + 0.6 * STRIP;
    canvas.text("none", (left - 6.0, none), words(12.0, BLACK), LEFT_OF)?;
    let labels = pair.lines(canvas, all, |point| {
        let share = point.wrong_share();
        Some(if share > 0.0 {
            pair.curves.y.at(share)
        } else {
            none
        })
    })?;
    let within = (left, top, right, bottom + STRIP);
    labels::place(canvas, within, &labels, &pair.border())?;
    let middle = 0.5 * (left + right);
    let name = "time of a frame, one thread (milliseconds)";
    canvas.text(
        name,
        (middle, bottom + STRIP + 24.0),
        words(13.0, BLACK),
        BELOW,
    )?;
    let centre = (left - 50.0, 0.5 * (top + bottom + STRIP));
    canvas.upward_text("wrong pixels (share)", centre, words(13.0, BLACK))?;
    let compared = format!(
        "of {} pixels compared with their exact rays, fewer of slow methods (see the CSV)",
        frame.compared
    );
    canvas.text(
        &compared,
        (right - 8.0, top - 9.0),
        words(11.0, GREY),
        LEFT_OF,
    )
}
