//! Guards against what people and programs may type: scenes, ranges, names and sizes that make no sense are refused in a sentence,
//! and neither crash the program, nor keep it, nor leave anything behind.
#![cfg(unix)]

#[path = "common/animated.rs"]
mod animated;

use std::cell::Cell;
use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use animated::{done, files, refused, with_animation};
use assert_cmd::cargo::cargo_bin_cmd;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRng, TestRunner};

/// How often the program is run on scenes made up.
const SCENES: u32 = 1000;

/// A scene's keys: the part, the key, and values with which the others make a scene.
const KEYS: [(&str, &str, &[&str]); 18] = [
    ("camera", "position", &["[20, 0, 5]", "[0.0, 1.2, 0.1]"]),
    ("camera", "focus", &["[0, 0, 0]", "[1, 2, 3]"]),
    ("camera", "up", &["[0, 0.1, 1]"]),
    ("camera", "fov", &["40", "1e-3", "170.5"]),
    ("disk", "inner", &["3", "5.5"]),
    ("disk", "outer", &["12", "1e6"]),
    ("disk", "normal", &["[0, 0, 1]", "[1e300, 1, 0]"]),
    ("image", "width", &["24", "1"]),
    ("image", "height", &["16", "1"]),
    ("image", "antialias", &["true", "false"]),
    ("image", "tolerance", &["0.001", "1"]),
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

/// Numbers at the ends of all that a number can be, and beyond.
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

/// What is no number.
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

/// A value: a good one, a strange number, a vector of these, or none of all that.
fn value(good: &'static [&'static str]) -> impl Strategy<Value = String> {
    let number = || proptest::sample::select(&NUMBERS[..]);
    prop_oneof![
        150 => proptest::sample::select(good).prop_map(str::to_owned),
        2 => number().prop_map(str::to_owned),
        2 => (number(), number(), number()).prop_map(|(x, y, z)| format!("[{x}, {y}, {z}]")),
        1 => (number(), number()).prop_map(|(from, to)| format!("{{ radius = [{from}, {to}], inclination = {to}, azimuth = 0 }}")),
        1 => any::<f64>().prop_map(|number| format!("{number:?}")),
        1 => proptest::sample::select(&OTHERS[..]).prop_map(str::to_owned),
        1 => (1..3000_usize, any::<bool>()).prop_map(|(depth, closed)| "[".repeat(depth) + &"]".repeat(if closed { depth } else { 0 })),
        1 => (1..30_000_usize).prop_map(|many| format!("[{}]", "1,".repeat(many))),
        1 => (1..300_000_usize).prop_map(|long| "9".repeat(long)),
    ]
}

/// A scene's text: each key there, not there or there twice; then a part of it, or with bytes of another kind in it.
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
    (keys, any::<[bool; 3]>(), harm).prop_map(|(values, [animated, keyframed, windows], harm)| {
        let mut text = String::new();
        let mut part = "";
        for (&(of, key, _), (how_often, value)) in KEYS.iter().zip(values) {
            let is_asked = match key {
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
    })
}

/// Runs the program, for no more than a minute, and returns its exit code and what it said.
fn typed(folder: &Path, args: &[&OsStr]) -> (i32, String) {
    let mut command = cargo_bin_cmd!("darkness");
    let output = command
        .current_dir(folder)
        .env_remove("DARKNESS_TABLE")
        .timeout(Duration::from_secs(60))
        .args(args)
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    let Some(code) = output.status.code() else {
        panic!("{args:?} ended by {}: {said}", output.status);
    };
    (code, said)
}

fn words(args: &[&'static str]) -> Vec<&'static OsStr> {
    args.iter().map(|&arg| OsStr::new(arg)).collect()
}

/// Asserts that it is a sentence of the program.
fn is_sentence(said: &str) {
    assert!(
        said.starts_with("darkness: ") || said.starts_with("error: "),
        "{said}"
    );
    assert!(said.len() < 5000 && !said.contains("panicked"), "{said}");
    assert!(
        !said.contains(|c: char| c.is_control() && c != '\n'),
        "{said:?}"
    );
}

#[test]
fn a_thousand_scenes_are_drawn_or_refused() {
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
    // The same thousand each time.
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

#[test]
fn ranges_that_make_no_sense_are_misuse_and_the_longest_are_none() {
    let folder = with_animation(9);
    let here = folder.path();
    for range in [
        "5-1",
        "0",
        "1-9x0",
        "",
        ",",
        "1-",
        "-3",
        "1--3",
        "a",
        "1-4294967296",
        "1-99999999999999999999",
        "1-9x-1",
        "1;2",
        "٣",
    ] {
        let frames = format!("--frames={range}");
        refused(
            here,
            &["render", "small.toml", &frames, "-o", "f_#.png"],
            2,
            &["--frames"],
        );
    }
    for range in [
        "1-4294967295",
        "10",
        "1-9,4294967295",
        "1-4294967295x1000000000",
    ] {
        refused(
            here,
            &["render", "small.toml", "--frames", range, "-o", "f_#.png"],
            2,
            &["there is no frame", "1 to 9"],
        );
    }
    done(
        here,
        &[
            "render",
            "small.toml",
            "--frames",
            "1-3,2-4,3,8-9x1,9",
            "-o",
            "f_#.png",
        ],
    );
    let left: Vec<_> = files(here).into_keys().collect();
    assert_eq!(
        left,
        [
            "f_1.png",
            "f_2.png",
            "f_3.png",
            "f_4.png",
            "f_8.png",
            "f_9.png",
            "small.toml",
            "tables"
        ]
    );
}

#[test]
fn names_with_ways_up_and_of_any_bytes() {
    let folder = with_animation(2);
    let here = folder.path();
    fs::create_dir(here.join("a")).unwrap();
    for (pattern, file) in [
        ("a/../f_##.png", "f_02.png"),
        ("./a/./../a/f_##.png", "a/f_02.png"),
        ("a/..##.png", "a/..02.png"),
    ] {
        done(here, &["render", "small.toml", "-o", pattern]);
        assert!(
            image::load_from_memory(&fs::read(here.join(file)).unwrap()).is_ok(),
            "{pattern}"
        );
    }
    for (pattern, word) in [
        ("##/../f.png", "folder"),
        ("..", "folder"),
        ("a/..", "folder"),
        ("small.toml/f_#.png", "small.toml"),
    ] {
        let (code, said) = typed(
            here,
            &["render", "small.toml", "-o", pattern].map(OsStr::new),
        );
        is_sentence(&said);
        assert!(code != 0 && said.contains(word), "{pattern}: {said}");
    }

    let scene = fs::read(here.join("small.toml")).unwrap();
    let still = String::from_utf8(scene.clone()).unwrap();
    let still = still
        .split("[animation]")
        .next()
        .unwrap()
        .replace("[camera]", "[camera]\nposition = [20, 0, 5]");
    let name = |text: &'static [u8]| OsStr::from_bytes(text);
    fs::write(here.join(name(b"s\xff.toml")), &still).unwrap();
    fs::create_dir(here.join(name(b"\xfe"))).unwrap();
    fs::write(here.join(name(b"r\xff.csv")), "u0,dudphi\n0.1,0.1\n").unwrap();
    let [render, output, table] = ["render", "-o", "--table"].map(OsStr::new);
    for (args, made) in [
        (
            vec![
                OsStr::new("table"),
                OsStr::new("draft"),
                output,
                name(b"\xfe/t\xff.table"),
            ],
            name(b"\xfe/t\xff.table"),
        ),
        (
            vec![
                render,
                name(b"s\xff.toml"),
                table,
                name(b"\xfe/t\xff.table"),
            ],
            name(b"s\xff.png"),
        ),
        (
            vec![
                render,
                OsStr::new("small.toml"),
                output,
                name(b"\xfe/f_#.png"),
            ],
            name(b"\xfe/f_2.png"),
        ),
        (
            vec![render, OsStr::new("small.toml"), output, name(b"\xff.y4m")],
            name(b"\xff.y4m"),
        ),
        (
            vec![OsStr::new("trace"), name(b"r\xff.csv")],
            name(b"r\xff.csv"),
        ),
    ] {
        let (code, said) = typed(here, &args);
        assert_eq!(code, 0, "{args:?}: {said}");
        assert!(here.join(made).is_file(), "{args:?}");
    }
    for args in [
        vec![
            render,
            OsStr::new("small.toml"),
            output,
            name(b"\xff_#.png"),
        ],
        vec![render, OsStr::new("--frames"), name(b"1-\xff")],
        vec![render, name(b"\xff")],
        vec![render, table, name(b"\xff")],
        vec![render, OsStr::new("--size"), name(b"9x\xff")],
        vec![OsStr::new("scene"), name(b"\xff")],
        vec![name(b"\xff")],
        vec![OsStr::new("trace"), name(b"\xff")],
        vec![OsStr::new("job"), OsStr::new("slurm"), name(b"\xff")],
    ] {
        let (code, said) = typed(here, &args);
        assert!(code == 1 || code == 2, "{args:?}: {code}: {said}");
        is_sentence(&said);
    }
}

/// Guards against a picture that is asked for and takes the memory of all that runs beside it.
#[test]
fn pictures_too_large_are_refused_before_their_memory_is_asked_for() {
    let folder = with_animation(12);
    let here = folder.path();
    for size in [
        "2147483648x2147483648",
        "4294967295x4294967295",
        "1000000x1000000",
        "65536x65536",
    ] {
        refused(
            here,
            &["render", "--size", size],
            2,
            &["of memory", "4.0 GiB are allowed", "--max-memory", "--size"],
        );
    }
    for size in [
        "0x1",
        "1x0",
        "0x0",
        "1000001x1",
        "-1x1",
        "1x",
        "x",
        "1e3x1",
        "99999999999x1",
        "1x1x1",
        "",
    ] {
        refused(here, &["render", &format!("--size={size}")], 2, &["--size"]);
    }
    // In a scene's file, too.
    let scene = fs::read_to_string(here.join("small.toml")).unwrap();
    fs::write(
        here.join("huge.toml"),
        scene
            .replace("width = 96", "width = 900000")
            .replace("height = 54", "height = 900000"),
    )
    .unwrap();
    refused(
        here,
        &["render", "huge.toml", "-o", "f_##.png"],
        2,
        &["1.5 TiB of memory", "--max-memory"],
    );
    // The limit can be moved, and what does not fit side by side is drawn one by one.
    refused(
        here,
        &[
            "render",
            "small.toml",
            "-o",
            "f_##.png",
            "--max-memory",
            "10kB",
        ],
        2,
        &["10.1 KiB of memory"],
    );
    for amount in ["lots", "", "-1", "1 parsec"] {
        refused(
            here,
            &["render", &format!("--max-memory={amount}")],
            2,
            &["--max-memory", "16GiB"],
        );
    }
    done(
        here,
        &["render", "small.toml", "-o", "a/f_##.png", "--threads", "3"],
    );
    done(
        here,
        &[
            "render",
            "small.toml",
            "-o",
            "b/f_##.png",
            "--threads",
            "3",
            "--max-memory",
            "11kB",
        ],
    );
    assert!(files(&here.join("a")) == files(&here.join("b")));
    assert_eq!(files(&here.join("b")).len(), 12);
}

/// Guards against a file that grows for as long as its own growth is read, and against a scene under what is drawn of it.
#[test]
fn what_is_read_is_not_written_to_by_the_standard_output() {
    let folder = with_animation(2);
    let here = folder.path();
    let rays = format!("u0,dudphi\n{}", "0.03,0.1\n".repeat(20_000));
    fs::write(here.join("rays.csv"), &rays).unwrap();
    let scene = fs::read_to_string(here.join("small.toml")).unwrap();
    let program = assert_cmd::cargo::cargo_bin!("darkness")
        .display()
        .to_string();
    for line in [
        "trace rays.csv --method exact >> rays.csv",
        "render small.toml --frames 1-2 --format raw -o - 1<>small.toml",
        "render small.toml --frames 1 -o - >> tables/draft.table",
    ] {
        let output = Command::new("sh")
            .current_dir(here)
            .args(["-c", &format!("'{program}' {line}")])
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        assert!(
            said.contains("the standard output goes to this file"),
            "{said}"
        );
    }
    assert_eq!(fs::read_to_string(here.join("rays.csv")).unwrap(), rays);
    assert_eq!(fs::read_to_string(here.join("small.toml")).unwrap(), scene);
    done(here, &["table", "inspect", "tables/draft.table"]);
}

/// Guards against variables and limits that reach deeper than the program's own options.
#[test]
fn the_surroundings_change_nothing() {
    let folder = with_animation(2);
    let here = folder.path();
    let program = assert_cmd::cargo::cargo_bin!("darkness")
        .display()
        .to_string();
    for (line, code) in [
        ("RUST_MIN_STACK=0 {} render small.toml -q -o f_#.png", 0),
        (
            "RAYON_NUM_THREADS=20000 {} render small.toml -q -o f_#.png",
            0,
        ),
        ("RAYON_NUM_THREADS=no {} render small.toml -q -o f_#.png", 0),
        ("TMPDIR=/nowhere {} render small.toml -q -o f_#.png", 0),
        ("ulimit -f 0; {} --help > help", 0),
        ("ulimit -f 0; {} bogus 2> error", 2),
    ] {
        let line = line.replace("{}", &format!("'{program}'"));
        let output = Command::new("sh")
            .current_dir(here)
            .args(["-c", &line])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line}: {said}");
    }
    // Ranges of a hundred million frames, where one is asked for.
    let many: Vec<String> = (2..900).map(|step| format!("1-100000000x{step}")).collect();
    let scene = fs::read_to_string(here.join("small.toml")).unwrap();
    fs::write(
        here.join("long.toml"),
        scene.replace("frames = 2\n", "frames = 100000000\n"),
    )
    .unwrap();
    refused(
        here,
        &[
            "render",
            "long.toml",
            "--explain",
            "--frames",
            &many.join(","),
        ],
        2,
        &["--explain tells of one frame"],
    );
}

/// Guards against commands that take a file's name for an option, and terminals that take it for an order.
#[test]
fn names_that_could_be_taken_for_something_else() {
    let folder = with_animation(2);
    let here = folder.path();
    fs::rename(here.join("small.toml"), here.join("-x.toml")).unwrap();
    let (script, _) = done(
        here,
        &[
            "job",
            "slurm",
            "--table=tables/draft.table",
            "--output=-o_#.png",
            "--",
            "-x.toml",
        ],
    );
    fs::write(here.join("job.sh"), script).unwrap();
    let bin = Path::new(assert_cmd::cargo::cargo_bin!("darkness"))
        .parent()
        .unwrap();
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let output = Command::new("bash")
        .current_dir(here)
        .env("PATH", path)
        .env("SLURM_ARRAY_TASK_ID", "0")
        .arg("job.sh")
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(here.join("-o_2.png").is_file());
    let (code, said) = typed(here, &words(&["render", "\u{1b}[31m.toml"]));
    assert_eq!(code, 1);
    is_sentence(&said);
}

/// Guards against the end of the process where memory is refused: what the system says is told.
#[test]
#[cfg(target_os = "linux")]
fn memory_that_the_system_refuses_is_told() {
    let folder = with_animation(1);
    let here = folder.path();
    let program = assert_cmd::cargo::cargo_bin!("darkness")
        .display()
        .to_string();
    let mut refused = 0;
    // Kilobytes of address space: from not enough to begin, over none for the frame, to enough for its file.
    for limit in (16_000..300_000).step_by(12_000) {
        for antialias in [true, false] {
            let line = format!(
                "ulimit -v {limit}; exec '{program}' render classic --size 12000x8000 --threads 1 --quiet \
                 --table tables/draft.table -o f.png --antialias {antialias}"
            );
            let output = Command::new("sh")
                .current_dir(here)
                .args(["-c", &line])
                .output()
                .unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            match output.status.code() {
                Some(0) => {}
                Some(1) => {
                    is_sentence(&said);
                    assert!(said.contains("memory"), "{said}");
                    refused += 1;
                }
                _ => panic!("{limit} KiB: {}: {said}", output.status),
            }
        }
    }
    assert!(refused > 3, "{refused} refused");
}
