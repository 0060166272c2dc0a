//! The chart as one SVG figure.

mod axis;
mod canvas;
mod critical;
mod labels;
mod rays;
mod scene;
mod style;

use plotters::drawing::DrawingAreaErrorKind;

use super::{Chart, machine};
use canvas::BELOW;
use style::{BLACK, GREY, bold, words};

/// The page, in pixels.
const WIDTH: u32 = 1000;
const HEIGHT: u32 = 1960;

/// Where the plots begin.
const LEFT: f64 = 72.0;

/// Between two panels.
const APART: f64 = 38.0;

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure cannot be drawn: {0}")]
pub struct DrawError(String);

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for DrawError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

/// The figure, as the text of an SVG file.
///
/// # Errors
/// [`DrawError`]: what the drawing library says.
pub fn svg(chart: &Chart) -> Result<String, DrawError> {
    canvas::page((WIDTH, HEIGHT), |canvas| {
        let middle = 0.5 * f64::from(WIDTH);
        let title = "Light around a black hole: speed against accuracy";
        canvas.text(title, (middle, 14.0), bold(21.0, BLACK), BELOW)?;
        let made = format!("darkness {} on {}", env!("CARGO_PKG_VERSION"), machine());
        canvas.text(&made, (middle, 42.0), words(12.0, GREY), BELOW)?;
        let below = rays::draw(canvas, &chart.rays, (LEFT, 72.0))?;
        let below = critical::draw(canvas, &chart.critical, (LEFT, below + APART))?;
        scene::draw(canvas, &chart.frame, (LEFT, below + APART))
    })
}
