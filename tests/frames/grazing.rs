//! Guards against light and data that no ray has, in pixels where the disk is seen so flat, or from so near, that much
//! of it lies within one of them.

use darkness::scene::{Layer, Light, Scene};

use crate::lit::Layers;
use crate::tables::table;

/// Cameras that look along the disk or at all of it at once: position, focus, field of view, disk, and size.
const VIEWS: [(&str, &str, f64, &str, (u32, u32)); 8] = [
    (
        "[30, 0, 0.01]",
        "[0, 0, 0]",
        120.0,
        "inner = 3\nouter = 100",
        (96, 54),
    ),
    (
        "[30, 0, 0.01]",
        "[0, 0, 0]",
        120.0,
        "inner = 3\nouter = 12",
        (96, 54),
    ),
    (
        "[-388.85, -992.31, 1.0658]",
        "[0.92, 3.07, 2.31]",
        1.075,
        "inner = 3\nouter = 12",
        (64, 36),
    ),
    (
        "[533.66, -1155.98, 0.1273]",
        "[3.44, -3.75, 4.25]",
        5.4,
        "inner = 3\nouter = 1000",
        (64, 36),
    ),
    (
        "[7.1715, 9.2143, 0.00117]",
        "[-3.49, -0.27, 6.48]",
        98.14,
        "inner = 3\nouter = 12",
        (64, 36),
    ),
    (
        "[0.69367, 2.06332, 0]",
        "[0.2988, -0.19, -0.8]",
        150.0,
        "inner = 3\nouter = 5",
        (64, 36),
    ),
    (
        "[29.5442, 0, 5.2094]",
        "[0, 0, 0]",
        179.0,
        "inner = 3\nouter = 12",
        (96, 54),
    ),
    (
        "[29.5442, 0, 5.2094]",
        "[0, 0, 0]",
        30.0,
        "inner = 3\nouter = 12",
        (1, 1),
    ),
];

fn luminance([red, green, blue]: [f64; 3]) -> f64 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[test]
fn no_pixel_is_brighter_than_the_disk_or_tells_what_no_ray_has() {
    let angles = table("standard").lookup();
    let mut wrong = Vec::new();
    for (position, focus, fov, disk, (width, height)) in VIEWS {
        let text = format!(
            "[camera]\nposition = {position}\nfocus = {focus}\nfov = {fov}\n[disk]\n{disk}\n\
             [image]\nwidth = {width}\nheight = {height}\n"
        );
        let light = Light::BlackBody {
            temperature: 7000.0,
        };
        let scene = Scene::from_toml(&text)
            .unwrap()
            .with_light(Some(light))
            .unwrap();
        let finer = scene
            .with_size(width.max(12) * 8, height.max(12) * 8)
            .unwrap();
        let centres = Layers::rendered(&finer.with_antialias(false), angles);
        let pixels = finer.image().width as usize * finer.image().height as usize;
        let brightest = (0..pixels)
            .map(|i| luminance(centres.colour(i)))
            .fold(0.0, f64::max);
        let frame = Layers::rendered(&scene, angles);
        for i in 0..(width * height) as usize {
            let of = || {
                format!(
                    "{position}, {disk:?}, pixel {}, {}",
                    i as u32 % width,
                    i as u32 / width
                )
            };
            let coverage = f64::from(frame.plane(Layer::Coverage)[i]);
            let light = luminance(frame.colour(i));
            // The brightest place may lie between the centres, and a share is right to a hundredth.
            if brightest > 0.0 && light > 1.2 * brightest * (coverage + 0.01) {
                wrong.push(format!(
                    "{}: light {light} of {brightest} in {coverage}",
                    of()
                ));
            }
            if frame.plane(Layer::Order)[i] >= 0.0 {
                let cosine = frame.plane(Layer::EmissionCosine)[i];
                let redshift = frame.plane(Layer::Redshift)[i];
                if !(0.0..=1.0).contains(&cosine) || !(0.0..10.0).contains(&redshift) {
                    wrong.push(format!("{}: cosine {cosine}, redshift {redshift}", of()));
                }
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of them:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
