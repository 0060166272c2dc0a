//! Draws the frames of an [`Animation`](crate::scene::Animation), many of them side by side. Frames of one camera
//! radius share their curves.
//!
//! A frame's bytes depend only on the animation, the table and the frame's number. They do not depend on which other
//! frames are drawn, nor on the thread.

mod curved;
mod ray_by_ray;
mod spans;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::RenderError;
use super::frame::Workspace;
use super::locked;
use crate::isoradial::EdgeError;
use crate::scene::SceneError;
pub use curved::Curved;
pub use ray_by_ray::RayByRay;

/// How the threads of the current rayon pool divide the frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// Each thread draws frames of its own.
    SideBySide,
    /// All threads draw one frame after the other.
    OneByOne,
}

impl Sharing {
    /// The fewest frames per thread that are drawn side by side. With fewer, threads would idle during the last frames.
    const MANY: u64 = 4;

    /// Returns the fastest way to draw `count` frames if at most `at_a_time` of them fit into memory together.
    pub fn fastest(count: u64, at_a_time: u64) -> Self {
        let threads = rayon::current_num_threads() as u64;
        if count >= Self::MANY * threads && threads <= at_a_time {
            Self::SideBySide
        } else {
            Self::OneByOne
        }
    }
}

/// Draws any frame of an animation.
pub trait Frames: Sync {
    /// Draws frame `number` into `pixels`, row by row from the top, on this thread alone or on all threads of the
    /// current rayon pool.
    ///
    /// # Errors
    /// [`FrameError`] if there is no such frame, or if it cannot be drawn.
    fn draw(
        &self,
        number: u32,
        on_all_threads: bool,
        workspace: &mut Workspace,
        pixels: &mut Vec<u8>,
    ) -> Result<Effort, FrameError>;
}

/// The time that a frame took, and its error.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effort {
    /// The time for curves that no earlier frame had built.
    pub curves: Duration,
    /// The time for the pixels.
    pub pixels: Duration,
    /// The bound of an edge's error.
    pub error: EdgeError,
    /// Whether each pixel's ray was followed by itself, because the curves are less accurate than the angles.
    pub ray_by_ray: bool,
}

/// Why a frame could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// The animation has no such frame, or it is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The frame could not be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A frame of a batch: drawn, or failed.
#[derive(Debug)]
pub struct Drawn<'a> {
    /// Its number in the animation.
    pub number: u32,
    /// The number of frames that were begun before it.
    pub place: u64,
    /// Its pixels, row by row from the top, and what they took.
    pub pixels: Result<(&'a [u8], Effort), FrameError>,
}

/// Draws frames on all threads of the current rayon pool. Frames are begun in order. Each is passed to `done` as soon
/// as it is finished, so in any order and from several threads at once. Frames that are not `wanted` are skipped.
///
/// It takes the memory of one frame, or of one a thread if they are drawn side by side.
///
/// # Errors
/// Returns the first error of `done`. No more frames are begun after it.
pub fn draw<E: Send>(
    frames: &impl Frames,
    numbers: impl Iterator<Item = u32> + Send,
    sharing: Sharing,
    wanted: impl Fn(u32) -> bool + Sync,
    done: impl Fn(Drawn<'_>) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let side_by_side = sharing == Sharing::SideBySide;
    let numbers = Mutex::new(numbers.zip(0..));
    let failed = AtomicBool::new(false);
    let worker = || {
        let (mut workspace, mut pixels) = (Workspace::default(), Vec::new());
        while !failed.load(Ordering::Relaxed) {
            let Some((number, place)) = locked(&numbers).next() else {
                break;
            };
            if !wanted(number) {
                continue;
            }
            let effort = frames.draw(number, !side_by_side, &mut workspace, &mut pixels);
            let drawn = Drawn {
                number,
                place,
                pixels: effort.map(|effort| (pixels.as_slice(), effort)),
            };
            if let Err(error) = done(drawn) {
                failed.store(true, Ordering::Relaxed);
                return Err(error);
            }
        }
        Ok(())
    };
    if side_by_side {
        // Each thread runs one loop. A spawned task could be run from within another frame's wait.
        rayon::broadcast(|_| worker()).into_iter().collect()
    } else {
        worker()
    }
}
