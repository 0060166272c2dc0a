//! Guards against frames that depend on what is drawn beside them, and on how many threads draw.

use core::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

use darkness::isoradial::{Isoradials, Sight};
use darkness::orbit::exact::Exact;
use darkness::render::batch::Batch;
use darkness::render::{RenderError, coverage, mask, pixelwise};
use darkness::scene::{Scene, View};

/// Cameras of one radius, to the last bit, that look here and there through several lenses.
fn scenes(count: usize) -> Vec<Scene> {
    let near = |x: f64, y: f64| format!("{x:?}, {y:?}");
    (0..count)
        .map(|i| {
            let side = [
                near(29.5442, 0.0),
                near(0.0, 29.5442),
                near(-29.5442, 0.0),
                near(0.0, -29.5442),
            ];
            let (height, fov) = ([5.2094, -5.2094][i % 2], 12.0 + 5.0 * (i % 5) as f64);
            let focus = near(0.5 * (i % 3) as f64, 0.25 * (i % 7) as f64);
            let text = format!(
                "[camera]\nposition = [{}, {height:?}]\nfocus = [{focus}, 0.0]\nfov = {fov:?}\n\
                 [disk]\ninner = 3.0\nouter = 12.0\n[image]\nwidth = 150\nheight = 140\n",
                side[i % 4]
            );
            Scene::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
        })
        .collect()
}

/// The views, and curves that serve them all.
fn views_and_curves(scenes: &[Scene]) -> (Vec<View>, Isoradials) {
    let views: Vec<View> = scenes.iter().map(View::new).collect();
    let sights = scenes.iter().zip(&views);
    let sights = sights.map(|(scene, view)| Sight::new(scene, view, scene.tolerance()));
    let all = sights.reduce(|a, b| a.and(&b).unwrap()).unwrap();
    (views, Isoradials::new(&all, &Exact))
}

#[test]
fn a_frame_of_a_batch_is_the_frame_alone() {
    for count in [1, 3, 20] {
        let (views, curves) = views_and_curves(&scenes(count));
        for (antialias, threads) in [(true, 1), (true, 3), (false, 2)] {
            let pool = rayon::ThreadPoolBuilder::new();
            let pool = pool.num_threads(threads).build().unwrap();
            let batch = Batch::new(&curves, antialias);
            // Twice, the second time into the memory of the first.
            for _ in 0..2 {
                let frames = Mutex::new(vec![Vec::new(); count]);
                let drawn = pool.install(|| {
                    batch.draw(&views, |index, pixels| {
                        frames.lock().unwrap()[index] = pixels.to_vec();
                        Ok::<_, RenderError>(())
                    })
                });
                drawn.unwrap();
                for (frame, view) in frames.into_inner().unwrap().iter().zip(&views) {
                    let alone = if antialias {
                        coverage::render(view, &curves)
                    } else {
                        mask::render(view, &curves)
                    };
                    assert!(
                        *frame == alone.unwrap(),
                        "{count} frames, {threads} threads"
                    );
                }
            }
        }
    }
}

/// Guards against curves that are kept for a view that they do not serve, and drawn anew for one that they do.
#[test]
fn curves_serve_every_view_of_their_radius() {
    let scenes = scenes(20);
    let (views, curves) = views_and_curves(&scenes);
    for (scene, view) in scenes.iter().zip(&views) {
        let sight = Sight::new(scene, view, scene.tolerance());
        assert!(curves.serves(&sight));
        // Not the other way round: none of these views shows all that the others do.
        let own = Isoradials::new(&sight, &Exact);
        assert!(
            own.serves(&sight)
                && !views.iter().zip(&scenes).all(|(view, scene)| {
                    own.serves(&Sight::new(scene, view, scene.tolerance()))
                })
        );
        let exact = pixelwise::render(scene, view, &Exact, &|| ()).unwrap();
        assert!(mask::render(view, &curves).unwrap() == exact);
    }
    let farther = Scene::from_toml(
        "[camera]\nposition = [29.5443, 0.0, 5.2094]\nfov = 12.0\n[disk]\ninner = 3.0\nouter = 12.0\n\
         [image]\nwidth = 150\nheight = 140\n",
    );
    let farther = farther.unwrap();
    let sight = Sight::new(&farther, &View::new(&farther), farther.tolerance());
    assert!(!curves.serves(&sight));
    let finer = Sight::new(&scenes[0], &views[0], 0.1 * scenes[0].tolerance());
    assert!(!curves.serves(&finer));
}

/// Guards against a failure that is lost, or that a whole batch is drawn after.
#[test]
fn a_failure_ends_the_batch() {
    let (views, curves) = views_and_curves(&scenes(20));
    let views: Vec<View> = views.iter().cycle().take(400).copied().collect();
    let (batch, begun) = (Batch::new(&curves, false), AtomicUsize::new(0));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    let drawn = pool.unwrap().install(|| {
        batch.draw(&views, |index, _| {
            begun.fetch_add(1, Ordering::Relaxed);
            match index {
                7 => Err(RenderError::Memory {
                    width: 1,
                    height: 2,
                    bytes: 3,
                }),
                _ => Ok(()),
            }
        })
    });
    assert!(matches!(drawn, Err(RenderError::Memory { bytes: 3, .. })));
    assert!(begun.into_inner() < 400);
}
