//! Finds the least that a scene needs: which table, how many orders, how many nodes.
//!
//! # Derivation
//! A scene names one number, [`Scene::tolerance`] T: the allowed error of an edge, in pixels. [`crate::isoradial`]
//! derives the number of orders and nodes from it.
//!
//! Half of T is for the table. An error δφ of its angles moves an edge by at most `S δφ` pixels, where S is the
//! [`sensitivity`] of the scene's curves. So the smallest table that promises `δφ ≤ T/(2S)` is enough. S is small where
//! pixels are large: for `classic` at 1920 × 1080 an edge moves by 0.4 rad for each radian of φ, and a pixel is
//! 4.8e-4 rad. The photon rings need less: S falls by `e^{−π}` with each order.
//!
//! Light and data ([`Form::needs_map`], [`Form::shows_directions`]) have no tolerance in pixels: their promise, radii
//! within 1e-6 of themselves and directions within 1e-6 radians, is that of the standard table, so that a frame that
//! shows them takes no coarser one.

use super::planes::Form;
use crate::isoradial::{CurveSpec, sensitivity};
use crate::orbit::exact::Exact;
use crate::scene::{Animation, Scene, SceneError, View};
use crate::table::Spec;

/// What a scene needs of its curves and of the swept angles behind them.
#[derive(Debug, Clone, PartialEq)]
pub struct Needs {
    /// What the curves are built for.
    pub curve_spec: CurveSpec,
    /// How far an edge moves when all angles change, in pixels per radian.
    pub sensitivity: f64,
    /// The built-in tables, coarsest first.
    pub tables: Vec<Candidate>,
    /// The frame whose needs these are; 1 for those of a scene.
    pub frame: i64,
}

/// A built-in table, and whether it is accurate enough for a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// One of [`Spec::NAMES`].
    pub name: &'static str,
    /// The greatest error of its angles, in radians.
    pub error: f64,
    /// The most that its error moves an edge, in pixels.
    pub displacement: f64,
    /// Whether that is at most half of the scene's tolerance, and the table is fine enough for light and data where the
    /// frame shows them.
    pub is_enough: bool,
}

impl Needs {
    /// The most frames of an animation that decide which table it needs.
    pub const SAMPLED: u32 = 9;

    /// Computes what `scene` needs for a frame in some form.
    pub fn new(scene: &Scene, view: &View, form: Form) -> Self {
        let spec = CurveSpec::new(scene, view, scene.tolerance());
        let sensitivity = sensitivity(&spec, &Exact);
        let shows_data = form.needs_map(scene) || form.shows_directions();
        let coarsest = if form.shows_light() || shows_data {
            Spec::standard().tolerance
        } else {
            f64::INFINITY
        };
        let candidate = |name| {
            let error = Spec::named(name)?.tolerance;
            let displacement = sensitivity * error;
            Some(Candidate {
                name,
                error,
                displacement,
                is_enough: displacement <= 0.5 * spec.tolerance && error <= coarsest,
            })
        };
        Self {
            curve_spec: spec,
            sensitivity,
            tables: Spec::NAMES.into_iter().filter_map(candidate).collect(),
            frame: 1,
        }
    }

    /// Computes what an animation needs: the needs of the most sensitive of up to
    /// [`Self::SAMPLED`] evenly spaced frames. They
    /// depend on the animation alone, so that one table serves all its frames.
    ///
    /// # Errors
    /// Returns the error of the first of these frames if none of them can be built.
    pub fn of_animation(animation: &Animation, form: Form) -> Result<Self, SceneError> {
        let (first, span) = (animation.first(), i64::from(animation.frames()) - 1);
        let mut most: Option<Self> = None;
        let mut before = None;
        let mut refused = None;
        let sampled = i64::from(Self::SAMPLED);
        for place in 0..sampled {
            let number = first + span * place / (sampled - 1);
            if before == Some(number) {
                continue;
            }
            before = Some(number);
            // Skips invalid frames. They are reported where they are drawn.
            let scene = match animation.frame(number) {
                Ok(scene) => scene,
                Err(error) => {
                    refused.get_or_insert(error);
                    continue;
                }
            };
            let needs = Self {
                frame: number,
                ..Self::new(&scene, &View::new(&scene), form)
            };
            if most
                .as_ref()
                .is_none_or(|most| needs.sensitivity > most.sensitivity)
            {
                most = Some(needs);
            }
        }
        let none = SceneError::NoFrame {
            number: first,
            first,
            last: animation.last(),
        };
        most.ok_or(refused.unwrap_or(none))
    }

    /// Returns the smallest table that is enough, or `None` if only exact angles are.
    pub fn table(&self) -> Option<&Candidate> {
        self.tables.iter().find(|candidate| candidate.is_enough)
    }
}
