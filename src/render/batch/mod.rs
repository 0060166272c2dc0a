//! The frames of an [`Animation`](crate::scene::Animation): many of them side by side, with curves shared where the camera's radius stays.
//!
//! A frame's bytes depend on the animation, the table and the frame's number alone: not on which other frames are drawn,
//! nor on where.

mod curved;
mod ray_by_ray;
mod spans;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::frame::Workspace;
use super::{FrameReport, RenderError};
use crate::scene::SceneError;
pub use curved::Curved;
pub use ray_by_ray::RayByRay;

/// How the threads of the current rayon pool share frames out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// A frame on each thread.
    SideBySide,
    /// One frame after the other, each on all threads.
    OneByOne,
}

impl Sharing {
    /// As many frames as there are threads, times this, are drawn side by side: the last frames of fewer would leave threads
    /// without work.
    const MANY: u64 = 4;

    /// What is fastest for `count` frames, of which at most so many can be held at a time.
    pub fn fastest(count: u64, at_a_time: u64) -> Self {
        let threads = rayon::current_num_threads() as u64;
        if count >= Self::MANY * threads && threads <= at_a_time {
            Self::SideBySide
        } else {
            Self::OneByOne
        }
    }
}

/// What draws any frame of an animation.
pub trait Frames: Sync {
    /// Draws frame `number` into `pixels`, row by row from the top, on this thread alone or on all of the current rayon
    /// pool.
    ///
    /// # Errors
    /// [`FrameError`]
    fn draw(
        &self,
        number: u32,
        on_all_threads: bool,
        workspace: &mut Workspace,
        pixels: &mut Vec<u8>,
    ) -> Result<FrameReport, FrameError>;
}

/// Why a frame could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// The scene has no such frame.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The frame itself.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A frame that was drawn, or could not be.
#[derive(Debug)]
pub struct DrawnFrame<'a> {
    /// Its number in the animation.
    pub number: u32,
    /// How many frames were begun before it.
    pub place: u64,
    /// Its pixels, row by row from the top.
    pub pixels: Result<(&'a [u8], FrameReport), FrameError>,
}

/// Draws frames on all threads of the current rayon pool. They are begun in order; each is handed to `done` when it
/// is finished, in any order and from several threads at once. Those that are not `wanted` are passed over.
///
/// The memory is that of a frame, side by side of one for each thread.
///
/// # Errors
/// What `done` returns; no more frames are begun then.
pub fn draw<E: Send>(
    frames: &impl Frames,
    numbers: impl Iterator<Item = u32> + Send,
    sharing: Sharing,
    wanted: impl Fn(u32) -> bool + Sync,
    done: impl Fn(DrawnFrame<'_>) -> Result<(), E> + Sync,
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
            let drawn = DrawnFrame {
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
        // One loop for each thread, on that thread: none is ever run from within another's wait.
        rayon::broadcast(|_| worker()).into_iter().collect()
    } else {
        worker()
    }
}

/// Locks. What is behind a lock is whole at every moment here, also where a thread panicked.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
