//! Frames against the least that a frame costs: filling its bytes. One thread, curves given.
//!
//! `cargo bench --bench fill`

mod interleaved;

use darkness::isoradial::{Isoradials, Sight};
use darkness::orbit::exact::Exact;
use darkness::render::{coverage, mask};
use darkness::scene::{Scene, View, builtins};
use darkness::table::{Spec, generate};
use interleaved::{Contender, compare};

fn main() {
    let Some(table) = Spec::named("standard").and_then(|spec| generate(&spec, &|_, _| ())) else {
        return;
    };
    let lookup = table.lookup();
    let Ok(one_thread) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else {
        return;
    };
    one_thread.install(|| {
        for builtin in builtins() {
            let Some(scene) = Scene::builtin(builtin.name()) else {
                continue;
            };
            let view = View::new(&scene);
            let sight = Sight::new(&scene, &view, scene.tolerance());
            let curves = Isoradials::new(&sight, &lookup);
            let pixels = view.width() as usize * view.height() as usize;
            let mut bytes = vec![0_u8; pixels];
            let mut frame = vec![0_u8; pixels];
            let mut smooth = vec![0_u8; pixels];
            compare(
                &format!("{}, time per pixel", builtin.name()),
                pixels,
                51,
                &mut [
                    Contender {
                        name: "filling the same bytes",
                        run: Box::new(|| {
                            std::hint::black_box(&mut bytes).fill(0);
                            f64::from(bytes[0])
                        }),
                    },
                    Contender {
                        name: "hard edges",
                        run: Box::new(|| {
                            let width = view.width() as usize;
                            let drawn = mask::render_into(&view, &curves, &mut frame, width);
                            drawn.map_or(0.0, |()| f64::from(frame[pixels / 2]))
                        }),
                    },
                    Contender {
                        name: "smooth edges",
                        run: Box::new(|| {
                            let width = view.width() as usize;
                            let drawn = coverage::render_into(&view, &curves, &mut smooth, width);
                            drawn.map_or(0.0, |()| f64::from(smooth[pixels / 2]))
                        }),
                    },
                    Contender {
                        name: "the curves from exact",
                        run: Box::new(|| Isoradials::new(&sight, &Exact).nodes() as f64),
                    },
                    Contender {
                        name: "the curves",
                        run: Box::new(|| Isoradials::new(&sight, &lookup).nodes() as f64),
                    },
                ],
            );
        }
    });
}
