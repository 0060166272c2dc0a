//! A 1920 × 1080 mask frame on one thread: isoradial curves from the open table against plain RK4, every pixel's ray
//! stepped through the orbit equation (h = 0.02 in φ, its steps ended exactly at each crossing of the disk's plane).
//!
//! `cargo bench --bench frame`

mod interleaved;

use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::{FixedStep, Scheme};
use darkness::render::mask::{WHITE, render, render_every_pixel};
use darkness::render::{RenderError, pixelwise};
use darkness::scene::{Scene, View, builtins};
use darkness::table::{Spec, Table};
use interleaved::{Contender, compare};

/// The frame, or none where there is no memory for it.
fn drawn(frame: Result<Vec<u8>, RenderError>) -> Vec<u8> {
    frame.unwrap_or_default()
}

fn white(pixels: &[u8]) -> f64 {
    pixels.iter().map(|&pixel| u64::from(pixel)).sum::<u64>() as f64
}

/// The baseline's frame.
fn rk4_frame(scene: &Scene, view: &View) -> Vec<u8> {
    let method = FixedStep::new(Scheme::Rk4, 0.02);
    let mut pixels = Vec::with_capacity(view.width() as usize * view.height() as usize);
    for j in 0..view.height() {
        for i in 0..view.width() {
            let hit = pixelwise::sees_in_steps(scene, view, &method, (i, j));
            pixels.push(if hit { WHITE } else { 0 });
        }
    }
    pixels
}

fn main() {
    let Ok(table) = Table::generate(&Spec::standard()) else {
        return;
    };
    let lookup = table.lookup();
    let Ok(one_thread) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else {
        return;
    };
    one_thread.install(|| {
        for builtin in builtins() {
            let Ok(scene) = Scene::builtin(builtin.name()) else {
                continue;
            };
            let view = View::new(&scene);
            let pixels = view.width() as usize * view.height() as usize;
            let spec = CurveSpec::new(&scene, &view, scene.tolerance());
            let curves = Isoradials::new(&spec, &lookup);
            println!(
                "{}: {} orders, {} bytes of curves, wrong pixels of RK4: {}, of the outline: {}",
                builtin.name(),
                curves.orders().len(),
                curves.bytes(),
                drawn(render_every_pixel(&view, &curves))
                    .iter()
                    .zip(rk4_frame(&scene, &view))
                    .filter(|(a, b)| *a != b)
                    .count(),
                drawn(render_every_pixel(&view, &curves))
                    .iter()
                    .zip(drawn(render(&view, &curves)))
                    .filter(|(a, b)| *a != b)
                    .count(),
            );
            let mut bytes = vec![0_u8; pixels];
            compare(
                &format!("{}, time per pixel", builtin.name()),
                pixels,
                if builtin.name() == "classic" { 5 } else { 1 },
                &mut [
                    Contender {
                        name: "RK4, h = 0.02, every pixel",
                        run: Box::new(|| white(&rk4_frame(&scene, &view))),
                    },
                    Contender {
                        name: "curves and frame",
                        run: Box::new(|| {
                            white(&drawn(render(&view, &Isoradials::new(&spec, &lookup))))
                        }),
                    },
                    Contender {
                        name: "the frame, curves given",
                        run: Box::new(|| white(&drawn(render(&view, &curves)))),
                    },
                    Contender {
                        name: "every pixel by itself, curves given",
                        run: Box::new(|| white(&drawn(render_every_pixel(&view, &curves)))),
                    },
                    Contender {
                        name: "the curves alone",
                        run: Box::new(|| Isoradials::new(&spec, &lookup).nodes() as f64),
                    },
                    Contender {
                        name: "filling the same bytes",
                        run: Box::new(|| {
                            std::hint::black_box(&mut bytes).fill(WHITE);
                            f64::from(bytes[0])
                        }),
                    },
                ],
            );
        }
        exact_frame(&lookup);
    });
}

/// Every pixel of a small classic frame through the exact method and through the table, without curves.
fn exact_frame(lookup: &darkness::table::Lookup<'_>) {
    let Ok(scene) = Scene::builtin("classic").and_then(|scene| scene.with_size(480, 270)) else {
        return;
    };
    let view = View::new(&scene);
    let count = |pixels: Result<Vec<u8>, _>| pixels.map_or(0.0, |pixels: Vec<u8>| white(&pixels));
    compare(
        "classic at 480 × 270, pixel by pixel",
        480 * 270,
        5,
        &mut [
            Contender {
                name: "exact",
                run: Box::new(|| {
                    count(pixelwise::render(&scene, &view, &Exact, &|| ()).map_err(|_| ()))
                }),
            },
            Contender {
                name: "standard table",
                run: Box::new(|| {
                    count(pixelwise::render(&scene, &view, lookup, &|| ()).map_err(|_| ()))
                }),
            },
        ],
    );
}
