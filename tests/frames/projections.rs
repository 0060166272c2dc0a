//! Guards against fisheyes and equirectangular pictures that show anything else than each pixel's own ray: across their
//! seams, at the poles and behind the camera.

use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::render::{coverage, mask, pixelwise};
use darkness::scene::{Camera, Projection, Scene, View};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::any_scene::any_scene;
use crate::tables::table;

/// A scene as another picture, which is `height` pixels high.
fn seen_by(scene: &Scene, projection: Projection, fov: f64, height: u32) -> Scene {
    let (width, fov_degrees) = match projection {
        Projection::Equirectangular => (2 * height, 180.0),
        _ => (height + height / 8, fov),
    };
    let camera = Camera {
        projection,
        fov_degrees,
        ..*scene.camera()
    };
    let scene = scene.clone().with_size(width, height).unwrap();
    scene.with_camera(camera).unwrap()
}

fn curves(scene: &Scene) -> (View, Isoradials) {
    let view = View::new(scene);
    let spec = CurveSpec::new(scene, &view, scene.tolerance());
    let curves = Isoradials::new(&spec, &table("standard").lookup());
    (view, curves)
}

fn projections() -> impl Strategy<Value = (Projection, f64)> {
    prop_oneof![
        (-2.0..2.5_f64).prop_map(|log| (Projection::Fisheye, libm::pow(10.0, log))),
        (200.0..=360.0_f64).prop_map(|fov| (Projection::Fisheye, fov)),
        Just((Projection::Fisheye, 360.0)),
        Just((Projection::Equirectangular, 180.0)),
        Just((Projection::Equirectangular, 180.0)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 600,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn hard_edges_equal_each_pixel_s_own_ray(
        (kind, scene) in any_scene(),
        (projection, fov) in projections(),
    ) {
        let scene = seen_by(&scene, projection, fov, scene.image().height);
        let (view, curves) = curves(&scene);
        let drawn = mask::render(&view, &curves).unwrap();
        let single = mask::render_every_pixel(&view, &curves).unwrap();
        let differing = drawn.iter().zip(&single).filter(|(a, b)| a != b).count();
        prop_assert_eq!(differing, 0, "{:?}\n{}", kind, scene.to_toml());
    }

}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        rng_seed: RngSeed::Fixed(2),
        ..ProptestConfig::default()
    })]

    #[test]
    fn smooth_edges_are_the_mean_of_many_rays(
        (kind, scene) in any_scene(),
        (projection, fov) in projections(),
    ) {
        const RAYS: u32 = 32;
        let height = 12;
        let scene = seen_by(&scene, projection, fov, height);
        let width = scene.image().width;
        let (view, curves) = curves(&scene);
        let drawn = coverage::render(&view, &curves).unwrap();
        let fine = scene.clone().with_size(RAYS * width, RAYS * height).unwrap();
        let fine = View::new(&fine);
        let many = mask::render_every_pixel(&fine, &curves).unwrap();
        for (place, drawn) in drawn.iter().enumerate() {
            let (i, j) = (place as u32 % width, place as u32 / width);
            // Whole pixels are shown or not.
            if !view.shows((f64::from(i) + 0.5, f64::from(j) + 0.5)) {
                continue;
            }
            let rays = (0..RAYS * RAYS).map(|ray| {
                let (column, row) = (i * RAYS + ray % RAYS, j * RAYS + ray / RAYS);
                let is_shown = fine.shows((f64::from(column) + 0.5, f64::from(row) + 0.5));
                is_shown.then(|| f64::from(many[(row * RAYS * width + column) as usize]))
            });
            // At the rim rays beyond it see nothing.
            let Some(sum) = rays.sum::<Option<f64>>() else {
                continue;
            };
            let mean = sum / f64::from(RAYS * RAYS);
            let off = (mean - f64::from(*drawn)).abs() / 255.0;
            // Each row of rays counts an edge to half a ray, and a pixel may hold several edges.
            prop_assert!(off < 0.045, "{:?} {} {}: {} not {}\n{}", kind, i, j, drawn, mean, scene.to_toml());
        }
    }
}

/// The curves themselves against rays that are followed by another method.
#[test]
fn pictures_equal_exact_rays() {
    for name in ["classic", "face-on", "photon-ring", "flyby"] {
        let scene = Scene::builtin(name).unwrap();
        for (projection, fov) in [
            (Projection::Fisheye, 180.0),
            (Projection::Fisheye, 360.0),
            (Projection::Equirectangular, 180.0),
        ] {
            let scene = seen_by(&scene, projection, fov, 180);
            let (view, curves) = curves(&scene);
            let drawn = mask::render(&view, &curves).unwrap();
            let exact = pixelwise::render(&scene, &view, &Exact, &|| ()).unwrap();
            assert!(drawn == exact, "{name} {projection:?}");
        }
    }
}
