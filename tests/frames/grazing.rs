//! Guards against light and data that no ray has, in pixels where the disk is seen so flat, or from so near, that much
//! of it lies within one of them.

use darkness::scene::{Layer, Light, Scene};

use crate::lit::Layers;
use crate::tables::table;

struct View {
    camera: &'static str,
    outer: f64,
    size: (u32, u32),
}

const fn view(camera: &'static str, outer: f64, size: (u32, u32)) -> View {
    View {
        camera,
        outer,
        size,
    }
}

/// Cameras that look along the disk, from without and within, or at all of it at once.
const VIEWS: [View; 8] = [
    view("position = [30, 0, 0.01]\nfov = 120", 100.0, (96, 54)),
    view("position = [30, 0, 0.01]\nfov = 120", 12.0, (96, 54)),
    view(
        "position = [-388.85, -992.31, 1.0658]\nfocus = [0.92, 3.07, 2.31]\nfov = 1.075",
        12.0,
        (64, 36),
    ),
    view(
        "position = [533.66, -1155.98, 0.1273]\nfocus = [3.44, -3.75, 4.25]\nfov = 5.4",
        1000.0,
        (64, 36),
    ),
    view(
        "position = [7.1715, 9.2143, 0.00117]\nfocus = [-3.49, -0.27, 6.48]\nfov = 98.14",
        12.0,
        (64, 36),
    ),
    view(
        "position = [0.69367, 2.06332, 0]\nfocus = [0.2988, -0.19, -0.8]\nfov = 150",
        5.0,
        (64, 36),
    ),
    view("position = [29.5442, 0, 5.2094]\nfov = 179", 12.0, (96, 54)),
    view("position = [29.5442, 0, 5.2094]\nfov = 30", 12.0, (1, 1)),
];

fn luminance([red, green, blue]: [f64; 3]) -> f64 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// The greatest luminance of a scene's places, 8 in a pixel's side.
fn brightest(scene: &Scene) -> f64 {
    let (width, height) = (scene.image().width, scene.image().height);
    let finer = scene
        .clone()
        .with_size(width.max(12) * 8, height.max(12) * 8)
        .unwrap()
        .with_antialias(false);
    let layers = Layers::rendered(&finer, table("standard").lookup());
    let pixels = finer.image().width * finer.image().height;
    let luminances = (0..pixels as usize).map(|i| luminance(layers.colour(i)));
    luminances.fold(0.0, f64::max)
}

#[test]
fn no_pixel_is_brighter_than_the_disk_or_tells_what_no_ray_has() {
    for View {
        camera,
        outer,
        size: (width, height),
    } in VIEWS
    {
        let text = format!(
            "[camera]\n{camera}\n[disk]\ninner = 3\nouter = {outer}\n[image]\nwidth = {width}\nheight = {height}\n"
        );
        let light = Light::BlackBody {
            temperature: 7000.0,
        };
        let scene = Scene::from_toml(&text).unwrap();
        let scene = scene.with_light(Some(light)).unwrap();
        let brightest = brightest(&scene);
        let frame = Layers::rendered(&scene, table("standard").lookup());
        for i in 0..(width * height) as usize {
            let place = format!("{camera}, outer {outer}, pixel {i}");
            let coverage = f64::from(frame.plane(Layer::Coverage)[i]);
            let light = luminance(frame.colour(i));
            // The brightest place may lie between those of `brightest`, and a share is right to a hundredth. What is
            // seen of a disk as small as a place is not known.
            let most = 1.2 * brightest * (coverage + 0.01);
            assert!(
                brightest == 0.0 || light <= most,
                "{place}: {light}, {most}"
            );
            if frame.plane(Layer::Order)[i] >= 0.0 {
                let cosine = frame.plane(Layer::EmissionCosine)[i];
                let redshift = frame.plane(Layer::Redshift)[i];
                assert!((0.0..=1.0).contains(&cosine), "{place}: cosine {cosine}");
                assert!(
                    (0.0..10.0).contains(&redshift),
                    "{place}: redshift {redshift}"
                );
            }
        }
    }
}
