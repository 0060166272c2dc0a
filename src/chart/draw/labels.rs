//! Labels at their lines: each is put where it covers least of what is drawn, since where the lines run depends on the
//! machine.

use super::DrawError;
use super::axis::Plot;
use super::canvas::{CENTRED, Canvas, Colour};
use super::style::bold;

/// A line's label: its words, and the points of the line that it may stand at.
#[derive(Debug, Clone)]
pub(super) struct Label {
    pub(super) words: String,
    pub(super) colour: Colour,
    /// On the page, in pixels.
    pub(super) line: Vec<(f64, f64)>,
}

/// The size of the labels' letters, in pixels.
const SIZE: f64 = 12.0;

/// A rectangle on the page: left, top, right, bottom.
type Rect = (f64, f64, f64, f64);

fn overlap(a: Rect, b: Rect) -> f64 {
    let width = a.2.min(b.2) - a.0.max(b.0);
    let height = a.3.min(b.3) - a.1.max(b.1);
    width.max(0.0) * height.max(0.0)
}

/// The boxes about a line, some pixels apart.
fn beads(line: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    let ends = line.iter().copied();
    let between = line.windows(2).flat_map(|pair| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let steps = (libm::hypot(x1 - x0, y1 - y0) / 4.0).ceil();
        (1..steps as u32).map(move |k| {
            let share = f64::from(k) / steps;
            (x0 + (x1 - x0) * share, y0 + (y1 - y0) * share)
        })
    });
    ends.chain(between)
}

/// Draws the labels of lines that are drawn on `plot` along `obstacles` too.
pub(super) fn place(
    canvas: &Canvas<'_>,
    plot: &Plot,
    labels: &[Label],
    obstacles: &[(f64, f64)],
) -> Result<(), DrawError> {
    let mut taken: Vec<Rect> = Vec::new();
    let drawn: Vec<(f64, f64)> = labels
        .iter()
        .flat_map(|label| beads(&label.line))
        .chain(obstacles.iter().copied())
        .collect();
    for label in labels {
        // Letters of a sans-serif are some six tenths as wide as high.
        let (width, height) = (0.6 * SIZE * label.words.chars().count() as f64, 1.15 * SIZE);
        let mut best: Option<(f64, Rect)> = None;
        for (x, y) in beads(&label.line) {
            for (across, up, dislike) in OFFSETS {
                let centre = (
                    x + across * (0.5 * width + 8.0),
                    y - up * (0.5 * height + 6.0),
                );
                let rect = (
                    centre.0 - 0.5 * width,
                    centre.1 - 0.5 * height,
                    centre.0 + 0.5 * width,
                    centre.1 + 0.5 * height,
                );
                let cost = dislike + cost(rect, plot.corners(), &taken, &drawn);
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, rect));
                }
            }
        }
        if let Some((_, rect)) = best {
            taken.push(rect);
            let centre = (0.5 * (rect.0 + rect.2), 0.5 * (rect.1 + rect.3));
            canvas.text(&label.words, centre, bold(SIZE, label.colour), CENTRED)?;
        }
    }
    Ok(())
}

/// Where a label may stand from a point: across and up, in halves of its own size, and how little that is liked.
const OFFSETS: [(f64, f64, f64); 8] = [
    (1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.5),
    (0.0, 1.0, 0.5),
    (0.0, -1.0, 1.0),
    (1.0, 1.0, 1.0),
    (1.0, -1.0, 1.0),
    (-1.0, 1.0, 1.5),
    (-1.0, -1.0, 1.5),
];

/// How much a label covers, and whether it leaves the plot.
fn cost(rect: Rect, plot: Rect, taken: &[Rect], drawn: &[(f64, f64)]) -> f64 {
    let inside = overlap(rect, plot);
    let area = (rect.2 - rect.0) * (rect.3 - rect.1);
    let covered = drawn
        .iter()
        .filter(|(x, y)| {
            rect.0 - 3.0 < *x && *x < rect.2 + 3.0 && rect.1 - 3.0 < *y && *y < rect.3 + 3.0
        })
        .count();
    let spread = (rect.0 - 3.0, rect.1 - 2.0, rect.2 + 3.0, rect.3 + 2.0);
    let clashes: f64 = taken.iter().map(|&other| overlap(spread, other)).sum();
    10.0 * covered as f64 + 5.0 * clashes + 5.0 * (area - inside)
}
