//! The third panel: a frame's time against the displacement of its edges, by order, and against its wrong pixels.

use core::ops::Range;

use plotters::style::BLACK;

use super::plot::{DrawError, ErrorAxis, PageArea, PlotLine, decades, heading, legend, plot};
use super::style::{SeriesStyle, px};
use crate::chart::measurement::ComparedMethod;
use crate::chart::number_format::grouped;
use crate::chart::scene::{FramePoint, ScenePanel};

/// The titles of the columns, and the names of their y axes: three orders, and the wrong pixels.
const COLUMNS: [(&str, &str); 4] = [
    ("direct image", "displacement (pixels)"),
    ("first ring", ""),
    ("second ring", ""),
    ("wrong pixels", "wrong pixels (share)"),
];

/// The column of the wrong pixels.
const WRONG: usize = 3;

/// Where the columns end.
const ENDS: [i32; WRONG] = [px(222), px(400), px(578)];

/// Draws the panel.
pub(super) fn draw(area: &PageArea<'_>, scene: &ScenePanel) -> Result<(), DrawError> {
    let caption = format!(
        "{} at {} × {}, hard edges, whole frames on one thread. Tables and the exact method give isoradial curves,\n\
         right to the {:?} pixels allowed (line), and the frame is filled between them. Euler, RK4 and adaptive step\n\
         along every pixel's ray, timed on an even sample. Displacement: the largest of an edge at {} angles; cross\n\
         at the top: an edge was lost. Wrong pixels: the share of {} that differ from their exact rays; of slow\n\
         methods fewer are compared (see the CSV).",
        scene.name,
        scene.size.0,
        scene.size.1,
        scene.tolerance,
        scene.places,
        grouped(scene.compared as usize)
    );
    let title = "Scene: what a frame costs, and how far its edges are displaced";
    let (area, legend_area) = heading(area, title, &caption)?;
    let cells = area.split_by_breakpoints(ENDS, [0_i32; 0]);
    // Curves at other tolerances than the scene's are in the CSV alone.
    let points = scene.points.iter().filter(|point| {
        let tolerance = point.curve_tolerance;
        tolerance.is_none_or(|tolerance| tolerance == scene.tolerance)
    });
    let mut points: Vec<_> = points.collect();
    points.sort_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
    let times = decades(points.iter().map(|point| point.milliseconds));
    let columns: [_; COLUMNS.len()] =
        core::array::from_fn(|column| lines(scene, &points, column, &times));
    let displacements = ErrorAxis::new(columns[..WRONG].iter().flatten());
    let shares = ErrorAxis::new(&columns[WRONG]);
    for (column, (title, name)) in COLUMNS.into_iter().enumerate() {
        let y = if column == WRONG {
            &shares
        } else {
            &displacements
        };
        let x = (&times, "time (milliseconds)");
        plot(&cells[column], title, x, (y, name), &columns[column])?;
    }
    legend(&legend_area, &lines(scene, &[], 0, &(1.0..1.0)))
}

/// Returns the lines of a column: the displacement that the scene allows, and every method.
fn lines(
    scene: &ScenePanel,
    points: &[&FramePoint],
    column: usize,
    times: &Range<f64>,
) -> Vec<PlotLine> {
    let allowed = [times.start, times.end].map(|time| (time, scene.tolerance));
    let allowed = allowed[..if column == WRONG { 0 } else { 2 }].to_vec();
    let mut lines = vec![PlotLine::new(
        (SeriesStyle::line(BLACK, 2), "allowed"),
        allowed,
    )];
    for method in ComparedMethod::ALL
        .into_iter()
        .filter(|method| *method != ComparedMethod::TableScaled)
    {
        let mut line = PlotLine::new(SeriesStyle::of(method), Vec::new());
        for point in points.iter().filter(|point| point.method == method) {
            let time = point.milliseconds;
            if column == WRONG {
                line.points.push((time, point.wrong_share()));
                continue;
            }
            let order = &point.orders[column];
            line.points
                .extend(order.error.map(|error| (time, error.max)));
            line.failures
                .extend((order.failures > 0).then_some((time, 1)));
        }
        lines.push(line);
    }
    lines
}
