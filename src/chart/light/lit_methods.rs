//! The methods that draw a lit frame, at every setting that is measured.

use super::super::measurement::{ChartEffort, ComparedMethod};
use super::super::methods::{Stepper, Tables};
use super::exact_sights::compared_layers;
use crate::light::Sight;
use crate::orbit::exact::Exact;
use crate::orbit::path::SweptAngles;
use crate::render::{Plane, RenderError, Renderer, pixelwise};
use crate::scene::{Scene, View};

/// How a lit frame is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LitFrame {
    /// By following each pixel's ray.
    PixelByPixel,
    /// From the map of a camera radius that is new: its curves and its map are built first.
    NewRadius,
    /// From the map of a camera radius that the frame before had.
    SameRadius,
}

/// Tells what a pixel sees.
pub(super) type PixelSight<'a> = dyn Fn((u32, u32)) -> Option<Sight> + Sync + 'a;

/// Makes a renderer.
pub(super) type NewRenderer<'a> = dyn Fn() -> Box<dyn LitRenderer + 'a> + Sync + 'a;

/// What draws the frame.
pub(super) enum LitMethod<'a> {
    Pixels(Box<PixelSight<'a>>),
    Map(Box<NewRenderer<'a>>),
}

/// A renderer of any angles.
pub(super) trait LitRenderer {
    /// Draws a picture in colour, three bytes a pixel.
    fn draw(&mut self, scene: &Scene, pixels: &mut [u8]) -> Result<(), RenderError>;

    /// Returns the [`compared_layers`].
    fn layers(&mut self, scene: &Scene) -> Result<Vec<Plane>, RenderError>;
}

impl<A: SweptAngles> LitRenderer for Renderer<A> {
    fn draw(&mut self, scene: &Scene, pixels: &mut [u8]) -> Result<(), RenderError> {
        self.render_rgb_into(scene, pixels, 3 * scene.image().width as usize)?;
        Ok(())
    }

    fn layers(&mut self, scene: &Scene) -> Result<Vec<Plane>, RenderError> {
        self.render_layers(scene, compared_layers())
    }
}

/// A method at one setting.
pub(super) struct LitSetting<'a> {
    pub(super) method: ComparedMethod,
    pub(super) frame: LitFrame,
    pub(super) draws: LitMethod<'a>,
    pub(super) setting: String,
}

/// Lists every method at every setting, the baseline first.
pub(super) fn settings<'a>(
    scene: &'a Scene,
    view: &'a View,
    tables: &'a Tables,
    baseline_step: f64,
    effort: ChartEffort,
) -> Vec<LitSetting<'a>> {
    let (rk4, adaptive): (&[f64], &[f64]) = match effort {
        ChartEffort::Quick => (&[0.2, 0.02], &[1e-3, 1e-9]),
        ChartEffort::Full => (
            &[0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3],
            &[1e-3, 1e-6, 1e-9, 1e-12],
        ),
    };
    let mut steppers = vec![Stepper::rk4(baseline_step)];
    steppers.extend(rk4.iter().map(|&h| Stepper::rk4(h)));
    steppers.extend(
        adaptive
            .iter()
            .map(|&tolerance| Stepper::adaptive(tolerance)),
    );
    let mut all: Vec<_> = steppers
        .into_iter()
        .map(|stepper| LitSetting {
            method: stepper.method(),
            frame: LitFrame::PixelByPixel,
            setting: stepper.setting(),
            draws: LitMethod::Pixels(Box::new(move |place| stepper.sight(scene, view, place))),
        })
        .collect();
    for (method, table) in tables.tables() {
        let bytes = format!("table-bytes={}", table.bytes().len());
        all.extend(of_angles(scene, view, *method, &bytes, table.lookup()));
    }
    all.extend(of_angles(scene, view, ComparedMethod::Exact, "", Exact));
    all
}

/// The three ways to draw a frame from a method's angles.
fn of_angles<'a>(
    scene: &'a Scene,
    view: &'a View,
    method: ComparedMethod,
    words: &str,
    angles: impl SweptAngles + Copy + 'a,
) -> [LitSetting<'a>; 3] {
    [
        (LitFrame::PixelByPixel, "drawn=pixel-by-pixel"),
        (LitFrame::NewRadius, "drawn=map-of-new-radius"),
        (LitFrame::SameRadius, "drawn=map-of-same-radius"),
    ]
    .map(|(frame, drawn)| LitSetting {
        method,
        frame,
        setting: format!("{drawn} {words}").trim_end().to_owned(),
        draws: match frame {
            LitFrame::PixelByPixel => LitMethod::Pixels(Box::new(move |place| {
                let sight = pixelwise::sight(scene, view, &angles, place);
                sight.unwrap_or_default()
            })),
            LitFrame::NewRadius | LitFrame::SameRadius => {
                LitMethod::Map(Box::new(move || Box::new(Renderer::with_angles(angles))))
            }
        },
    })
}
