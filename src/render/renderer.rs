//! The renderer: a scene in, its pixels out.

use std::time::Instant;

use image::GrayImage;

use super::batch::{self, Curved, DrawnFrame, Sharing};
use super::error::{RenderError, blank};
use super::frame::{Threads, Workspace};
use super::scene_frame::{FrameReport, SceneFrame};
use crate::isoradial::{CurveSpec, Isoradials};
use crate::orbit::path::SweptAngles;
use crate::scene::{Animation, Scene, View};
use crate::table::{Lookup, Table};

/// Draws scenes.
///
/// A renderer keeps the isoradial curves of the last scene. While the camera's radius and the disk stay the same, the
/// next scene is drawn from them if it shows no more of them, and nothing smaller: only the first frame of a flight
/// around the hole pays for curves. Every edge is right to the scene's tolerance whichever curves it is drawn from.
/// Where no curves can be that accurate (a disk of any width seen through a lens of any length), each pixel's ray is
/// followed by itself; [`FrameReport::ray_by_ray`] tells.
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
            workspace: Workspace::default(),
        }
    }

    /// Returns a scene's picture, drawn on all threads of the current rayon pool.
    ///
    /// # Errors
    /// [`RenderError::Memory`]
    pub fn render(&mut self, scene: &Scene) -> Result<GrayImage, RenderError> {
        let view = View::new(scene);
        let mut pixels = blank(&view)?;
        self.render_into(scene, &mut pixels, view.width() as usize)?;
        // The length is that of the picture.
        Ok(GrayImage::from_raw(view.width(), view.height(), pixels).unwrap_or_default())
    }

    /// Draws a scene's picture into a caller's memory, on all threads of the current rayon pool. Row j begins at byte
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
        let start = Instant::now();
        let view = View::new(scene);
        let spec = CurveSpec::new(scene, &view, scene.tolerance());
        let kept = self.curves.take().filter(|curves| curves.serves(&spec));
        let curves = kept.unwrap_or_else(|| Isoradials::new(&spec, &self.angles));
        let curves = self.curves.insert(curves);
        let frame = SceneFrame {
            scene,
            view: &view,
            curves,
            angles: &self.angles,
            threads: Threads::All,
        };
        let time = start.elapsed();
        let report = frame.draw(&mut self.workspace, pixels, stride)?;
        Ok(FrameReport {
            curves: time,
            ..report
        })
    }
}

impl<A: SweptAngles> Renderer<A> {
    /// Draws frames of an animation, side by side on all threads of the current rayon pool where there are enough. They
    /// are begun in the order of `numbers`. `done` gets each frame as it is finished, in any order and from several
    /// threads at once.
    ///
    /// A frame's bytes depend on the animation, the table and its number alone: not on which other frames are drawn.
    ///
    /// # Errors
    /// The first error that `done` returns. No frame is begun after it.
    pub fn render_frames<E: Send>(
        &self,
        animation: &Animation,
        numbers: impl ExactSizeIterator<Item = u32> + Send,
        done: impl Fn(DrawnFrame<'_>) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let frames = Curved::new(animation, &self.angles);
        let sharing = Sharing::fastest(numbers.len() as u64, u64::MAX);
        batch::draw(&frames, numbers, sharing, |_| true, done)
    }
}
