//! What is written over the picture: figures, help, messages, the scale of false colours, the animation's bar.

use super::super::controls;
use super::bitmap::{Area, Bitmap};
use super::false_colour::ColourScale;
use super::pace::Coarseness;
use super::text::Typeface;
use super::viewer::Viewer;

/// The height of a line of 1, in pixels.
const LINE: f32 = 15.0;

/// The width and the height of the colours of a scale, in pixels.
const SCALE: (usize, usize) = (256, 12);

/// The distance of writing from what it stands on, in pixels.
const MARGIN: usize = 6;

/// The colours of the animation's bar: the line, and the frame that is shown.
const BAR: [u32; 2] = [0x0080_8080, 0x00ff_ffff];

/// Writes over pictures.
pub(super) struct Overlay {
    typeface: Typeface,
}

/// What only the window knows.
pub(super) struct Measured<'a> {
    /// Of frames a second, while they are drawn.
    pub(super) rate: Option<f64>,
    /// How coarse the frame is.
    pub(super) coarseness: Coarseness,
    /// Of the false colours.
    pub(super) scale: Option<(ColourScale, &'a [u32])>,
    /// What the pointer is over.
    pub(super) pointed: Option<&'a str>,
    /// Why the picture could not be drawn.
    pub(super) fault: Option<&'a str>,
}

impl Overlay {
    /// Writes as large as the display needs; 1 is an ordinary one.
    pub(super) fn new(scale_factor: f64) -> Self {
        Self {
            typeface: Typeface::new(LINE * scale_factor as f32),
        }
    }

    /// Writes what is to be written over a picture.
    pub(super) fn write(
        &mut self,
        viewer: &Viewer,
        measured: &Measured<'_>,
        bitmap: &mut Bitmap<'_>,
    ) {
        if let Some((scale, colours)) = measured.scale {
            self.scale(scale.labels(viewer.shown()), colours, bitmap);
        }
        // The help may stand in the same place.
        if viewer.has_figures() && !viewer.has_help() {
            let lines = figures(viewer, measured);
            self.lines(&lines, (0, 0), bitmap);
        }
        if viewer.has_help() {
            let lines: Vec<String> = controls::lines().collect();
            let width = self.width(&lines).min(bitmap.width());
            let height = self.height(&lines).min(bitmap.height());
            let corner = ((bitmap.width() - width) / 2, (bitmap.height() - height) / 2);
            self.lines(&lines, corner, bitmap);
        }
        if let Some(message) = measured.fault.or_else(|| viewer.message()) {
            let columns =
                bitmap.width().saturating_sub(2 * MARGIN) / self.typeface.advance().max(1);
            let lines = wrapped(message, columns);
            let below = bitmap.height().saturating_sub(self.height(&lines));
            let above_bar = viewer.bar().map_or(0, |bar| bar.height);
            self.lines(&lines, (0, below.saturating_sub(above_bar)), bitmap);
        }
        if let Some(bar) = viewer.bar() {
            self.bar(viewer, bar, bitmap);
        }
    }

    fn width(&self, lines: &[String]) -> usize {
        let widest = lines.iter().map(|line| self.typeface.width(line)).max();
        widest.unwrap_or_default() + 2 * MARGIN
    }

    fn height(&self, lines: &[String]) -> usize {
        lines.len() * self.typeface.line_height() + 2 * MARGIN
    }

    /// Writes lines on darkened ground, whose upper left corner is given.
    fn lines(&mut self, lines: &[String], (left, top): (usize, usize), bitmap: &mut Bitmap<'_>) {
        bitmap.dim(Area {
            left,
            top,
            width: self.width(lines),
            height: self.height(lines),
        });
        for (i, line) in lines.iter().enumerate() {
            let y = top + MARGIN + i * self.typeface.line_height();
            self.typeface.write(bitmap, (left + MARGIN, y), line);
        }
    }

    /// Draws a scale in the upper right corner: its colours, and below them the least, the name and the greatest.
    fn scale(&mut self, [from, name, to]: [String; 3], colours: &[u32], bitmap: &mut Bitmap<'_>) {
        let labels =
            self.typeface.width(&from) + self.typeface.width(&name) + self.typeface.width(&to);
        let width = SCALE.0.max(labels + 4 * self.typeface.advance());
        let ground = Area {
            left: bitmap.width().saturating_sub(width + 2 * MARGIN),
            top: 0,
            width: width + 2 * MARGIN,
            height: SCALE.1 + self.typeface.line_height() + 2 * MARGIN,
        };
        bitmap.dim(ground);
        let area = Area {
            left: ground.left + MARGIN,
            top: MARGIN,
            width,
            height: SCALE.1,
        };
        let last = colours.len() - 1;
        bitmap.fill_columns(area, |place| colours[(place * last as f64 + 0.5) as usize]);
        let y = area.top + area.height;
        let middle = area.left + (width - self.typeface.width(&name)) / 2;
        let right = area.left + width - self.typeface.width(&to);
        for (x, label) in [(area.left, from), (middle, name), (right, to)] {
            self.typeface.write(bitmap, (x, y), &label);
        }
    }

    /// Draws the animation's bar: a line, the frame that is shown, and its number.
    fn bar(&mut self, viewer: &Viewer, bar: Area, bitmap: &mut Bitmap<'_>) {
        bitmap.dim(bar);
        let line = Area {
            top: bar.top + bar.height / 2,
            height: 2,
            ..bar
        };
        bitmap.fill(line, BAR[0]);
        let at = viewer.playback().share() * bar.width.saturating_sub(4) as f64;
        let knob = Area {
            left: at as usize,
            width: 4,
            ..bar
        };
        bitmap.fill(knob, BAR[1]);
        let number = format!("frame {}", viewer.playback().frame());
        let x = bar
            .width
            .saturating_sub(self.typeface.width(&number) + MARGIN);
        let above = bar.top.saturating_sub(self.typeface.line_height());
        self.typeface.write(bitmap, (x, above), &number);
    }
}

/// The lines of the figures.
fn figures(viewer: &Viewer, measured: &Measured<'_>) -> Vec<String> {
    let navigator = viewer.navigator();
    let rate = match measured.rate {
        Some(rate) => format!("{rate:.0} frames/s"),
        None => "at rest".into(),
    };
    let coarseness = match measured.coarseness {
        Coarseness::FULL => String::new(),
        Coarseness { reduction: 1, .. } => ", hard edges".into(),
        Coarseness { reduction, .. } => format!(", at 1/{reduction} of the size"),
    };
    let mut lines = vec![
        rate + &coarseness,
        format!("radius {:.4}", navigator.radius()),
        format!("inclination {:.2}°", navigator.inclination()),
        format!("field of view {:.4}°", navigator.fov_degrees()),
        format!("shows {}", viewer.shown().name()),
    ];
    if let Some(order) = viewer.order() {
        lines.push(format!("order {order} alone"));
    }
    let scene = viewer.scene();
    if scene.shows_colour() && (scene.exposure() != 0.0 || viewer.stops() != 0.0) {
        lines.push(format!("exposure {:+.2} stops", scene.exposure()));
    }
    if viewer.playback().has_frames() {
        lines.push(format!("frame {}", viewer.playback().frame()));
    }
    lines.extend(measured.pointed.map(str::to_owned));
    lines
}

/// Breaks a text into lines of at most so many characters, between words where it can.
fn wrapped(text: &str, columns: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            let length = line.chars().count() + 1 + word.chars().count();
            if !line.is_empty() && length > columns {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line += word;
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_between_words() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(
            wrapped("incomprehensible word", 4),
            ["incomprehensible", "word"]
        );
        assert_eq!(wrapped("a\nb c", 80), ["a", "b c"]);
        assert!(wrapped("", 80).is_empty());
    }
}
