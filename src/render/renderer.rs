//! The renderer: a scene in, its pixels out.

use std::sync::Arc;
use std::time::Instant;

use image::{GrayImage, RgbImage};

use super::batch::{self, Curved, DrawnFrame, Sharing};
use super::error::{RenderError, blank, make_room};
use super::frame::{Threads, Workspace};
use super::ink::SharedColours;
use super::planes::{Form, FrameMemory, Plane, Target};
use super::scene_frame::{FrameReport, SceneFrame, is_unresolved};
use super::sky::{FrameSky, SharedSky, SkyAtRadius};
use crate::isoradial::{CurveSpec, Isoradials, RadiusMap};
use crate::orbit::path::SweptAngles;
use crate::scene::{Animation, ImageSize, LayerSet, Light, Scene, Sky, Tone, View};
use crate::sky::SkySource;
use crate::table::{Lookup, Table};

/// Draws scenes.
///
/// A renderer keeps the isoradial curves of the last scene. While the camera's radius and the disk stay the same, the
/// next scene is drawn from them if it shows no more of them, and nothing smaller. If it shows a little more, the new
/// curves reach farther than it needs: few frames of a flight around the hole pay for curves. Every edge is right to
/// the scene's tolerance whichever curves it is drawn from. Where no curves can be that accurate (a disk of any width
/// seen through a lens of any length), each pixel's ray is followed by itself; [`FrameReport::ray_by_ray`] tells.
///
/// Smooth edges or hard ones are the scene's choice, [`Scene::antialias`]: a pixel is the share of its square that the
/// disk covers, linear, or white where its centre sees the disk.
///
/// ```
/// use darkness::table::Spec;
/// use darkness::{Renderer, Scene, Table};
///
/// let table = Table::generate(&Spec::draft())?;
/// let mut renderer = Renderer::new(&table);
/// let scene = Scene::builtin("face-on")?.with_size(64, 64)?;
/// // A window's memory: rows of 64 bytes, 100 apart.
/// let mut memory = vec![0; 100 * 64];
/// renderer.render_into(&scene, &mut memory, 100)?;
/// assert!(memory.contains(&255));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Renderer<A> {
    angles: A,
    /// The curves of the scene before.
    curves: Option<Isoradials>,
    /// Their map, once a scene has needed it.
    map: Option<RadiusMap>,
    /// The sky at their radius, once a scene has needed it, and whether that was for its light.
    sky: Option<(bool, SkyAtRadius)>,
    /// The sky of the scene before, and what its files hold.
    source: (Option<Sky>, SharedSky),
    /// Light, exposure and tone of the scene before, and their colours.
    shown: Option<(Option<Light>, u64, Tone)>,
    colours: SharedColours,
    workspace: Workspace,
}

impl<'a> Renderer<Lookup<'a>> {
    /// Creates a renderer that reads angles from a table.
    pub fn new(table: &'a Table) -> Self {
        Self::with_angles(table.lookup())
    }
}

impl<A: SweptAngles> Renderer<A> {
    /// Creates a renderer that takes angles from any method, for instance [`crate::orbit::exact::Exact`].
    pub fn with_angles(angles: A) -> Self {
        Self {
            angles,
            curves: None,
            map: None,
            sky: None,
            source: (None, SharedSky::default()),
            shown: None,
            colours: SharedColours::default(),
            workspace: Workspace::default(),
        }
    }

    /// Takes what a sky holds from memory instead of from the files that its scenes name, for all scenes with this sky.
    #[must_use]
    pub fn with_sky(mut self, sky: Sky, source: Arc<SkySource>) -> Self {
        self.source = (Some(sky), SharedSky::new(Some(source)));
        self
    }

    /// Returns a scene's mask, drawn on all threads of the current rayon pool: where the disk is.
    ///
    /// # Errors
    /// [`RenderError::Memory`]
    pub fn render(&mut self, scene: &Scene) -> Result<GrayImage, RenderError> {
        let ImageSize { width, height } = scene.size();
        let mut pixels = blank(&View::new(scene))?;
        self.render_into(scene, &mut pixels, width as usize)?;
        // The length is that of the picture.
        Ok(GrayImage::from_raw(width, height, pixels).unwrap_or_default())
    }

    /// Returns a scene's picture in colour, sRGB, drawn on all threads of the current rayon pool.
    ///
    /// # Errors
    /// [`RenderError::NoLight`] for a scene without light, [`RenderError::Memory`].
    pub fn render_rgb(&mut self, scene: &Scene) -> Result<RgbImage, RenderError> {
        let ImageSize { width, height } = scene.size();
        let mut pixels = Vec::new();
        make_room(&View::new(scene), 3, &mut pixels)?;
        self.render_rgb_into(scene, &mut pixels, 3 * width as usize)?;
        Ok(RgbImage::from_raw(width, height, pixels).unwrap_or_default())
    }

    /// Returns layers of data, a plane for each in the set's order, drawn on all threads of the current rayon pool.
    ///
    /// # Errors
    /// [`RenderError::NoLight`] for colours or temperatures of a scene without, [`RenderError::Memory`].
    pub fn render_layers(
        &mut self,
        scene: &Scene,
        layers: LayerSet,
    ) -> Result<Vec<Plane>, RenderError> {
        let mut memory = FrameMemory::new(Form::Layers(layers));
        self.draw(scene, &mut memory)?;
        Ok(memory.into_planes())
    }

    /// Draws a scene into memory that is reused, in the memory's form, on all threads of the current rayon pool.
    ///
    /// # Errors
    /// [`RenderError::NoLight`] for light of a scene without, [`RenderError::Memory`].
    pub fn draw(
        &mut self,
        scene: &Scene,
        memory: &mut FrameMemory,
    ) -> Result<FrameReport, RenderError> {
        let view = View::new(scene);
        let form = memory.form();
        self.draw_into(scene, &view, form, memory.target(&view)?)
    }

    /// Draws a scene's mask into a caller's memory, on all threads of the current rayon pool. Row j begins at byte
    /// `j stride`; bytes between the rows stay as they are.
    ///
    /// # Errors
    /// [`RenderError::Buffer`] for a stride or a buffer that the picture does not fit.
    pub fn render_into(
        &mut self,
        scene: &Scene,
        pixels: &mut [u8],
        stride: usize,
    ) -> Result<FrameReport, RenderError> {
        let target = Target::Grey8(pixels, stride);
        self.draw_into(scene, &View::new(scene), Form::Grey8, target)
    }

    /// Draws a scene's picture in colour into a caller's memory, as [`Self::render_into`] does: three bytes a pixel,
    /// row j from byte `j stride` on.
    ///
    /// # Errors
    /// [`RenderError::NoLight`] for a scene without light, and those of [`Self::render_into`].
    pub fn render_rgb_into(
        &mut self,
        scene: &Scene,
        pixels: &mut [u8],
        stride: usize,
    ) -> Result<FrameReport, RenderError> {
        let target = Target::Rgb8(pixels, stride);
        self.draw_into(scene, &View::new(scene), Form::Rgb8, target)
    }

    fn draw_into(
        &mut self,
        scene: &Scene,
        view: &View,
        form: Form,
        target: Target<'_>,
    ) -> Result<FrameReport, RenderError> {
        let start = Instant::now();
        let spec = CurveSpec::new(scene, view, scene.tolerance());
        let angles = &self.angles;
        let kept = self.curves.take();
        let is_beside = kept.as_ref().is_some_and(|kept| kept.are_beside(&spec));
        self.curves = kept.filter(|kept| kept.serves(&spec));
        if self.curves.is_none() {
            self.map = None;
            if is_beside {
                // The camera turns: the next frame will show yet more, and that is to be there already.
                let ahead = Isoradials::new(&spec.ahead(), angles);
                self.curves =
                    Some(ahead).filter(|ahead| !is_unresolved(ahead.error(), scene.tolerance()));
            } else {
                self.sky = None;
            }
        }
        let curves = self
            .curves
            .get_or_insert_with(|| Isoradials::new(&spec, angles));
        if form.needs_map(scene) {
            self.map
                .get_or_insert_with(|| RadiusMap::new(curves, angles));
        }
        let shown = (scene.light(), scene.exposure().to_bits(), scene.tone());
        if self.shown != Some(shown) {
            self.shown = Some(shown);
            self.colours = SharedColours::default();
        }
        if self.source.0.as_ref() != scene.sky() {
            self.source = (scene.sky().cloned(), SharedSky::default());
            self.sky = None;
        }
        let source = self.source.1.source(scene, form)?;
        let sky = if form.needs_escape(scene) {
            let has_light = source.is_some();
            if self.sky.as_ref().is_some_and(|(had, _)| has_light && !had) {
                self.sky = None;
            }
            let (_, radius) = self.sky.get_or_insert_with(|| {
                let radius = SkyAtRadius::new(scene, view, source, angles, Threads::All);
                (has_light, radius)
            });
            Some(FrameSky::at_radius(radius, scene, view, source, form))
        } else {
            None
        };
        let frame = SceneFrame {
            scene,
            view,
            curves,
            map: self.map.as_ref(),
            sky,
            colours: self.colours.of(scene, form),
            angles,
            threads: Threads::All,
        };
        let time = start.elapsed();
        let report = frame.draw(&mut self.workspace, target)?;
        Ok(FrameReport {
            curves: time,
            ..report
        })
    }
}

impl<A: SweptAngles> Renderer<A> {
    /// Draws frames of an animation in a form, side by side on all threads of the current rayon pool where there are
    /// enough. They are begun in the order of `numbers`. `done` gets each frame as it is finished, in any order and
    /// from several threads at once.
    ///
    /// A frame's bytes depend on the animation, the table and its number alone: not on which other frames are drawn.
    ///
    /// # Errors
    /// The first error that `done` returns. No frame is begun after it.
    pub fn render_frames<E: Send>(
        &self,
        animation: &Animation,
        form: Form,
        numbers: impl Iterator<Item = i64> + Clone + Send,
        done: impl Fn(DrawnFrame<'_>) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let (sky, read) = &self.source;
        let source = read.read().filter(|_| sky.as_ref() == animation.sky());
        let frames = Curved::new(animation, &self.angles, source);
        let sharing = Sharing::fastest(numbers.clone().count() as u64, u64::MAX);
        batch::draw(&frames, form, numbers, sharing, |_| true, done)
    }
}
