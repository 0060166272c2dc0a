//! Guards against frames that depend on what else is drawn, on the number of threads, or on where a worker begins.

use core::sync::atomic::{AtomicUsize, Ordering};
use std::collections::BTreeMap;
use std::sync::Mutex;

use darkness::cli::FrameRange;
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::render::batch::{self, Curved, DrawnFrame, FrameError, Frames, RayByRay, Sharing};
use darkness::render::{Form, Pixels, coverage, mask, pixelwise};
use darkness::scene::{Animation, Scene, View};

/// A built-in animation, small, so many of its frames long.
fn animation(name: &str, frames: u32) -> Animation {
    let text = Animation::load(name).unwrap().to_toml();
    let long = text
        .lines()
        .find(|line| line.starts_with("frames"))
        .unwrap();
    let text = text.replace(long, &format!("frames = {frames}"));
    Animation::from_toml(&text)
        .unwrap()
        .with_size(160, 90)
        .unwrap()
}

fn fastest(range: &FrameRange) -> Sharing {
    Sharing::fastest(range.count(), u64::MAX)
}

/// The frames of a range, drawn on so many threads.
fn drawn(frames: &impl Frames, range: &str, threads: usize) -> BTreeMap<i64, Vec<u8>> {
    let range: FrameRange = range.parse().unwrap();
    let all = Mutex::new(BTreeMap::new());
    let places = Mutex::new(Vec::new());
    let done = |drawn: DrawnFrame<'_>| {
        let (Pixels::Grey8(pixels), effort) = drawn.pixels? else {
            panic!("asked for another form");
        };
        assert!(!effort.ray_by_ray);
        places.lock().unwrap().push((drawn.number, drawn.place));
        all.lock().unwrap().insert(drawn.number, pixels.to_vec());
        Ok::<(), FrameError>(())
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap()
        .install(|| {
            batch::draw(
                frames,
                Form::Grey8,
                range.iter(),
                fastest(&range),
                |_| true,
                done,
            )
        })
        .unwrap();
    let mut places = places.into_inner().unwrap();
    places.sort_unstable();
    let begun: Vec<_> = range.iter().zip(0..).collect();
    assert_eq!(places, begun, "frames are begun in order, each once");
    all.into_inner().unwrap()
}

#[test]
fn a_frame_is_the_same_alone_in_a_chunk_and_among_all() {
    for name in ["orbit", "approach", "tilt"] {
        for antialias in [true, false] {
            let animation = animation(name, 300).with_antialias(antialias).unwrap();
            // A worker anew for each, as another process is.
            let all = drawn(&Curved::new(&animation, &Exact, None), "1-300x9", 3);
            for (range, threads) in [("1-300x9", 1), ("253-262:9", 2), ("1-30x9,298-300x9", 3)] {
                let some = drawn(&Curved::new(&animation, &Exact, None), range, threads);
                assert!(!some.is_empty());
                for (number, pixels) in some {
                    assert!(
                        all.get(&number).is_none_or(|frame| *frame == pixels),
                        "{name}, frame {number}, {range}, {threads} threads"
                    );
                }
            }
            for number in [1, 253, 262] {
                let alone = drawn(
                    &Curved::new(&animation, &Exact, None),
                    &number.to_string(),
                    2,
                );
                if let Some(frame) = all.get(&number) {
                    assert!(*frame == alone[&number], "{name}, frame {number}");
                }
            }
        }
    }
}

/// Guards against curves that are kept for a view which they do not serve: shared ones draw the masks that each pixel's
/// ray does.
#[test]
fn shared_curves_draw_what_a_frames_own_do() {
    let zoom = "[camera]\nposition = [29.5442, 0, 5.2094]\nfov = 40\n[disk]\ninner = 3\nouter = 12\n\
        [image]\nwidth = 150\nheight = 140\nantialias = false\n[animation]\nframes = 24\n\
        [[animation.keyframe]]\nframe = 1\nfov = 40\nposition = [29.5442, 0, 5.2094]\n\
        [[animation.keyframe]]\nframe = 24\nfov = 12\nfocus = [0, 3, 1]\nposition = [0, -29.5442, -5.2094]\n";
    for animation in [
        animation("orbit", 24).with_antialias(false).unwrap(),
        Animation::from_toml(zoom).unwrap(),
    ] {
        let frames = drawn(&Curved::new(&animation, &Exact, None), "1-24", 2);
        let by_rays = drawn(&RayByRay::new(&animation, &Exact, None, &|| ()), "1-24", 2);
        assert!(frames == by_rays);
        for (number, frame) in frames {
            let scene = animation.frame(number).unwrap();
            let view = View::new(&scene);
            let spec = CurveSpec::new(&scene, &view, scene.tolerance());
            let own = Isoradials::new(&spec, &Exact);
            // Where an edge passes a pixel's centre as closely as the tolerance, either is right.
            let mask = mask::render(&view, &own).unwrap();
            let others = mask.iter().zip(&frame).filter(|(a, b)| a != b).count();
            assert!(others <= 1, "frame {number}: {others} pixels");
            // Shared curves are finer: an edge moves by less than the tolerance, a grey by one.
            let smooth = coverage::render(&view, &own).unwrap();
            let shared = animation.clone().with_antialias(true).unwrap();
            let shared = drawn(&Curved::new(&shared, &Exact, None), &number.to_string(), 1);
            let apart = |(a, b): (&u8, &u8)| a.abs_diff(*b);
            let most = smooth.iter().zip(&shared[&number]).map(apart).max();
            assert!(most <= Some(1), "frame {number}: {most:?}");
        }
    }
}

#[test]
fn a_scene_that_does_not_move_is_the_picture() {
    let still = Animation::load("classic")
        .unwrap()
        .with_size(160, 90)
        .unwrap();
    let frame = drawn(&Curved::new(&still, &Exact, None), "1", 2);
    let scene = Scene::load("classic").unwrap().with_size(160, 90).unwrap();
    let view = View::new(&scene);
    let spec = CurveSpec::new(&scene, &view, scene.tolerance());
    let curves = Isoradials::new(&spec, &Exact);
    assert!(frame[&1] == coverage::render(&view, &curves).unwrap());
    let hard = still.with_antialias(false).unwrap();
    let frame = drawn(&Curved::new(&hard, &Exact, None), "1", 2);
    assert!(frame[&1] == pixelwise::render(&scene, &view, &Exact, &|| ()).unwrap());
}

/// Guards against a failure that is lost, or that a whole batch is drawn after, and against one that stops the others
/// where it should not.
#[test]
fn a_failure_ends_the_batch_if_it_is_told_to() {
    let orbit = animation("orbit", 400);
    // A camera that comes to the horizon at frame 361.
    let falling = orbit
        .to_toml()
        .replace("radius = 30.0", "radius = [10.0, 0.0]");
    let falling = falling.replace("frames = 400", "frames = 401\ninterpolation = \"linear\"");
    let falling = falling.replacen("interpolation = \"smooth\"\n", "", 1);
    let falling = Animation::from_toml(&falling).unwrap();
    let frames = Curved::new(&falling, &Exact, None);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap();
    for stop in [true, false] {
        let (begun, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let done = |drawn: DrawnFrame<'_>| {
            begun.fetch_add(1, Ordering::Relaxed);
            if drawn.pixels.is_err() {
                failed.fetch_add(1, Ordering::Relaxed);
            }
            match drawn.pixels {
                Err(error) if stop => Err((drawn.number, error)),
                _ => Ok(()),
            }
        };
        let range = FrameRange::up_to(401);
        let run = || {
            batch::draw(
                &frames,
                Form::Grey8,
                range.iter(),
                fastest(&range),
                |_| true,
                done,
            )
        };
        let ended = pool.install(run);
        assert_eq!(ended.is_err(), stop);
        if stop {
            let (number, error) = ended.unwrap_err();
            assert!((361..=362).contains(&number), "{number}");
            assert!(error.to_string().contains("horizon"), "{error}");
            assert!(begun.into_inner() <= 363);
        } else {
            assert_eq!((begun.into_inner(), failed.into_inner()), (401, 41));
        }
    }
}

#[test]
fn frames_that_are_not_wanted_are_passed_over() {
    let orbit = animation("orbit", 40);
    let drawn = Mutex::new(Vec::new());
    let done = |frame: DrawnFrame<'_>| {
        drawn.lock().unwrap().push(frame.number);
        frame.pixels.map(|_| ())
    };
    let range = FrameRange::up_to(40);
    batch::draw(
        &Curved::new(&orbit, &Exact, None),
        Form::Grey8,
        range.iter(),
        fastest(&range),
        |number| number % 10 == 3,
        done,
    )
    .unwrap();
    let mut drawn = drawn.into_inner().unwrap();
    drawn.sort_unstable();
    assert_eq!(drawn, [3, 13, 23, 33]);
}
