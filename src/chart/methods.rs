//! The methods that are compared, and their settings.

use super::measurement::{ChartEffort, ComparedMethod};
use crate::light::Sight;
use crate::orbit::exact::Exact;
use crate::orbit::integrate::{Adaptive, FixedStep, Scheme};
use crate::orbit::{Orbits, Ray};
use crate::render::pixelwise;
use crate::scene::{Scene, View};
use crate::table::{Spec, SpecError, Table};

/// A ray and a radius. The answer is the angle swept to the ray's first crossing of the radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Question {
    /// The ray.
    pub ray: Ray,
    /// The radius, in Schwarzschild radii.
    pub radius: f64,
}

/// A method that answers many questions per virtual call, so that the call's cost does not count.
pub trait Answers: Orbits {
    /// Returns the sum of the angles to the first crossings. Rays without a crossing are skipped.
    fn sum(&self, questions: &[Question]) -> f64;
}

impl<T: Orbits> Answers for T {
    fn sum(&self, questions: &[Question]) -> f64 {
        questions
            .iter()
            .filter_map(|&Question { ray, radius }| self.first_crossing(ray, radius).ok().flatten())
            .sum()
    }
}

/// A method at one setting.
pub struct Contestant<'a> {
    /// The method.
    pub method: ComparedMethod,
    /// The settings: `name=value`, separated by spaces.
    pub setting: String,
    /// The method's implementation.
    pub orbits: Box<dyn Answers + 'a>,
}

impl<'a> Contestant<'a> {
    /// Creates a contestant.
    pub fn new(method: ComparedMethod, setting: String, orbits: impl Answers + 'a) -> Self {
        Self {
            method,
            setting,
            orbits: Box::new(orbits),
        }
    }

    /// Creates Euler's method or RK4 with steps of `h` radians.
    pub fn fixed(scheme: Scheme, h: f64) -> Self {
        let method = match scheme {
            Scheme::Euler => ComparedMethod::Euler,
            Scheme::Rk4 => ComparedMethod::Rk4,
        };
        // With the finest steps a near-critical ray takes more steps than the usual limit.
        let orbits = FixedStep {
            max_steps: 1_000_000,
            ..FixedStep::new(scheme, h)
        };
        Self::new(method, format!("h={h}"), orbits)
    }

    /// Creates adaptive integration to `tolerance`.
    pub fn adaptive(tolerance: f64) -> Self {
        let setting = format!("tolerance={tolerance:e}");
        Self::new(ComparedMethod::Adaptive, setting, Adaptive::new(tolerance))
    }

    /// Creates a contestant that reads a table.
    pub fn table(method: ComparedMethod, table: &'a Table) -> Self {
        let nodes = table.metadata().spec.nodes();
        let setting = format!("nodes={nodes} bytes={}", table.bytes().len());
        Self::new(method, setting, table.lookup())
    }

    /// Creates the exact method.
    pub fn exact() -> Self {
        Self::new(ComparedMethod::Exact, String::new(), Exact)
    }
}

/// A method that steps along the ray of each pixel.
#[derive(Debug, Clone, Copy)]
pub enum Stepper {
    /// With equal steps.
    Fixed(FixedStep),
    /// With steps that a tolerance controls.
    Adaptive(Adaptive),
}

impl Stepper {
    /// Creates Euler's method with steps of `h` radians.
    pub fn euler(h: f64) -> Self {
        Self::Fixed(FixedStep::new(Scheme::Euler, h))
    }

    /// Creates RK4 with steps of `h` radians.
    pub fn rk4(h: f64) -> Self {
        Self::Fixed(FixedStep::new(Scheme::Rk4, h))
    }

    /// Creates adaptive integration to `tolerance`.
    pub fn adaptive(tolerance: f64) -> Self {
        Self::Adaptive(Adaptive::new(tolerance))
    }

    /// Returns the method.
    pub fn method(&self) -> ComparedMethod {
        match self {
            Self::Fixed(fixed) => match fixed.scheme {
                Scheme::Euler => ComparedMethod::Euler,
                Scheme::Rk4 => ComparedMethod::Rk4,
            },
            Self::Adaptive(_) => ComparedMethod::Adaptive,
        }
    }

    /// Returns the setting as `name=value`.
    pub fn setting(&self) -> String {
        match self {
            Self::Fixed(fixed) => format!("h={}", fixed.h),
            Self::Adaptive(adaptive) => format!("tolerance={:e}", adaptive.tolerance),
        }
    }

    /// Returns the method's implementation.
    pub fn orbits(&self) -> &dyn Orbits {
        match self {
            Self::Fixed(fixed) => fixed,
            Self::Adaptive(adaptive) => adaptive,
        }
    }

    /// Returns whether a pixel (column, row) of `scene` sees the disk. If the method fails, the pixel does not.
    pub fn sees(&self, scene: &Scene, view: &View, pixel: (u32, u32)) -> bool {
        match self {
            Self::Fixed(fixed) => pixelwise::sees_in_steps(scene, view, fixed, pixel),
            Self::Adaptive(adaptive) => {
                pixelwise::sees(scene, view, adaptive, pixel).unwrap_or_default()
            }
        }
    }

    /// Returns what a pixel (column, row) of `scene` sees of the disk: nothing if the method fails.
    pub fn sight(&self, scene: &Scene, view: &View, pixel: (u32, u32)) -> Option<Sight> {
        match self {
            Self::Fixed(fixed) => pixelwise::sight_in_steps(scene, view, fixed, pixel),
            Self::Adaptive(adaptive) => {
                let sight = pixelwise::sight(scene, view, adaptive, pixel);
                sight.unwrap_or_default()
            }
        }
    }
}

/// The tables that are compared.
#[derive(Debug)]
pub struct Tables {
    files: Vec<(ComparedMethod, Table)>,
    scaled: Vec<Table>,
}

impl Tables {
    /// Generates the program's three tables, and tables with the standard table's number of nodes along each axis,
    /// times several factors.
    ///
    /// # Errors
    /// [`SpecError`] if a table cannot be generated.
    pub fn new(effort: ChartEffort) -> Result<Self, SpecError> {
        let factors: &[f64] = match effort {
            ChartEffort::Quick => &[0.125, 0.25, 0.5, 1.0, 2.0],
            ChartEffort::Full => &[0.125, 0.25, 0.5, 1.0, 2.0, 4.0],
        };
        let files = [
            (ComparedMethod::TableDraft, Spec::draft()),
            (ComparedMethod::TableStandard, Spec::standard()),
            (ComparedMethod::TableFine, Spec::fine()),
        ];
        let files = files
            .into_iter()
            .map(|(method, spec)| Ok((method, Table::generate(&spec)?)));
        let scaled = factors
            .iter()
            .map(|&factor| Table::generate(&Spec::standard().scaled(factor)));
        Ok(Self {
            files: files.collect::<Result<_, SpecError>>()?,
            scaled: scaled.collect::<Result<_, SpecError>>()?,
        })
    }

    /// Returns the program's own three tables.
    pub fn tables(&self) -> &[(ComparedMethod, Table)] {
        &self.files
    }

    /// Returns a contestant for each of the program's own three tables.
    pub fn files(&self) -> impl Iterator<Item = Contestant<'_>> {
        self.files
            .iter()
            .map(|(method, table)| Contestant::table(*method, table))
    }

    /// Returns a contestant for each of the scaled tables.
    pub fn scaled(&self) -> impl Iterator<Item = Contestant<'_>> {
        self.scaled
            .iter()
            .map(|table| Contestant::table(ComparedMethod::TableScaled, table))
    }
}
