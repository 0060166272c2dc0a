//! Guards against memory that is allocated for each frame: once warm, no frame allocates.
#![expect(unsafe_code, reason = "an allocator that counts")]

use core::alloc::{GlobalAlloc, Layout};
use core::sync::atomic::{AtomicU64, Ordering};
use std::alloc::System;

use darkness::cli::FrameRange;
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::render::Form;
use darkness::render::batch::{self, Curved, DrawnFrame, Sharing};
use darkness::render::frame::{Threads, Workspace};
use darkness::scene::{Animation, Scene, View};

struct Counting;

static COUNT: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the same contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the same contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Returns how many allocations `work` makes.
fn count(work: impl FnOnce()) -> u64 {
    let before = COUNT.load(Ordering::Relaxed);
    work();
    COUNT.load(Ordering::Relaxed) - before
}

pub(crate) fn frames_take_no_memory_once_warm() {
    assert_eq!(count(|| drop(std::hint::black_box(vec![1_u8; 100]))), 1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    pool.unwrap().install(|| {
        for name in ["classic", "edge-on", "photon-ring"] {
            let scene = Scene::builtin(name).unwrap().with_size(640, 360).unwrap();
            let view = View::new(&scene);
            let curves = Isoradials::new(&CurveSpec::new(&scene, &view, scene.tolerance()), &Exact);
            let mut pixels = vec![0_u8; 640 * 360];
            let mut workspace = Workspace::default();
            let mut draw = |frames| {
                for _ in 0..frames {
                    for smooth in [false, true] {
                        let drawn =
                            workspace.draw(&view, &curves, smooth, Threads::All, &mut pixels, 640);
                        drawn.unwrap();
                    }
                }
            };
            draw(1);
            // A thread that had no work so far is warm after its first band.
            let least = (0..5).map(|_| count(|| draw(50))).min();
            assert_eq!(least, Some(0), "{name}");
        }
        // Frames of one radius: the allocations of a batch do not grow with their number.
        let orbit = Animation::load("orbit")
            .unwrap()
            .with_size(640, 360)
            .unwrap();
        let draw = |frames: FrameRange| {
            let curved = Curved::new(&orbit, &Exact);
            let done = |drawn: DrawnFrame<'_>| drawn.pixels.map(|_| ());
            let sharing = Sharing::fastest(frames.count(), u64::MAX);
            batch::draw(&curved, Form::Grey8, frames.iter(), sharing, |_| true, done).unwrap();
        };
        draw(FrameRange::up_to(20));
        let (some, all) = (
            count(|| draw(FrameRange::up_to(20))),
            count(|| draw(FrameRange::up_to(240))),
        );
        assert!(all <= some + 10, "{some} for 20 frames, {all} for 240");
    });
}
