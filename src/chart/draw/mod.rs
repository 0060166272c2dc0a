//! The chart as one SVG figure, drawn by plotters.

mod critical;
mod light;
mod plot;
mod rays;
mod scene;
mod style;

use plotters::prelude::*;

use super::data::ChartData;
use super::machine::machine;
use super::verdict::verdict;
pub use plot::DrawError;
use style::{GREY, bold, font, px};

/// The size of the page as shown, and where on it the panels after the first begin, below the title.
const SIZE: (i32, i32) = (1000, 2210);
const CRITICAL: i32 = 635;
const SCENE: i32 = CRITICAL + 580;
const LIGHT: i32 = SCENE + 440;

/// Draws the figure and returns it as the text of an SVG file.
///
/// # Errors
/// [`DrawError`] with the drawing library's error.
pub fn svg(chart: &ChartData) -> Result<String, DrawError> {
    let size = (px(SIZE.0) as u32, px(SIZE.1) as u32);
    let mut svg = String::new();
    {
        let page = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        page.fill(&WHITE)?;
        let title = "Light around a black hole: speed against accuracy";
        let mut below = page.margin(px(8), 0, 0, 0).titled(title, bold(21.0))?;
        for line in verdict(chart) {
            below = below.titled(&line, font(14.0, BLACK))?;
        }
        let made = format!("darkness {} on {}", env!("CARGO_PKG_VERSION"), machine());
        let below = below.titled(&made, font(12.0, GREY))?;
        let (above_light, light) = below.split_vertically(px(LIGHT));
        let (above_scene, scene) = above_light.split_vertically(px(SCENE));
        let (rays, critical) = above_scene.split_vertically(px(CRITICAL));
        rays::draw(&rays, &chart.rays)?;
        critical::draw(&critical, &chart.critical)?;
        scene::draw(&scene, &chart.scene)?;
        light::draw(&light, &chart.light)?;
        page.present()?;
    }
    // The first tag gives the size at which the figure is shown, beside that of its coordinates.
    let drawn = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    let shown = format!("width=\"{}\" height=\"{}\"", SIZE.0, SIZE.1);
    Ok(svg.replacen(&drawn, &shown, 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::critical::CriticalPanel;
    use crate::chart::light::LightPanel;
    use crate::chart::rays::RayPanel;
    use crate::chart::scene::ScenePanel;
    use crate::scene::Light;

    #[test]
    fn a_figure_without_measurements_is_drawn() {
        let (points, rounding) = (Vec::new(), Vec::new());
        let chart = ChartData {
            rays: RayPanel {
                points: Vec::new(),
                baseline_step: 0.1,
                count: 0,
            },
            critical: CriticalPanel { points, rounding },
            scene: ScenePanel {
                name: "<&>".to_owned(),
                size: (1, 1),
                tolerance: 1e-3,
                places: 0,
                compared: 0,
                points: Vec::new(),
            },
            light: LightPanel {
                name: "<&>".to_owned(),
                size: (1, 1),
                light: Light::Bolometric,
                compared: 0,
                points: Vec::new(),
            },
        };
        let svg = svg(&chart).unwrap();
        assert!(svg.contains("&lt;&amp;&gt; at 1 × 1"));
    }
}
