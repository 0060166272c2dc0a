//! Draws the frames of an [`Animation`](crate::scene::Animation), many of them side by side. Frames of one camera
//! radius share their curves.
//!
//! A frame's bytes depend only on the animation, the table and the frame's number. They do not depend on which other
//! frames are drawn, nor on the thread.

mod curved;
mod ray_by_ray;
mod spans;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::frame::Workspace;
use super::planes::{Form, FrameMemory, Pixels};
use super::{FrameReport, RenderError};
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
    /// Draws frame `number` into `memory`, in its form, on this thread alone or on all threads of the current rayon
    /// pool.
    ///
    /// # Errors
    /// [`FrameError`] if there is no such frame, or if it cannot be drawn.
    fn draw(
        &self,
        number: i64,
        on_all_threads: bool,
        workspace: &mut Workspace,
        memory: &mut FrameMemory,
    ) -> Result<FrameReport, FrameError>;
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
pub struct DrawnFrame<'a> {
    /// Its number in the animation.
    pub number: i64,
    /// The number of frames that were begun before it.
    pub place: u64,
    /// Its pixels, row by row from the top.
    pub pixels: Result<(Pixels<'a>, FrameReport), FrameError>,
}

/// Draws frames in a form, on all threads of the current rayon pool. Frames are begun in order. Each is passed to
/// `done` as soon as it is finished, so in any order and from several threads at once. Frames that are not `wanted` are
/// skipped.
///
/// It takes the memory of one frame, or of one a thread if they are drawn side by side.
///
/// # Errors
/// Returns the first error of `done`. No more frames are begun after it.
pub fn draw<E: Send>(
    frames: &(impl Frames + ?Sized),
    form: Form,
    numbers: impl Iterator<Item = i64> + Send,
    sharing: Sharing,
    wanted: impl Fn(i64) -> bool + Sync,
    done: impl Fn(DrawnFrame<'_>) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let side_by_side = sharing == Sharing::SideBySide;
    let numbers = Mutex::new(numbers.zip(0..));
    let failed = AtomicBool::new(false);
    let worker = || {
        let (mut workspace, mut memory) = (Workspace::default(), FrameMemory::new(form));
        while !failed.load(Ordering::Relaxed) {
            let Some((number, place)) = locked(&numbers).next() else {
                break;
            };
            if !wanted(number) {
                continue;
            }
            let effort = frames.draw(number, !side_by_side, &mut workspace, &mut memory);
            let drawn = DrawnFrame {
                number,
                place,
                pixels: effort.map(|effort| (memory.pixels(), effort)),
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

/// Locks. What is behind a lock is whole at every moment here, also where a thread panicked.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
