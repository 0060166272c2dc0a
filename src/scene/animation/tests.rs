use super::*;
use crate::scene::{Light, View};

const REST: &str = "[disk]\ninner = 3\nouter = 12\n[image]\nwidth = 64\nheight = 36\n";

fn animation(camera: &str, animation: &str) -> Result<Animation, SceneError> {
    Animation::from_toml(&format!(
        "[camera]\nfov = 40\n{camera}\n{REST}[animation]\n{animation}\n"
    ))
}

/// Asserts that a sentence with all of `words` refuses the animation or, if not, one of its frames.
fn refused(camera: &str, text: &str, words: &[&str]) {
    let checked = animation(camera, text).and_then(|animation| {
        (animation.first()..=animation.last())
            .try_for_each(|number| animation.check(number).map(drop))
    });
    let message = checked.expect_err(text).to_string();
    for word in words {
        assert!(message.contains(word), "{text}: {message}");
    }
}

#[test]
fn a_scene_that_does_not_move_is_one_frame() {
    let classic = crate::scene::builtins()[0].toml();
    let still = Animation::from_toml(classic).unwrap();
    assert!(still.is_still() && still.frames() == 1);
    assert_eq!(still.frame(1).unwrap(), Scene::from_toml(classic).unwrap());
    assert!(matches!(still.frame(2), Err(SceneError::NoFrame { .. })));
    assert!(matches!(still.frame(0), Err(SceneError::NoFrame { .. })));
}

#[test]
fn a_closed_orbit_does_not_repeat_its_first_frame_and_keeps_its_radius_to_the_last_bit() {
    for (inclination, azimuth) in [
        ("80", "[0, 360]"),
        ("[10, -710]", "[5, 365]"),
        ("[0, 360]", "30"),
    ] {
        let text = format!(
            "frames = 240\norbit = {{ radius = 29.7, inclination = {inclination}, azimuth = {azimuth} }}"
        );
        let orbit = animation("", &text).unwrap();
        let place = |number| orbit.frame(number).unwrap().camera().position;
        let step = (place(2) - place(1)).length();
        for number in 1..240 {
            let scene = orbit.frame(number).unwrap();
            assert_eq!(scene.radius(), 29.7);
            assert_eq!(View::new(&scene).radius(), 29.7);
            assert!((scene.camera().position.length() - 29.7).abs() < 1e-13);
            let next = (place(number + 1) - place(number)).length();
            assert!(next > 0.3 * step && next < 3.0 * step);
        }
        assert!(
            ((place(1) - place(240)).length() - (place(240) - place(239)).length()).abs()
                < 0.1 * step
        );
    }
}

#[test]
fn an_open_orbit_begins_at_from_and_ends_at_to() {
    let text = "frames = 11\ninterpolation = \"linear\"\n\
                orbit = { radius = [60, 20], inclination = [0, 90], azimuth = [0, 360] }";
    let orbit = animation("", text).unwrap();
    let place = |number| orbit.frame(number).unwrap().camera().position;
    assert_eq!(place(1), DVec3::new(0.0, 0.0, 60.0));
    assert!((place(11) - DVec3::new(20.0, 0.0, 0.0)).length() == 0.0);
    assert!((orbit.frame(6).unwrap().radius() - 40.0).abs() < 1e-13);
    // At the pole up is where inclination falls to.
    assert_eq!(orbit.frame(1).unwrap().camera().up, DVec3::NEG_X);
    assert_eq!(orbit.frame(11).unwrap().camera().up, DVec3::Z);
    let smooth = animation("", &text.replace("linear", "smooth")).unwrap();
    let first = |animation: &Animation| 60.0 - animation.frame(2).unwrap().radius();
    assert!(first(&smooth) < 0.4 * first(&orbit));
}

#[test]
fn up_of_an_orbit_is_minus_the_derivative_by_inclination() {
    let at = |inclination: f64| {
        let text = format!(
            "frames = 1\norbit = {{ radius = 20, inclination = {inclination:?}, azimuth = 123 }}"
        );
        *animation("", &text).unwrap().frame(1).unwrap().camera()
    };
    for inclination in [0.0, 1.0, 40.0, 90.0, 179.0, 180.0, 200.0] {
        let h = 1e-4;
        let (less, more) = (at(inclination - h), at(inclination + h));
        let derivative = (more.position - less.position) / (2.0 * h.to_radians()) / 20.0;
        assert!(
            (at(inclination).up + derivative).length() < 1e-8,
            "{inclination}"
        );
    }
    // The scene's own comes first.
    let text = "frames = 1\norbit = { radius = 20, inclination = 80, azimuth = 0 }";
    let own = animation("up = [0, 1, 0]", text).unwrap();
    assert_eq!(own.frame(1).unwrap().camera().up, DVec3::Y);
}

const KEYFRAMES: &str = "frames = 60\n\
    [[animation.keyframe]]\nframe = 1\nposition = [60, 0, 10]\nfov = 20\n\
    [[animation.keyframe]]\nframe = 20\nfocus = [1, 2, 3]\nposition = [-20, 0.5, 10]\n\
    [[animation.keyframe]]\nframe = 60\nposition = [0, -20, 2]\nfov = 90\nnormal = [0, 1, 9]\nup = [0, 1, 1]\n";

#[test]
fn keyframes_are_met_and_what_they_leave_out_is_interpolated() {
    for interpolation in ["smooth", "linear"] {
        let text = format!("interpolation = \"{interpolation}\"\n{KEYFRAMES}");
        let moving = animation("focus = [9, 9, 9]", &text).unwrap();
        let at = |number| moving.frame(number).unwrap();
        assert_eq!(at(1).camera().position, DVec3::new(60.0, 0.0, 10.0));
        assert_eq!(at(20).camera().position, DVec3::new(-20.0, 0.5, 10.0));
        assert_eq!(at(60).camera().position, DVec3::new(0.0, -20.0, 2.0));
        for number in [1, 7, 20, 45, 60] {
            assert_eq!(at(number).camera().focus, DVec3::new(1.0, 2.0, 3.0));
            assert_eq!(at(number).camera().up, DVec3::new(0.0, 1.0, 1.0));
            assert_eq!(at(number).disk().unwrap().normal, DVec3::new(0.0, 1.0, 9.0));
        }
        assert_eq!(
            (at(1).camera().fov_degrees, at(60).camera().fov_degrees),
            (20.0, 90.0)
        );
        assert!(at(20).camera().fov_degrees > 20.5);
        // Past the hole, not through it.
        for number in 1..=60 {
            let position = at(number).camera().position;
            assert!((position.length() - at(number).radius()).abs() < 1e-12);
            let ends = if number < 20 {
                (20.0, 61.0)
            } else {
                (20.0, 22.5)
            };
            assert!(
                position.length() > ends.0 && position.length() < ends.1,
                "{position}"
            );
        }
    }
}

#[test]
fn keyframes_of_one_radius_keep_it_to_the_last_bit() {
    let text = "frames = 50\n\
        [[animation.keyframe]]\nframe = 1\nposition = [29.5442, 0, 5.2094]\n\
        [[animation.keyframe]]\nframe = 50\nposition = [5.2094, 29.5442, 0]\n";
    let moving = animation("up = [1, 0, 7]", text).unwrap();
    let radius = moving.frame(1).unwrap().radius();
    for number in 1..=50 {
        assert_eq!(moving.frame(number).unwrap().radius(), radius);
    }
}

#[test]
fn what_is_written_reads_back() {
    let orbit = "frames = 7\nfps = 23.976\norbit = { radius = [60, 1.5], inclination = 80, azimuth = [0, 90] }\n\
        [[animation.keyframe]]\nframe = 3\nfov = 12\n";
    for (camera, text) in [
        ("", orbit),
        ("position = [20, 0, 5]", "frames = 3"),
        ("", KEYFRAMES),
    ] {
        let read = animation(camera, text).unwrap();
        assert_eq!(Animation::from_toml(&read.to_toml()).unwrap(), read);
        let small = read.clone().with_size(20, 10).unwrap();
        assert_eq!(small.frame(1).unwrap().image().width, 20);
        assert_ne!(small.to_toml(), read.to_toml());
        assert!(small.with_size(0, 3).is_err());
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_frame() {
    let still = "position = [20, 0, 5]";
    refused("", "frames = 5", &["camera.position"]);
    for frames in ["0", "-3", "1000000001"] {
        refused(
            still,
            &format!("frames = {frames}"),
            &["animation.frames", frames],
        );
    }
    refused(still, "fps = 3", &["frames", "line"]);
    refused(still, "frames = 3\nfps = 0", &["animation.fps"]);
    refused(
        still,
        "frames = 3\ninterpolation = \"cubic\"",
        &["smooth", "linear", "cubic", "line"],
    );
    refused(still, "frames = 3\nspeed = 2", &["speed", "line"]);
    let key = |frame: i32, text: &str| format!("[[animation.keyframe]]\nframe = {frame}\n{text}\n");
    let keys = |keys: &[String]| format!("frames = 30\n{}", keys.concat());
    refused(
        still,
        &keys(&[key(31, "fov = 3")]),
        &["frame = 31", "1 to 30"],
    );
    refused(
        still,
        &keys(&[key(0, "fov = 3")]),
        &["frame = 0", "1 to 30"],
    );
    refused(
        still,
        &keys(&[key(5, "fov = 3"), key(5, "fov = 4")]),
        &["frame 5", "above"],
    );
    refused(still, &keys(&[key(5, "")]), &["frame 5", "position", "fov"]);
    refused(
        still,
        &keys(&[key(5, "up = [0, 0, 0]")]),
        &["frame 5", "up", "zero"],
    );
    refused(
        still,
        &keys(&[key(5, "focus = [0, nan, 0]")]),
        &["frame 5", "focus", "NaN"],
    );
    refused(
        still,
        &keys(&[key(5, "exposure = 1")]),
        &["`exposure`", "line"],
    );
    refused(
        still,
        &keys(&[key(5, "focus = [0, 0]")]),
        &["three numbers", "line"],
    );
    refused(
        "",
        &keys(&[
            key(5, "position = [9, 9, 9]"),
            key(9, "position = [0.5, 0.5, 0]"),
        ]),
        &["frame 9", "horizon"],
    );
    refused(
        "",
        &keys(&[
            key(5, "position = [9, 0, 9]"),
            key(9, "position = [-18, 0, -18]"),
        ]),
        &["frames 5 and 9", "position", "opposite"],
    );
}

#[test]
fn orbits_that_cannot_be_are_refused_with_their_frame() {
    let orbit = |radius, inclination| {
        format!(
            "frames = 41\ninterpolation = \"linear\"\n\
             orbit = {{ radius = {radius}, inclination = {inclination}, azimuth = 0 }}"
        )
    };
    refused("", &orbit("[40, 0.5]", "30"), &["frame 41", "horizon"]);
    refused("", &orbit("nan", "30"), &["animation.orbit.radius", "NaN"]);
    refused("", &orbit("[1, 2, 3]", "30"), &["[from, to]", "line"]);
    refused("", &orbit("\"far\"", "30"), &["a number", "line"]);
    refused("", &orbit("[41, 1.5]", "90"), &["frame 31", "matter"]);
    refused(
        "",
        &orbit("5", "[70, 110]"),
        &["frame 21", "matter", "radius 5.0"],
    );
    // Between frames too, but not beside the disk.
    refused(
        "",
        &orbit("5", "[70, 111]"),
        &["frame 20", "through", "5.0"],
    );
    assert!(
        animation("", &orbit("15", "[70, 111]"))
            .unwrap()
            .check(20)
            .is_ok()
    );
    refused(
        "",
        &format!(
            "{}\n[[animation.keyframe]]\nframe = 5\nposition = [1, 1, 7]\n",
            orbit("9", "30")
        ),
        &["orbit", "position"],
    );
    refused(
        "up = [0, 0, 1]",
        &orbit("20", "[0, 90]"),
        &["frame 1", "camera.up", "parallel"],
    );
}

#[test]
fn an_animation_without_a_disk_passes_through_its_plane_and_turns_no_disk() {
    let toml = |keyframes: &str| {
        format!(
            "[camera]\nposition = [5, 0, 1]\nfov = 40\n[sky]\ngrid = 15\n[image]\nwidth = 64\nheight = 36\n\
             [animation]\nframes = 10\n{keyframes}"
        )
    };
    let keys = "[[animation.keyframe]]\nframe = 1\nposition = [5, 0, 1]\n\
        [[animation.keyframe]]\nframe = 10\nposition = [5, 0, -2]\n";
    let falling = Animation::from_toml(&toml(keys)).unwrap();
    for number in 1..=falling.last() {
        let scene = falling.check(number).unwrap();
        assert!(scene.disk().is_none() && scene.sky() == falling.sky());
    }
    assert_eq!(Animation::from_toml(&falling.to_toml()).unwrap(), falling);
    assert!(falling.with_light(Some(Light::Bolometric)).is_err());

    let keys = keys.replace("position = [5, 0, -2]", "normal = [0, 1, 1]");
    let message = Animation::from_toml(&toml(&keys)).unwrap_err().to_string();
    for word in ["animation.keyframe.normal", "[disk]", "remove the key"] {
        assert!(message.contains(word), "{message}");
    }
    let message = Animation::from_toml(&toml(&keys).replace("[sky]\ngrid = 15\n", ""));
    let message = message.unwrap_err().to_string();
    assert!(message.contains("neither a disk nor a sky"), "{message}");
}

#[test]
fn frames_are_numbered_from_any_number_and_show_the_same() {
    let keyframes = |frames: [i64; 3]| {
        let [a, b, c] = frames;
        format!(
            "[[animation.keyframe]]\nframe = {a}\nposition = [60, 0, 10]\n\
             [[animation.keyframe]]\nframe = {b}\nposition = [-20, 0.5, 10]\nnormal = [0, 1, 9]\n\
             [[animation.keyframe]]\nframe = {c}\nposition = [0, -20, 2]\nup = [0, 1, 1]\n"
        )
    };
    for first in [1001, 0, -5, -1_000_000_000, 1_000_000_000] {
        for (path, shifted) in [
            (
                keyframes([1, 4, 12]),
                keyframes([first, first + 3, first + 11]),
            ),
            (
                "orbit = { radius = 30, inclination = 80, azimuth = [0, 360] }".into(),
                String::new(),
            ),
            (
                "orbit = { radius = [30, 9], inclination = 80, azimuth = 5 }".into(),
                String::new(),
            ),
        ] {
            let shifted = if shifted.is_empty() { &path } else { &shifted };
            let one = animation("", &format!("frames = 12\n{path}")).unwrap();
            let other = animation("", &format!("frames = 12\nfirst = {first}\n{shifted}")).unwrap();
            assert_eq!((other.first(), other.last()), (first, first + 11));
            for number in 1..=12 {
                let shown = other.check(first + number - 1).unwrap();
                assert_eq!(shown, one.check(number).unwrap());
            }
            let message = other.frame(first - 1).unwrap_err().to_string();
            let frames = format!("the frames are {first} to {}", first + 11);
            assert!(message.contains(&frames), "{message}");
            assert_eq!(Animation::from_toml(&other.to_toml()).unwrap(), other);
            assert!(!one.to_toml().contains("first"));
        }
    }
    let still = "orbit = { radius = 30, inclination = 80, azimuth = 0 }";
    for first in ["1000000001", "-1000000001", "9223372036854775807"] {
        let text = format!("frames = 3\nfirst = {first}\n{still}");
        refused("", &text, &["animation.first", first, "1000000000"]);
    }
    let outside = format!("frames = 12\nfirst = 1001\n{}", keyframes([1, 1004, 1012]));
    refused(
        "",
        &outside,
        &["animation.keyframe.frame = 1", "1001 to 1012"],
    );
}
