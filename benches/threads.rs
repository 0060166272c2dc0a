//! One thread and two: a frame's bands shared out, and a batch's frames.
//!
//! `cargo bench --bench threads`

mod interleaved;

use darkness::cli::FrameRange;
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::render::Form;
use darkness::render::batch::{self, Curved, DrawnFrame, Sharing};
use darkness::render::frame::{Threads, Workspace};
use darkness::scene::{Animation, Scene, View, builtins};
use interleaved::{Contender, compare};
use rayon::prelude::*;

/// How many frames are drawn at once.
const FRAMES: u32 = 24;

/// As much work as a frame, without any memory.
fn arithmetic(seed: usize) -> f64 {
    let mut x = seed as f64 + 0.5;
    for _ in 0..100_000 {
        x = (x * x + 1.0).sqrt() - 0.5 * x;
    }
    x
}

fn main() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (Ok(one), Ok(two)) = (pool(1), pool(2)) else {
        return;
    };
    // What two threads of this machine are worth, when nothing but registers is shared out.
    let work = || (0..FRAMES as usize).into_par_iter().map(arithmetic).sum();
    compare(
        "arithmetic alone, time per share",
        FRAMES as usize,
        51,
        &mut [
            Contender {
                name: "one thread",
                run: Box::new(|| one.install(work)),
            },
            Contender {
                name: "two threads",
                run: Box::new(|| two.install(work)),
            },
        ],
    );
    for (width, height) in [(1920, 1080), (7680, 4320)] {
        let scene = Scene::builtin("classic").and_then(|scene| scene.with_size(width, height));
        let Ok(scene) = scene else {
            return;
        };
        let view = View::new(&scene);
        let curves = Isoradials::new(&CurveSpec::new(&scene, &view, scene.tolerance()), &Exact);
        let pixels = width as usize * height as usize;
        for antialias in [false, true] {
            let memory = || (vec![0_u8; pixels], Workspace::default());
            let (mut first, mut second) = (memory(), memory());
            let draw = |(frame, workspace): &mut (Vec<u8>, Workspace)| {
                let width = width as usize;
                let drawn = workspace.draw(&view, &curves, antialias, Threads::All, frame, width);
                drawn.map_or(0.0, |()| f64::from(frame[pixels / 2]))
            };
            let edges = if antialias { "smooth" } else { "hard" };
            compare(
                &format!("classic, {width} × {height}, {edges} edges, a frame, time per pixel"),
                pixels,
                51,
                &mut [
                    Contender {
                        name: "one thread",
                        run: Box::new(|| one.install(|| draw(&mut first))),
                    },
                    Contender {
                        name: "two threads",
                        run: Box::new(|| two.install(|| draw(&mut second))),
                    },
                ],
            );
            if width > 1920 {
                continue;
            }
            let text = format!("{}\n[animation]\nframes = {FRAMES}\n", builtins()[0].toml());
            let animation =
                Animation::from_toml(&text).and_then(|still| still.with_antialias(antialias));
            let Ok(animation) = animation else {
                return;
            };
            let (alone, side_by_side) = (
                Curved::new(&animation, &Exact, None),
                Curved::new(&animation, &Exact, None),
            );
            let draw = |frames: &Curved<'_, Exact>| {
                let all = FrameRange::up_to(FRAMES.into());
                let done = |drawn: DrawnFrame<'_>| {
                    drawn.pixels.map(|(frame, _)| {
                        std::hint::black_box(frame);
                    })
                };
                let drawn = batch::draw(
                    frames,
                    Form::Grey8,
                    all.iter(),
                    Sharing::fastest(all.count(), u64::MAX),
                    |_| true,
                    done,
                );
                drawn.map_or(0.0, |()| f64::from(FRAMES))
            };
            compare(
                &format!("the same, {FRAMES} frames, time per frame"),
                FRAMES as usize,
                21,
                &mut [
                    Contender {
                        name: "one thread",
                        run: Box::new(|| one.install(|| draw(&alone))),
                    },
                    Contender {
                        name: "two threads",
                        run: Box::new(|| two.install(|| draw(&side_by_side))),
                    },
                ],
            );
        }
    }
}
