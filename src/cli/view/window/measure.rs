//! How fast this machine draws: frames a second, and how late a movement is seen.

use std::fmt::Display;
use std::time::{Duration, Instant};

use crate::scene::ImageSize;

/// Frames that are drawn before the clock starts: tables are read, memory is touched.
const UNMEASURED: u32 = 5;

/// Times of frames in which the camera turns.
#[derive(Debug)]
pub(super) struct Measure {
    frames: u32,
    /// When each frame's movement was made.
    moved: Vec<Instant>,
    /// From each movement to the time when the display had its picture.
    late: Vec<Duration>,
}

impl Measure {
    /// Measures so many frames.
    pub(super) fn new(frames: u32) -> Self {
        Self {
            frames,
            moved: Vec::new(),
            late: Vec::new(),
        }
    }

    /// Takes the time of a movement.
    pub(super) fn begin(&mut self) {
        self.moved.push(Instant::now());
    }

    /// Takes the time when the display has taken the picture of the movement before the last.
    pub(super) fn shown(&mut self) {
        if let [.., before, _] = self.moved[..] {
            self.late.push(before.elapsed());
        }
    }

    /// Whether there are enough frames. One more is drawn, by which the last one's time is known.
    pub(super) fn is_done(&self) -> bool {
        self.late.len() >= (self.frames + UNMEASURED) as usize
    }

    /// Returns a line that tells what was measured.
    pub(super) fn report(&self, scene: &dyn Display, size: ImageSize, threads: usize) -> String {
        let unmeasured = UNMEASURED as usize;
        let (Some(first), Some(last), Some(late)) = (
            self.moved.get(unmeasured),
            self.moved.last(),
            self.late.get(unmeasured..).filter(|late| !late.is_empty()),
        ) else {
            return format!("{scene}: the window was closed before anything was measured\n");
        };
        let count = late.len();
        let time = (*last - *first).as_secs_f64() / count as f64;
        let mut late = late.to_vec();
        late.sort_unstable();
        let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
        format!(
            "{scene}, {} × {}, {threads} threads: {count} frames, {:.1} frames/s; a movement is seen after {:.1} ms \
             (median), {:.1} ms (95 of 100)\n",
            size.width,
            size.height,
            1.0 / time,
            milliseconds(late[count / 2]),
            milliseconds(late[count * 95 / 100]),
        )
    }
}
