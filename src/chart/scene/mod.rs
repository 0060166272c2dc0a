//! The third panel: what a scene's frame costs, and how right it is.
//!
//! Tables, grids and the exact method draw isoradial curves, to several tolerances, and fill the frame between them; the
//! integrators step every pixel's ray. Asked of both: where each edge of the disk is, order by order, in pixels from
//! where it should be ([`edges`]), and how many pixels are wrong ([`frames`]). Times are of whole frames on one thread:
//! curves and frame together, or the time of an even sample of pixels for those that step each.

mod edges;
mod frames;

use core::time::Duration;

use super::interleaved::{Contender, rounds};
use super::methods::{Method, Stepper, Tables};
use super::{ChartError, Effort, Measurement, Panel, Quantiles, Time};
use crate::isoradial::{Isoradials, Sight};
use crate::orbit::exact::Exact;
use crate::orbit::path::SweptAngles;
use crate::render::mask;
use crate::scene::{self, View};
use edges::{Displacements, Edges, ORDERS};
use frames::Truth;

/// What the curves are asked for, in pixels, beside the scene's own tolerance.
const TOLERANCES: [f64; 5] = [1.0, 0.1, 0.01, 1e-3, 1e-4];

/// Pictures with more pixels than this are drawn with their own tolerance only.
const MANY_PIXELS: u64 = 1 << 25;

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
                repetitions: 3,
                time: Duration::from_secs(3),
                sampled_pixels: 1024,
                compared_pixels: 1 << 17,
                places: 129,
                seconds: 0.15,
            },
            Effort::Full => Self {
                repetitions: 7,
                time: Duration::from_secs(40),
                sampled_pixels: 8192,
                compared_pixels: 1 << 22,
                places: 129,
                seconds: 3.0,
            },
        }
    }
}

/// A way to draw the frame, with its knob set.
enum Way<'a> {
    Curves {
        angles: &'a dyn Curves,
        sight: Sight,
    },
    Steps(Stepper),
}

/// A method's swept angles, to draw curves from.
trait Curves: Sync {
    fn draw(&self, sight: &Sight) -> Isoradials;
}

impl<T: SweptAngles> Curves for T {
    fn draw(&self, sight: &Sight) -> Isoradials {
        Isoradials::new(sight, self)
    }
}

/// What draws curves: the method, its words for the CSV, the bytes of its table.
struct Source<'a> {
    method: Method,
    table_bytes: Option<usize>,
    angles: Box<dyn Curves + Send + 'a>,
}

/// A setting to be measured.
struct Entry<'a> {
    method: Method,
    way: Way<'a>,
    setting: String,
    table_bytes: Option<usize>,
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

/// A count with its thousands set apart.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut grouped = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// A number below 1 to two digits, rounded up: what nothing is above.
fn two_digits(value: f64) -> String {
    if value <= 0.0 {
        return "0".into();
    }
    let digits = 1 - libm::floor(libm::log10(value)) as i32;
    let scale = libm::pow(10.0, f64::from(digits));
    let rounded = (value * scale).ceil() / scale;
    if digits > 6 {
        format!("{rounded:.1e}")
    } else {
        format!("{rounded:.*}", digits.max(0) as usize)
    }
}

/// All that draws curves.
fn sources(tables: &Tables) -> Vec<Source<'_>> {
    let mut all: Vec<Source<'_>> = Vec::new();
    for (method, table) in tables.tables() {
        all.push(Source {
            method: *method,
            table_bytes: Some(table.bytes().len()),
            angles: Box::new(table.lookup()),
        });
    }
    if let Some((nearest, linear, cubic)) = tables.standard_grid() {
        let source = |method, bytes, angles| Source {
            method,
            table_bytes: Some(bytes),
            angles,
        };
        all.push(source(
            Method::Nearest,
            nearest.bytes(),
            Box::new(nearest.lookup()),
        ));
        all.push(source(
            Method::Linear,
            linear.bytes(),
            Box::new(linear.lookup()),
        ));
        all.push(source(
            Method::Cubic,
            cubic.bytes(),
            Box::new(cubic.lookup()),
        ));
    }
    all.push(Source {
        method: Method::Exact,
        table_bytes: None,
        angles: Box::new(Exact),
    });
    all
}

/// Every method at every setting; first the baseline.
fn entries<'a>(
    scene: &scene::Scene,
    view: &View,
    sources: &'a [Source<'_>],
    baseline_step: f64,
    effort: Effort,
) -> Vec<Entry<'a>> {
    let mut steppers = vec![Stepper::rk4(baseline_step)];
    steppers.extend(match effort {
        Effort::Quick => vec![
            Stepper::euler(0.01),
            Stepper::euler(1e-3),
            Stepper::rk4(0.2),
            Stepper::rk4(0.02),
            Stepper::adaptive(1e-3),
            Stepper::adaptive(1e-9),
        ],
        Effort::Full => vec![
            Stepper::euler(0.1),
            Stepper::euler(0.03),
            Stepper::euler(0.01),
            Stepper::euler(3e-3),
            Stepper::euler(1e-3),
            Stepper::rk4(0.3),
            Stepper::rk4(0.2),
            Stepper::rk4(0.1),
            Stepper::rk4(0.02),
            Stepper::rk4(0.01),
            Stepper::rk4(5e-3),
            Stepper::adaptive(1e-3),
            Stepper::adaptive(1e-6),
            Stepper::adaptive(1e-9),
            Stepper::adaptive(1e-12),
        ],
    });
    let mut all: Vec<_> = steppers
        .into_iter()
        .map(|stepper| Entry {
            method: stepper.method(),
            setting: stepper.setting(),
            way: Way::Steps(stepper),
            table_bytes: None,
        })
        .collect();
    let mut tolerances = vec![scene.tolerance()];
    if u64::from(view.width()) * u64::from(view.height()) <= MANY_PIXELS {
        tolerances.extend(TOLERANCES);
    }
    tolerances.sort_by(|a, b| b.total_cmp(a));
    tolerances.dedup();
    for source in sources {
        for &tolerance in &tolerances {
            all.push(Entry {
                method: source.method,
                way: Way::Curves {
                    angles: &*source.angles,
                    sight: Sight::new(scene, view, tolerance),
                },
                setting: format!("curve-tolerance={tolerance:e}"),
                table_bytes: source.table_bytes,
            });
        }
    }
    all
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
            setting += &format!(" nodes={} bytes={}", curves.nodes(), curves.bytes());
            if let Some(bytes) = entry.table_bytes {
                setting += &format!(" table-bytes={bytes}");
            }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_bounds_are_written_for_readers() {
        assert_eq!(grouped(14640), "14,640");
        assert_eq!(grouped(212), "212");
        assert_eq!(grouped(1_000_000), "1,000,000");
        assert_eq!(two_digits(6.31e-4), "0.00064");
        assert_eq!(two_digits(0.5), "0.50");
        assert_eq!(two_digits(0.0), "0");
        assert_eq!(two_digits(3.21e-9), "3.3e-9");
    }
}
