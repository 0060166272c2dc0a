//! The fourth panel: the time and the error of a lit frame.
//!
//! The scene's disk shines, by its own light or as a black body of 7000 K. Edges are hard, so that every pixel shows
//! what its centre sees. The integrators, the exact method and the tables follow every pixel's ray. Tables and the
//! exact method also draw the frame from the map of the camera's radius, as the program does. All have the same
//! shading: from redshift and flux to the bytes of the picture.
//!
//! Measured are the relative error of the redshift and the error of the luminance that follows from radius and redshift
//! at a pixel's centre (the hottest ring at rest has 1), over the pixels that see the disk in the right order
//! (`exact_sights.rs`). The pixels that do not are counted as failures. The time of a frame from the map includes the
//! curves and the map where the radius is new. The times of the other methods are those of an evenly spread sample of
//! pixels, scaled to the frame.

mod exact_sights;
mod lit_methods;

use super::frame_times::{FrameEffort, one_thread};
use super::interleaved::Contender;
use super::measurement::{ChartEffort, ChartError, ComparedMethod, Measurement, Panel, Time};
use super::methods::Tables;
use super::pixel_choice::sample;
use crate::light::{DisplayTransform, Palette, Radiance, RadianceTable};
use crate::render::RenderError;
use crate::scene::{Light, Scene, View};
use exact_sights::{ExactSights, LightErrors, amplitude};
pub use lit_methods::LitFrame;
use lit_methods::{LitMethod, LitSetting, settings};

/// The light of a scene that has none of its own.
const LIGHT: Light = Light::BlackBody {
    temperature: 7000.0,
};

/// The camera's radius changes by this share from one frame to the next where each frame's radius is to be new.
const NEW_RADIUS: f64 = 1e-6;

/// The measurements of a lit frame.
#[derive(Debug)]
pub struct LightPanel {
    /// The scene's name.
    pub name: String,
    /// The picture's width and height.
    pub size: (u32, u32),
    /// The disk's light.
    pub light: Light,
    /// The number of pixels compared with exact rays; for slow methods fewer are.
    pub compared: u64,
    /// Every method at every setting.
    pub points: Vec<LightPoint>,
}

/// One method at one setting.
#[derive(Debug)]
pub struct LightPoint {
    /// The method.
    pub method: ComparedMethod,
    /// How it draws the frame.
    pub frame: LitFrame,
    /// The time of a frame, in milliseconds.
    pub milliseconds: f64,
    /// The relative errors of the redshift, with the number of wrong pixels (`failures`) and of pixels compared
    /// (`count`).
    pub redshift: Measurement,
    /// The errors of the luminance.
    pub luminance: Measurement,
}

impl LightPoint {
    /// Returns the share of the compared pixels that miss the disk, see it by mistake, or see another order.
    pub fn wrong_share(&self) -> f64 {
        self.redshift.failures as f64 / self.redshift.count.max(1) as f64
    }
}

impl LightPanel {
    /// Measures the lit frame of `scene`. `baseline_step` is the step of RK4 in `ratio_to_rk4`. `progress` receives the
    /// share that is done, from 0 to 1.
    ///
    /// # Errors
    /// [`ChartError`] if a frame cannot be rendered, or a thread cannot be started.
    pub fn measure(
        scene: &Scene,
        name: String,
        tables: &Tables,
        baseline_step: f64,
        effort: ChartEffort,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Self, ChartError> {
        let bounds = FrameEffort::of(effort);
        let light = scene.light().unwrap_or(LIGHT);
        let scene = scene
            .clone()
            .with_antialias(false)
            .with_light(Some(light))?;
        let view = View::new(&scene);
        let settings = settings(&scene, &view, tables, baseline_step, effort);
        let times = one_thread()?.install(|| time(&scene, light, &settings, &bounds, progress))?;
        let truth = ExactSights::new(&scene, &view, light, bounds.compared_pixels)
            .map_err(RenderError::from)?;
        progress(0.6);
        let mut points = Vec::with_capacity(settings.len());
        for (i, (setting, time)) in settings.iter().zip(times).enumerate() {
            points.push(point(setting, time, &scene, &truth, bounds.budget(time))?);
            progress(0.6 + 0.4 * (i + 1) as f64 / settings.len() as f64);
        }
        Ok(Self {
            name,
            size: (view.width(), view.height()),
            light,
            compared: truth.pixels(),
            points,
        })
    }
}

/// Times every setting: nanoseconds per pixel, and the ratio to the first setting.
fn time(
    scene: &Scene,
    light: Light,
    settings: &[LitSetting<'_>],
    bounds: &FrameEffort,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<Time>, ChartError> {
    let sample = sample(&View::new(scene), bounds.sampled_pixels);
    let pixels = f64::from(scene.image().width) * f64::from(scene.image().height);
    let palette = Palette::new(
        &RadianceTable::new(&Radiance::new(light)),
        &DisplayTransform::new(scene.exposure(), scene.tone()),
    );
    let elsewhere = at_another_radius(scene)?;
    let mut frame = vec![0_u8; 3 * pixels as usize];
    // The first frame tells of errors, and what follows cannot have others.
    for setting in settings {
        if let LitMethod::Map(renderer) = &setting.draws {
            renderer().draw(scene, &mut frame)?;
        }
    }
    let contenders = settings
        .iter()
        .map(|setting| Contender {
            name: &setting.setting,
            run: match &setting.draws {
                LitMethod::Map(renderer) => {
                    let mut renderer = renderer();
                    let mut frame = vec![0_u8; 3 * pixels as usize];
                    let scenes = match setting.frame {
                        LitFrame::NewRadius => [scene, &elsewhere],
                        _ => [scene, scene],
                    };
                    let mut turn = scenes.into_iter().cycle();
                    Box::new(move || {
                        let drawn = turn.next().map(|scene| renderer.draw(scene, &mut frame));
                        drawn.map_or(f64::NAN, |_| f64::from(frame[0]))
                    }) as Box<dyn FnMut() -> f64>
                }
                LitMethod::Pixels(sight) => Box::new(|| {
                    let byte = |&place: &(u32, u32)| {
                        let y =
                            sight(place).map_or(0.0, |sight| amplitude(sight.u, sight.redshift));
                        f64::from(palette.rgb8(y as f32)[0])
                    };
                    sample.iter().map(byte).sum()
                }),
            },
        })
        .collect();
    let items = |setting: &LitSetting<'_>| match setting.draws {
        LitMethod::Map(_) => pixels,
        LitMethod::Pixels(_) => sample.len() as f64,
    };
    let items: Vec<f64> = settings.iter().map(items).collect();
    Ok(bounds.times(contenders, &items, progress))
}

/// The same scene from a camera a little farther away.
fn at_another_radius(scene: &Scene) -> Result<Scene, ChartError> {
    let mut camera = *scene.camera();
    camera.position *= 1.0 + NEW_RADIUS;
    Ok(scene.clone().with_camera(camera)?)
}

/// Measures the errors of one setting. `budget` is the number of pixels whose rays may be followed.
fn point(
    setting: &LitSetting<'_>,
    time: Time,
    scene: &Scene,
    truth: &ExactSights<'_>,
    budget: u64,
) -> Result<LightPoint, ChartError> {
    let errors = match &setting.draws {
        LitMethod::Map(renderer) => truth.of_layers(&renderer().layers(scene)?),
        LitMethod::Pixels(_) if setting.method == ComparedMethod::Exact => {
            truth.of_pixels(&|place| truth.sight_in_two_parts(place), budget)
        }
        LitMethod::Pixels(sight) => truth.of_pixels(sight, budget),
    };
    let LightErrors {
        redshift,
        luminance,
        wrong,
        compared,
    } = errors;
    let row = |quantity: &str, error| Measurement {
        panel: Panel::Light,
        method: setting.method,
        setting: format!("{} of={quantity}", setting.setting)
            .trim()
            .to_owned(),
        time: Some(time),
        error,
        failures: wrong,
        count: compared,
    };
    let pixels = f64::from(scene.image().width) * f64::from(scene.image().height);
    Ok(LightPoint {
        method: setting.method,
        frame: setting.frame,
        milliseconds: time.nanoseconds * pixels * 1e-6,
        redshift: row("redshift", redshift),
        luminance: row("luminance", luminance),
    })
}
