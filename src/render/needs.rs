//! The least that a scene needs: which table, how many orders, how many nodes.
//!
//! # Derivation
//! A scene names one number, [`Scene::tolerance`] T: what an edge may be off by, in pixels. The curves' share of it,
//! and which orders are thicker than it, is told in [`crate::isoradial`]. The table's share is T/2: an error δφ of its
//! angles moves an edge by `S δφ` pixels at most, S the [`sensitivity`] of this scene's curves, so that the smallest
//! table which promises `δφ ≤ T/2S` is enough. S is small where pixels are large (S = 0.4 rad/rad over 4.8e-4 rad a
//! pixel for `classic` at 1920 × 1080), and of the rings, whose angles all but stand still, smaller by e^{−π} with
//! each order.

use crate::isoradial::{Sight, sensitivity};
use crate::orbit::exact::Exact;
use crate::scene::{Animation, Scene, SceneError, View};
use crate::table::Spec;

/// What a scene asks of its curves and of the angles that they are drawn from.
#[derive(Debug, Clone, PartialEq)]
pub struct Needs {
    /// What the curves are drawn for.
    pub sight: Sight,
    /// How far an edge moves with the angles, in pixels per radian.
    pub sensitivity: f64,
    /// The tables that come with the program, coarsest first, and what each may displace an edge by.
    pub tables: Vec<Candidate>,
}

/// A table that may do for a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// One of [`Spec::NAMES`].
    pub name: &'static str,
    /// What it may displace an edge of the scene by, in pixels.
    pub displacement: f64,
    /// Whether that is within the scene's tolerance.
    pub is_enough: bool,
}

impl Needs {
    /// What `scene` needs.
    pub fn new(scene: &Scene, view: &View) -> Self {
        let sight = Sight::new(scene, view, scene.tolerance());
        let sensitivity = sensitivity(&sight, &Exact);
        let candidate = |name| {
            let displacement = sensitivity * Spec::named(name)?.tolerance;
            Some(Candidate {
                name,
                displacement,
                is_enough: displacement <= 0.5 * sight.tolerance,
            })
        };
        Self {
            sight,
            sensitivity,
            tables: Spec::NAMES.into_iter().filter_map(candidate).collect(),
        }
    }

    /// The needs of the frame among some of an animation, evenly apart, that needs most: they depend on the animation alone, and one
    /// table serves all its frames.
    ///
    /// # Errors
    /// Where none of them can be.
    pub fn of_animation(animation: &Animation) -> Result<Self, SceneError> {
        const LOOKED_AT: u64 = 9;
        let last = u64::from(animation.frames());
        let mut most: Option<Self> = None;
        let mut before = 0;
        let mut refused = None;
        for place in 0..LOOKED_AT {
            let number = (1 + (last - 1) * place / (LOOKED_AT - 1)) as u32;
            if number == before {
                continue;
            }
            before = number;
            // One that cannot be is not this one's to tell.
            let scene = match animation.frame(number) {
                Ok(scene) => scene,
                Err(error) => {
                    refused.get_or_insert(error);
                    continue;
                }
            };
            let needs = Self::new(&scene, &View::new(&scene));
            if most
                .as_ref()
                .is_none_or(|most| needs.sensitivity > most.sensitivity)
            {
                most = Some(needs);
            }
        }
        let none = SceneError::NoFrame {
            number: 1,
            frames: animation.frames(),
        };
        most.ok_or(refused.unwrap_or(none))
    }

    /// The smallest table that is enough; none where only exact angles are.
    pub fn table(&self) -> Option<&Candidate> {
        self.tables.iter().find(|candidate| candidate.is_enough)
    }
}
