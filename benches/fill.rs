//! Frames against the least that a frame costs: filling its bytes. One thread, curves given.
//!
//! `cargo bench --bench fill`

mod interleaved;

use core::cell::RefCell;

use darkness::Renderer;
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::render::frame::{Threads, Workspace};
use darkness::render::{Form, FrameMemory};
use darkness::scene::{Camera, Projection, Region, Scene, View, builtins};
use darkness::table::{Lookup, Spec, Table};
use interleaved::{Contender, compare};

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
            if let Ok(scene) = Scene::builtin(builtin.name()) {
                frames_of(builtin.name(), &scene, &lookup, 51);
            }
        }
        // Sixteen times the pixels, four times the edges.
        let large = Scene::builtin("classic").and_then(|scene| scene.with_size(7680, 4320));
        if let Ok(scene) = large {
            frames_of("classic, 7680 × 4320", &scene, &lookup, 21);
        }
        projections(&table);
        crop_of_a_large_picture(&table);
    });
}

/// Whole frames of `classic` with smooth edges: a flat one, the whole sphere, a dome. A renderer keeps the curves.
fn projections(table: &Table) {
    let Ok(classic) = Scene::builtin("classic") else {
        return;
    };
    let scene = |projection, fov_degrees, width, height| {
        let camera = Camera {
            projection,
            fov_degrees,
            ..*classic.camera()
        };
        let scene = classic.clone().with_size(width, height);
        scene.and_then(|scene| scene.with_camera(camera))
    };
    let (Ok(sphere), Ok(dome)) = (
        scene(Projection::Equirectangular, 180.0, 4096, 2048),
        scene(Projection::Fisheye, 180.0, 4096, 4096),
    ) else {
        return;
    };
    let draw = |scene: Scene| {
        let mut renderer = Renderer::new(table);
        let mut memory = FrameMemory::new(Form::Grey8);
        move || {
            let drawn = renderer.draw(&scene, &mut memory);
            drawn.map_or(0.0, |report| report.error.total())
        }
    };
    compare(
        "whole frames in each projection, curves given",
        1,
        51,
        &mut [
            Contender {
                name: "perspective, 1920 × 1080",
                run: Box::new(draw(classic.clone())),
            },
            Contender {
                name: "equirectangular, 4096 × 2048",
                run: Box::new(draw(sphere)),
            },
            Contender {
                name: "fisheye of 180°, 4096 × 4096",
                run: Box::new(draw(dome)),
            },
        ],
    );
}

/// A part of a picture of 65,536 × 65,536 pixels, on the disk's edge. A renderer keeps the curves, and a light's map.
fn crop_of_a_large_picture(table: &Table) {
    let part = Region {
        left: 12_768,
        top: 17_920,
        width: 64,
        height: 64,
    };
    let scene = |name| {
        let scene = Scene::builtin(name).and_then(|scene| scene.with_size(65_536, 65_536));
        scene.and_then(|scene| scene.with_crop(Some(part)))
    };
    let (Ok(mask), Ok(lit)) = (scene("classic"), scene("lit")) else {
        return;
    };
    let hard_mask = mask.clone().with_antialias(false);
    let draw = |scene: Scene, form: Form| {
        let (mut renderer, mut memory) = (Renderer::new(table), FrameMemory::new(form));
        move || {
            let drawn = renderer.draw(&scene, &mut memory);
            drawn.map_or(0.0, |report| report.error.total())
        }
    };
    compare(
        "64 × 64 pixels of 65,536 × 65,536, curves given",
        1,
        51,
        &mut [
            Contender {
                name: "hard edges",
                run: Box::new(draw(hard_mask, Form::Grey8)),
            },
            Contender {
                name: "smooth edges",
                run: Box::new(draw(mask, Form::Grey8)),
            },
            Contender {
                name: "colour",
                run: Box::new(draw(lit, Form::Rgb8)),
            },
        ],
    );
}

fn frames_of(name: &str, scene: &Scene, lookup: &Lookup<'_>, rounds: usize) {
    let view = View::new(scene);
    let spec = CurveSpec::new(scene, &view, scene.tolerance());
    let curves = Isoradials::new(&spec, lookup);
    let width = view.width() as usize;
    let pixels = width * view.height() as usize;
    // One buffer, which is as near in the caches for one contender as for another.
    let buffer = RefCell::new(vec![0_u8; pixels]);
    // And one for each: none is near when its turn comes.
    let apart = [(); 3].map(|()| RefCell::new(vec![0_u8; pixels]));
    let fill = |buffer: &RefCell<Vec<u8>>| {
        let bytes = &mut *buffer.borrow_mut();
        std::hint::black_box(&mut *bytes).fill(0);
        f64::from(bytes[0])
    };
    let workspace = RefCell::new(Workspace::default());
    let draw = |buffer: &RefCell<Vec<u8>>, smooth: bool| {
        let bytes = &mut *buffer.borrow_mut();
        let mut workspace = workspace.borrow_mut();
        let drawn = workspace.draw(&view, &curves, smooth, Threads::This, bytes, width);
        drawn.map_or(0.0, |()| f64::from(bytes[pixels / 2]))
    };
    let hard = |buffer: &RefCell<Vec<u8>>| draw(buffer, false);
    let smooth = |buffer: &RefCell<Vec<u8>>| draw(buffer, true);
    compare(
        &format!("{name}, time per pixel"),
        pixels,
        rounds,
        &mut [
            Contender {
                name: "filling the same buffer",
                run: Box::new(|| fill(&buffer)),
            },
            Contender {
                name: "hard edges",
                run: Box::new(|| hard(&buffer)),
            },
            Contender {
                name: "smooth edges",
                run: Box::new(|| smooth(&buffer)),
            },
            Contender {
                name: "the curves from exact",
                run: Box::new(|| Isoradials::new(&spec, &Exact).nodes() as f64),
            },
            Contender {
                name: "the curves",
                run: Box::new(|| Isoradials::new(&spec, lookup).nodes() as f64),
            },
        ],
    );
    compare(
        "each into a buffer of its own",
        pixels,
        rounds,
        &mut [
            Contender {
                name: "filling a buffer",
                run: Box::new(|| fill(&apart[0])),
            },
            Contender {
                name: "hard edges",
                run: Box::new(|| hard(&apart[1])),
            },
            Contender {
                name: "smooth edges",
                run: Box::new(|| smooth(&apart[2])),
            },
        ],
    );
}
