//! The second panel: error against the distance from the critical ray, on both sides of it.

use super::DrawError;
use super::axis::{Axis, Plot, heading, power_of_ten};
use super::canvas::{BELOW, Canvas, LEFT_OF, RIGHT_OF};
use super::labels::{self, Label};
use super::style::{BLACK, GREY, LIGHT, Look, Marker, bold, plain, words};
use crate::chart::critical::{Critical, Place, Point, Side};
use crate::chart::methods::Method;

const WIDTH: f64 = 890.0;
const HEIGHT: f64 = 380.0;

/// Height of a method's row in the band of failures.
const ROW: f64 = 13.0;

/// Between the two closest distances, in decades each.
const GAP: f64 = 0.8;

/// Both sides' axis: the distance falls towards the middle from both ends.
struct Mirrored {
    middle: f64,
    half: f64,
    decades: f64,
}

impl Mirrored {
    fn at(&self, place: Place) -> f64 {
        self.at_decade(place.side, libm::log10(place.distance))
    }

    fn at_decade(&self, side: Side, decade: f64) -> f64 {
        let share = 1.0 - (-decade).min(self.decades) / (self.decades + GAP);
        match side {
            Side::Escape => self.middle - share * self.half,
            Side::Capture => self.middle + share * self.half,
        }
    }
}

/// One method at one setting.
struct Series<'a> {
    look: Look,
    label: String,
    points: Vec<&'a Point>,
}

/// The points of each method and setting, from left to right.
fn series(critical: &Critical) -> Vec<Series<'_>> {
    let mut all: Vec<Series<'_>> = Vec::new();
    for point in &critical.points {
        let method = point.measurement.method;
        let (knob, _) = point
            .measurement
            .setting
            .split_once(' ')
            .unwrap_or_default();
        let look = Look::of(method);
        let label = match method {
            Method::Euler | Method::Rk4 => format!("{} {}", look.label, knob.replace('=', " = ")),
            Method::Adaptive => "adaptive 10⁻⁹".into(),
            _ => look.label.to_owned(),
        };
        match all.iter_mut().find(|series| series.label == label) {
            Some(series) => series.points.push(point),
            None => all.push(Series {
                look,
                label,
                points: vec![point],
            }),
        }
    }
    // The coarser of two settings of one method is drawn in dashes.
    for i in 1..all.len() {
        if all[i].look.label == all[i - 1].look.label {
            all[i - 1].look.dash = Some((5.0, 3.0));
        }
    }
    all
}

/// Draws the panel below and to the right of `at`; returns where it ends.
pub(super) fn draw(
    canvas: &Canvas<'_>,
    critical: &Critical,
    at: (f64, f64),
) -> Result<f64, DrawError> {
    let (left, top) = at;
    let caption = "Fate and angle of whole flights towards the photon sphere, from r = 1000, 30, 6, 2 and from 1.2 outwards: the largest error among the rays of one distance. Crosses: an answer was wrong in kind. Grey line: what rounding a ray's own slope to a double does; exact and the tables answer for the very numbers they are given, and may lie below it.";
    let title = "Critical: accuracy beside the critical ray";
    let band = heading(canvas, (left - 56.0, top), title, caption)? + 8.0;
    let all = series(critical);
    let failing: Vec<_> = all.iter().filter(|series| series.fails()).collect();
    let top = band + ROW * failing.len() as f64 + if failing.is_empty() { 0.0 } else { 8.0 };
    let bottom = top + HEIGHT;
    let errors = critical
        .points
        .iter()
        .filter_map(|point| point.measurement.error);
    let plot = Plot {
        x: Axis {
            decades: (0.0, 1.0),
            pixels: (left, left + WIDTH),
        },
        y: Axis::about(errors.map(|error| error.max).chain([1e-16]), (bottom, top)),
    };
    let least = critical.points.iter().map(|point| point.place.distance);
    let x = Mirrored {
        middle: left + 0.5 * WIDTH,
        half: 0.5 * WIDTH,
        decades: -libm::log10(least.fold(1.0, f64::min)),
    };
    frame(canvas, &plot, &x, band)?;

    let rounding = [Side::Escape, Side::Capture].map(|side| {
        let here = critical
            .rounding
            .iter()
            .filter(|(place, _)| place.side == side);
        here.map(|&(place, angle)| (x.at(place), plot.y.at(angle)))
            .collect::<Vec<_>>()
    });
    for line in &rounding {
        canvas.line(line, plain(GREY, 0.9))?;
    }
    let mut labels = vec![Label {
        words: "rounding of the ray".into(),
        colour: GREY,
        lines: rounding.to_vec(),
    }];
    for series in &all {
        let lines = [Side::Escape, Side::Capture].map(|side| series.line(&plot, &x, side));
        for line in &lines {
            canvas.line(line, series.look.pen(1.5))?;
            for &at in line {
                canvas.marker(series.look.marker, at, 2.8, series.look.colour)?;
            }
        }
        labels.push(Label {
            words: series.label.clone(),
            colour: series.look.colour,
            lines: lines.to_vec(),
        });
    }
    // Labels keep off the line in the middle.
    let middle = (0..HEIGHT as i32 / 4).map(|k| (x.middle, bottom - 4.0 * f64::from(k)));
    labels::place(canvas, plot.corners(), &labels, &middle.collect::<Vec<_>>())?;
    for (i, series) in failing.iter().enumerate() {
        let y = band + ROW * (i as f64 + 0.5);
        let name = words(11.0, series.look.colour);
        canvas.text(&series.label, (left + WIDTH - 6.0, y), name, LEFT_OF)?;
        for point in &series.points {
            if point.measurement.failures > 0 {
                canvas.marker(
                    Marker::Cross,
                    (x.at(point.place), y),
                    3.4,
                    series.look.colour,
                )?;
            }
        }
    }
    if !failing.is_empty() {
        let y = band + 0.5 * ROW * failing.len() as f64;
        canvas.upward_text("failed", (left - 12.0, y), bold(11.0, BLACK))?;
    }
    Ok(bottom + 48.0)
}

impl Series<'_> {
    fn fails(&self) -> bool {
        self.points
            .iter()
            .any(|point| point.measurement.failures > 0)
    }

    /// Its line on one side.
    fn line(&self, plot: &Plot, x: &Mirrored, side: Side) -> Vec<(f64, f64)> {
        let here = self.points.iter().filter(|point| point.place.side == side);
        here.filter_map(|point| {
            let error = point.measurement.error?;
            Some((x.at(point.place), plot.y.at(error.max)))
        })
        .collect()
    }
}

/// The frame, with the distance's decades on both sides.
fn frame(canvas: &Canvas<'_>, plot: &Plot, x: &Mirrored, band: f64) -> Result<(), DrawError> {
    let (left, top, right, bottom) = plot.corners();
    for decade in (0..=x.decades.round() as i32).step_by(3) {
        for side in [Side::Escape, Side::Capture] {
            let at = x.at_decade(side, -f64::from(decade));
            canvas.line(&[(at, band), (at, bottom)], plain(LIGHT, 0.8))?;
            if decade == 15 {
                continue;
            }
            canvas.text(
                &power_of_ten(-decade),
                (at, bottom + 5.0),
                words(12.0, BLACK),
                BELOW,
            )?;
        }
    }
    plot.rows(canvas, true)?;
    canvas.line(&[(x.middle, band), (x.middle, bottom)], plain(BLACK, 1.0))?;
    canvas.line(&[(left, top), (right, top)], plain(GREY, 1.0))?;
    canvas.line(
        &[
            (left, band),
            (right, band),
            (right, bottom),
            (left, bottom),
            (left, band),
        ],
        plain(GREY, 1.0),
    )?;
    plot.names(
        canvas,
        "distance from the critical ray, |27 e²/4 − 1|",
        "largest error of the angle (radians)",
    )?;
    let below = bottom + 32.0;
    canvas.text(
        "← rays that escape",
        (left, below),
        words(12.0, GREY),
        RIGHT_OF,
    )?;
    canvas.text(
        "rays that are captured →",
        (right, below),
        words(12.0, GREY),
        LEFT_OF,
    )?;
    canvas.text(
        "critical",
        (x.middle, bottom + 5.0),
        words(12.0, BLACK),
        BELOW,
    )
}
