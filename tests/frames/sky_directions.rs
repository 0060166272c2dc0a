//! Directions in the sky: the layers `sky` and `sky_uv` against references, and by every method.

use core::f64::consts::{PI, TAU};

use darkness::Renderer;
use darkness::scene::{Layer, LayerSet, Scene};

use crate::light_references::{Reference, SCENES, Seen, reference};
use crate::tables::table;

/// Directions of a scene's pixels, and their places.
fn directions(
    renderer: &mut Renderer<impl darkness::orbit::path::SweptAngles>,
    scene: &Scene,
) -> Vec<([f64; 3], [f64; 2])> {
    let layers: LayerSet = [Layer::Sky, Layer::SkyUv].into_iter().collect();
    let planes = renderer.render_layers(scene, layers).unwrap();
    let (directions, places) = (
        planes[0].values.as_chunks::<3>().0,
        planes[1].values.as_chunks::<2>().0,
    );
    directions
        .iter()
        .zip(places)
        .map(|(d, p)| (d.map(f64::from), p.map(f64::from)))
        .collect()
}

/// The angle between two directions, of about unit length.
fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let square = |i: usize| (a[i] - b[i]) * (a[i] - b[i]);
    (square(0) + square(1) + square(2)).sqrt()
}

#[test]
fn directions_are_those_of_the_references() {
    let table = table("standard");
    for name in SCENES {
        let Reference { scene, rows } = reference(name);
        let mut renderer = Renderer::new(table);
        let width = scene.image().width as usize;
        for antialias in [true, false] {
            let found = directions(&mut renderer, &scene.clone().with_antialias(antialias));
            let (mut worst, mut seen, mut worst_place) = (0.0_f64, 0, 0.0_f64);
            for ((column, row), expected) in &rows {
                let (direction, [u, v]) = found[*row as usize * width + *column as usize];
                let Seen::Sky(expected) = expected else {
                    assert!(direction.iter().all(|d| d.is_nan()) && u.is_nan() && v.is_nan());
                    continue;
                };
                let off = apart(direction, *expected);
                worst = worst.max(off);
                let latitude = (v - 0.5) * PI;
                let longitude = (0.5 - u) * TAU;
                let place = [
                    libm::cos(latitude) * libm::cos(longitude),
                    libm::cos(latitude) * libm::sin(longitude),
                    libm::sin(latitude),
                ];
                worst_place = worst_place.max(apart(place, *expected));
                seen += 1;
            }
            println!("{name}: {seen} directions, worst {worst:e}, of places {worst_place:e}");
            // A float's rounding: 3e-8 of a component, 3e-8 of a turn.
            assert!(seen > 300 && worst < 7e-8 && worst_place < 4.5e-7, "{name}");
        }
    }
}
