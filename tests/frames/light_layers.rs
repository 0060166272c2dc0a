//! Layers of data as the renderer draws them from the map of the camera's radius, against references in long double.

use darkness::light::Sight;
use darkness::scene::Layer;

use crate::light_references::{Reference, SCENES, Seen, Worst, reference};
use crate::lit::{Edges, Layers};
use crate::tables::table;

/// What data may be off by, relative (radius, redshift) or not (azimuth, emission cosine).
const MOST: f64 = 1e-6;

/// The same in units of a float32's last place, with half a unit for the rounding. Patches are right to 1e-7 of the
/// greatest value in them: an azimuth of 1 beside one of 2π to five units. 3.5 were seen of an azimuth, 1.3 of the
/// rest.
const UNITS: f64 = 6.0;

#[test]
fn layers_equal_the_references() {
    for name in SCENES {
        for antialias in [false, true] {
            let Reference { scene, rows } = reference(name);
            let scene = scene.with_antialias(antialias);
            let layers = Layers::rendered(&scene, table("standard").lookup());
            let edges = Edges::new(&scene);
            let width = scene.image().width as usize;
            let (mut worst, mut lit, mut at_edges) = (Worst::default(), 0, 0);
            for &((i, j), known) in &rows {
                let pixel = j as usize * width + i as usize;
                let known: Option<Sight> = match known {
                    Seen::Disk(sight) => Some(sight),
                    Seen::Sky(_) | Seen::Hole => None,
                };
                let found = layers.sight(pixel);
                let share = layers.plane(Layer::Coverage)[pixel];
                match (found, known) {
                    (None, None) => {}
                    // A pixel that is covered in part tells of the covered point next to its centre.
                    (Some(_), None) if antialias && share < 1.0 => {}
                    (Some(found), Some(known)) if found.order == known.order => {
                        worst.add(&found, &known);
                        lit += 1;
                    }
                    _ => {
                        assert!(
                            edges.have((i, j)),
                            "{name}, antialias {antialias}: ({i}, {j}) shows {found:?} for {known:?}"
                        );
                        at_edges += 1;
                    }
                }
            }
            println!("{name}, antialias {antialias}: {lit} lit, {at_edges} at edges, {worst:?}");
            assert!(lit > 250, "{name}: {lit} lit pixels");
            assert!(worst.greatest() <= MOST, "{name}: {worst:?}");
            assert!(worst.float32 <= UNITS, "{name}: {worst:?}");
        }
    }
}

/// The alpha of a pixel that no disk covers tells the hole's shadow.
#[test]
fn alpha_equals_the_references() {
    for name in SCENES {
        for antialias in [false, true] {
            let Reference { scene, rows } = reference(name);
            let layers = Layers::rendered(
                &scene.clone().with_antialias(antialias),
                table("standard").lookup(),
            );
            let width = scene.image().width as usize;
            let mut wrong = Vec::new();
            for &((i, j), known) in &rows {
                let alpha = layers.plane(Layer::Alpha)[j as usize * width + i as usize];
                let is_so = match known {
                    Seen::Disk(_) | Seen::Hole => alpha == 1.0 || antialias && alpha > 0.0,
                    Seen::Sky(_) => alpha == 0.0 || antialias && alpha < 1.0,
                };
                if !is_so {
                    wrong.push(((i, j), alpha, known));
                }
            }
            assert!(
                wrong.is_empty(),
                "{name}, {antialias}: {} wrong, {:?}",
                wrong.len(),
                wrong[0]
            );
        }
    }
}
