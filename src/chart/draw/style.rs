//! How each method looks, on every panel: colours that colour-blind readers tell apart, and a marker and a dash of its
//! own for print without colours.
//!
//! Colours: M. Okabe & K. Ito, *Color Universal Design* (2008).

use super::canvas::{Colour, Font, Pen};
use crate::chart::methods::Method;

pub(super) const BLACK: Colour = Colour(0, 0, 0);
pub(super) const GREY: Colour = Colour(110, 110, 110);
pub(super) const LIGHT: Colour = Colour(224, 224, 224);
const ORANGE: Colour = Colour(230, 159, 0);
const SKY: Colour = Colour(86, 180, 233);
const BLUE: Colour = Colour(0, 114, 178);
const VERMILION: Colour = Colour(213, 94, 0);
const PURPLE: Colour = Colour(204, 121, 167);

/// A point's shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Marker {
    Disc,
    Square,
    Diamond,
    Up,
    Down,
    Cross,
    Star,
}

/// How a series looks, and what it is called.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub(super) colour: Colour,
    pub(super) marker: Marker,
    pub(super) dash: Option<(f64, f64)>,
    pub(super) label: &'static str,
    /// The same, where there is little room.
    pub(super) short: &'static str,
}

impl Look {
    pub(super) fn of(method: Method) -> Self {
        let (colour, marker, dash, label) = match method {
            Method::Euler => (ORANGE, Marker::Disc, None, "Euler"),
            Method::Rk4 => (VERMILION, Marker::Square, None, "RK4"),
            Method::Adaptive => (PURPLE, Marker::Diamond, None, "adaptive (DOP853)"),
            Method::Exact => (BLACK, Marker::Star, None, "exact"),
            Method::TableDraft => (BLUE, Marker::Up, Some((7.0, 2.5)), "table draft"),
            Method::TableStandard => (BLUE, Marker::Up, None, "table standard"),
            Method::TableFine => (BLUE, Marker::Up, Some((2.0, 2.0)), "table fine"),
            Method::TableScaled => (SKY, Marker::Down, Some((8.0, 3.0)), "tables of other sizes"),
        };
        let short = match method {
            Method::Adaptive => "adaptive",
            Method::TableDraft => "draft",
            Method::TableStandard => "standard",
            Method::TableFine => "fine",
            Method::TableScaled => "other sizes",
            _ => label,
        };
        Self {
            colour,
            marker,
            dash,
            label,
            short,
        }
    }

    /// The pen of its line.
    pub(super) fn pen(self, width: f64) -> Pen {
        Pen {
            colour: self.colour,
            width,
            dash: self.dash,
        }
    }
}

/// A whole line.
pub(super) fn plain(colour: Colour, width: f64) -> Pen {
    Pen {
        colour,
        width,
        dash: None,
    }
}

/// Words of that size.
pub(super) fn words(size: f64, colour: Colour) -> Font {
    Font {
        size,
        colour,
        bold: false,
    }
}

/// Words that stand out.
pub(super) fn bold(size: f64, colour: Colour) -> Font {
    Font {
        bold: true,
        ..words(size, colour)
    }
}
