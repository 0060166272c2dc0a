//! The map of a camera radius keeps what its error says.

use core::cell::Cell;

use darkness::Renderer;
use darkness::isoradial::{CurveSpec, Isoradials, RadiusMap};
use darkness::orbit::exact::Exact;
use darkness::render::pixelwise;
use darkness::scene::{Layer, LayerSet, Scene, View};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use crate::lit::Edges;

/// A scene far or near, above the disk's plane, in it or about it, the disk of any width.
fn any_radius() -> impl Strategy<Value = Scene> {
    let unit = || 0.0..1.0_f64;
    let log = |share: f64, from: f64, to: f64| from * libm::pow(to / from, share);
    (0..5_usize, [unit(), unit(), unit(), unit(), unit()]).prop_filter_map("it stands in the disk", move |(kind, [a, b, c, d, e])| {
        let radius = match kind {
            0 => 1.0 + log(a, 1e-3, 0.5),
            1 => [1e4, 1e6][usize::from(a > 0.5)],
            _ => log(a, 1.5, 300.0),
        };
        let z = match kind {
            2 => log(b, 1e-6, 1e-2),
            _ => 2.0 * b - 1.0,
        };
        let inner = if c < 0.7 { 3.0 } else { log(c, 3.0, 30.0) };
        let outer = match kind {
            3 => log(d, 20.0, 1e6),
            _ => inner + log(d, 1e-2, 100.0),
        };
        let position = [radius * (1.0 - z * z).sqrt(), 0.0, radius * z];
        // From a picture of the rings to one of the whole disk, or to one as wide as can be.
        let view = libm::atan(log(e, 1.5, (1.5 * outer).max(3.0)) / radius);
        let fov = (2.0 * view.to_degrees()).min(120.0);
        let text = format!(
            "[camera]\nposition = [{:e}, {:e}, {:e}]\nfov = {fov:e}\n[disk]\ninner = {inner:e}\nouter = {outer:e}\n\
             [image]\nwidth = 24\nheight = 18\nantialias = false\n",
            position[0], position[1], position[2]
        );
        Scene::from_toml(&text).ok()
    })
}

#[test]
fn maps_are_as_accurate_as_they_say() {
    let lit = Cell::new(0_u32);
    let claimed = Cell::new(0.0_f64);
    let worst = Cell::new((0.0_f64, 0.0_f64));
    let config = ProptestConfig {
        cases: std::env::var("CASES").map_or(60, |c| c.parse().unwrap()),
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let result = TestRunner::new_with_rng(
        config,
        proptest::test_runner::TestRng::deterministic_rng(
            proptest::test_runner::RngAlgorithm::ChaCha,
        ),
    )
    .run(&any_radius(), |scene| {
        let view = View::new(&scene);
        let curves = Isoradials::new(&CurveSpec::new(&scene, &view, scene.tolerance()), &Exact);
        let map = RadiusMap::new(&curves, &Exact);
        claimed.set(claimed.get().max(map.error()));
        let layers = LayerSet::default().with(Layer::Order).with(Layer::Radius);
        let planes = Renderer::with_angles(Exact)
            .render_layers(&scene, layers)
            .unwrap();
        let width = view.width();
        for pixel in 0..width * view.height() {
            let place = (pixel % width, pixel / width);
            let known = pixelwise::sight(&scene, &view, &Exact, place).unwrap();
            let order = planes[0].values[pixel as usize];
            let told = (order >= 0.0).then_some(order as u32);
            if told != known.map(|sight| sight.order) {
                prop_assert!(
                    Edges::new(&scene).have(place),
                    "{place:?}: {told:?} or {known:?}"
                );
                continue;
            }
            let Some(known) = known else { continue };
            lit.set(lit.get() + 1);
            let error = (f64::from(planes[1].values[pixel as usize]) * known.u - 1.0).abs();
            let (most, of) = worst.get();
            if error > most {
                worst.set((error, map.error()));
            }
            let _ = of;
            let allowed = 3.0 * map.error() + 1.2e-7;
            prop_assert!(
                error <= allowed,
                "{place:?}: {error:e} for {:e}, {known:?}",
                map.error()
            );
        }
        Ok(())
    });
    println!(
        "{} lit pixels, claimed {:e}, worst {:?}",
        lit.get(),
        claimed.get(),
        worst.get()
    );
    result.unwrap_or_else(|error| panic!("{error}"));
}
