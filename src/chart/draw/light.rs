//! The fourth panel: a lit frame's time against the errors of its redshifts and of its colours.

use super::plot::{DrawError, ErrorAxis, PageArea, PlotLine, decades, heading, legend, plot};
use super::style::{SeriesStyle, px};
use crate::chart::light::{LightPanel, LightPoint, LitFrame};
use crate::chart::measurement::ComparedMethod;
use crate::chart::number_format::grouped;
use crate::scene::Light;

/// The titles of the columns and the names of their y axes.
const COLUMNS: [(&str, &str); 3] = [
    ("redshift", "relative error"),
    ("luminance", "error / hottest ring's luminance"),
    ("wrong pixels", "wrong pixels (share)"),
];

/// The column of the wrong pixels.
const WRONG: usize = 2;

/// Where the columns end.
const ENDS: [i32; WRONG] = [px(262), px(524)];

/// Draws the panel.
pub(super) fn draw(area: &PageArea<'_>, light: &LightPanel) -> Result<(), DrawError> {
    let source = match light.light {
        Light::BlackBody { temperature } => format!("a black body of {temperature} K"),
        Light::Bolometric => "grey light of all wavelengths".to_owned(),
    };
    let caption = format!(
        "{} at {} × {}, the disk as {source}, hard edges, whole frames in 8-bit colour on one thread.\n\
         Filled: from the map of the camera's radius; curves and map are built for each frame. Hollow, RK4, adaptive:\n\
         along each pixel's ray, timed on an even sample. Marker: the largest error of the pixels that show the disk\n\
         in the right order; whisker: from the 99th percentile. Luminance: what follows from radius and redshift.\n\
         Wrong pixels: the share of {} (of slow methods fewer, see the CSV) that miss the disk, see it by mistake, or\n\
         see another order.",
        light.name,
        light.size.0,
        light.size.1,
        grouped(light.compared as usize)
    );
    let title = "Light: what a frame in colour costs, and how far redshift and colour are off";
    let (area, legend_area) = heading(area, title, &caption)?;
    let cells = area.split_by_breakpoints(ENDS, [0_i32; 0]);
    let times = decades(light.points.iter().map(|point| point.milliseconds));
    for (column, (title, name)) in COLUMNS.into_iter().enumerate() {
        let lines = lines(&light.points, column);
        let y = ErrorAxis::new(&lines);
        let x = (&times, "time (milliseconds)");
        plot(&cells[column], title, x, (&y, name), &lines)?;
    }
    legend(&legend_area, &lines(&[], 0))
}

/// Returns the lines of a column: every method, as far as it is drawn pixel by pixel and from the map.
fn lines(points: &[LightPoint], column: usize) -> Vec<PlotLine> {
    let mut lines = Vec::new();
    for method in ComparedMethod::ALL {
        let (style, label) = SeriesStyle::of(method);
        let series = match method {
            ComparedMethod::Euler | ComparedMethod::TableScaled => vec![],
            ComparedMethod::Rk4 | ComparedMethod::Adaptive => {
                vec![(style, label.to_owned(), LitFrame::PixelByPixel)]
            }
            _ => vec![
                (style, format!("{label}, map"), LitFrame::NewRadius),
                (
                    style.hollow(),
                    format!("{label}, by pixel"),
                    LitFrame::PixelByPixel,
                ),
            ],
        };
        for (style, label, frame) in series {
            let of = |point: &&LightPoint| point.method == method && point.frame == frame;
            let mut of: Vec<_> = points.iter().filter(of).collect();
            of.sort_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
            let mut line = PlotLine::new((style, &label), Vec::new());
            for point in of {
                let time = point.milliseconds;
                if column == WRONG {
                    line.points.push((time, point.wrong_share()));
                    continue;
                }
                let row = [&point.redshift, &point.luminance][column];
                let Some(error) = row.error else { continue };
                let whisker = SeriesStyle::line(style.colour, 2);
                let ends = vec![(time, error.p99), (time, error.max)];
                lines.push(PlotLine::new((whisker, ""), ends));
                line.points.push((time, error.max));
            }
            lines.push(line);
        }
    }
    lines
}
