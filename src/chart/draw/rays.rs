//! The first panel: time against error.

use core::ops::Range;

use plotters::prelude::*;

use super::plot::{
    DrawError, ErrorAxis, MARGIN, PageArea, PlotLine, X_LABELS, Y_LABELS, axis, decades, heading,
    legend, plot,
};
use super::style::{GREY, LIGHT, SeriesStyle, font, px};
use crate::chart::measurement::ComparedMethod;
use crate::chart::number_format::{axis_label, grouped};
use crate::chart::rays::RayPanel;

/// Draws the panel.
pub(super) fn draw(area: &PageArea<'_>, rays: &RayPanel) -> Result<(), DrawError> {
    let caption = format!(
        "The angle to the first crossing of one radius, for {} rays of cameras at r = 1.05 … 1000 in all\n\
         directions and radii 3 … 30 (evenly in log r). One thread, times from median ratios to RK4. Marker: 99th\n\
         percentile of the error against the exact method; whisker: median to largest; cross at the top: crossings\n\
         were missed. Exact: one integral against the sum of two over the same range. Pareto front: the settings\n\
         without failures than which no other is both faster and more accurate.",
        grouped(rays.count)
    );
    let (area, legend_area) = heading(area, "Rays: what one swept angle costs", &caption)?;
    let (mut lines, mut candidates) = (Vec::new(), Vec::new());
    for method in ComparedMethod::ALL {
        let rows = rays.points.iter().filter(|row| row.method == method);
        let rows = rows.filter_map(|row| Some((row.time?.nanoseconds, row.error?, row.failures)));
        let mut rows: Vec<_> = rows.collect();
        rows.sort_by(|a, b| b.1.p99.total_cmp(&a.1.p99));
        let (style, label) = SeriesStyle::of(method);
        let whisker = SeriesStyle::line(style.colour, 2);
        let mut line = PlotLine::new((style, label), Vec::new());
        for (time, error, failures) in rows {
            let ends = [error.p50, error.max].map(|error| (time, error));
            lines.push(PlotLine::new((whisker, ""), ends.to_vec()));
            line.points.push((time, error.p99));
            if failures == 0 {
                candidates.push((time, error.p99));
            } else {
                line.failures.push((time, 1));
            }
        }
        lines.push(line);
    }
    let front = (SeriesStyle::line(LIGHT, 18), "Pareto front");
    lines.insert(0, PlotLine::new(front, pareto_front(candidates)));
    let points = lines.iter().flat_map(|line| &line.points);
    let times = decades(points.map(|point| point.0));
    let (top, area) = area.split_vertically(X_LABELS + px(1));
    ratio_axis(&top, rays, &times)?;
    let x = (&times, "time per ray (nanoseconds)");
    let y = (&ErrorAxis::new(&lines), "error of the angle (radians)");
    plot(&area, "", x, y, &lines)?;
    legend(&legend_area, &lines)
}

/// Draws the axis above the plot: the speed as a multiple of the baseline's.
fn ratio_axis(area: &PageArea<'_>, rays: &RayPanel, times: &Range<f64>) -> Result<(), DrawError> {
    let mut rows = rays.points.iter().filter_map(|row| row.time);
    let Some(baseline) = rows.find(|time| time.ratio_to_rk4 == 1.0) else {
        return Ok(());
    };
    let [from, to] = [times.start, times.end].map(|time| baseline.nanoseconds / time);
    let step = rays.baseline_step;
    ChartBuilder::on(area)
        .margin_left(Y_LABELS)
        .margin_right(MARGIN)
        .top_x_label_area_size(X_LABELS)
        .build_cartesian_2d(axis(from..to, 12), 0.0..1.0)?
        .configure_mesh()
        .disable_mesh()
        .label_style(font(12.0, GREY))
        .axis_style(GREY)
        .set_all_tick_mark_size(px(3))
        .x_label_formatter(&|ratio| format!("{} ×", axis_label(*ratio)))
        .x_desc(format!(
            "times as fast as RK4 in steps of {step:.3} (error 10⁻⁶)"
        ))
        .draw()?;
    Ok(())
}

/// Returns the points `(cost, error)` that no other point beats in both numbers, by rising cost.
fn pareto_front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut least = f64::INFINITY;
    points.retain(|&(_, error)| {
        let better = error < least;
        least = least.min(error);
        better
    });
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beaten_points_are_left_out() {
        let points = vec![(3.0, 1.0), (1.0, 5.0), (2.0, 6.0), (2.0, 2.0), (4.0, 1.0)];
        assert_eq!(pareto_front(points), [(1.0, 5.0), (2.0, 2.0), (3.0, 1.0)]);
        assert_eq!(pareto_front(Vec::new()), []);
    }
}
