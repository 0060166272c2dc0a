//! Plots with two logarithmic axes, their series and their legends, drawn by plotters.

use core::ops::Range;

use plotters::coord::Shift;
use plotters::coord::combinators::{LogCoord, WithKeyPoints};
use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::style::{GREY, LIGHT, SeriesStyle, bold, font, px};
use crate::chart::number_format::axis_label;

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure cannot be drawn: {0}")]
pub struct DrawError(String);

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for DrawError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

/// A rectangle of the page.
pub(super) type PageArea<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A logarithmic axis with chosen ticks.
type LogAxis = WithKeyPoints<LogCoord<f64>>;

/// The height of an x axis' labels and name, the width of a y axis', and the margin at the right of a plot.
pub(super) const X_LABELS: i32 = px(42);
pub(super) const Y_LABELS: i32 = px(66);
pub(super) const MARGIN: i32 = px(12);

/// One line of a plot.
#[derive(Debug, Clone)]
pub(super) struct PlotLine {
    pub(super) style: SeriesStyle,
    pub(super) label: String,
    pub(super) points: Vec<(f64, f64)>,
    /// The places of failures along the x axis, and their row above the y axis' errors, from 1.
    pub(super) failures: Vec<(f64, usize)>,
}

impl PlotLine {
    /// Creates a line without failures. A line without a label is not in the legend.
    pub(super) fn new((style, label): (SeriesStyle, &str), points: Vec<(f64, f64)>) -> Self {
        Self {
            style,
            label: label.to_owned(),
            points,
            failures: Vec::new(),
        }
    }
}

/// A logarithmic y axis for errors. Its lowest decade stands for 0 if there are errors of 0. Rows above it, a decade
/// high, are for failures.
pub(super) struct ErrorAxis {
    range: Range<f64>,
    has_zero: bool,
    failure_rows: usize,
}

impl ErrorAxis {
    /// Creates an axis that contains all `lines`.
    pub(super) fn new<'a>(lines: impl IntoIterator<Item = &'a PlotLine>) -> Self {
        let (mut errors, mut failure_rows) = (Vec::new(), 0);
        for line in lines {
            errors.extend(line.points.iter().map(|point| point.1));
            let rows = line.failures.iter().map(|failure| failure.1);
            failure_rows = rows.fold(failure_rows, usize::max);
        }
        let mut range = decades(errors.iter().copied());
        let has_zero = errors.iter().any(|error| *error <= 0.0);
        range.start *= if has_zero { 0.1 } else { 1.0 };
        Self {
            range,
            has_zero,
            failure_rows,
        }
    }

    /// Returns where an error is on the axis.
    fn place(&self, error: f64) -> f64 {
        error.max(self.range.start)
    }

    /// Returns where a row for failures is on the axis.
    fn failure(&self, row: usize) -> f64 {
        self.range.end * libm::pow(10.0, row as f64)
    }

    fn axis(&self, labels: i32) -> LogAxis {
        let range = self.range.start..2.0 * self.failure(self.failure_rows);
        let mut ticks = ticks(&range, labels);
        ticks.extend(self.has_zero.then_some(range.start));
        range.log_scale().with_key_points(ticks)
    }

    fn label(&self, value: f64) -> String {
        match value {
            _ if value > 2.0 * self.range.end => "failed".to_owned(),
            _ if self.has_zero && value < 2.0 * self.range.start => "0".to_owned(),
            _ => axis_label(value),
        }
    }
}

/// Returns the range of whole decades that contains all positive finite `values`.
pub(super) fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let range = around(values);
    let [low, high] = [range.start, range.end].map(libm::log10);
    libm::pow(10.0, low.floor())..libm::pow(10.0, high.ceil().max(low.floor() + 1.0))
}

/// Returns the range of all positive finite `values`, and 0.1 … 1 without any.
fn around(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for value in values.filter(|value| *value > 0.0 && value.is_finite()) {
        (low, high) = (low.min(value), high.max(value));
    }
    if low <= high { low..high } else { 0.1..1.0 }
}

/// Returns a logarithmic axis with at most `labels` ticks.
pub(super) fn axis(range: Range<f64>, labels: i32) -> LogAxis {
    let ticks = ticks(&range, labels);
    range.log_scale().with_key_points(ticks)
}

/// Returns powers of ten as ticks, or on a short axis the ticks that the library gives a linear axis.
fn ticks(range: &Range<f64>, labels: i32) -> Vec<f64> {
    let [start, end] = [range.start, range.end].map(libm::log10);
    let (low, high) = (start.min(end), start.max(end));
    if high - low < 0.9 {
        return RangedCoordf64::from(range.clone()).key_points(2 * labels as usize);
    }
    let (first, last) = ((low - 1e-6).ceil() as i32, (high + 1e-6).floor() as i32);
    let every = (last - first) / labels.max(1) + 1;
    let decades = (first..=last).filter(|decade| decade % every == 0);
    let powers = decades.map(|decade| libm::pow(10.0, f64::from(decade)));
    powers.collect()
}

/// Draws a panel's title and the lines of its caption. Returns the area below, and at its right an area for the legend.
pub(super) fn heading<'a>(
    area: &PageArea<'a>,
    title: &str,
    caption: &str,
) -> Result<(PageArea<'a>, PageArea<'a>), DrawError> {
    let mut below = area.margin(px(16), 0, 0, 0).titled(title, bold(16.0))?;
    for line in caption.lines() {
        below = below.titled(line, font(12.0, GREY))?;
    }
    let below = below.margin(px(8), 0, px(10), 0);
    let (width, _) = below.dim_in_pixel();
    Ok(below.split_horizontally(width.cast_signed() - px(190)))
}

/// Draws a plot: its axes with their names, its lines and their failures. Without a name the y axis has no labels.
pub(super) fn plot(
    area: &PageArea<'_>,
    title: &str,
    (x, x_name): (&Range<f64>, &str),
    (y, y_name): (&ErrorAxis, &str),
    lines: &[PlotLine],
) -> Result<(), DrawError> {
    let (width, height) = area.dim_in_pixel();
    let y_labels = if y_name.is_empty() { px(20) } else { Y_LABELS };
    let x_axis = axis(x.clone(), (width.cast_signed() - y_labels) / px(40));
    let y_axis = y.axis((height.cast_signed() - X_LABELS) / px(15));
    let mut plot = ChartBuilder::on(area)
        .caption(title, bold(12.0))
        .margin_top(px(6))
        .margin_right(MARGIN)
        .x_label_area_size(X_LABELS)
        .y_label_area_size(y_labels)
        .build_cartesian_2d(x_axis, y_axis)?;
    let y_label = |value: &f64| match y_name {
        "" => String::new(),
        _ => y.label(*value),
    };
    plot.configure_mesh()
        .label_style(font(12.0, BLACK))
        .axis_desc_style(font(13.0, BLACK))
        .axis_style(GREY)
        .bold_line_style(LIGHT)
        .set_all_tick_mark_size(px(3))
        .x_desc(x_name)
        .y_desc(y_name)
        .x_label_formatter(&|value| axis_label(*value))
        .y_label_formatter(&y_label)
        .draw()?;
    for line in lines {
        let (style, (dash, gap)) = (line.style, line.style.dash);
        let points = line.points.iter().map(|&(x, error)| (x, y.place(error)));
        let stroke = style.colour.stroke_width(style.width);
        plot.draw_series(DashedLineSeries::new(points.clone(), dash, gap, stroke))?;
        let failures = line.failures.iter();
        let failures = failures.map(|&(x, row)| ((x, y.failure(row)), style.failed()));
        let markers = points.map(|place| (place, style)).chain(failures);
        plot.draw_series(markers.map(|(place, style)| {
            let (inside, outline) = style.fill();
            EmptyElement::at(place)
                + Polygon::new(style.outline((0, 0)), inside)
                + PathElement::new(style.closed_outline((0, 0)), outline)
        }))?;
    }
    Ok(())
}

/// Draws the legend of `lines`.
pub(super) fn legend(area: &PageArea<'_>, lines: &[PlotLine]) -> Result<(), DrawError> {
    const LENGTH: i32 = px(26);
    let mut chart = ChartBuilder::on(area).build_cartesian_2d(0..1, 0..1)?;
    for line in lines.iter().filter(|line| !line.label.is_empty()) {
        let (style, (dash, gap)) = (line.style, line.style.dash);
        let stroke = style.colour.stroke_width(style.width);
        let entry = chart.draw_series(LineSeries::new([(0, 0)], TRANSPARENT))?;
        entry.label(&line.label).legend(move |place| {
            let (inside, outline) = style.fill();
            EmptyElement::at(place)
                + DashedPathElement::new([(0, 0), (LENGTH, 0)], dash, gap, stroke)
                + Polygon::new(style.outline((LENGTH / 2, 0)), inside)
                + PathElement::new(style.closed_outline((LENGTH / 2, 0)), outline)
        });
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .legend_area_size(LENGTH + px(8))
        .label_font(font(12.0, BLACK))
        .draw()?;
    Ok(())
}
