//! The third panel: the time and the error of a scene's frame.
//!
//! Tables and the exact method build isoradial curves, at several tolerances, and a frame is rendered from the
//! curves. The integrators step along every pixel's ray. Measured for both are the displacement of each edge of the
//! disk, by order (`edges.rs`), and the number of wrong pixels (`frames.rs`). Times are those of a whole frame on one
//! thread: curves and frame together, or for the integrators the time of an evenly spread sample of pixels, scaled to
//! the frame.

mod edges;
mod frame_methods;
mod frames;

use super::frame_times::{FrameEffort, one_thread};
use super::interleaved::Contender;
use super::measurement::{
    ChartEffort, ChartError, ComparedMethod, Measurement, Panel, Quantiles, Time,
};
use super::methods::Tables;
use super::number_format::{grouped, two_digits};
use super::pixel_choice::sample;
use crate::render::mask;
use crate::scene::{Scene, View};
use edges::{Displacements, ExactEdges, ORDERS};
use frame_methods::{FrameMethod, FrameSetting, settings, sources};
use frames::ExactPixels;

/// The number of angles φ₁ at which each edge is measured.
const PLACES: u32 = 129;

/// The measurements of a scene's frame.
#[derive(Debug)]
pub struct ScenePanel {
    /// The scene's name.
    pub name: String,
    /// The picture's width and height.
    pub size: (u32, u32),
    /// The scene's tolerance: the largest displacement allowed for an edge, in pixels.
    pub tolerance: f64,
    /// The number of angles at which each edge was measured.
    pub places: u32,
    /// The number of pixels compared with exact rays; for slow methods fewer are.
    pub compared: u64,
    /// Every method at every setting.
    pub points: Vec<FramePoint>,
}

/// One method at one setting.
#[derive(Debug)]
pub struct FramePoint {
    /// The method.
    pub method: ComparedMethod,
    /// The time of a frame, in milliseconds.
    pub milliseconds: f64,
    /// The number of the curves' nodes, for methods that build curves.
    pub nodes: Option<usize>,
    /// The tolerance of the curves in pixels, for methods that build curves.
    pub curve_tolerance: Option<f64>,
    /// The size in bytes of the table that the curves were built from, if any.
    pub table_bytes: Option<usize>,
    /// The displacements of each order's edges.
    pub orders: [Measurement; ORDERS],
    /// The number of wrong pixels (`failures`) and of pixels compared (`count`).
    pub pixels: Measurement,
}

impl FramePoint {
    /// Returns the share of the compared pixels that are wrong.
    pub fn wrong_share(&self) -> f64 {
        self.pixels.failures as f64 / self.pixels.count.max(1) as f64
    }

    /// Returns the largest displacement of any edge in pixels, or infinity if an edge is lost.
    pub fn displacement(&self) -> f64 {
        self.orders.iter().fold(0.0, |most: f64, order| {
            if order.failures > 0 {
                return f64::INFINITY;
            }
            most.max(order.error.map_or(0.0, |error| error.max))
        })
    }
}

impl ScenePanel {
    /// Measures the frame of `scene`. `baseline_step` is the step of RK4 in `ratio_to_rk4`. `progress` receives the
    /// share that is done, from 0 to 1.
    ///
    /// # Errors
    /// [`ChartError`] if a frame does not fit into memory, or a thread cannot be started.
    pub fn measure(
        scene: &Scene,
        name: String,
        tables: &Tables,
        baseline_step: f64,
        effort: ChartEffort,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Self, ChartError> {
        let bounds = FrameEffort::of(effort);
        let view = View::new(scene);
        let sources = sources(tables);
        let settings = settings(scene, &view, &sources, baseline_step, effort);
        let times = one_thread()?.install(|| time(scene, &view, &settings, &bounds, progress));
        let truth = ExactPixels::new(scene, &view, bounds.compared_pixels)?;
        progress(0.6);
        let edges = ExactEdges::new(scene, &view, PLACES);
        let mut points = Vec::with_capacity(settings.len());
        for (i, (setting, time)) in settings.iter().zip(times).enumerate() {
            let budget = bounds.budget(time);
            points.push(point(setting, time, scene, &view, &edges, &truth, budget)?);
            progress(0.6 + 0.4 * (i + 1) as f64 / settings.len() as f64);
        }
        Ok(Self {
            name,
            size: (view.width(), view.height()),
            tolerance: scene.tolerance(),
            places: PLACES,
            compared: truth.pixels(),
            points,
        })
    }

    /// Returns the measurement with the smallest table, and then the fewest nodes, that displaces no edge by more than
    /// the scene's tolerance.
    pub fn least(&self) -> Option<&FramePoint> {
        self.points
            .iter()
            .filter(|point| {
                matches!(
                    point.method,
                    ComparedMethod::TableDraft
                        | ComparedMethod::TableStandard
                        | ComparedMethod::TableFine
                ) && point.displacement() <= self.tolerance
            })
            .min_by_key(|point| (point.table_bytes, point.nodes))
    }

    /// Describes in one sentence the smallest table and curves that meet the scene's tolerance, as measured.
    pub fn summary(&self) -> String {
        let (name, asked) = (&self.name, self.tolerance);
        let mut orders = self.points.iter().flat_map(|point| &point.orders);
        if orders.all(|order| order.count == 0) {
            return format!("{name}: no edge of the disk is in the picture; no table is needed");
        }
        let Some(point) = self.least() else {
            return format!(
                "{name}: no table keeps every edge within {asked:?} pixels; exact angles are needed"
            );
        };
        let table = match point.method {
            ComparedMethod::TableDraft => "draft",
            ComparedMethod::TableFine => "fine",
            _ => "standard",
        };
        format!(
            "{name}: the {table} table ({} bytes) and {} curve nodes suffice: no edge is displaced by more than \
             {} pixels (allowed: {asked:?})",
            grouped(point.table_bytes.unwrap_or_default()),
            grouped(point.nodes.unwrap_or_default()),
            two_digits(point.displacement()),
        )
    }
}

/// Times every setting: nanoseconds per pixel, and the ratio to the first setting.
fn time(
    scene: &Scene,
    view: &View,
    settings: &[FrameSetting<'_>],
    bounds: &FrameEffort,
    progress: &(dyn Fn(f64) + Sync),
) -> Vec<Time> {
    let sample = sample(view, bounds.sampled_pixels);
    let pixels = f64::from(view.width()) * f64::from(view.height());
    let contenders = settings
        .iter()
        .map(|setting| Contender {
            name: &setting.setting,
            run: match &setting.renders {
                FrameMethod::Curves { angles, spec } => Box::new(move || {
                    let curves = angles.build(spec);
                    let frame = mask::render(view, &curves).unwrap_or_default();
                    frame.first().copied().map_or(f64::NAN, f64::from)
                })
                    as Box<dyn FnMut() -> f64>,
                FrameMethod::Steps(stepper) => {
                    let sample = &sample;
                    Box::new(move || frames::white(scene, view, stepper, sample))
                }
            },
        })
        .collect();
    // Stepping methods, the baseline among them, run on the sample; curves render all pixels.
    let items = |setting: &FrameSetting<'_>| match setting.renders {
        FrameMethod::Curves { .. } => pixels,
        FrameMethod::Steps(_) => sample.len() as f64,
    };
    let items: Vec<f64> = settings.iter().map(items).collect();
    bounds.times(contenders, &items, progress)
}

/// Measures the errors of one setting. `budget` is the number of pixels that may be stepped.
fn point(
    setting: &FrameSetting<'_>,
    time: Time,
    scene: &Scene,
    view: &View,
    edges: &ExactEdges,
    truth: &ExactPixels,
    budget: u64,
) -> Result<FramePoint, ChartError> {
    let mut words = setting.setting.clone();
    let (mut nodes, mut curve_tolerance) = (None, None);
    let (displacements, (wrong, compared)) = match &setting.renders {
        FrameMethod::Curves { angles, spec } => {
            let curves = angles.build(spec);
            (nodes, curve_tolerance) = (Some(curves.nodes()), Some(spec.tolerance));
            words = format!("{words} nodes={} bytes={}", curves.nodes(), curves.bytes());
            if let Some(bytes) = setting.table_bytes {
                words = format!("{words} table-bytes={bytes}");
            }
            let frame = mask::render(view, &curves)?;
            (edges.of_curves(&curves), truth.wrong_in(&frame, view))
        }
        FrameMethod::Steps(stepper) => (
            edges.of_orbits(stepper.orbits()),
            truth.wrong_of(scene, view, stepper, budget),
        ),
    };
    let row = |order: String, error, failures, count| Measurement {
        panel: Panel::Scene,
        method: setting.method,
        setting: format!("{words} {order}"),
        time: Some(time),
        error,
        failures,
        count,
    };
    let pixels = f64::from(view.width()) * f64::from(view.height());
    Ok(FramePoint {
        method: setting.method,
        milliseconds: time.nanoseconds * pixels * 1e-6,
        nodes,
        curve_tolerance,
        table_bytes: setting.table_bytes,
        pixels: row("order=all".into(), None, wrong, compared),
        orders: core::array::from_fn(|order| {
            let Displacements { pixels, lost } =
                displacements.get(order).cloned().unwrap_or_default();
            let count = pixels.len() as u64 + lost;
            row(format!("order={order}"), Quantiles::of(pixels), lost, count)
        }),
    })
}
