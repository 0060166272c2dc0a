//! Light and data are the same bytes on any number of threads, whatever was drawn before.

use std::collections::BTreeMap;
use std::sync::Mutex;

use darkness::Renderer;
use darkness::render::{Form, FrameMemory, Pixels};
use darkness::scene::{Animation, Scene};
use darkness::table::Lookup;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::lit::layers_of;
use crate::tables::table;

/// A frame's samples as bytes, whatever its form.
fn bytes(pixels: Pixels<'_>) -> Vec<u8> {
    match pixels {
        Pixels::Grey8(samples) | Pixels::Rgb8(samples) => samples.to_vec(),
        Pixels::Grey16(samples) | Pixels::Rgb16(samples) => samples
            .iter()
            .flat_map(|sample| sample.to_le_bytes())
            .collect(),
        Pixels::Planes(planes) => {
            let values = planes.iter().flat_map(|plane| &plane.values);
            values.flat_map(|value| value.to_le_bytes()).collect()
        }
    }
}

fn pool(threads: usize) -> ThreadPool {
    let pool = ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap()
}

fn forms(scene: &Scene) -> [Form; 3] {
    [Form::Rgb8, Form::Rgb16, Form::Layers(layers_of(scene))]
}

fn drawn(renderer: &mut Renderer<Lookup<'_>>, scene: &Scene, form: Form) -> Vec<u8> {
    let mut memory = FrameMemory::new(form);
    renderer.draw(scene, &mut memory).unwrap();
    bytes(memory.pixels())
}

/// Frames of several bands of rows, and so of work for several threads.
fn scenes() -> impl Iterator<Item = Scene> {
    let frames = [("lit", 1), ("rings", 1), ("plunge", 230)];
    let scenes = frames.into_iter().map(|(name, number)| {
        let animation = Animation::load(name).unwrap().with_size(700, 240).unwrap();
        animation.frame(number).unwrap()
    });
    scenes.flat_map(|scene| [true, false].map(|antialias| scene.clone().with_antialias(antialias)))
}

#[test]
fn any_number_of_threads_draws_the_same_bytes() {
    let pools = [1, 2, 5].map(pool);
    for scene in scenes() {
        for form in forms(&scene) {
            let frames = pools.each_ref().map(|pool| {
                pool.install(|| drawn(&mut Renderer::new(table("standard")), &scene, form))
            });
            assert!(frames[0].iter().any(|byte| *byte != 0));
            assert!(
                frames[1] == frames[0] && frames[2] == frames[0],
                "{form:?}, {}",
                scene.to_toml()
            );
        }
    }
}

/// The memory and the workspace keep nothing of other frames: neither of other scenes, sizes and forms, nor of a
/// scene with smooth edges for one with hard ones.
#[test]
fn a_renderer_draws_a_scene_s_bytes_whatever_it_drew_before() {
    let mut renderer = Renderer::new(table("standard"));
    let mut memories = None;
    for scene in scenes().collect::<Vec<_>>().iter().rev() {
        let memories = memories.get_or_insert_with(|| forms(scene).map(FrameMemory::new));
        for memory in memories {
            renderer.draw(scene, memory).unwrap();
            let kept = bytes(memory.pixels());
            let fresh = drawn(&mut Renderer::new(table("standard")), scene, memory.form());
            assert!(kept == fresh, "{:?}, {}", memory.form(), scene.to_toml());
        }
    }
}

/// A frame of a batch is the same whether it is drawn alone or side by side with others.
#[test]
fn frames_of_a_batch_do_not_depend_on_each_other() {
    for name in ["lit-orbit", "plunge"] {
        let animation = Animation::load(name).unwrap().with_size(64, 36).unwrap();
        let layers = Form::Layers(layers_of(&animation.frame(1).unwrap()));
        let renderer = Renderer::new(table("standard"));
        for form in [Form::Rgb8, layers] {
            let draw = |threads: usize, numbers: &[i64]| {
                let frames = Mutex::new(BTreeMap::new());
                pool(threads)
                    .install(|| {
                        renderer.render_frames(&animation, form, numbers.iter().copied(), |frame| {
                            let (pixels, _) = frame.pixels.map_err(|error| error.to_string())?;
                            frames.lock().unwrap().insert(frame.number, bytes(pixels));
                            Ok::<(), String>(())
                        })
                    })
                    .unwrap();
                frames.into_inner().unwrap()
            };
            // Four a thread: side by side.
            let together = draw(2, &[1, 2, 30, 77, 106, 150, 239, 240]);
            for number in [1, 106, 239] {
                let alone = draw(1, &[number]);
                assert!(
                    alone[&number] == together[&number],
                    "{name} {number}, {form:?}"
                );
            }
        }
    }
}
