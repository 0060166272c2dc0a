//! Guards against a window that shows other pixels than the library draws, or that moves otherwise than the hand.

use darkness::Scene;
use darkness::scene::Navigator;

use crate::display::{SIZE, Window, can_show, drawn, steered, wait_until};

/// The middle of the window.
const MIDDLE: (i32, i32) = (160, 90);

/// The degrees about the hole that a drag of one pixel turns.
const TURN: f64 = 180.0 / SIZE.1 as f64;

#[test]
fn the_window_shows_the_librarys_frame_and_the_key_q_ends_it_with_0() {
    if !can_show() {
        return;
    }
    for name in ["classic", "lit", "stars", "grid"] {
        let window = Window::open(name);
        window.shows(&drawn(&steered(name, |_| {})));
        window.hand("key q");
        let output = window.ends();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{stderr}");
        assert!(output.stdout.is_empty() && stderr.is_empty(), "{stderr}");
    }
}

#[test]
fn a_drag_down_inclines_and_a_drag_sideways_changes_nothing_of_a_symmetric_disk() {
    if !can_show() {
        return;
    }
    for name in ["classic", "lit"] {
        let window = Window::open(name);
        let before = drawn(&steered(name, |_| {}));
        window.shows(&before);
        window.drag(1, MIDDLE, (160, 120));
        let inclined = drawn(&steered(name, |navigator| navigator.turn(0.0, 30.0 * TURN)));
        assert!(inclined != before);
        window.shows(&inclined);
        let turned = |navigator: &mut Navigator| {
            navigator.turn(0.0, 30.0 * TURN);
            navigator.turn(40.0 * TURN, 0.0);
        };
        let sideways = drawn(&steered(name, turned));
        window.drag(1, MIDDLE, (200, 90));
        window.shows(&sideways);
        // Up to rounding: the camera's position is another one.
        let farthest = sideways.bytes.iter().zip(&inclined.bytes);
        let farthest = farthest.map(|(&a, &b)| a.abs_diff(b)).max();
        assert!(farthest <= Some(1), "{name}: {farthest:?}");
    }
}

#[test]
fn before_a_sky_a_drag_sideways_turns_the_sky() {
    if !can_show() {
        return;
    }
    let window = Window::open("stars");
    let turned = drawn(&steered("stars", |navigator| {
        navigator.turn(25.0 * TURN, 0.0);
    }));
    window.shows(&drawn(&steered("stars", |_| {})));
    window.drag(1, MIDDLE, (185, 90));
    window.shows(&turned);
}

#[test]
fn the_wheel_moves_and_the_right_button_looks_aside() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    window.shows(&drawn(&steered("lit", |_| {})));
    window.hand("mousemove 160 90 click 4");
    // Of a wheel that has buttons and no axes, as xdotool's, winit tells both the pressing and the releasing.
    let rolled = |notches: &[(f64, usize)]| {
        let notches: Vec<_> = notches.to_vec();
        move |navigator: &mut Navigator| {
            for (direction, count) in notches {
                (0..count).for_each(|_| navigator.zoom(libm::pow(0.9, direction)));
            }
        }
    };
    let seen = window.at_rest();
    let told = (1..=2).find(|&told| seen == drawn(&steered("lit", rolled(&[(1.0, told)]))));
    let told = told.expect("one notch or two");
    window.hand("click 5 click 5");
    let out = rolled(&[(1.0, told), (-1.0, 2 * told)]);
    window.shows(&drawn(&steered("lit", out)));
    window.drag(3, MIDDLE, (170, 60));
    let aside = |navigator: &mut Navigator| {
        rolled(&[(1.0, told), (-1.0, 2 * told)])(navigator);
        let per_pixel = navigator.fov_degrees() * (1.0 / f64::from(SIZE.1));
        navigator.look(-per_pixel * 10.0, -per_pixel * -30.0);
    };
    window.shows(&drawn(&steered("lit", aside)));
}

#[test]
fn a_window_of_another_size_shows_a_picture_of_that_size() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    window.shows(&drawn(&steered("lit", |_| {})));
    for (width, height) in [(500, 200), (97, 131), (1, 1), (640, 360)] {
        window.resize(width, height);
        let scene = Scene::builtin("lit").unwrap().with_size(width, height);
        window.shows(&drawn(&scene.unwrap()));
    }
}

#[test]
fn the_title_tells_what_the_pointer_is_over() {
    if !can_show() {
        return;
    }
    let window = Window::open("lit");
    window.shows(&drawn(&steered("lit", |_| {})));
    for (place, words) in [
        (
            "40 95",
            ["disk: order 0, radius", "redshift 1.", "temperature"],
        ),
        ("160 86", ["the hole", "lit", ""]),
        ("5 5", ["sky: longitude", "latitude", "°"]),
    ] {
        window.hand(&format!("mousemove {place}"));
        wait_until(words[0], || {
            let title = window.title();
            words.iter().all(|word| title.contains(word))
        });
    }
}
