//! Guards against keys that do not what the help says.

use darkness::Scene;
use darkness::scene::{Layer, LayerSet, Light};

use crate::display::{Picture, Window, can_show, drawn, steered, wait_until};
use crate::tables::table;

/// The colour of the pixel at a place.
fn pixel(picture: &Picture, (x, y): (u32, u32)) -> [u8; 3] {
    let place = 3 * (y * picture.width + x) as usize;
    picture.bytes[place..place + 3].try_into().unwrap()
}

#[test]
fn the_field_of_view_the_exposure_and_the_reset() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    let first = drawn(&steered("lit", |_| {}));
    window.shows(&first);
    window.hand("key bracketleft");
    let near = steered("lit", |navigator| navigator.scale_fov(1.0 / 1.1));
    window.shows(&drawn(&near));
    window.hand("key period period comma");
    window.shows(&drawn(&near.with_exposure(0.25).unwrap()));
    window.hand("key r");
    window.shows(&first);
}

#[test]
fn what_is_shown_steps_through_mask_light_and_layers() {
    if !can_show() {
        return;
    }
    let window = Window::open("classic");
    let mask = steered("classic", |_| {});
    window.shows(&drawn(&mask));
    window.hand("key l");
    let light = Light::BlackBody {
        temperature: 7000.0,
    };
    let lit = drawn(&mask.clone().with_light(Some(light)).unwrap());
    window.shows(&lit);
    // Radius: the hue goes from violet within to yellow without, and black is where no disk is.
    window.hand("key l l l");
    let radius = LayerSet::default().with(Layer::Radius);
    let mut renderer = darkness::Renderer::new(table("standard"));
    let values = renderer
        .render_layers(&mask, radius)
        .unwrap()
        .remove(0)
        .values;
    let is_coloured = |picture: &Picture| {
        let (width, below_scale) = (picture.width, 60);
        (below_scale..picture.height).all(|y| {
            (0..width).all(|x| {
                let value = values[(y * width + x) as usize];
                let [red, green, blue] = pixel(picture, (x, y));
                match value {
                    value if value.is_nan() => [red, green, blue] == [0; 3],
                    value if value < 4.0 => blue > green,
                    value if value > 11.0 => green > 180 && blue < 120,
                    _ => green > 0,
                }
            })
        })
    };
    let picture = window.shows_what("radii in colours", is_coloured);
    // The scale in the upper right corner.
    assert_eq!(pixel(&picture, (50, 10)), [0; 3]);
    let row: Vec<_> = (0..320).map(|x| pixel(&picture, (x, 10))).collect();
    assert!(row.contains(&[68, 1, 84]) && row.contains(&[253, 231, 37]));
    window.hand("key shift+l shift+l shift+l");
    window.shows(&lit);
}

#[test]
fn an_order_alone_is_what_is_seen_of_it() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    let scene = steered("lit", |_| {});
    let whole = drawn(&scene);
    window.shows(&whole);
    let orders = LayerSet::default().with(Layer::Order);
    let mut renderer = darkness::Renderer::new(table("standard"));
    let orders = renderer
        .render_layers(&scene, orders)
        .unwrap()
        .remove(0)
        .values;
    for order in 0..2 {
        window.hand("key o");
        let mut alone = whole.clone();
        for (pixel, &seen) in alone.bytes.chunks_mut(3).zip(&orders) {
            if seen != order as f32 {
                pixel.fill(0);
            }
        }
        // The message about it is gone after three seconds.
        window.shows(&alone);
    }
}

#[test]
fn help_and_figures_are_written_over_the_picture_and_go() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    let plain = drawn(&steered("lit", |_| {}));
    window.shows(&plain);
    for key in ["h", "i"] {
        window.hand(&format!("key {key}"));
        window.shows_what(key, |picture| *picture != plain);
        window.hand(&format!("key {key}"));
        window.shows(&plain);
    }
}

#[test]
fn the_animation_plays_and_its_bar_leads_to_any_frame() {
    if !can_show() {
        return;
    }
    let window = Window::open("tilt");
    let frame = |number| {
        let animation = darkness::scene::Animation::load("tilt").unwrap();
        let scene: Scene = animation.frame(number).unwrap();
        let camera = *scene.camera();
        let scene = scene.with_size(320, 180).unwrap().with_camera(camera);
        drawn(&scene.unwrap())
    };
    let first = frame(1);
    window.shows(&first);
    window.hand("key space");
    let upper = |picture: &Picture| picture.bytes[..3 * 320 * 120].to_vec();
    window.shows_what("motion", |picture| upper(picture) != upper(&first));
    window.hand("key space");
    window.hand("mousemove 0 175 mousedown 1 mousemove 319 175 mouseup 1 mousemove 160 20");
    let last = darkness::scene::Animation::load("tilt").unwrap().last();
    window.shows(&frame(last));
}

#[test]
fn full_screen_is_asked_for_and_the_window_goes_on() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    let plain = drawn(&steered("lit", |_| {}));
    window.shows(&plain);
    // Without a window manager nothing comes of it.
    window.hand("key f");
    window.hand("key f key bracketright");
    let wider = steered("lit", |navigator| navigator.scale_fov(1.1));
    wait_until("the next frame", || window.picture() == drawn(&wider));
}
