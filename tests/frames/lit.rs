//! Frames of data and of light, by each method.

use std::cell::OnceCell;

use darkness::Renderer;
use darkness::light::Sight;
use darkness::orbit::Orbits;
use darkness::orbit::exact::Exact;
use darkness::orbit::path::SweptAngles;
use darkness::render::batch::{Frames, RayByRay};
use darkness::render::frame::Workspace;
use darkness::render::{Form, FrameMemory, Pixels, Plane, pixelwise};
use darkness::scene::{Animation, Layer, LayerSet, Light, Scene, View};
use proptest::prelude::Strategy;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use crate::any_scene::{Kind, any_scene};

/// What a ray tells about the disk, and whether the pixel is covered.
const DATA: [Layer; 6] = [
    Layer::Coverage,
    Layer::Order,
    Layer::Radius,
    Layer::Azimuth,
    Layer::Redshift,
    Layer::EmissionCosine,
];

/// A frame's layers: data, and light if the scene has any.
#[derive(Debug, PartialEq)]
pub(crate) struct Layers(Vec<Plane>);

/// Every layer that a scene's light allows, and without light those of data.
pub(crate) fn layers_of(scene: &Scene) -> LayerSet {
    let data = DATA.into_iter().chain([Layer::Alpha]).collect::<LayerSet>();
    match scene.light() {
        None => data,
        Some(Light::Bolometric) => data.with(Layer::Colour),
        Some(Light::BlackBody { .. }) => data.with(Layer::Colour).with(Layer::Temperature),
    }
}

impl Layers {
    /// From the map of the camera's radius, or ray by ray where the curves do not reach: as users get it.
    pub(crate) fn rendered(scene: &Scene, angles: impl SweptAngles) -> Self {
        let mut renderer = Renderer::with_angles(angles);
        Self(renderer.render_layers(scene, layers_of(scene)).unwrap())
    }

    /// From each pixel's own ray.
    pub(crate) fn by_rays(scene: &Scene, orbits: &impl Orbits) -> Self {
        Self(drawn_by_rays(scene, orbits, Form::Layers(layers_of(scene))).into_planes())
    }

    pub(crate) fn plane(&self, layer: Layer) -> &[f32] {
        let plane = self.0.iter().find(|plane| plane.layer == layer);
        &plane.expect("a layer of the frame").values
    }

    /// The linear light of a pixel.
    pub(crate) fn colour(&self, pixel: usize) -> [f64; 3] {
        let colour = &self.plane(Layer::Colour)[3 * pixel..][..3];
        [colour[0], colour[1], colour[2]].map(f64::from)
    }

    /// What a pixel tells of the disk; `None` where its order is −1. All layers must agree on whether it tells
    /// anything.
    pub(crate) fn sight(&self, pixel: usize) -> Option<Sight> {
        let value = |layer| f64::from(self.plane(layer)[pixel]);
        let order = value(Layer::Order);
        let data = [
            Layer::Radius,
            Layer::Azimuth,
            Layer::Redshift,
            Layer::EmissionCosine,
        ]
        .map(value);
        if order == -1.0 {
            assert!(data.iter().all(|v| v.is_nan()), "{pixel}: {data:?}");
            assert_eq!(value(Layer::Coverage), 0.0, "{pixel}");
            return None;
        }
        assert!(data.iter().all(|v| v.is_finite()), "{pixel}: {data:?}");
        assert!(value(Layer::Coverage) > 0.0, "{pixel}");
        assert!(order >= 0.0 && order.fract() == 0.0, "{pixel}: {order}");
        Some(Sight {
            order: order as u32,
            u: 1.0 / data[0],
            azimuth: data[1],
            redshift: data[2],
            emission_cosine: data[3],
        })
    }
}

/// A frame from each pixel's own ray.
fn drawn_by_rays(scene: &Scene, orbits: &impl Orbits, form: Form) -> FrameMemory {
    let still = Animation::from_toml(&scene.to_toml()).unwrap();
    assert_eq!(still.frame(1).unwrap().to_toml(), scene.to_toml());
    let mut memory = FrameMemory::new(form);
    let row_done = || ();
    let frames = RayByRay::new(&still, orbits, None, &row_done);
    let workspace = &mut Workspace::default();
    frames.draw(1, true, workspace, &mut memory).unwrap();
    memory
}

/// The 8-bit colours of each pixel's own ray.
pub(crate) fn rgb_by_rays(scene: &Scene, orbits: &impl Orbits) -> Vec<u8> {
    match drawn_by_rays(scene, orbits, Form::Rgb8).pixels() {
        Pixels::Rgb8(bytes) => bytes.to_vec(),
        other => panic!("{other:?}"),
    }
}

/// The pixels of a scene that are about an edge: a thousandth of a pixel aside, another order is seen or none. That is
/// what curves promise ([`darkness::scene::DEFAULT_TOLERANCE`]).
pub(crate) struct Edges<'a> {
    scene: &'a Scene,
    view: OnceCell<View>,
}

impl<'a> Edges<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        let view = OnceCell::new();
        Self { scene, view }
    }

    pub(crate) fn have(&self, (i, j): (u32, u32)) -> bool {
        const SHIFTS: [f64; 3] = [-1e-3, 0.0, 1e-3];
        let view = self.view.get_or_init(|| View::new(self.scene));
        let order = |dx: f64, dy: f64| {
            let (x, y) = (f64::from(i) + 0.5 + dx, f64::from(j) + 0.5 + dy);
            order_at(self.scene, view, x, y)
        };
        let centre = order(0.0, 0.0);
        let around = SHIFTS.iter().flat_map(|&dx| SHIFTS.map(|dy| (dx, dy)));
        around.into_iter().any(|(dx, dy)| order(dx, dy) != centre)
    }
}

fn order_at(scene: &Scene, view: &View, column: f64, row: f64) -> Option<u32> {
    let ray = view.ray_at(view.x_at(column), view.y_at(row));
    let sight = pixelwise::sight_along(scene, view, &Exact, ray).unwrap();
    sight.map(|sight| sight.order)
}

/// The light of a scene's number: black bodies from red to blue, and all wavelengths together.
fn light(number: usize) -> Light {
    match number % 4 {
        0 => Light::Bolometric,
        1 => Light::BlackBody {
            temperature: 7000.0,
        },
        2 => Light::BlackBody {
            temperature: 2500.0,
        },
        _ => Light::BlackBody { temperature: 4e4 },
    }
}

/// Random scenes with light and hard edges, the same at each call.
pub(crate) fn random_lit_scenes(count: usize, size: (u32, u32)) -> Vec<(Kind, Scene)> {
    let (mut runner, scenes) = (TestRunner::deterministic(), any_scene());
    let scene = |number| {
        let (kind, scene) = scenes.new_tree(&mut runner).unwrap().current();
        let scene = scene.with_antialias(false).with_light(Some(light(number)));
        (kind, scene.unwrap().with_size(size.0, size.1).unwrap())
    };
    (0..count).map(scene).collect()
}

/// The built-in scenes with light, small, with hard edges: their names, and frames of the animations.
pub(crate) fn builtin_lit_scenes() -> Vec<(String, Scene)> {
    let still = ["lit", "luminet", "rings"].map(|name| (name, 1));
    let moving = [
        ("lit-orbit", 7),
        ("lit-orbit", 100),
        ("plunge", 1),
        ("plunge", 90),
        ("plunge", 150),
        ("plunge", 240),
    ];
    let scenes = still.into_iter().chain(moving);
    scenes
        .map(|(name, number)| {
            let animation = Animation::load(name).unwrap();
            let animation = animation.with_size(96, 54).unwrap();
            let scene = animation.frame(number).unwrap();
            (format!("{name} {number}"), scene.with_antialias(false))
        })
        .collect()
}
