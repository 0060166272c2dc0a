//! The methods that render a frame, at every setting that is measured.

use super::super::measurement::{ChartEffort, ComparedMethod};
use super::super::methods::{Stepper, Tables};
use crate::isoradial::{CurveSpec, Isoradials};
use crate::orbit::exact::Exact;
use crate::orbit::path::SweptAngles;
use crate::scene::{Scene, View};

/// The tolerances of curves, in pixels, that are measured besides the scene's own.
const TOLERANCES: [f64; 5] = [1.0, 0.1, 0.01, 1e-3, 1e-4];

/// Pictures with more pixels than this are rendered with the scene's own tolerance only.
const MANY_PIXELS: u64 = 1 << 25;

/// How a frame is rendered.
pub(super) enum FrameMethod<'a> {
    /// From isoradial curves.
    Curves {
        angles: &'a dyn BuildCurves,
        spec: CurveSpec,
    },
    /// By stepping along every pixel's ray.
    Steps(Stepper),
}

/// Swept angles from which curves can be built.
pub(super) trait BuildCurves: Sync {
    /// Builds the curves.
    fn build(&self, spec: &CurveSpec) -> Isoradials;
}

impl<T: SweptAngles> BuildCurves for T {
    fn build(&self, spec: &CurveSpec) -> Isoradials {
        Isoradials::new(spec, self)
    }
}

/// A method whose swept angles curves are built from, and the size of its table in bytes, if it has one.
pub(super) struct CurveSource<'a> {
    pub(super) method: ComparedMethod,
    pub(super) table_bytes: Option<usize>,
    pub(super) angles: Box<dyn BuildCurves + Send + 'a>,
}

/// A method at one setting.
pub(super) struct FrameSetting<'a> {
    pub(super) method: ComparedMethod,
    pub(super) renders: FrameMethod<'a>,
    pub(super) setting: String,
    pub(super) table_bytes: Option<usize>,
}

/// Lists the methods that curves are built from.
pub(super) fn sources(tables: &Tables) -> Vec<CurveSource<'_>> {
    let mut all: Vec<CurveSource<'_>> = Vec::new();
    for (method, table) in tables.tables() {
        all.push(CurveSource {
            method: *method,
            table_bytes: Some(table.bytes().len()),
            angles: Box::new(table.lookup()),
        });
    }
    all.push(CurveSource {
        method: ComparedMethod::Exact,
        table_bytes: None,
        angles: Box::new(Exact),
    });
    all
}

/// Lists every method at every setting, the baseline first.
pub(super) fn settings<'a>(
    scene: &Scene,
    view: &View,
    sources: &'a [CurveSource<'_>],
    baseline_step: f64,
    effort: ChartEffort,
) -> Vec<FrameSetting<'a>> {
    let mut steppers = vec![Stepper::rk4(baseline_step)];
    steppers.extend(match effort {
        ChartEffort::Quick => vec![
            Stepper::euler(0.01),
            Stepper::euler(1e-3),
            Stepper::rk4(0.2),
            Stepper::rk4(0.02),
            Stepper::adaptive(1e-3),
            Stepper::adaptive(1e-9),
        ],
        ChartEffort::Full => vec![
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
        .map(|stepper| FrameSetting {
            method: stepper.method(),
            setting: stepper.setting(),
            renders: FrameMethod::Steps(stepper),
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
            all.push(FrameSetting {
                method: source.method,
                renders: FrameMethod::Curves {
                    angles: &*source.angles,
                    spec: CurveSpec::new(scene, view, tolerance),
                },
                setting: format!("curve-tolerance={tolerance:e}"),
                table_bytes: source.table_bytes,
            });
        }
    }
    all
}
