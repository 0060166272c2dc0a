//! The third panel: what a scene's frame costs, and how right it is.
//!
//! Tables and the exact method draw isoradial curves, to several tolerances, and fill the frame between them;
//! the integrators step every pixel's ray. Asked of both: where each edge of the disk is, order by order, in pixels
//! from where it should be (`edges.rs`), and how many pixels are wrong (`frames.rs`). Times are of whole frames on
//! one thread: curves and frame together, or the time of an even sample of pixels for those that step each.

mod edges;
mod frames;
mod ways;
mod words;

use core::time::Duration;

use super::interleaved::{Contender, rounds};
use super::methods::{Method, Tables};
use super::{ChartError, Effort, Measurement, Panel, Quantiles, Time};
use crate::render::mask;
use crate::scene::{self, View};
use edges::{Displacements, Edges, ORDERS};
use frames::Truth;
use ways::{Entry, Way, entries, sources};
use words::{grouped, two_digits};

/// What is measured of a scene's frame.
#[derive(Debug)]
pub struct Frame {
    /// What the scene is called.
    pub name: String,
    /// The picture's width and height.
    pub size: (u32, u32),
    /// What its edges may be off by, in pixels.
    pub tolerance: f64,
    /// At how many angles each edge was looked at.
    pub places: u32,
    /// How many pixels were compared with exact rays at most.
    pub compared: u64,
    /// Every method at every setting.
    pub points: Vec<Point>,
}

/// One method at one setting.
#[derive(Debug)]
pub struct Point {
    /// The method.
    pub method: Method,
    /// The time of a frame, in milliseconds.
    pub milliseconds: f64,
    /// Nodes of the curves, where there are any.
    pub nodes: Option<usize>,
    /// Bytes of the table that they were drawn from.
    pub table_bytes: Option<usize>,
    /// What was found of each order.
    pub orders: [Measurement; ORDERS],
    /// The pixels: how many are wrong (failures) of those compared (count).
    pub pixels: Measurement,
}

impl Point {
    /// Which share of the pixels compared is wrong.
    pub fn wrong_share(&self) -> f64 {
        self.pixels.failures as f64 / self.pixels.count.max(1) as f64
    }

    /// The largest displacement of any edge, in pixels; infinite where one is lost.
    pub fn displacement(&self) -> f64 {
        self.orders.iter().fold(0.0, |most: f64, order| {
            if order.failures > 0 {
                return f64::INFINITY;
            }
            most.max(order.error.map_or(0.0, |error| error.max))
        })
    }
}

/// How much may be done.
struct Bounds {
    repetitions: usize,
    /// For all repetitions.
    time: Duration,
    /// Pixels whose time is taken of those methods that step each.
    sampled_pixels: u32,
    /// Pixels to know the truth of, at most.
    compared_pixels: u64,
    /// At how many φ₁ each edge is looked at.
    places: u32,
    /// Seconds of one thread for counting the wrong pixels of one setting.
    seconds: f64,
}

impl Bounds {
    fn of(effort: Effort) -> Self {
        match effort {
            Effort::Quick => Self {
                repetitions: 5,
                time: Duration::from_secs(3),
                sampled_pixels: 1024,
                compared_pixels: 1 << 17,
                places: 129,
                seconds: 0.15,
            },
            Effort::Full => Self {
                repetitions: 21,
                time: Duration::from_secs(40),
                sampled_pixels: 8192,
                compared_pixels: 1 << 22,
                places: 129,
                seconds: 3.0,
            },
        }
    }
}

impl Frame {
    /// Measures the frame of `scene`; `progress` is told which share is done. `baseline_step` is RK4's for the ratios.
    ///
    /// # Errors
    /// [`ChartError`]
    pub fn measure(
        scene: &scene::Scene,
        name: String,
        tables: &Tables,
        baseline_step: f64,
        effort: Effort,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Self, ChartError> {
        let bounds = Bounds::of(effort);
        let view = View::new(scene);
        let sources = sources(tables);
        let entries = entries(scene, &view, &sources, baseline_step, effort);
        let one_thread = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .map_err(|error| ChartError::Threads(error.to_string()))?;
        let times = one_thread.install(|| time(scene, &view, &entries, &bounds, progress));
        let truth = Truth::new(scene, &view, bounds.compared_pixels)?;
        progress(0.6);
        let edges = Edges::new(scene, &view, bounds.places);
        let mut points = Vec::with_capacity(entries.len());
        for (i, (entry, time)) in entries.iter().zip(times).enumerate() {
            let budget = (bounds.seconds * 1e9 / time.nanoseconds.max(1e-3)) as u64;
            points.push(point(entry, time, scene, &view, &edges, &truth, budget)?);
            progress(0.6 + 0.4 * (i + 1) as f64 / entries.len() as f64);
        }
        Ok(Self {
            name,
            size: (view.width(), view.height()),
            tolerance: scene.tolerance(),
            places: bounds.places,
            compared: truth.pixels(),
            points,
        })
    }

    /// The smallest table, and the fewest nodes of curves drawn from it, with which no edge is off by more than the
    /// scene's tolerance.
    pub fn least(&self) -> Option<&Point> {
        self.points
            .iter()
            .filter(|point| {
                matches!(
                    point.method,
                    Method::TableDraft | Method::TableStandard | Method::TableFine
                ) && point.displacement() <= self.tolerance
            })
            .min_by_key(|point| (point.table_bytes, point.nodes))
    }

    /// What is enough for this scene, as measured, in one sentence.
    pub fn summary(&self) -> String {
        let (name, asked) = (&self.name, self.tolerance);
        let mut orders = self.points.iter().flat_map(|point| &point.orders);
        if orders.all(|order| order.count == 0) {
            return format!("{name}: no edge of the disk is in the picture; no table is needed");
        }
        let Some(point) = self.least() else {
            return format!(
                "{name}: with no table are all edges right to the {asked:?} pixels asked for; exact angles are needed"
            );
        };
        let table = match point.method {
            Method::TableDraft => "draft",
            Method::TableFine => "fine",
            _ => "standard",
        };
        format!(
            "{name}: the {table} table ({} bytes) and {} curve nodes are enough: no edge is off by more than {} pixels (asked: {asked:?})",
            grouped(point.table_bytes.unwrap_or_default()),
            grouped(point.nodes.unwrap_or_default()),
            two_digits(point.displacement()),
        )
    }
}

/// Times every entry: nanoseconds a pixel, and the ratio to the first.
fn time(
    scene: &scene::Scene,
    view: &View,
    entries: &[Entry<'_>],
    bounds: &Bounds,
    progress: &(dyn Fn(f64) + Sync),
) -> Vec<Time> {
    let sample = frames::sample(view, bounds.sampled_pixels);
    let pixels = f64::from(view.width()) * f64::from(view.height());
    let mut contenders: Vec<_> = entries
        .iter()
        .map(|entry| Contender {
            name: &entry.setting,
            run: match &entry.way {
                Way::Curves { angles, sight } => Box::new(move || {
                    let frame = mask::render(view, &angles.draw(sight)).unwrap_or_default();
                    frame.first().copied().map_or(f64::NAN, f64::from)
                }) as Box<dyn FnMut() -> f64>,
                Way::Steps(stepper) => {
                    let sample = &sample;
                    Box::new(move || frames::white(scene, view, stepper, sample))
                }
            },
        })
        .collect();
    let mut done = 0.0;
    let times = rounds(
        &mut contenders,
        bounds.repetitions,
        (Duration::from_millis(2), bounds.time),
        &mut || {
            done += 1.0;
            progress(0.5 * done / (bounds.repetitions + 1) as f64);
        },
    );
    // The baseline's rounds are of the sample; a frame of curves has all pixels.
    let items = |entry: &Entry<'_>| match entry.way {
        Way::Curves { .. } => pixels,
        Way::Steps(_) => sample.len() as f64,
    };
    entries
        .iter()
        .enumerate()
        .map(|(i, entry)| Time {
            nanoseconds: times.median(i) * 1e9 / items(entry),
            ratio_to_rk4: times.ratio(i, 0) * items(entry) / sample.len() as f64,
        })
        .collect()
}

/// Everything else about an entry. `budget` is how many pixels may be stepped.
fn point(
    entry: &Entry<'_>,
    time: Time,
    scene: &scene::Scene,
    view: &View,
    edges: &Edges,
    truth: &Truth,
    budget: u64,
) -> Result<Point, ChartError> {
    let mut setting = entry.setting.clone();
    let mut nodes = None;
    let (displacements, (wrong, compared)) = match &entry.way {
        Way::Curves { angles, sight } => {
            let curves = angles.draw(sight);
            nodes = Some(curves.nodes());
            let words = format!("nodes={} bytes={}", curves.nodes(), curves.bytes());
            let table = entry
                .table_bytes
                .map(|bytes| format!("table-bytes={bytes}"));
            setting = [Some(setting), Some(words), table]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
                .join(" ");
            let frame = mask::render(view, &curves)?;
            (edges.of_curves(&curves), truth.wrong_in(&frame, view))
        }
        Way::Steps(stepper) => (
            edges.of_orbits(stepper.orbits()),
            truth.wrong_of(scene, view, stepper, budget),
        ),
    };
    let row = |words: String, error, failures, count| Measurement {
        panel: Panel::Scene,
        method: entry.method,
        setting: format!("{setting} {words}"),
        time: Some(time),
        error,
        failures,
        count,
    };
    let pixels = f64::from(view.width()) * f64::from(view.height());
    Ok(Point {
        method: entry.method,
        milliseconds: time.nanoseconds * pixels * 1e-6,
        nodes,
        table_bytes: entry.table_bytes,
        pixels: row("order=all".into(), None, wrong, compared),
        orders: core::array::from_fn(|order| {
            let Displacements { pixels, lost } =
                displacements.get(order).cloned().unwrap_or_default();
            let count = pixels.len() as u64 + lost;
            row(format!("order={order}"), Quantiles::of(pixels), lost, count)
        }),
    })
}
