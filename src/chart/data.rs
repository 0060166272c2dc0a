//! Everything the chart shows, measured in one run.

use super::critical::CriticalPanel;
use super::light::LightPanel;
use super::measurement::{ChartEffort, ChartError, ChartProgress, Measurement};
use super::methods::Tables;
use super::rays::RayPanel;
use super::scene::ScenePanel;
use super::verdict::verdict;
use crate::scene::{LayerSet, Scene};

/// The measurements of all panels.
#[derive(Debug)]
pub struct ChartData {
    /// Time and error of one swept angle.
    pub rays: RayPanel,
    /// Error near the critical ray.
    pub critical: CriticalPanel,
    /// Time and error of a scene's frame.
    pub scene: ScenePanel,
    /// Time and error of the same frame, lit.
    pub light: LightPanel,
}

impl ChartData {
    /// Measures all panels. The last two show `scene` before a black sky. The figure calls it `name`.
    ///
    /// # Errors
    /// [`ChartError`] if the scene has no disk, or if a table, a thread or a frame cannot be made.
    pub fn measure(
        scene: &Scene,
        name: String,
        effort: ChartEffort,
        progress: &ChartProgress<'_>,
    ) -> Result<Self, ChartError> {
        if scene.disk().is_none() {
            return Err(ChartError::NoDisk);
        }
        let scene = &scene
            .clone()
            .with_layers(LayerSet::default())?
            .with_sky(None)?;
        progress("generating tables", 0.0);
        let tables = Tables::new(effort)?;
        let rays = RayPanel::measure(&tables, effort, &|share| {
            progress("timing rays", 0.05 + 0.4 * share);
        });
        let critical = CriticalPanel::measure(&tables, effort, &|share| {
            progress("near-critical rays", 0.45 + 0.05 * share);
        });
        let step = rays.baseline_step;
        let frame = ScenePanel::measure(scene, name.clone(), &tables, step, effort, &|share| {
            progress("frames", 0.5 + 0.25 * share);
        })?;
        let light = LightPanel::measure(scene, name, &tables, step, effort, &|share| {
            progress("light", 0.75 + 0.25 * share);
        })?;
        Ok(Self {
            rays,
            critical,
            scene: frame,
            light,
        })
    }

    /// Returns in one sentence how long the table takes on this machine for frames that are right, and how long RK4
    /// takes.
    pub fn verdict(&self) -> String {
        verdict(self).join(" ")
    }

    /// Returns all measured points, panel by panel.
    pub fn measurements(&self) -> impl Iterator<Item = &Measurement> {
        self.rays
            .points
            .iter()
            .chain(self.critical.points.iter().map(|point| &point.measurement))
            .chain(self.scene.points.iter().flat_map(|point| {
                let orders = point.orders.iter().filter(|order| order.count > 0);
                orders.chain([&point.pixels])
            }))
            .chain(
                self.light
                    .points
                    .iter()
                    .flat_map(|point| [&point.redshift, &point.luminance]),
            )
    }
}
