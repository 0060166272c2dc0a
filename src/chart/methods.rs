//! The methods that are compared, and the knob that each of them has.

use core::fmt;

use super::measurement::Effort;
use crate::orbit::exact::Exact;
use crate::orbit::integrate::{Adaptive, FixedStep, Scheme};
use crate::orbit::{Orbits, Ray};
use crate::render::pixelwise;
use crate::scene::{Scene, View};
use crate::table::{Spec, SpecError, Table};

/// A way to answer what happens to a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Euler's method in equal steps.
    Euler,
    /// The classical Runge–Kutta method in equal steps.
    Rk4,
    /// DOP853 in steps as long as a tolerance allows.
    Adaptive,
    /// Elliptic integrals.
    Exact,
    /// The draft table.
    TableDraft,
    /// The standard table.
    TableStandard,
    /// The fine table.
    TableFine,
    /// Tables of the standard one's nodes along each axis times some factors.
    TableScaled,
}

impl Method {
    /// All of them, in the order they are drawn.
    pub const ALL: [Self; 8] = [
        Self::Euler,
        Self::Rk4,
        Self::Adaptive,
        Self::TableScaled,
        Self::TableDraft,
        Self::TableStandard,
        Self::TableFine,
        Self::Exact,
    ];

    /// Its name in the CSV.
    pub fn name(self) -> &'static str {
        match self {
            Self::Euler => "euler",
            Self::Rk4 => "rk4",
            Self::Adaptive => "adaptive",
            Self::Exact => "exact",
            Self::TableDraft => "table-draft",
            Self::TableStandard => "table-standard",
            Self::TableFine => "table-fine",
            Self::TableScaled => "table-scaled",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A ray, and the radius whose first crossing is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Question {
    /// The ray.
    pub ray: Ray,
    /// The radius, in Schwarzschild radii.
    pub radius: f64,
}

/// A method, to be asked many questions at once: the method is looked up once for all of them.
pub trait Answers: Orbits {
    /// The sum of the angles of the first crossings, of those that there are.
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

/// A method with its knob set.
pub struct Contestant<'a> {
    /// The method.
    pub method: Method,
    /// The knob's setting, as words `name=value`.
    pub setting: String,
    /// What answers.
    pub orbits: Box<dyn Answers + 'a>,
}

impl<'a> Contestant<'a> {
    /// A method with its knob set.
    pub fn new(method: Method, setting: String, orbits: impl Answers + 'a) -> Self {
        Self {
            method,
            setting,
            orbits: Box::new(orbits),
        }
    }

    /// Euler's method or RK4 in steps of `h`.
    pub fn fixed(scheme: Scheme, h: f64) -> Self {
        let method = match scheme {
            Scheme::Euler => Method::Euler,
            Scheme::Rk4 => Method::Rk4,
        };
        // At the finest steps a near-critical ray takes more than the usual limit.
        let orbits = FixedStep {
            max_steps: 1_000_000,
            ..FixedStep::new(scheme, h)
        };
        Self::new(method, format!("h={h}"), orbits)
    }

    /// Adaptive integration to `tolerance`.
    pub fn adaptive(tolerance: f64) -> Self {
        let setting = format!("tolerance={tolerance:e}");
        Self::new(Method::Adaptive, setting, Adaptive::new(tolerance))
    }

    /// A table.
    pub fn table(method: Method, table: &'a Table) -> Self {
        let nodes = table.metadata().spec.nodes();
        let setting = format!("nodes={nodes} bytes={}", table.bytes().len());
        Self::new(method, setting, table.lookup())
    }

    /// The exact method.
    pub fn exact() -> Self {
        Self::new(Method::Exact, String::new(), Exact)
    }
}

/// A method that steps along rays, pixel by pixel.
#[derive(Debug, Clone, Copy)]
pub enum Stepper {
    /// In equal steps.
    Fixed(FixedStep),
    /// In steps as long as a tolerance allows.
    Adaptive(Adaptive),
}

impl Stepper {
    /// Euler's method in steps of `h`.
    pub fn euler(h: f64) -> Self {
        Self::Fixed(FixedStep::new(Scheme::Euler, h))
    }

    /// RK4 in steps of `h`.
    pub fn rk4(h: f64) -> Self {
        Self::Fixed(FixedStep::new(Scheme::Rk4, h))
    }

    /// Adaptive integration to `tolerance`.
    pub fn adaptive(tolerance: f64) -> Self {
        Self::Adaptive(Adaptive::new(tolerance))
    }

    /// Which method it is.
    pub fn method(&self) -> Method {
        match self {
            Self::Fixed(fixed) => match fixed.scheme {
                Scheme::Euler => Method::Euler,
                Scheme::Rk4 => Method::Rk4,
            },
            Self::Adaptive(_) => Method::Adaptive,
        }
    }

    /// Its knob's setting, as words `name=value`.
    pub fn setting(&self) -> String {
        match self {
            Self::Fixed(fixed) => format!("h={}", fixed.h),
            Self::Adaptive(adaptive) => format!("tolerance={:e}", adaptive.tolerance),
        }
    }

    /// The method.
    pub fn orbits(&self) -> &dyn Orbits {
        match self {
            Self::Fixed(fixed) => fixed,
            Self::Adaptive(adaptive) => adaptive,
        }
    }

    /// Whether a pixel (column, row) of `scene` sees the disk; not where the method gives up.
    pub fn sees(&self, scene: &Scene, view: &View, pixel: (u32, u32)) -> bool {
        match self {
            Self::Fixed(fixed) => pixelwise::sees_in_steps(scene, view, fixed, pixel),
            Self::Adaptive(adaptive) => {
                pixelwise::sees(scene, view, adaptive, pixel).unwrap_or_default()
            }
        }
    }
}

/// The tables that are compared, in memory.
#[derive(Debug)]
pub struct Tables {
    files: Vec<(Method, Table)>,
    scaled: Vec<Table>,
}

impl Tables {
    /// Makes them: the program's own three tables, and tables of the standard one's nodes along each axis times some
    /// factors.
    ///
    /// # Errors
    /// [`SpecError`] where one of them cannot be made.
    pub fn new(effort: Effort) -> Result<Self, SpecError> {
        let factors: &[f64] = match effort {
            Effort::Quick => &[0.125, 0.25, 0.5, 1.0, 2.0],
            Effort::Full => &[0.125, 0.25, 0.5, 1.0, 2.0, 4.0],
        };
        let files = [
            (Method::TableDraft, Spec::draft()),
            (Method::TableStandard, Spec::standard()),
            (Method::TableFine, Spec::fine()),
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
    pub fn tables(&self) -> &[(Method, Table)] {
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
            .map(|table| Contestant::table(Method::TableScaled, table))
    }
}
