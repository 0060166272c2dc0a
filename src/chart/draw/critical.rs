//! The second panel: error against the distance from the critical ray, on both sides of it.

use super::plot::{DrawError, ErrorAxis, PageArea, PlotLine, decades, heading, legend, plot};
use super::style::{GREY, SeriesStyle, px};
use crate::chart::critical::{CriticalPanel, CriticalPoint};
use crate::chart::measurement::ComparedMethod;
use crate::orbit::Fate;

/// Returns the style and the label of a point's method and setting.
fn style(point: &CriticalPoint) -> (SeriesStyle, String) {
    let row = &point.measurement;
    let (mut style, label) = SeriesStyle::of(row.method);
    let (knob, _) = row.setting.split_once(' ').unwrap_or_default();
    let label = match row.method {
        ComparedMethod::Adaptive => "adaptive 10⁻⁹".to_owned(),
        ComparedMethod::Euler | ComparedMethod::Rk4 => {
            format!("{label} {}", knob.replace('=', " = "))
        }
        _ => label.to_owned(),
    };
    // Dashes mark the coarser of the two settings of RK4.
    if knob == "h=0.05" {
        style.dash = (10, 6);
    }
    (style, label)
}

/// Returns a line for each method and setting, from the points of rays with this fate. The order of the lines and of
/// the rows for failures is the same for both fates.
fn lines(critical: &CriticalPanel, fate: Fate) -> Vec<PlotLine> {
    let mut lines: Vec<PlotLine> = Vec::new();
    let mut failing = Vec::new();
    for point in &critical.points {
        let (style, label) = style(point);
        if lines.last().is_none_or(|line| line.label != label) {
            lines.push(PlotLine::new((style, &label), Vec::new()));
        }
        let (row, distance) = (&point.measurement, point.distance);
        if row.failures > 0 && failing.last() != Some(&label) {
            failing.push(label);
        }
        if let Some(line) = lines.last_mut().filter(|_| distance.fate == fate) {
            line.points
                .extend(row.error.map(|error| (distance.value, error.max)));
            line.failures
                .extend((row.failures > 0).then_some((distance.value, failing.len())));
        }
    }
    let rounding = critical
        .rounding
        .iter()
        .filter(|(distance, _)| distance.fate == fate);
    let rounding = rounding.map(|(distance, angle)| (distance.value, *angle));
    let style = (SeriesStyle::line(GREY, 2), "rounding of the ray");
    lines.push(PlotLine::new(style, rounding.collect()));
    lines
}

/// Draws the panel.
pub(super) fn draw(area: &PageArea<'_>, critical: &CriticalPanel) -> Result<(), DrawError> {
    let caption = "\
        Fate and total angle of rays towards the photon sphere, from r = 1000, 30, 6 and 2, and from 1.2 outwards:\n\
        the largest error among the rays of one distance. Cross at the top: wrong fates or missing answers.\n\
        Grey line: the effect of rounding a ray's own slope to a double; the exact method and the tables answer\n\
        for exactly the numbers that they are given, and may lie below it.";
    let (area, legend_area) = heading(area, "Critical: accuracy near the critical ray", caption)?;
    let [escaping, captured] = [Fate::Escape, Fate::Capture].map(|fate| lines(critical, fate));
    let x = decades(critical.points.iter().map(|point| point.distance.value));
    let y = ErrorAxis::new(escaping.iter().chain(&captured));
    let (left, right) = area.split_horizontally(area.dim_in_pixel().0.cast_signed() / 2 + px(23));
    let (reversed, x_name) = (
        x.end..x.start,
        "distance from the critical ray, |27 e²/4 − 1|",
    );
    let y_name = "largest error of the angle (radians)";
    plot(
        &left,
        "rays that escape",
        (&reversed, x_name),
        (&y, y_name),
        &escaping,
    )?;
    plot(
        &right,
        "rays that are captured",
        (&x, x_name),
        (&y, ""),
        &captured,
    )?;
    legend(&legend_area, &escaping)
}
