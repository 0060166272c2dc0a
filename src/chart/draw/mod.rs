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
const HEIGHT: u32 = 1900;

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
        rays::draw(canvas, &chart.rays, (72.0, 72.0))?;
        critical::draw(canvas, &chart.critical, (72.0, 690.0))?;
        scene::draw(canvas, &chart.frame, (72.0, 1290.0))
    })
}
