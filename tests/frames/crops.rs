//! Guards against crops that differ from the whole picture, in any form and by any method.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use darkness::Renderer;
use darkness::orbit::exact::Exact;
use darkness::render::batch::{Frames, RayByRay};
use darkness::render::frame::Workspace;
use darkness::render::{Form, FrameMemory, Pixels};
use darkness::scene::{
    Animation, ImageSize, Layer, Light, Projection, Region, Scene, Sky, SkyFile, StarSource, Stars,
};
use darkness::sky::{Panorama, SkySource, StarField};
use proptest::prelude::Strategy;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use crate::any_scene::any_scene;
use crate::lit::layers_of;
use crate::noise::Random;
use crate::projections::seen_by;
use crate::tables::table;

/// A frame's pixels: the bytes of each, row by row; of layers one pixel after the other has all its numbers.
#[derive(Debug, PartialEq)]
struct Picture {
    width: usize,
    bytes_of_pixel: usize,
    bytes: Vec<u8>,
}

impl Picture {
    fn new(pixels: Pixels<'_>, ImageSize { width, height }: ImageSize) -> Self {
        let count = width as usize * height as usize;
        let bytes: Vec<u8> = match pixels {
            Pixels::Grey8(samples) | Pixels::Rgb8(samples) => samples.to_vec(),
            Pixels::Grey16(samples) | Pixels::Rgb16(samples) => samples
                .iter()
                .flat_map(|sample| sample.to_le_bytes())
                .collect(),
            Pixels::Planes(planes) => {
                let of_pixel = |pixel: usize| {
                    planes.iter().flat_map(move |plane| {
                        let channels = plane.layer.channels();
                        assert_eq!(plane.values.len(), count * channels);
                        plane.values[pixel * channels..][..channels].iter()
                    })
                };
                let values = (0..count).flat_map(of_pixel);
                values.flat_map(|value| value.to_le_bytes()).collect()
            }
        };
        assert_eq!(bytes.len() % count, 0);
        Self {
            width: width as usize,
            bytes_of_pixel: bytes.len() / count,
            bytes,
        }
    }

    /// A part of it.
    fn part(&self, part: Region) -> Self {
        let (left, width) = (part.left as usize, part.width as usize);
        let row = |row: u32| {
            let first = (row as usize * self.width + left) * self.bytes_of_pixel;
            &self.bytes[first..first + width * self.bytes_of_pixel]
        };
        let rows = part.top..part.top + part.height;
        Self {
            width,
            bytes_of_pixel: self.bytes_of_pixel,
            bytes: rows.flat_map(row).copied().collect(),
        }
    }
}

/// A sky with a panorama, stars and a grid.
fn sky(random: &mut Random) -> (Sky, Arc<SkySource>) {
    let sky = Sky {
        panorama: Some(SkyFile::new("of the test")),
        stars: Some(Stars::new(StarSource::File(SkyFile::new("of the test")))),
        grid: Some(15.0),
        rotation: [10.0, 20.0, 30.0],
        ..Sky::default()
    };
    let texels = (0..6 * 32 * 32).map(|_| random.number() as f32).collect();
    let panorama = Panorama::from_linear(32, texels);
    let stars = StarField::synthetic(3000, 1, None);
    let source = SkySource::new(Some(panorama), Some(stars), Some(15.0));
    (sky, Arc::new(source))
}

/// A part of a picture: of any size, and often at its sides.
fn any_part(random: &mut Random, ImageSize { width, height }: ImageSize) -> Region {
    let mut side = |all: u32| {
        let mut below = |count: u32| (random.number() * f64::from(count)) as u32;
        let length = 1 + [below(3), below(40), below(all)][below(3) as usize];
        let length = length.min(all);
        (below(all - length + 1), length)
    };
    let ((left, width), (top, height)) = (side(width), side(height));
    Region {
        left,
        top,
        width,
        height,
    }
}

/// Random scenes: masks, light, skies with all they may hold, skies with stars alone.
fn any_scenes(count: usize) -> impl Iterator<Item = (Scene, Option<Arc<SkySource>>)> {
    let mut runner = TestRunner::deterministic();
    let mut random = Random(11);
    let (full, source) = sky(&mut random);
    let dots = Sky {
        stars: full.stars.clone(),
        ..Sky::default()
    };
    let stars = StarField::synthetic(3000, 1, None);
    let stars = Arc::new(SkySource::new(None, Some(stars), None));
    (0..count).map(move |number| {
        let (_, scene) = any_scene().new_tree(&mut runner).unwrap().current();
        // Some pictures have several tiles a side.
        let ImageSize { width, height } = scene.image();
        let scene = scene
            .with_size(width * (1 + number as u32 % 3), height)
            .unwrap();
        let scene = match number % 7 {
            4 => seen_by(&scene, Projection::Fisheye, 360.0, height),
            5 => seen_by(&scene, Projection::Fisheye, 150.0, height),
            6 => seen_by(&scene, Projection::Equirectangular, 180.0, height),
            _ => scene,
        };
        let scene = scene.with_antialias(number % 4 != 3);
        let light = match number % 3 {
            0 => None,
            1 => Some(Light::Bolometric),
            _ => Some(Light::BlackBody {
                temperature: 7000.0,
            }),
        };
        let scene = scene.with_light(light).unwrap();
        match number % 5 {
            0 | 1 => (scene, None),
            2 => (
                scene.with_sky(Some(dots.clone())).unwrap(),
                Some(Arc::clone(&stars)),
            ),
            _ => (
                scene.with_sky(Some(full.clone())).unwrap(),
                Some(Arc::clone(&source)),
            ),
        }
    })
}

/// The forms in which a scene can be drawn.
fn forms(scene: &Scene) -> Vec<Form> {
    let layers = layers_of(scene).with(Layer::Sky).with(Layer::SkyUv);
    let mut forms = vec![Form::Grey8, Form::Grey16];
    if scene.shows_colour() {
        forms.extend([Form::Rgb8, Form::Rgb16]);
    }
    let layers = if scene.shows_colour() {
        layers.with(Layer::Colour)
    } else {
        layers
    };
    forms.push(Form::Layers(layers));
    forms
}

/// The bytes of 1,000 random crops of random scenes are those of the whole picture.
#[test]
fn crops_have_the_whole_pictures_bytes() {
    let mut random = Random(7);
    let mut crops = 0;
    for (number, (scene, source)) in any_scenes(125).enumerate() {
        let mut renderer = Renderer::new(table("standard"));
        if let (Some(sky), Some(source)) = (scene.sky(), source) {
            renderer = renderer.with_sky(sky.clone(), source);
        }
        let mut memories: Vec<_> = forms(&scene).into_iter().map(FrameMemory::new).collect();
        let wholes: Vec<Picture> = memories
            .iter_mut()
            .map(|memory| {
                renderer.draw(&scene, memory).unwrap();
                Picture::new(memory.pixels(), scene.size())
            })
            .collect();
        for _ in 0..8 {
            let part = any_part(&mut random, scene.image());
            let cropped = scene.clone().with_crop(Some(part)).unwrap();
            // Each form of some scenes, one of the others.
            let one = (random.number() * memories.len() as f64) as usize;
            for (i, (memory, whole)) in memories.iter_mut().zip(&wholes).enumerate() {
                if number % 8 == 0 || i == one {
                    renderer.draw(&cropped, memory).unwrap();
                    let drawn = Picture::new(memory.pixels(), cropped.size());
                    assert!(
                        drawn == whole.part(part),
                        "{:?}\n{}",
                        memory.form(),
                        cropped.to_toml()
                    );
                }
            }
            crops += 1;
        }
    }
    assert_eq!(crops, 1000);
}

/// A mosaic of crops is the picture, whichever renderer draws them.
#[test]
fn a_mosaic_of_crops_is_the_picture() {
    let lefts = [(0, 1), (1, 130), (131, 149), (280, 40)];
    let tops = [(0, 33), (33, 1), (34, 66)];
    for (name, form) in [
        ("classic", Form::Grey8),
        ("lit", Form::Rgb16),
        ("lit", Form::Rgb8),
    ] {
        let scene = Scene::builtin(name).unwrap().with_size(320, 100).unwrap();
        let drawn = |scene: &Scene| {
            let mut memory = FrameMemory::new(form);
            Renderer::new(table("standard"))
                .draw(scene, &mut memory)
                .unwrap();
            Picture::new(memory.pixels(), scene.size())
        };
        let whole = drawn(&scene);
        let mut mosaic = Vec::new();
        for (top, height) in tops {
            let parts = lefts.map(|(left, width)| {
                let part = Region {
                    left,
                    top,
                    width,
                    height,
                };
                drawn(&scene.clone().with_crop(Some(part)).unwrap())
            });
            for row in 0..height as usize {
                for part in &parts {
                    let bytes = part.width * part.bytes_of_pixel;
                    mosaic.extend_from_slice(&part.bytes[row * bytes..][..bytes]);
                }
            }
        }
        assert!(mosaic == whole.bytes, "{name}");
    }
}

/// A caller's buffer keeps what is between the rows of a crop.
#[test]
fn crops_go_into_a_callers_buffer() {
    let scene = Scene::builtin("lit").unwrap().with_size(200, 80).unwrap();
    let whole = Renderer::new(table("standard")).render_rgb(&scene).unwrap();
    let part = Region {
        left: 70,
        top: 20,
        width: 90,
        height: 50,
    };
    let scene = scene.with_crop(Some(part)).unwrap();
    let (stride, mut pixels) = (301, vec![7; 301 * 49 + 270]);
    let mut renderer = Renderer::new(table("standard"));
    renderer
        .render_rgb_into(&scene, &mut pixels, stride)
        .unwrap();
    let own = renderer.render_rgb(&scene).unwrap();
    assert_eq!(own.dimensions(), (90, 50));
    for (y, row) in pixels.chunks(stride).enumerate() {
        assert!(row[270..].iter().all(|byte| *byte == 7));
        for (x, pixel) in row[..270].as_chunks::<3>().0.iter().enumerate() {
            let (x, y) = (x as u32, y as u32);
            assert_eq!(*pixel, whole.get_pixel(70 + x, 20 + y).0);
            assert_eq!(*pixel, own.get_pixel(x, y).0);
        }
    }
    assert!(renderer.render_rgb_into(&scene, &mut pixels, 269).is_err());
}

/// Frames of a batch, drawn side by side, are crops of the whole frames.
#[test]
fn crops_of_a_batch_are_parts_of_its_frames() {
    let whole = Animation::load("lit-orbit")
        .unwrap()
        .with_size(150, 50)
        .unwrap();
    let part = Region {
        left: 20,
        top: 9,
        width: 115,
        height: 30,
    };
    let cropped = whole.clone().with_crop(Some(part)).unwrap();
    assert_eq!((cropped.region(), cropped.image()), (part, whole.image()));
    let frames = |animation: &Animation| {
        let pictures = Mutex::new(BTreeMap::new());
        let renderer = Renderer::new(table("standard"));
        let drawn = renderer.render_frames(animation, Form::Rgb8, 1..=20, |frame| {
            let (pixels, _) = frame.pixels.map_err(|error| error.to_string())?;
            let picture = Picture::new(pixels, animation.size());
            pictures.lock().unwrap().insert(frame.number, picture);
            Ok::<(), String>(())
        });
        drawn.unwrap();
        pictures.into_inner().unwrap()
    };
    let (whole, cropped) = (frames(&whole), frames(&cropped));
    assert_eq!(cropped.len(), 20);
    for (number, picture) in cropped {
        assert!(picture == whole[&number].part(part), "{number}");
    }
}

/// Crops that are drawn ray by ray.
#[test]
fn crops_have_the_whole_pictures_bytes_ray_by_ray() {
    let mut random = Random(5);
    for (scene, source) in any_scenes(10) {
        let scene = match scene.camera().projection {
            Projection::Equirectangular => scene.with_size(140, 70).unwrap(),
            _ => scene.with_size(140, 40).unwrap(),
        };
        for form in forms(&scene) {
            let drawn = |scene: &Scene| {
                let still = Animation::from_toml(&scene.to_toml()).unwrap();
                let (mut memory, row_done) = (FrameMemory::new(form), || ());
                let frames = RayByRay::new(&still, &Exact, source.clone(), &row_done);
                let workspace = &mut Workspace::default();
                frames.draw(1, true, workspace, &mut memory).unwrap();
                Picture::new(memory.pixels(), scene.size())
            };
            let part = any_part(&mut random, scene.image());
            let cropped = scene.clone().with_crop(Some(part)).unwrap();
            assert!(
                drawn(&cropped) == drawn(&scene).part(part),
                "{form:?}\n{}",
                cropped.to_toml()
            );
        }
    }
}
