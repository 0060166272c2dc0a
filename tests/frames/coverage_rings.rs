//! Guards against rings that lose their light, break or flicker once they are thinner than a pixel, and against disks
//! below a pixel that vanish or light pixels that they do not reach.

use core::f64::consts::PI;

use darkness::render::coverage;
use darkness::scene::Scene;

use crate::shares::{LEVEL, Picture, described};
use crate::tables::table;

fn drawn(text: &str) -> (Picture, Vec<f64>) {
    let scene = Scene::from_toml(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    // A thread is a tenth of a thousandth of a pixel from where it should be at most.
    let scene = scene.with_tolerance(1e-4).unwrap();
    let picture = Picture::new(&scene, &table("standard").lookup());
    let pixels = coverage::render(&picture.view, &picture.curves).unwrap();
    let shares = pixels
        .iter()
        .map(|&value| f64::from(value) * LEVEL)
        .collect();
    (picture, shares)
}

/// What a picture makes of its truth.
#[derive(Debug)]
struct Kept {
    /// Of the picture, of the truth, and of the truth in whole greys.
    light: f64,
    known: f64,
    in_greys: f64,
    /// The greatest and the root mean square error, of the pixels that have any light.
    worst: f64,
    rms: f64,
    /// The greatest share that is drawn black, and the greatest grey where nothing is.
    gone: f64,
    extra: f64,
    /// The brightest pixel.
    peak: f64,
}

impl Kept {
    fn new(shares: &[f64], truth: &[f64]) -> Self {
        let both = || shares.iter().copied().zip(truth.iter().copied());
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let squares: f64 = both()
            .map(|(share, known)| (share - known) * (share - known))
            .sum();
        let lit = truth
            .iter()
            .filter(|&&known| known > NOTHING)
            .count()
            .max(1);
        Self {
            light: shares.iter().sum(),
            known: truth.iter().sum(),
            in_greys: truth
                .iter()
                .map(|known| (known / LEVEL).round() * LEVEL)
                .sum(),
            worst: most(&mut both().map(|(share, known)| (share - known).abs())),
            rms: (squares / lit as f64).sqrt(),
            gone: most(&mut both().filter(|pair| pair.0 == 0.0).map(|pair| pair.1)),
            extra: most(&mut both().filter(|pair| pair.1 <= NOTHING).map(|pair| pair.0)),
            peak: most(&mut truth.iter().copied()),
        }
    }
}

/// A share that is none.
const NOTHING: f64 = 1e-9;

/// A narrow disk, `thickness` pixels wide where it is seen from above, from `radius` away and the angle `rise` above
/// its plane; the shadow's radius is a quarter of the picture's height.
fn thread(radius: f64, rise: f64, thickness: f64, (width, height): (u32, u32)) -> String {
    let sine = (6.75 * (1.0 - 1.0 / radius)).sqrt() / radius;
    let pixel = 4.0 * sine / f64::from(height);
    let fov = 2.0 * libm::atan(0.5 * f64::from(height) * pixel).to_degrees();
    let (up, aside) = libm::sincos(rise);
    let position = [radius * aside, 0.0, radius * up];
    let edges = (3.0, 3.0 + thickness * pixel * radius);
    described(position, [0.0, 0.03, 0.07], fov, edges, (width, height))
}

const FROM_ABOVE: f64 = 0.5 * PI;

/// Guards against rings that are dimmer, broken or uneven because they are thin: direct images and rings of a disk that
/// is itself a thread of 1/50 to 1/2 of a pixel.
#[test]
fn threads_keep_their_light_and_do_not_break() {
    let mut worst = (0.0_f64, 0.0_f64);
    for radius in [12.0, 30.0, 1e4] {
        for rise in [0.0, 0.02, 0.2, 0.6, 1.2, FROM_ABOVE] {
            for thickness in [0.02, 0.05, 0.1, 0.25, 0.5] {
                for size in [(131, 121), (47, 39)] {
                    let (picture, shares) = drawn(&thread(radius, rise, thickness, size));
                    let kept = Kept::new(&shares, &picture.swept(&picture.orders()));
                    let name = format!(
                        "r = {radius}, {rise:.2} above, {thickness} thick, {size:?}: {kept:?}"
                    );
                    // From above, where every pixel has several greys; else the light of all that is below half a grey
                    // is lost, which is all of the rings of a thread of 1/50.
                    if kept.peak > 0.25 {
                        assert!((kept.light / kept.known - 1.0).abs() < 0.01, "{name}");
                    }
                    // To a percent, and as much as rounding does to some hundred pixels half of which are off by a
                    // grey.
                    assert!(
                        (kept.light - kept.in_greys).abs() < 0.01 * kept.known + 5.0 * LEVEL,
                        "{name}"
                    );
                    // A share may be off by half a percent, and what is less than half a grey is black.
                    assert!(kept.gone <= 1.25 * LEVEL, "{name}");
                    assert!(kept.extra == 0.0, "{name}");
                    // Measured: 0.0040; 0.0013, of which rounding alone makes 0.0011.
                    assert!(kept.worst < 0.008 && kept.rms < 0.002, "{name}");
                    worst = (worst.0.max(kept.worst), worst.1.max(kept.rms));
                }
            }
        }
    }
    println!("worst {:.4}, root mean square {:.4}", worst.0, worst.1);
}

/// Guards against a truth that is itself dimmer: from above a ring's area is known, of every order.
#[test]
fn a_ring_s_light_is_its_area() {
    for thickness in [0.02, 0.1, 0.5, 5.0] {
        let centred =
            thread(30.0, FROM_ABOVE, thickness, (131, 121)).replace("0.03, 0.07", "0.0, 0.0");
        let (straight, _) = drawn(&centred);
        for order in straight.orders() {
            // About the axis the picture is not stretched: R = tan ψ in pixels.
            let [outer, inner] = straight.edges(order, 1.0).unwrap();
            let radius = |kappa: f64| 1.0 / (kappa * straight.view.pixel_side());
            let area = PI * (radius(outer) * radius(outer) - radius(inner) * radius(inner));
            let swept: f64 = straight.swept(&[order]).iter().sum();
            // Both edges' polygons lie within them, by 5e-4 pixels at most.
            assert!(
                (swept / area - 1.0).abs() < 1e-3,
                "order {order}, {thickness} thick: {swept}, {area}"
            );
        }
    }
}

/// Guards against disks that are as small as a pixel: they are neither lost nor do they light what they do not reach.
#[test]
fn disks_below_a_pixel_keep_their_light() {
    let mut seen = 0;
    for rise in [0.003, 0.03, 0.3, 1.0, FROM_ABOVE] {
        for size in [0.1, 0.3, 1.0, 3.0, 10.0] {
            for focus in [[0.0; 3], [0.0, 2.0, 1.0], [0.0, -7.0, 4.0]] {
                let radius = 1e5;
                // So that the disk's 24 radii are `size` of 31 rows.
                let fov = 2.0 * libm::atan(12.0 / radius / size * 31.0).to_degrees();
                let (up, aside) = libm::sincos(rise);
                let position = [radius * aside, 0.0, radius * up];
                let (picture, shares) =
                    drawn(&described(position, focus, fov, (3.0, 12.0), (33, 31)));
                let kept = Kept::new(&shares, &picture.swept(&picture.orders()));
                let name = format!("{rise:.3} above, {size} pixels, {focus:?}: {kept:?}");
                assert!(kept.extra == 0.0, "{name}");
                // Greys are rounded, and arcs and chords are off by 1/200 of a pixel at most.
                let allowed = if size > 1.0 { 0.05 } else { 0.01 };
                assert!((kept.light - kept.known).abs() < allowed, "{name}");
                assert!(kept.worst < 0.008, "{name}");
                seen += usize::from(kept.light > 0.0);
            }
        }
    }
    // Of 75 all but the smallest seen from the side, whose light is less than half a grey.
    assert!(seen > 65, "{seen} disks have any light");
}
