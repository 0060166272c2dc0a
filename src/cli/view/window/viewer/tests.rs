use super::*;
use crate::scene::{Layer, View};

const SIZE: ImageSize = ImageSize {
    width: 320,
    height: 180,
};

/// A viewer of a built-in scene, and the time at which it began.
fn viewer(name: &str) -> (Viewer, Instant) {
    let mut viewer = Viewer::new(Animation::load(name).unwrap(), SIZE).unwrap();
    assert!(viewer.take_change() && !viewer.take_change());
    (viewer, Instant::now())
}

/// Drags from the middle of the picture.
fn drag(viewer: &mut Viewer, button: Button, (right, down): (f64, f64), now: Instant) {
    viewer.point((160.0, 90.0), now);
    viewer.press(button, true, now);
    viewer.point((160.0 + right, 90.0 + down), now);
    viewer.press(button, false, now);
}

fn keys(viewer: &mut Viewer, keys: &str, now: Instant) {
    for key in keys.chars() {
        let action = super::super::super::controls::action(key).unwrap();
        assert_eq!(viewer.act(action, now), None, "{key}");
    }
}

#[test]
fn at_first_it_shows_what_is_rendered() {
    for name in ["classic", "lit", "stars", "orbit"] {
        let (viewer, _) = viewer(name);
        let scene = Scene::builtin(name).unwrap();
        let scene = scene.with_size(SIZE.width, SIZE.height).unwrap();
        let camera = *scene.camera();
        let scene = scene
            .with_camera(camera)
            .unwrap()
            .with_layers(<_>::default());
        assert_eq!(viewer.scene(), &scene.unwrap(), "{name}");
        assert!(!viewer.is_moving() && viewer.message().is_none() && viewer.bar().is_none());
    }
}

#[test]
fn drags_turn_and_look_aside_and_the_wheel_moves() {
    let (mut viewer, now) = viewer("lit");
    let mut expected = Navigator::new(viewer.scene());
    drag(&mut viewer, Button::Left, (32.0, 18.0), now);
    expected.turn(32.0, 18.0);
    assert_eq!(viewer.navigator(), &expected);
    assert_eq!(viewer.scene().camera(), &expected.camera());
    assert!(viewer.is_moving() && viewer.take_change());

    drag(&mut viewer, Button::Right, (10.0, 20.0), now);
    let per_pixel = expected.fov_degrees() * (1.0 / 180.0);
    expected.look(-per_pixel * 10.0, -per_pixel * 20.0);
    assert_eq!(viewer.navigator(), &expected);

    viewer.roll(2.0, now);
    expected.zoom(0.81);
    let away = viewer.navigator().radius() - expected.radius();
    assert!(away.abs() < 1e-12, "{away}");
    // Without a button nothing is dragged.
    let before = viewer.scene().clone();
    viewer.point((1.0, 1.0), now);
    assert_eq!(viewer.scene(), &before);
}

#[test]
fn what_is_seen_follows_the_pointer_when_it_looks_aside() {
    let (mut viewer, now) = viewer("lit");
    let ray = |viewer: &Viewer, x, y| {
        let ray = View::new(viewer.scene()).pixel(x, y);
        [ray.ta, ray.tb]
    };
    let before = ray(&viewer, 160, 90);
    drag(&mut viewer, Button::Right, (7.0, -5.0), now);
    let after = ray(&viewer, 167, 85);
    let side = View::new(viewer.scene()).pixel_side();
    for (before, after) in before.iter().zip(after) {
        assert!((before - after).abs() < 0.5 * side);
    }
}

#[test]
fn the_camera_comes_to_rest() {
    let (mut viewer, now) = viewer("lit");
    assert_eq!(viewer.next(now), None);
    viewer.roll(1.0, now);
    viewer.take_change();
    let rest = viewer.next(now).unwrap();
    viewer.pass(now + REST / 2);
    assert!(viewer.is_moving() && !viewer.take_change());
    viewer.pass(rest);
    assert!(!viewer.is_moving() && viewer.take_change());
    assert_eq!(viewer.next(rest), None);
}

#[test]
fn keys_change_the_field_of_view_and_the_exposure_and_reset_brings_all_back() {
    let (mut viewer, now) = viewer("lit");
    let first = viewer.scene().clone();
    keys(&mut viewer, "]", now);
    assert!(viewer.scene().camera().fov_degrees > first.camera().fov_degrees);
    keys(&mut viewer, "[[", now);
    assert!(viewer.scene().camera().fov_degrees < first.camera().fov_degrees);
    keys(&mut viewer, "...,", now);
    assert_eq!(viewer.scene().exposure(), first.exposure() + 0.5);
    keys(&mut viewer, "lo", now);
    assert_eq!(
        (viewer.shown().name().as_str(), viewer.order()),
        ("coverage", Some(0))
    );
    drag(&mut viewer, Button::Left, (5.0, 5.0), now);
    keys(&mut viewer, "r", now);
    assert_eq!(viewer.scene(), &first);
    assert_eq!((viewer.shown(), viewer.order()), (Shown::Light, None));
    // As far as exposures go.
    for _ in 0..1000 {
        keys(&mut viewer, ".", now);
    }
    assert_eq!(viewer.scene().exposure(), MAX_EXPOSURE);
}

#[test]
fn orders_come_one_by_one_where_there_is_a_disk() {
    let (mut viewer, now) = viewer("lit");
    let mut seen = Vec::new();
    for _ in 0..6 {
        keys(&mut viewer, "o", now);
        seen.push(viewer.order());
    }
    assert_eq!(seen, [Some(0), Some(1), Some(2), Some(3), None, Some(0)]);
    assert_eq!(viewer.message(), Some("order 0 alone"));
    let (mut sky, now) = self::viewer("grid");
    keys(&mut sky, "o", now);
    assert_eq!(sky.order(), None);
}

#[test]
fn a_mask_has_a_light_when_light_is_asked_for() {
    let (mut viewer, now) = viewer("classic");
    let mask = viewer.scene().clone();
    keys(&mut viewer, "l", now);
    assert!(viewer.scene().light().is_some());
    keys(&mut viewer, "L", now);
    assert_eq!(viewer.scene(), &mask);
    keys(&mut viewer, "llll", now);
    assert_eq!(viewer.shown(), Shown::Channel(Layer::Radius, 0));
    assert_eq!(viewer.scene().light(), None);
    // Exposure means nothing to a mask.
    keys(&mut viewer, "LLLL.", now);
    assert_eq!(viewer.scene(), &mask);
}

#[test]
fn keys_of_the_window_are_handed_on() {
    let (mut viewer, now) = viewer("lit");
    for (action, request) in [
        (Action::FullScreen, Request::FullScreen),
        (Action::SaveScene, Request::SaveScene),
        (Action::SavePicture, Request::SavePicture),
        (Action::Close, Request::Close),
    ] {
        assert_eq!(viewer.act(action, now), Some(request));
    }
    assert!(!viewer.take_change());
    keys(&mut viewer, "hi", now);
    assert!(viewer.has_help() && viewer.has_figures() && viewer.take_change());
    keys(&mut viewer, "HI", now);
    assert!(!viewer.has_help() && !viewer.has_figures());
}

#[test]
fn the_animation_plays_until_the_hand_takes_over() {
    let (mut viewer, now) = viewer("lit-orbit");
    let animation = Animation::load("lit-orbit").unwrap();
    keys(&mut viewer, " ", now);
    assert!(viewer.bar().is_some() && viewer.is_moving());
    let due = viewer.next(now).unwrap();
    viewer.pass(due);
    assert_eq!(viewer.playback().frame(), 2);
    assert_eq!(
        viewer.scene().camera(),
        animation.frame(2).unwrap().camera()
    );
    drag(&mut viewer, Button::Left, (9.0, 0.0), due);
    assert!(!viewer.playback().is_playing());
    let mut turned = Navigator::new(&animation.frame(2).unwrap());
    turned.turn(9.0, 0.0);
    assert_eq!(viewer.scene().camera(), &turned.camera());
    // It plays on from the frame that it stopped at, with the animation's camera.
    keys(&mut viewer, " ", due);
    assert_eq!(
        viewer.scene().camera(),
        animation.frame(2).unwrap().camera()
    );
    keys(&mut viewer, " r", due);
    assert_eq!(viewer.playback().frame(), 2);

    let (mut still, now) = self::viewer("lit");
    keys(&mut still, " ", now);
    assert_eq!(still.message(), Some("this scene has no animation"));
    assert!(!still.playback().is_playing());
    still.pass(now + MESSAGE);
    assert_eq!(still.message(), None);
}

#[test]
fn the_bar_appears_under_the_pointer_and_leads_to_frames() {
    let (mut viewer, now) = viewer("orbit");
    viewer.point((160.0, 20.0), now);
    assert!(viewer.bar().is_none() && !viewer.take_change());
    viewer.point((160.0, 175.0), now);
    assert!(viewer.bar().is_some() && viewer.take_change());
    viewer.press(Button::Left, true, now);
    assert_eq!(viewer.playback().frame(), 121);
    viewer.point((320.0, 20.0), now);
    assert_eq!(viewer.playback().frame(), 240);
    let last = Animation::load("orbit").unwrap().frame(240).unwrap();
    assert_eq!(viewer.scene().camera(), last.camera());
    viewer.press(Button::Left, false, now);
    assert!(viewer.bar().is_none());
    // In a scene without an animation the lower edge is like any other place.
    let (mut still, now) = self::viewer("lit");
    still.point((160.0, 175.0), now);
    still.press(Button::Left, true, now);
    still.point((160.0, 170.0), now);
    assert!(!still.navigator().is_at_start() && still.bar().is_none());
}

#[test]
fn a_scene_that_is_read_again_keeps_the_hands_camera_where_it_can() {
    let (mut viewer, now) = viewer("lit");
    let lit = Animation::load("lit").unwrap().to_toml();
    let with = |from: &str, to: &str| {
        assert!(lit.contains(from), "{lit}");
        Animation::from_toml(&lit.replace(from, to))
    };
    viewer.reload(with("outer = 12.0", "outer = 9.0"), now);
    assert_eq!(viewer.scene().disk().unwrap().outer, 9.0);
    let camera = *Scene::builtin("lit").unwrap().camera();
    assert_eq!(viewer.scene().camera(), &camera);

    drag(&mut viewer, Button::Left, (3.0, 3.0), now);
    let camera = *viewer.scene().camera();
    viewer.reload(with("outer = 12.0", "outer = 10.0"), now);
    assert_eq!(viewer.scene().camera(), &camera);
    assert_eq!(viewer.scene().disk().unwrap().outer, 10.0);

    let before = viewer.scene().clone();
    viewer.reload(with("outer = 12.0", "outer = 2.0"), now);
    assert_eq!(viewer.scene(), &before);
    assert!(viewer.message().unwrap().contains("disk.outer"));
    // What is wrong is told until it is mended.
    viewer.pass(now + Duration::from_secs(100));
    assert!(viewer.message().unwrap().contains("disk.outer"));
    viewer.reload(with("outer = 12.0", "outer = 11.0"), now);
    assert_eq!(viewer.message(), Some("the scene was read again"));
    assert_eq!(viewer.scene().disk().unwrap().outer, 11.0);
}

#[test]
fn another_size_keeps_the_view() {
    let (mut viewer, now) = viewer("lit");
    drag(&mut viewer, Button::Left, (3.0, 3.0), now);
    let camera = *viewer.scene().camera();
    let size = ImageSize {
        width: 500,
        height: 400,
    };
    viewer.resize(size);
    assert_eq!(
        (viewer.scene().camera(), viewer.scene().image()),
        (&camera, size)
    );
    viewer.take_change();
    viewer.resize(size);
    assert!(!viewer.take_change());
}

#[test]
fn the_whole_sphere_is_in_the_middle_of_any_window() {
    let toml = "[camera]\nposition = [20, 0, 5]\nprojection = \"equirectangular\"\n[disk]\n\
                [image]\nwidth = 64\nheight = 32\n";
    let animation = Animation::from_toml(toml).unwrap();
    let mut viewer = Viewer::new(animation, SIZE).unwrap();
    let size = |viewer: &Viewer| (viewer.scene().image().width, viewer.scene().image().height);
    assert_eq!(
        (size(&viewer), viewer.area().left, viewer.area().top),
        ((320, 160), 0, 10)
    );
    viewer.point((7.0, 30.0), Instant::now());
    assert_eq!(viewer.pointer(), Some((7.0, 20.0)));
    viewer.resize(ImageSize {
        width: 333,
        height: 100,
    });
    assert_eq!(
        (size(&viewer), viewer.area().left, viewer.area().top),
        ((200, 100), 66, 0)
    );
    keys(&mut viewer, "]", Instant::now());
    assert_eq!(viewer.scene().camera().fov_degrees, 180.0);
}

#[test]
fn a_crop_is_shown_as_the_whole_picture() {
    let toml = Scene::builtin("lit").unwrap().to_toml() + "crop = [5, 5, 20, 10]\n";
    let viewer = Viewer::new(Animation::from_toml(&toml).unwrap(), SIZE).unwrap();
    assert_eq!((viewer.scene().size(), viewer.scene().crop()), (SIZE, None));
}
