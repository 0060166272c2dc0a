//! Labels at their lines: each is put where it covers least of what is drawn, since where the lines run depends on the
//! machine.

use super::DrawError;
use super::canvas::{CENTRED, Canvas, Colour};
use super::style::{bold, plain};

/// A line's label: its words, and the points of the line that it may stand at.
#[derive(Debug, Clone)]
pub(super) struct Label {
    pub(super) words: String,
    pub(super) colour: Colour,
    /// On the page, in pixels; in pieces where it is interrupted.
    pub(super) lines: Vec<Vec<(f64, f64)>>,
}

/// The size of the labels' letters, in pixels.
const SIZE: f64 = 12.0;

/// A rectangle on the page: left, top, right, bottom.
pub(super) type Rect = (f64, f64, f64, f64);

fn overlap(a: Rect, b: Rect) -> f64 {
    let width = a.2.min(b.2) - a.0.max(b.0);
    let height = a.3.min(b.3) - a.1.max(b.1);
    width.max(0.0) * height.max(0.0)
}

/// A place for a label: what speaks against it, its rectangle, and the point that a line leads from.
type Place = (f64, Rect, Option<(f64, f64)>);

/// Points along a line, some pixels apart.
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

/// Draws the labels of lines within a rectangle of the page; `obstacles` are drawn there too. A label that finds no
/// room at its line stands apart, and a thin line leads to it.
pub(super) fn place(
    canvas: &Canvas<'_>,
    within: Rect,
    labels: &[Label],
    obstacles: &[(f64, f64)],
) -> Result<(), DrawError> {
    let mut taken: Vec<Rect> = Vec::new();
    let drawn: Vec<(f64, f64)> = labels
        .iter()
        .flat_map(|label| label.lines.iter().flat_map(|line| beads(line)))
        .chain(obstacles.iter().copied())
        .collect();
    for label in labels {
        // Bold letters of a sans-serif are some two thirds as wide as high.
        let (width, height) = (
            0.66 * SIZE * label.words.chars().count() as f64,
            1.15 * SIZE,
        );
        let mut best: Option<Place> = None;
        for (x, y) in label.lines.iter().flat_map(|line| beads(line)) {
            for ring in 0..RINGS {
                let apart = f64::from(ring) * RING;
                for (across, up, dislike) in OFFSETS {
                    let centre = (
                        x + across * (0.5 * width + 8.0 + apart),
                        y - up * (0.5 * height + 6.0 + apart),
                    );
                    let rect = (
                        centre.0 - 0.5 * width,
                        centre.1 - 0.5 * height,
                        centre.0 + 0.5 * width,
                        centre.1 + 0.5 * height,
                    );
                    let cost = dislike + 4.0 * f64::from(ring) + cost(rect, within, &taken, &drawn);
                    if best.is_none_or(|(least, ..)| cost < least) {
                        best = Some((cost, rect, (ring > 0).then_some((x, y))));
                    }
                }
            }
        }
        if let Some((_, rect, leader)) = best {
            taken.push(rect);
            let centre = (0.5 * (rect.0 + rect.2), 0.5 * (rect.1 + rect.3));
            if let Some((x, y)) = leader {
                let to = (x.clamp(rect.0, rect.2), y.clamp(rect.1, rect.3));
                canvas.line(&[(x, y), to], plain(label.colour, 0.6))?;
            }
            canvas.text(&label.words, centre, bold(SIZE, label.colour), CENTRED)?;
        }
    }
    Ok(())
}

/// How far from its line a label may stand: in steps of some pixels.
const RINGS: u32 = 8;
const RING: f64 = 12.0;

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

/// How much a label covers, and whether it leaves its place.
fn cost(rect: Rect, within: Rect, taken: &[Rect], drawn: &[(f64, f64)]) -> f64 {
    let inside = overlap(rect, within);
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
