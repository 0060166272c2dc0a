//! Guards against memory that is allocated for each frame: once warm, no frame allocates.
#![expect(unsafe_code, reason = "an allocator that counts")]

use core::alloc::{GlobalAlloc, Layout};
use core::sync::atomic::{AtomicU64, Ordering};
use std::alloc::System;
use std::sync::Arc;

use darkness::Renderer;
use darkness::cli::FrameRange;
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::render::batch::{self, Curved, DrawnFrame, Frames, Sharing};
use darkness::render::frame::{Threads, Workspace};
use darkness::render::{Form, FrameMemory};
use darkness::scene::{Animation, Layer, Region, Scene, Sky, SkyFile, StarSource, Stars, View};
use darkness::sky::{Panorama, SkySource, StarField};

use crate::tables;

struct Counting;

static COUNT: AtomicU64 = AtomicU64::new(0);

/// All bytes that were ever allocated.
static BYTES: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        BYTES.fetch_add(layout.size() as u64, Ordering::Relaxed);
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

/// Crops of a picture of four thousand million pixels, as masks, colours and layers.
pub(crate) fn a_crop_takes_no_memory_for_the_whole() {
    let scene = Scene::builtin("lit").unwrap();
    let scene = scene.with_size(65_536, 65_536).unwrap();
    let crop = |left, top| Region {
        left,
        top,
        width: 64,
        height: 64,
    };
    let layers = [Layer::Colour, Layer::Redshift].into_iter().collect();
    for form in [Form::Grey8, Form::Grey16, Form::Rgb8, Form::Layers(layers)] {
        for smooth in [false, true] {
            let mut renderer = Renderer::new(tables::table("standard"));
            let mut memory = FrameMemory::new(form);
            let mut draw = |left, top| {
                let scene = scene.clone().with_antialias(smooth);
                let scene = scene.with_crop(Some(crop(left, top))).unwrap();
                let before = BYTES.load(Ordering::Relaxed);
                let report = renderer.draw(&scene, &mut memory).unwrap();
                assert!(!report.ray_by_ray);
                BYTES.load(Ordering::Relaxed) - before
            };
            // With the curves, their map and the colours, and without.
            let (first, next) = (draw(32_736, 30_000), draw(50_000, 32_000));
            assert!(
                first < 64 << 20 && next < 8 << 20,
                "{first}, {next}: {form:?}"
            );
        }
    }
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
            let curved = Curved::new(&orbit, &Exact, None);
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

/// A lit disk so wide that some rays meet it where the map of the radius has a gap. Most of them are at smooth edges.
const WIDE: &str = "[camera]\nposition = [30, 0, 5]\nfov = 60\n[disk]\ninner = 3\nouter = 1e9\n\
    [disk.light]\nmodel = \"blackbody\"\ntemperature = 7000\n[image]\nwidth = 8\nheight = 4\n";

/// Light and data, on one thread: still scenes through a renderer, and steps of an orbit through a batch's frames.
pub(crate) fn lit_frames_take_no_memory_once_warm() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.unwrap().install(|| {
        let layers = Layer::NAMED.into_iter().chain([Layer::Alpha]).collect();
        for form in [Form::Rgb8, Form::Rgb16, Form::Layers(layers)] {
            for smooth in [false, true] {
                still_frames(form, smooth);
                steps_of_an_orbit(form, smooth);
            }
        }
    });
}

fn still_frames(form: Form, smooth: bool) {
    let small = |name| Scene::builtin(name).unwrap().with_size(96, 54).unwrap();
    let wide = Scene::from_toml(WIDE).unwrap();
    for (name, scene) in [
        ("lit", small("lit")),
        ("rings", small("rings")),
        ("wide", wide),
    ] {
        let scene = scene.with_antialias(smooth);
        let mut renderer = Renderer::new(tables::table("standard"));
        let mut memory = FrameMemory::new(form);
        let mut draw = || {
            let report = renderer.draw(&scene, &mut memory).unwrap();
            assert!(!report.ray_by_ray, "{name}");
        };
        assert!(count(&mut draw) > 0);
        assert_eq!(count(draw), 0, "{name}, {form:?}, smooth {smooth}");
    }
}

fn steps_of_an_orbit(form: Form, smooth: bool) {
    let orbit = Animation::load("lit-orbit").unwrap();
    let orbit = orbit.with_size(96, 54).unwrap();
    let orbit = orbit.with_antialias(smooth).unwrap();
    let angles = tables::table("standard").lookup();
    let frames = Curved::new(&orbit, &angles, None);
    let (mut workspace, mut memory) = (Workspace::default(), FrameMemory::new(form));
    let mut draw = || {
        for number in (1..=240).step_by(48) {
            let drawn = frames.draw(number, true, &mut workspace, &mut memory);
            assert!(!drawn.unwrap().ray_by_ray);
        }
    };
    assert!(count(&mut draw) > 0);
    assert_eq!(count(draw), 0, "lit-orbit, {form:?}, smooth {smooth}");
}

/// A panorama and stars in memory and a grid, behind a lit disk and without one, on one thread.
pub(crate) fn skies_take_no_memory_once_warm() {
    let texels = (0..6 * 64 * 64).map(|i| (i % 251) as f32 / 251.0).collect();
    let stars = StarField::synthetic(2000, 1, None);
    let panorama = Panorama::from_linear(64, texels);
    let source = Arc::new(SkySource::new(Some(panorama), Some(stars), Some(15.0)));
    let sky = Sky {
        panorama: Some(SkyFile::new("in memory")),
        stars: Some(Stars::new(StarSource::Synthetic {
            count: 2000,
            seed: 1,
        })),
        grid: Some(15.0),
        ..Sky::default()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.unwrap().install(|| {
        let layers = [Layer::Colour, Layer::Sky, Layer::SkyUv]
            .into_iter()
            .collect();
        for form in [Form::Rgb8, Form::Layers(layers)] {
            for (name, smooth) in ["lit", "grid"]
                .into_iter()
                .flat_map(|name| [(name, false), (name, true)])
            {
                let scene = Scene::builtin(name).unwrap().with_size(96, 54).unwrap();
                let scene = scene
                    .with_antialias(smooth)
                    .with_sky(Some(sky.clone()))
                    .unwrap();
                let renderer = Renderer::new(tables::table("standard"));
                let mut renderer = renderer.with_sky(sky.clone(), Arc::clone(&source));
                let mut memory = FrameMemory::new(form);
                let mut draw = || {
                    renderer.draw(&scene, &mut memory).unwrap();
                };
                assert!(count(&mut draw) > 0);
                assert_eq!(count(draw), 0, "{name}, {form:?}, smooth {smooth}");
            }
        }
    });
}
