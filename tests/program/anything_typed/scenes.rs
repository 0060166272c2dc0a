//! Guards against scenes that crash the program: they are made at random from good values, strange ones and none.

use std::cell::Cell;
use std::fs;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRng, TestRunner};

use super::{is_sentence, typed, words};
use crate::harness::{files, with_animation};

/// How many random scenes the program is run on.
const SCENES: u32 = 1000;

/// A scene's keys: the section, the key, and valid values.
const KEYS: [(&str, &str, &[&str]); 28] = [
    ("camera", "position", &["[20, 0, 5]", "[0.0, 1.2, 0.1]"]),
    ("camera", "focus", &["[0, 0, 0]", "[1, 2, 3]"]),
    ("camera", "up", &["[0, 0.1, 1]"]),
    ("camera", "fov", &["40", "1e-3", "170.5"]),
    ("disk", "inner", &["3", "5.5"]),
    ("disk", "outer", &["12", "1e6"]),
    ("disk", "normal", &["[0, 0, 1]", "[1e300, 1, 0]"]),
    ("disk.light", "model", &["\"blackbody\""]),
    ("disk.light", "temperature", &["7000", "1e9"]),
    ("sky", "grid", &["15", "7.5"]),
    ("sky", "rotation", &["[0, 90, -7.5]"]),
    ("sky", "stars", &["{ count = 5, seed = 1 }"]),
    ("image", "width", &["24", "1"]),
    ("image", "height", &["16", "1"]),
    ("image", "antialias", &["true", "false"]),
    ("image", "tolerance", &["0.001", "1"]),
    ("image", "exposure", &["0", "-3.5"]),
    ("image", "tone", &["\"neutral\"", "\"none\""]),
    ("image", "bits", &["8", "16"]),
    // A PNG picture holds none.
    ("image", "layers", &["[]"]),
    ("image", "crop", &["[0, 0, 1, 1]"]),
    ("animation", "frames", &["5"]),
    ("animation", "fps", &["24", "23.976"]),
    ("animation", "interpolation", &["\"smooth\"", "\"linear\""]),
    (
        "animation",
        "orbit",
        &["{ radius = 30, inclination = 80, azimuth = [0, 360] }"],
    ),
    ("[animation.keyframe]", "frame", &["2", "5"]),
    ("[animation.keyframe]", "position", &["[20, 1, 5]"]),
    ("[animation.keyframe]", "fov", &["30"]),
];

/// Numbers at the limits of their type, and beyond.
const NUMBERS: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "-nan",
    "0",
    "-0.0",
    "-1",
    "1e308",
    "-1.7976931348623157e308",
    "5e-324",
    "-2e-310",
    "1e999",
    "1e15",
    "1.0000000000000002",
    "2.9999999999999996",
    "3.0000000000000004",
    "180",
    "179.99999999999997",
    "1e-100",
    "1e100",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775808",
    "4294967296",
];

/// Values that are not numbers.
const OTHERS: [&str; 16] = [
    "",
    "true",
    "\"\"",
    "\"40\"",
    "[]",
    "{}",
    "[[]]",
    "[1, 2]",
    "[1, 2, 3, 4]",
    "[1, \"2\", 3]",
    "1979-05-27",
    "'''\n'''",
    "\"\\u0000\\u001B[31m\"",
    "{ radius = 1, radius = 2 }",
    "{ radius = nan, inclination = inf, azimuth = [0] }",
    "0x",
];

/// A value: a valid one, a strange number, a vector of these, or not a number.
fn value(good: &'static [&'static str]) -> impl Strategy<Value = String> {
    let number = || proptest::sample::select(&NUMBERS[..]);
    prop_oneof![
        150 => proptest::sample::select(good).prop_map(str::to_owned),
        2 => number().prop_map(str::to_owned),
        2 => (number(), number(), number()).prop_map(|(x, y, z)| format!("[{x}, {y}, {z}]")),
        1 => (number(), number()).prop_map(|(from, to)| {
            format!("{{ radius = [{from}, {to}], inclination = {to}, azimuth = 0 }}")
        }),
        1 => any::<f64>().prop_map(|number| format!("{number:?}")),
        1 => proptest::sample::select(&OTHERS[..]).prop_map(str::to_owned),
        1 => (1..3000_usize, any::<bool>()).prop_map(|(depth, closed)| {
            "[".repeat(depth) + &"]".repeat(if closed { depth } else { 0 })
        }),
        1 => (1..30_000_usize).prop_map(|many| format!("[{}]", "1,".repeat(many))),
        1 => (1..300_000_usize).prop_map(|long| "9".repeat(long)),
    ]
}

/// A scene's text with each key once, twice or missing; some are then cut short, or get foreign bytes.
fn scene() -> impl Strategy<Value = Vec<u8>> {
    let keys: Vec<_> = KEYS
        .iter()
        .map(|&(_, _, good)| (0..250_u8, value(good)))
        .collect();
    let harm = prop_oneof![
        30 => Just(None),
        1 => (0.0..1.0, Just(Vec::new())).prop_map(Some),
        1 => (0.0..1.0, proptest::collection::vec(any::<u8>(), 1..20)).prop_map(Some),
    ];
    (keys, any::<[bool; 4]>(), harm).prop_map(
        |(values, [animated, keyframed, windows, lit], harm)| {
            let mut text = String::new();
            let mut part = "";
            for (&(of, key, _), (how_often, value)) in KEYS.iter().zip(values) {
                let is_asked = match key {
                    _ if of == "disk.light" => lit,
                    _ if of == "animation" => animated && (key != "orbit" || !keyframed),
                    _ => !of.starts_with('[') || (animated && keyframed),
                };
                if !is_asked || how_often == 0 {
                    continue;
                }
                if of != part {
                    text.extend(["[", of, "]\n"]);
                    part = of;
                }
                let line = format!("{key} = {value}\n");
                text += &line.repeat(if how_often == 1 { 2 } else { 1 });
            }
            if windows {
                text = text.replace('\n', "\r\n");
            }
            let mut bytes = text.into_bytes();
            if let Some((share, inserted)) = harm {
                let at = (share * bytes.len() as f64) as usize;
                if inserted.is_empty() {
                    bytes.truncate(at);
                } else {
                    bytes.splice(at..at, inserted);
                }
            }
            bytes
        },
    )
}

#[test]
fn a_thousand_random_scenes_are_each_drawn_or_refused() {
    let folder = with_animation(1);
    let here = folder.path();
    let render = |animated: bool| {
        let output = if animated { "f_#.png" } else { "f_1.png" };
        let frames: &[&str] = if animated { &["--frames", "1"] } else { &[] };
        let table = [
            "--table",
            "tables/draft.table",
            "--max-memory",
            "1MB",
            "--quiet",
        ];
        words(&[&["render", "made.toml", "-o", output], &table[..], frames].concat())
    };
    let (drawn, refused) = (Cell::new(0), Cell::new(0));
    let config = Config {
        cases: SCENES,
        failure_persistence: None,
        ..Config::default()
    };
    // The same thousand scenes each time.
    let random = TestRng::deterministic_rng(config.rng_algorithm);
    let made = TestRunner::new_with_rng(config, random).run(&scene(), |text| {
        fs::write(here.join("made.toml"), &text).unwrap();
        let animated = text.windows(11).any(|word| word == b"[animation]");
        let (code, said) = typed(here, &render(animated));
        let picture = here.join("f_1.png");
        if code == 0 {
            drawn.set(drawn.get() + 1);
            prop_assert!(image::open(&picture).is_ok());
            fs::remove_file(&picture).unwrap();
        } else {
            refused.set(refused.get() + 1);
            prop_assert!(code == 1 || code == 2, "{code}");
            is_sentence(&said);
        }
        let left: Vec<_> = files(here).into_keys().collect();
        prop_assert_eq!(left, ["made.toml", "small.toml", "tables"]);
        Ok(())
    });
    let (drawn, refused) = (drawn.get(), refused.get());
    println!("{drawn} drawn, {refused} refused");
    made.unwrap();
    assert!(
        drawn > SCENES / 20 && refused > SCENES / 4,
        "{drawn} drawn, {refused} refused"
    );
}
