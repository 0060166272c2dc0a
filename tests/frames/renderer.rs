//! Guards against a `Renderer` whose pictures depend on what it drew before, or that panics on a caller's numbers.

use std::sync::Mutex;

use darkness::render::{Form, Pixels, RenderError, coverage, mask};
use darkness::scene::{Animation, Scene, View};
use darkness::table::Lookup;
use darkness::{Renderer, isoradial::CurveSpec, isoradial::Isoradials};

use crate::tables::table;

fn fresh(scene: &Scene) -> Vec<u8> {
    let view = View::new(scene);
    let spec = CurveSpec::new(scene, &view, scene.tolerance());
    let curves = Isoradials::new(&spec, &table("standard").lookup());
    if scene.antialias() {
        coverage::render(&view, &curves).unwrap()
    } else {
        mask::render(&view, &curves).unwrap()
    }
}

/// The greatest difference of a renderer's picture from that of the scene's own curves.
fn apart(renderer: &mut Renderer<Lookup<'_>>, scene: &Scene) -> Option<u8> {
    let picture = renderer.render(scene).unwrap().into_raw();
    let fresh = fresh(scene);
    let differences = picture.iter().zip(&fresh).map(|(a, b)| a.abs_diff(*b));
    differences.max()
}

#[test]
fn a_first_picture_is_that_of_the_scene_s_own_curves() {
    for name in ["classic", "edge-on", "photon-ring"] {
        for antialias in [true, false] {
            let scene = Scene::builtin(name).unwrap().with_size(161, 90).unwrap();
            let scene = scene.with_antialias(antialias);
            let picture = Renderer::new(table("standard")).render(&scene).unwrap();
            assert_eq!(picture.dimensions(), (161, 90));
            assert!(picture.into_raw() == fresh(&scene), "{name}, {antialias}");
        }
    }
}

/// Curves that were kept may be finer than the scene's own: its edges move by less than the tolerance, a grey by one.
#[test]
fn kept_curves_move_no_edge_by_more_than_the_tolerance() {
    let mut renderer = Renderer::new(table("standard"));
    let scene = Scene::builtin("classic").unwrap();
    let size = scene.image();
    for (width, height) in [(size.width, size.height), (480, 270), (97, 61), (480, 270)] {
        let scene = scene.clone().with_size(width, height).unwrap();
        let most = apart(&mut renderer, &scene);
        assert!(most <= Some(1), "{width} × {height}: {most:?} greys");
    }
}

/// Guards against a scene that is drawn from the curves of another camera radius or another disk.
#[test]
fn each_scene_is_its_own() {
    let mut renderer = Renderer::new(table("standard"));
    for name in [
        "classic",
        "face-on",
        "inside",
        "classic",
        "close-up",
        "edge-on",
        "photon-ring",
    ] {
        let scene = Scene::builtin(name).unwrap().with_size(120, 70).unwrap();
        let most = apart(&mut renderer, &scene);
        assert!(most <= Some(1), "{name}: {most:?} greys");
    }
}

#[test]
fn any_stride_and_any_buffer_is_drawn_into_or_refused() {
    let mut renderer = Renderer::new(table("standard"));
    let scene = Scene::builtin("classic")
        .unwrap()
        .with_size(50, 30)
        .unwrap();
    for stride in [
        0,
        49,
        usize::MAX,
        usize::MAX / 29,
        usize::MAX / 64 + 1,
        1 << 62,
    ] {
        let error = renderer
            .render_into(&scene, &mut [0; 4096], stride)
            .unwrap_err();
        assert!(
            matches!(error, RenderError::Buffer { .. }),
            "{stride}: {error}"
        );
    }
    let one_row = scene.with_size(50, 1).unwrap();
    for stride in [50, 1 << 40, usize::MAX / 64 + 1, usize::MAX] {
        renderer
            .render_into(&one_row, &mut [0; 50], stride)
            .unwrap();
    }
    assert!(renderer.render_into(&one_row, &mut [0; 49], 50).is_err());
}

#[test]
fn frames_of_an_animation_are_drawn_side_by_side() {
    let animation = Animation::load("orbit").unwrap();
    let renderer = Renderer::new(table("standard"));
    let drawn = Mutex::new(Vec::new());
    let small: Vec<i64> = vec![3, 50, 240];
    renderer
        .render_frames(&animation, Form::Grey8, small.iter().copied(), |frame| {
            let (Pixels::Grey8(pixels), report) =
                frame.pixels.map_err(|error| error.to_string())?
            else {
                return Err("another form".to_owned());
            };
            assert!(!report.ray_by_ray && report.error.total() <= 1e-3);
            drawn.lock().unwrap().push((frame.number, pixels.len()));
            Ok::<(), String>(())
        })
        .unwrap();
    let mut drawn = drawn.into_inner().unwrap();
    drawn.sort_unstable();
    assert_eq!(
        drawn,
        small
            .iter()
            .map(|&number| (number, 1920 * 1080))
            .collect::<Vec<_>>()
    );
    let stopped = renderer.render_frames(&animation, Form::Grey8, [1, 2].into_iter(), |_| {
        Err("enough")
    });
    assert_eq!(stopped, Err("enough"));
}
