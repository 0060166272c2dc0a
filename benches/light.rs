//! Frames with light: `lit` at 1920 × 1080 on one thread, in colour and as data, against masks, against filling the
//! same memory, and against RK4 steps for each pixel with the same shading; two threads; the map of a camera radius.
//!
//! `cargo bench --bench light`

mod interleaved;

use core::cell::RefCell;
use core::time::Duration;

use darkness::Renderer;
use darkness::chart::interleaved::rounds;
use darkness::isoradial::{CurveSpec, Isoradials, RadiusMap};
use darkness::light::{DisplayTransform, Palette, Radiance, RadianceTable, Sight, flux};
use darkness::orbit::integrate::{FixedStep, Scheme};
use darkness::render::{Form, FrameMemory, pixelwise};
use darkness::scene::{Layer, LayerSet, Scene, View};
use darkness::table::{Lookup, Spec, Table};
use interleaved::{Contender, compare};
use rayon::ThreadPool;

/// RK4 follows one pixel in so many. No divisor of the picture's width, so that the pixels lie in all columns.
const ONE_OF: usize = 49;

/// A renderer, and the memory of its frames in one form.
struct Drawing<'a> {
    pool: &'a ThreadPool,
    scene: &'a Scene,
    state: RefCell<(Renderer<Lookup<'a>>, FrameMemory)>,
}

impl<'a> Drawing<'a> {
    fn new(pool: &'a ThreadPool, table: &'a Table, scene: &'a Scene, form: Form) -> Self {
        let state = (Renderer::new(table), FrameMemory::new(form));
        Self {
            pool,
            scene,
            state: RefCell::new(state),
        }
    }

    /// Draws a frame; not a number where that fails.
    fn draw(&self) -> f64 {
        let (renderer, memory) = &mut *self.state.borrow_mut();
        let drawn = self.pool.install(|| renderer.draw(self.scene, memory));
        drawn.map_or(f64::NAN, |_| 1.0)
    }

    fn contender(&'a self, name: &'a str) -> Contender<'a> {
        Contender {
            name,
            run: Box::new(|| self.draw()),
        }
    }
}

fn main() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (Ok(one), Ok(two)) = (pool(1), pool(2)) else {
        return;
    };
    let Ok(table) = Table::generate(&Spec::standard()) else {
        return;
    };
    let sized = |width, height| {
        let scene = Scene::builtin("lit").and_then(|scene| scene.with_size(width, height));
        scene.ok()
    };
    let (Some(scene), Some(large)) = (sized(1920, 1080), sized(7680, 4320)) else {
        return;
    };
    let data = [
        Layer::Radius,
        Layer::Azimuth,
        Layer::Redshift,
        Layer::EmissionCosine,
    ];
    let data = data.into_iter().fold(LayerSet::default(), LayerSet::with);
    frames(&one, &table, &scene, data);
    rk4(&one, &table, &scene, data);
    parallel(&one, &two, &table, &scene, data);
    sizes(&one, &table, &scene, &large);
    maps(&one, &table, &scene);
}

/// The number of a picture's pixels.
fn pixels(scene: &Scene) -> usize {
    scene.image().width as usize * scene.image().height as usize
}

/// Frames of one thread against filling memory.
fn frames(one: &ThreadPool, table: &Table, scene: &Scene, data: LayerSet) {
    let pixels = pixels(scene);
    let drawing = |form| Drawing::new(one, table, scene, form);
    let hard = scene.clone().with_antialias(false);
    let mask_hard = Drawing::new(one, table, &hard, Form::Grey8);
    let (colour, layers, mask) = (
        drawing(Form::Rgb8),
        drawing(Form::Layers(data)),
        drawing(Form::Grey8),
    );
    let mut buffer = vec![0_u8; 3 * pixels];
    let mut floats = vec![0.0_f32; 4 * pixels];
    compare(
        "lit, 1920 × 1080, one thread, time per pixel and frame",
        pixels,
        51,
        &mut [
            Contender {
                name: "filling 3 bytes a pixel (6.2 MB)",
                run: Box::new(|| {
                    std::hint::black_box(&mut buffer).fill(1);
                    f64::from(buffer[0])
                }),
            },
            Contender {
                name: "filling 4 floats a pixel (33 MB)",
                run: Box::new(|| {
                    std::hint::black_box(&mut floats).fill(1.0);
                    f64::from(floats[0])
                }),
            },
            colour.contender("colour, 8 bits"),
            layers.contender("four layers"),
            mask.contender("mask, smooth edges"),
            mask_hard.contender("mask, hard edges"),
        ],
    );
}

/// The amplitude of what a ray sees, 0 where there is no disk.
fn amplitude(sight: Option<Sight>) -> f64 {
    sight.map_or(0.0, |sight| {
        sight.redshift * sight.redshift * flux::signed_root(sight.u)
    })
}

/// RK4 with the same shading for one of [`ONE_OF`] pixels, its times multiplied by that, against whole frames.
fn rk4(one: &ThreadPool, table: &Table, scene: &Scene, data: LayerSet) {
    let Some(light) = scene.light() else {
        return;
    };
    let view = View::new(scene);
    let display = DisplayTransform::new(scene.exposure(), scene.tone());
    let palette = Palette::new(&RadianceTable::new(&Radiance::new(light)), &display);
    let method = FixedStep::new(Scheme::Rk4, 0.02);
    let width = scene.image().width as usize;
    let sights = || {
        let sampled = (0..pixels(scene)).step_by(ONE_OF);
        sampled.map(|k| {
            let place = ((k % width) as u32, (k / width) as u32);
            pixelwise::sight_in_steps(scene, &view, &method, place)
        })
    };
    let colour = Drawing::new(one, table, scene, Form::Rgb8);
    let layers = Drawing::new(one, table, scene, Form::Layers(data));
    let times = rounds(
        &mut [
            Contender {
                name: "",
                run: Box::new(|| {
                    let codes = sights().map(|sight| palette.rgb8(amplitude(sight) as f32)[0]);
                    codes.map(f64::from).sum()
                }),
            },
            Contender {
                name: "",
                run: Box::new(|| {
                    let values = |sight: Sight| {
                        1.0 / sight.u + sight.azimuth + sight.redshift + sight.emission_cosine
                    };
                    sights().flatten().map(values).sum()
                }),
            },
            colour.contender(""),
            layers.contender(""),
        ],
        21,
        (Duration::ZERO, Duration::MAX),
        &mut || (),
    );
    println!(
        "RK4, h = 0.02, with the same shading, times of one pixel in {ONE_OF} multiplied by {ONE_OF}"
    );
    for (name, steps, frame) in [("colour", 0, 2), ("four layers", 1, 3)] {
        println!(
            "  {name}: {:.2} s against {:.2} ms, {:.0} × as fast",
            times.median(steps) * ONE_OF as f64,
            times.median(frame) * 1e3,
            times.ratio(frame, steps) * ONE_OF as f64
        );
    }
}

/// One thread and two.
fn parallel(one: &ThreadPool, two: &ThreadPool, table: &Table, scene: &Scene, data: LayerSet) {
    for (title, form) in [
        ("colour on one thread and on two", Form::Rgb8),
        ("four layers on one thread and on two", Form::Layers(data)),
    ] {
        let [alone, both] = [one, two].map(|pool| Drawing::new(pool, table, scene, form));
        compare(
            title,
            pixels(scene),
            51,
            &mut [alone.contender("one thread"), both.contender("two threads")],
        );
    }
}

/// A frame of 1920 × 1080 and one of 7680 × 4320.
fn sizes(one: &ThreadPool, table: &Table, scene: &Scene, large: &Scene) {
    let [small, large] = [scene, large].map(|scene| Drawing::new(one, table, scene, Form::Rgb8));
    compare(
        "colour at 7680 × 4320 against 1920 × 1080, time per frame",
        1,
        11,
        &mut [
            large.contender("7680 × 4320"),
            small.contender("1920 × 1080"),
        ],
    );
}

/// The curves and the map of a new camera radius.
fn maps(one: &ThreadPool, table: &Table, scene: &Scene) {
    let lookup = table.lookup();
    let spec = CurveSpec::new(scene, &View::new(scene), scene.tolerance());
    let curves = Isoradials::new(&spec, &lookup);
    let map = RadiusMap::new(&curves, &lookup);
    println!(
        "the map: {} nodes, {} bytes, relative error {:.1e}",
        map.nodes(),
        map.bytes(),
        map.error()
    );
    let nodes = || RadiusMap::new(&curves, &lookup).nodes() as f64;
    compare(
        "a new camera radius, one thread",
        1,
        51,
        &mut [
            Contender {
                name: "its map",
                run: Box::new(|| one.install(nodes)),
            },
            Contender {
                name: "its curves",
                run: Box::new(|| one.install(|| Isoradials::new(&spec, &lookup).nodes() as f64)),
            },
        ],
    );
}
