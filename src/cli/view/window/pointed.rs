//! What the pointer is over.

use std::fmt::Write as _;

use crate::light::flux;
use crate::orbit::exact::Exact;
use crate::orbit::{EventKind, Fate, Orbits, Ray};
use crate::render::pixelwise;
use crate::scene::{Light, Scene, View};

/// Tells what the centre of the pixel at a point of the picture sees: of the disk its order, radius, azimuth, redshift
/// and, of black bodies, temperature; else the hole, or the sky's direction. `None` outside the picture.
pub(super) fn pointed(scene: &Scene, (x, y): (f64, f64)) -> Option<String> {
    let view = View::new(scene);
    let within = |value: f64, side: u32| (0.0..f64::from(side)).contains(&value);
    if !within(x, view.width()) || !within(y, view.height()) {
        return None;
    }
    let place = (x as u32, y as u32);
    if !view.shows((f64::from(place.0) + 0.5, f64::from(place.1) + 0.5)) {
        return None;
    }
    if let Some(sight) = pixelwise::sight(scene, &view, &Exact, place).ok()? {
        let mut text = format!(
            "disk: order {}, radius {:.4}, azimuth {:.2}°, redshift {:.4}",
            sight.order,
            1.0 / sight.u,
            sight.azimuth.to_degrees(),
            sight.redshift
        );
        if let Some(Light::BlackBody { temperature }) = scene.light() {
            // (F/F_max)^¼, as the amplitude is its square times g².
            let emitted = temperature * libm::sqrt(flux::signed_root(sight.u).max(0.0));
            let _ = write!(text, ", temperature {:.0} K", emitted * sight.redshift);
        }
        return Some(text);
    }
    let pixel = view.pixel(place.0, place.1);
    let s = pixel.transverse();
    let [outward, across, level] = view.axes();
    let direction = if s > 0.0 {
        let ray = Ray::new(view.u0(), view.dudphi(pixel)).ok()?;
        let end = Exact.follow(ray, &[]).ok()?.pop()?;
        if end.kind == EventKind::End(Fate::Capture) {
            return Some("the hole".into());
        }
        let sideways = across * (pixel.ta / s) + level * (pixel.tb / s);
        outward * libm::cos(end.angle) + sideways * libm::sin(end.angle)
    } else if pixel.z > 0.0 {
        return Some("the hole".into());
    } else {
        outward
    };
    let longitude = libm::atan2(direction.y, direction.x).to_degrees();
    let latitude = libm::asin(direction.z.clamp(-1.0, 1.0)).to_degrees();
    let longitude = longitude.rem_euclid(360.0);
    Some(format!(
        "sky: longitude {longitude:.2}°, latitude {latitude:.2}°"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Renderer;
    use crate::scene::{Layer, LayerSet};

    /// The number after a word.
    fn number(text: &str, word: &str) -> f64 {
        let (_, rest) = text
            .split_once(word)
            .unwrap_or_else(|| panic!("no {word}: {text}"));
        let end = rest.trim().find([',', '°', ' ']);
        rest.trim()[..end.unwrap_or(rest.trim().len())]
            .parse()
            .unwrap()
    }

    #[test]
    fn it_tells_what_the_layers_hold() {
        for name in ["lit", "inside", "stars", "grid"] {
            let scene = Scene::builtin(name).unwrap().with_size(96, 54).unwrap();
            let mut layers = vec![Layer::Sky];
            let has_disk = scene.disk().is_some();
            if has_disk {
                layers.extend([Layer::Order, Layer::Radius, Layer::Azimuth, Layer::Redshift]);
            }
            let has_temperature = matches!(scene.light(), Some(Light::BlackBody { .. }));
            if has_temperature {
                layers.push(Layer::Temperature);
            }
            let layers: LayerSet = layers.into_iter().collect();
            // What pixels' centres see, with hard edges.
            let scene = scene.with_antialias(false);
            let mut renderer = Renderer::with_angles(Exact);
            let planes = renderer.render_layers(&scene, layers).unwrap();
            let plane = |layer| {
                let plane = planes.iter().find(|plane| plane.layer == layer);
                plane.map(|plane| plane.values.as_slice())
            };
            let (mut disk, mut sky, mut hole) = (0, 0, 0);
            for pixel in (0..96 * 54).step_by(7) {
                let place = (f64::from(pixel % 96) + 0.9, f64::from(pixel / 96) + 0.1);
                let text = pointed(&scene, place).unwrap();
                let value = |layer: Layer, component| {
                    let values = plane(layer).unwrap();
                    f64::from(values[pixel as usize * layer.channels() + component])
                };
                if text.starts_with("disk") {
                    disk += 1;
                    assert_eq!(number(&text, "order"), value(Layer::Order, 0), "{text}");
                    for (word, layer, tolerance, unit) in [
                        ("radius", Layer::Radius, 1e-4, 1.0),
                        ("azimuth", Layer::Azimuth, 0.02, 1_f64.to_degrees()),
                        ("redshift", Layer::Redshift, 1e-4, 1.0),
                    ] {
                        let there = unit * value(layer, 0);
                        assert!(
                            (number(&text, word) - there).abs() <= tolerance,
                            "{text}: {there}"
                        );
                    }
                    if has_temperature {
                        let there = value(Layer::Temperature, 0);
                        assert!(
                            (number(&text, "temperature") - there).abs() < 1.0,
                            "{text}: {there}"
                        );
                    }
                } else if text.starts_with("sky") {
                    sky += 1;
                    let latitude = libm::asin(value(Layer::Sky, 2)).to_degrees();
                    assert!(
                        (number(&text, "latitude") - latitude).abs() < 0.01,
                        "{text}: {latitude}"
                    );
                } else {
                    hole += 1;
                    assert!(value(Layer::Sky, 0).is_nan());
                    assert!(!has_disk || value(Layer::Order, 0) == -1.0);
                }
            }
            assert!(
                sky > 0 && hole > 0 && (disk > 0) == has_disk,
                "{name}: {disk} {sky} {hole}"
            );
        }
        let scene = Scene::builtin("lit").unwrap();
        assert_eq!(pointed(&scene, (1920.0, 5.0)), None);
        assert_eq!(pointed(&scene, (5.0, -0.1)), None);
    }
}
