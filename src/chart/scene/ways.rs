//! The ways to draw a frame, each at its settings.

use super::super::Effort;
use super::super::methods::{Method, Stepper, Tables};
use crate::isoradial::{Isoradials, Sight};
use crate::orbit::exact::Exact;
use crate::orbit::path::SweptAngles;
use crate::scene::{Scene, View};

/// What the curves are asked for, in pixels, beside the scene's own tolerance.
const TOLERANCES: [f64; 5] = [1.0, 0.1, 0.01, 1e-3, 1e-4];

/// Pictures with more pixels than this are drawn with their own tolerance only.
const MANY_PIXELS: u64 = 1 << 25;

/// A way to draw the frame, with its knob set.
pub(super) enum Way<'a> {
    Curves {
        angles: &'a dyn Curves,
        sight: Sight,
    },
    Steps(Stepper),
}

/// A method's swept angles, to draw curves from.
pub(super) trait Curves: Sync {
    fn draw(&self, sight: &Sight) -> Isoradials;
}

impl<T: SweptAngles> Curves for T {
    fn draw(&self, sight: &Sight) -> Isoradials {
        Isoradials::new(sight, self)
    }
}

/// What draws curves: the method, its words for the CSV, the bytes of its table.
pub(super) struct Source<'a> {
    pub(super) method: Method,
    pub(super) table_bytes: Option<usize>,
    pub(super) angles: Box<dyn Curves + Send + 'a>,
}

/// A setting to be measured.
pub(super) struct Entry<'a> {
    pub(super) method: Method,
    pub(super) way: Way<'a>,
    pub(super) setting: String,
    pub(super) table_bytes: Option<usize>,
}

/// All that draws curves.
pub(super) fn sources(tables: &Tables) -> Vec<Source<'_>> {
    let mut all: Vec<Source<'_>> = Vec::new();
    for (method, table) in tables.tables() {
        all.push(Source {
            method: *method,
            table_bytes: Some(table.bytes().len()),
            angles: Box::new(table.lookup()),
        });
    }
    all.push(Source {
        method: Method::Exact,
        table_bytes: None,
        angles: Box::new(Exact),
    });
    all
}

/// Every method at every setting; first the baseline.
pub(super) fn entries<'a>(
    scene: &Scene,
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
