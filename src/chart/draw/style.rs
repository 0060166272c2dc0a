//! How each method looks in every panel: a colour that colour-blind readers can tell apart, and a marker and dashes for
//! print without colour.
//!
//! Colours: M. Okabe & K. Ito, *Color Universal Design* (2008).

use plotters::prelude::*;

use crate::chart::measurement::ComparedMethod;

pub(super) const GREY: RGBColor = RGBColor(110, 110, 110);
pub(super) const LIGHT: RGBColor = RGBColor(224, 224, 224);
const ORANGE: RGBColor = RGBColor(230, 159, 0);
const SKY: RGBColor = RGBColor(86, 180, 233);
const BLUE: RGBColor = RGBColor(0, 114, 178);
const VERMILION: RGBColor = RGBColor(213, 94, 0);
const PURPLE: RGBColor = RGBColor(204, 121, 167);

/// The figure is drawn at this multiple of its size on the page, because the library rounds positions to whole pixels.
const SCALE: i32 = 2;

/// Converts a length on the page to pixels of the drawing.
pub(super) const fn px(length: i32) -> i32 {
    length * SCALE
}

/// Returns a sans-serif font, `size` pixels high on the page.
pub(super) fn font(size: f64, colour: RGBColor) -> TextStyle<'static> {
    // The library's SVG backend divides sizes by this number.
    const BACKEND_SCALE: f64 = 1.24;
    let pixels = size * f64::from(SCALE) * BACKEND_SCALE;
    ("sans-serif", pixels).into_font().color(&colour)
}

/// Returns a bold font, `size` pixels high on the page.
pub(super) fn bold(size: f64) -> TextStyle<'static> {
    let style = font(size, BLACK);
    TextStyle {
        font: style.font.style(FontStyle::Bold),
        ..style
    }
}

/// A marker: its number of points, its radius in pixels of the drawing, the share of the radius at which the outline's
/// inner corners lie, and its turn in degrees.
type Marker = (u32, f64, f64, f64);

/// The look of one series.
#[derive(Debug, Clone, Copy)]
pub(super) struct SeriesStyle {
    pub(super) colour: RGBColor,
    /// The line's width, in pixels of the drawing.
    pub(super) width: u32,
    /// The lengths of a dash and of a gap, in pixels of the drawing.
    pub(super) dash: (u32, u32),
    marker: Marker,
    is_hollow: bool,
}

/// A dash longer than any line.
const SOLID: (u32, u32) = (100_000, 1);

impl SeriesStyle {
    /// Returns the style and the label of a method.
    pub(super) fn of(method: ComparedMethod) -> (Self, &'static str) {
        let triangle = |turn| (3, 10.0, 0.5, turn);
        let (colour, marker, dash, label) = match method {
            ComparedMethod::Euler => (ORANGE, (12, 7.0, 0.97, 0.0), SOLID, "Euler"),
            ComparedMethod::Rk4 => (VERMILION, (4, 9.0, 0.71, 45.0), SOLID, "RK4"),
            ComparedMethod::Adaptive => (PURPLE, (4, 10.0, 0.65, 0.0), SOLID, "adaptive (DOP853)"),
            ComparedMethod::TableScaled => (SKY, triangle(180.0), (16, 6), "tables of other sizes"),
            ComparedMethod::TableDraft => (BLUE, triangle(-90.0), (14, 5), "table draft"),
            ComparedMethod::TableStandard => (BLUE, triangle(0.0), SOLID, "table standard"),
            ComparedMethod::TableFine => (BLUE, triangle(90.0), (4, 4), "table fine"),
            ComparedMethod::Exact => (BLACK, (5, 11.0, 0.4, 0.0), SOLID, "exact"),
        };
        let mut style = Self::line(colour, 3);
        (style.dash, style.marker) = (dash, marker);
        (style, label)
    }

    /// Returns the style of a solid line without markers.
    pub(super) fn line(colour: RGBColor, width: u32) -> Self {
        Self {
            colour,
            width,
            dash: SOLID,
            marker: (0, 0.0, 0.0, 0.0),
            is_hollow: false,
        }
    }

    /// Returns the same style with hollow markers.
    pub(super) fn hollow(self) -> Self {
        let is_hollow = true;
        Self { is_hollow, ..self }
    }

    /// Returns the colours of the marker's inside and of its outline.
    pub(super) fn fill(self) -> (ShapeStyle, ShapeStyle) {
        let inside = if self.is_hollow {
            TRANSPARENT
        } else {
            self.colour.to_rgba()
        };
        (inside.filled(), self.colour.stroke_width(3))
    }

    /// Returns the same style with a cross for a marker.
    pub(super) fn failed(self) -> Self {
        let marker = (4, 9.0, 0.25, 45.0);
        Self { marker, ..self }
    }

    /// Returns the marker's outline around `centre`, in pixels of the drawing.
    pub(super) fn outline(self, centre: (i32, i32)) -> Vec<(i32, i32)> {
        let (corners, outer, inner, turn) = self.marker;
        let corner = |k: u32| {
            let turned = core::f64::consts::PI * f64::from(k) / f64::from(corners);
            let angle = turn.to_radians() + turned;
            let radius = [outer, outer * inner][k as usize % 2];
            let (x, y) = (radius * libm::sin(angle), -radius * libm::cos(angle));
            (centre.0 + x.round() as i32, centre.1 + y.round() as i32)
        };
        (0..2 * corners).map(corner).collect()
    }

    /// Returns the outline with its first point again at its end.
    pub(super) fn closed_outline(self, centre: (i32, i32)) -> Vec<(i32, i32)> {
        let mut outline = self.outline(centre);
        outline.extend(outline.first().copied());
        outline
    }
}
