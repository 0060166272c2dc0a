//! What a figure is drawn with: lines, markers and words, in pixels of a page that is seen 1 : 1.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::DrawError;
use super::style::Marker;

/// Units of the drawing a pixel: the back end counts in whole units, and an eighth of a pixel is not seen.
const UNITS: f64 = 8.0;

/// A colour.
pub(super) use plotters::style::RGBColor as Colour;

/// Where words stand against their point.
pub(super) type Anchor = (HPos, VPos);

/// To the right of the point, as high.
pub(super) const RIGHT_OF: Anchor = (HPos::Left, VPos::Center);
/// To its left.
pub(super) const LEFT_OF: Anchor = (HPos::Right, VPos::Center);
/// About it.
pub(super) const CENTRED: Anchor = (HPos::Center, VPos::Center);
/// To its right, below it.
pub(super) const RIGHT_BELOW: Anchor = (HPos::Left, VPos::Top);
/// Centred above it.
pub(super) const ABOVE: Anchor = (HPos::Center, VPos::Bottom);
/// Below it.
pub(super) const BELOW: Anchor = (HPos::Center, VPos::Top);

/// The page.
pub(super) const PAPER: Colour = WHITE;

/// How a line looks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub(super) colour: Colour,
    /// In pixels.
    pub(super) width: f64,
    /// Lengths of a dash and a gap in pixels, for a line that is not whole.
    pub(super) dash: Option<(f64, f64)>,
}

/// How words look.
#[derive(Debug, Clone, Copy)]
pub(super) struct Font {
    /// In pixels.
    pub(super) size: f64,
    pub(super) colour: Colour,
    pub(super) bold: bool,
}

/// A page being drawn on.
pub(super) struct Canvas<'a>(DrawingArea<SVGBackend<'a>, plotters::coord::Shift>);

type Drawn = Result<(), DrawError>;

fn units(pixels: f64) -> i32 {
    (pixels * UNITS).round() as i32
}

fn point((x, y): (f64, f64)) -> (i32, i32) {
    (units(x), units(y))
}

/// A page of that size, drawn on by `draw`, as SVG.
///
/// # Errors
/// [`DrawError`]
pub(super) fn page(
    (width, height): (u32, u32),
    draw: impl FnOnce(&Canvas<'_>) -> Drawn,
) -> Result<String, DrawError> {
    let size = (width * UNITS as u32, height * UNITS as u32);
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        area.fill(&WHITE)?;
        let canvas = Canvas(area);
        draw(&canvas)?;
        canvas.0.present()?;
    }
    // The first tag says how many units there are, and that they are pixels; seen they are to be smaller.
    let told = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    let seen = format!("width=\"{width}\" height=\"{height}\"");
    Ok(svg.replacen(&told, &seen, 1))
}

/// The dashes of a line, each of them a line.
fn dashed(points: &[(f64, f64)], dash: f64, gap: f64) -> Vec<Vec<(f64, f64)>> {
    let mut dashes: Vec<Vec<(f64, f64)>> = Vec::new();
    // How far into dash and gap the line has come.
    let mut phase = 0.0;
    for pair in points.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let length = libm::hypot(x1 - x0, y1 - y0);
        let mut gone = 0.0;
        while gone < length {
            let (inked, end) = if phase < dash {
                (true, dash)
            } else {
                (false, dash + gap)
            };
            let to = (gone + (end - phase).max(0.1)).min(length);
            let at = |way: f64| (x0 + (x1 - x0) * way / length, y0 + (y1 - y0) * way / length);
            if inked {
                match dashes.last_mut() {
                    // A dash goes round a corner.
                    Some(last) if gone == 0.0 && phase > 0.0 => last.push(at(to)),
                    _ => dashes.push(vec![at(gone), at(to)]),
                }
            }
            phase += to - gone;
            if phase >= dash + gap {
                phase = 0.0;
            }
            gone = to;
        }
    }
    dashes
}

impl Canvas<'_> {
    pub(super) fn line(&self, points: &[(f64, f64)], pen: Pen) -> Drawn {
        let style = pen.colour.stroke_width(units(pen.width).unsigned_abs());
        let dashes = match pen.dash {
            Some((dash, gap)) => dashed(points, dash, gap),
            None => vec![points.to_vec()],
        };
        for dash in dashes {
            let path: Vec<_> = dash.into_iter().map(point).collect();
            self.0.draw(&PathElement::new(path, style))?;
        }
        Ok(())
    }

    pub(super) fn marker(
        &self,
        marker: Marker,
        at: (f64, f64),
        size: f64,
        colour: Colour,
    ) -> Drawn {
        let (x, y) = at;
        let polygon = |corners: &[(f64, f64)]| {
            let corners: Vec<_> = corners
                .iter()
                .map(|(dx, dy)| point((x + dx * size, y + dy * size)))
                .collect();
            self.0.draw(&Polygon::new(corners, colour.filled()))
        };
        let stroke = |corners: &[(f64, f64)]| {
            let corners: Vec<_> = corners
                .iter()
                .map(|(dx, dy)| (x + dx * size, y + dy * size))
                .collect();
            let pen = Pen {
                colour,
                width: 0.4 * size,
                dash: None,
            };
            self.line(&corners, pen)
        };
        let radius = units(size).unsigned_abs();
        match marker {
            Marker::Disc => self
                .0
                .draw(&Circle::new(point(at), radius, colour.filled()))?,
            Marker::Square => polygon(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)])?,
            Marker::Diamond => polygon(&[(0.0, -1.3), (1.1, 0.0), (0.0, 1.3), (-1.1, 0.0)])?,
            Marker::Up => polygon(&[(0.0, -1.25), (1.2, 0.85), (-1.2, 0.85)])?,
            Marker::Down => polygon(&[(0.0, 1.25), (1.2, -0.85), (-1.2, -0.85)])?,
            Marker::Cross => {
                stroke(&[(-0.9, -0.9), (0.9, 0.9)])?;
                stroke(&[(-0.9, 0.9), (0.9, -0.9)])?;
            }
            Marker::Star => {
                let corners: Vec<_> = (0..10)
                    .map(|k| {
                        let turn = f64::from(k) * core::f64::consts::PI / 5.0;
                        let reach = if k % 2 == 0 { 1.6 } else { 0.65 };
                        (reach * libm::sin(turn), -reach * libm::cos(turn))
                    })
                    .collect();
                polygon(&corners)?;
            }
        }
        Ok(())
    }

    pub(super) fn text(&self, words: &str, at: (f64, f64), font: Font, anchor: Anchor) -> Drawn {
        self.turned_text(words, at, font, anchor, FontTransform::None)
    }

    /// Words that read upwards.
    pub(super) fn upward_text(&self, words: &str, at: (f64, f64), font: Font) -> Drawn {
        self.turned_text(words, at, font, CENTRED, FontTransform::Rotate270)
    }

    fn turned_text(
        &self,
        words: &str,
        at: (f64, f64),
        font: Font,
        (horizontal, vertical): Anchor,
        turn: FontTransform,
    ) -> Drawn {
        /// The back end divides sizes by it.
        const SHRUNK: f64 = 1.24;
        let weight = if font.bold {
            FontStyle::Bold
        } else {
            FontStyle::Normal
        };
        let style = ("sans-serif", font.size * UNITS * SHRUNK)
            .into_font()
            .style(weight)
            .transform(turn)
            .color(&font.colour)
            .pos(Pos::new(horizontal, vertical));
        self.0.draw_text(words, &style, point(at))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_are_as_long_as_asked_round_corners_too() {
        let line = [(0.0, 0.0), (33.0, 0.0), (33.0, 67.0)];
        let dashes = dashed(&line, 7.0, 3.0);
        assert_eq!(dashes.len(), 10);
        for dash in &dashes {
            let length: f64 = dash
                .windows(2)
                .map(|pair| libm::hypot(pair[1].0 - pair[0].0, pair[1].1 - pair[0].1))
                .sum();
            assert!((length - 7.0).abs() < 1e-9, "{dash:?}");
        }
        assert!(dashed(&line[..1], 7.0, 3.0).is_empty());
    }
}
