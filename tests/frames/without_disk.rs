//! Guards against a scene without a disk that shows one, or that cannot be drawn; against a disk before a sky that is
//! not white.

use darkness::isoradial::{CurveSpec, Isoradials, RadiusMap, sensitivity};
use darkness::orbit::exact::Exact;
use darkness::render::Form;
use darkness::render::needs::Needs;
use darkness::scene::{Camera, ImageSize, Layer, LayerSet, Scene, Sky, View};
use darkness::{Renderer, render::pixelwise};

use crate::methods::by_pixels;
use crate::tables::table;

fn scenes() -> impl Iterator<Item = Scene> {
    let size = ImageSize {
        width: 37,
        height: 21,
    };
    let cameras = [
        Camera::at([15.0, 0.0, 0.0], 60.0),
        Camera::at([5.0, 0.0, 3.0], 100.0),
        Camera::at([0.0, 1.2, 0.0], 120.0),
    ];
    cameras.into_iter().flat_map(move |camera| {
        let scene = Scene::without_disk(camera, Sky::default(), size).unwrap();
        [true, false].map(|antialias| scene.clone().with_antialias(antialias))
    })
}

#[test]
fn its_mask_is_black() {
    let mut renderer = Renderer::new(table("standard"));
    for scene in scenes() {
        let mask = renderer.render(&scene).unwrap().into_raw();
        assert!(mask.iter().all(|&pixel| pixel == 0));
        assert!(mask == by_pixels(&scene, &Exact));
        let view = View::new(&scene);
        let sight = pixelwise::sight(&scene, &view, &Exact, (18, 10));
        assert_eq!(sight, Ok(None));
    }
}

#[test]
fn its_data_are_those_of_no_disk() {
    let layers: LayerSet = [
        Layer::Coverage,
        Layer::Order,
        Layer::Radius,
        Layer::Redshift,
    ]
    .into_iter()
    .collect();
    let mut renderer = Renderer::new(table("standard"));
    for scene in scenes() {
        for plane in renderer.render_layers(&scene, layers).unwrap() {
            let nothing = plane.layer.nothing().to_bits();
            assert!(plane.values.iter().all(|value| value.to_bits() == nothing));
        }
    }
}

#[test]
fn it_has_no_curves_and_no_needs() {
    for scene in scenes() {
        let view = View::new(&scene);
        let spec = CurveSpec::new(&scene, &view, scene.tolerance());
        let curves = Isoradials::new(&spec, &Exact);
        assert!(curves.orders().is_empty() && curves.left_out().is_none());
        assert!(curves.serves(&spec));
        assert_eq!(RadiusMap::new(&curves, &Exact).nodes(), 0);
        assert_eq!(sensitivity(&spec, &Exact), 0.0);
        let needs = Needs::new(&scene, &view, Form::Grey8);
        assert_eq!(needs.table().unwrap().name, "draft");
    }
}

#[test]
fn directions_need_the_standard_table() {
    for scene in scenes() {
        for layer in [Layer::Sky, Layer::SkyUv] {
            let form = Form::Layers(LayerSet::default().with(layer));
            let needs = Needs::new(&scene, &View::new(&scene), form);
            assert_eq!(needs.table().unwrap().name, "standard");
            assert!(!form.needs_map(&scene));
        }
    }
}

#[test]
fn before_a_sky_a_disk_without_light_is_white() {
    let classic = Scene::builtin("classic")
        .and_then(|scene| scene.with_size(96, 54))
        .and_then(|scene| scene.with_sky(Some(Sky::default())))
        .unwrap();
    let mut renderer = Renderer::new(table("standard"));
    for antialias in [true, false] {
        let scene = classic.clone().with_antialias(antialias);
        let layers = [Layer::Coverage, Layer::Colour].into_iter().collect();
        let planes = renderer.render_layers(&scene, layers).unwrap();
        let (shares, colours) = (&planes[0].values, &planes[1].values);
        for (share, colour) in shares.iter().zip(colours.as_chunks::<3>().0) {
            let is_white = colour.iter().all(|c| (c - share).abs() < 1e-6);
            assert!(is_white, "{share}: {colour:?}");
        }
        assert!(shares.contains(&1.0) && shares.contains(&0.0));
    }
    // Where the renderer has a map, as for data of the scene before, its bytes are the same.
    let form = Form::Layers([Layer::Coverage, Layer::Colour].into_iter().collect());
    assert!(!form.needs_map(&classic) && !Form::Rgb8.needs_map(&classic));
    let picture = renderer.render_rgb(&classic).unwrap();
    let data = LayerSet::default().with(Layer::Redshift);
    assert!(Form::Layers(data).needs_map(&classic));
    renderer.render_layers(&classic, data).unwrap();
    assert!(renderer.render_rgb(&classic).unwrap() == picture);
    // Without a sky it has no colour.
    let black = classic.with_sky(None).unwrap();
    assert!(renderer.render_rgb(&black).is_err());
}
