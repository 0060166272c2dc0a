//! The map of a camera radius keeps what its error says.

use core::cell::Cell;

use darkness::Renderer;
use darkness::isoradial::{CurveSpec, Isoradials, RadiusMap};
use darkness::orbit::exact::Exact;
use darkness::render::pixelwise;
use darkness::scene::{Layer, LayerSet, Scene, View};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

use crate::lit::Edges;

/// A scene far or near, above the disk's plane, in it or about it, the disk of any width.
fn any_radius() -> impl Strategy<Value = Scene> {
    let unit = || 0.0..1.0_f64;
    let numbers = [unit(), unit(), unit(), unit(), unit()];
    (0..5_usize, numbers).prop_filter_map("it stands in the disk", |(kind, numbers)| {
        made(kind, numbers)
    })
}

fn made(kind: usize, [a, b, c, d, e]: [f64; 5]) -> Option<Scene> {
    let log = |share: f64, from: f64, to: f64| from * libm::pow(to / from, share);
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
    // From a picture of the rings to one of the whole disk, or as wide as can be.
    let half = libm::atan(log(e, 1.5, (1.5 * outer).max(3.0)) / radius);
    let fov = (2.0 * half.to_degrees()).min(120.0);
    let (x, z) = (radius * (1.0 - z * z).sqrt(), radius * z);
    let text = format!(
        "[camera]\nposition = [{x:e}, 0.0, {z:e}]\nfov = {fov:e}\n[disk]\ninner = {inner:e}\nouter = {outer:e}\n\
         [image]\nwidth = 24\nheight = 18\nantialias = false\n",
    );
    Scene::from_toml(&text).ok()
}

/// How much farther off the map may be than between the nodes where it was measured.
const UNMEASURED: f64 = 3.0;

/// The rounding to a float32, twice: of the radius, and of what is left of the patches' tolerance.
const ROUNDING: f64 = 1.2e-7;

#[test]
fn maps_are_as_accurate_as_they_say() {
    let (lit, worst) = (Cell::new(0_u32), Cell::new((0.0_f64, 0.0)));
    let config = ProptestConfig {
        cases: 200,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let result = TestRunner::new_with_rng(config, rng).run(&any_radius(), |scene| {
        let view = View::new(&scene);
        let spec = CurveSpec::new(&scene, &view, scene.tolerance());
        let claimed = RadiusMap::new(&Isoradials::new(&spec, &Exact), &Exact).error();
        prop_assert!(claimed <= 5e-7, "{claimed:e}");
        let layers = LayerSet::default().with(Layer::Order).with(Layer::Radius);
        let mut renderer = Renderer::with_angles(Exact);
        let planes = renderer.render_layers(&scene, layers).unwrap();
        for pixel in 0..view.width() * view.height() {
            let place = (pixel % view.width(), pixel / view.width());
            let known = pixelwise::sight(&scene, &view, &Exact, place).unwrap();
            let order = planes[0].values[pixel as usize];
            let told = (order >= 0.0).then_some(order as u32);
            if told != known.map(|sight| sight.order) {
                let is_at_edge = Edges::new(&scene).have(place);
                prop_assert!(is_at_edge, "{place:?}: {told:?} or {known:?}");
            } else if let Some(known) = known {
                let error = (f64::from(planes[1].values[pixel as usize]) * known.u - 1.0).abs();
                let allowed = UNMEASURED * claimed + ROUNDING;
                prop_assert!(
                    error <= allowed,
                    "{place:?}: {error:e}, {claimed:e}, {known:?}"
                );
                lit.set(lit.get() + 1);
                if error > worst.get().0 {
                    worst.set((error, claimed));
                }
            }
        }
        Ok(())
    });
    println!("{} lit pixels, worst {:?}", lit.get(), worst.get());
    result.unwrap_or_else(|error| panic!("{error}"));
    assert!(lit.get() > 1000, "{} lit pixels", lit.get());
}
