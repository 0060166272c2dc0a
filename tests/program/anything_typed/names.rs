//! Guards against senseless ranges of frames, and against file names that are taken for something else.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;

use super::{is_sentence, typed, words};
use crate::harness::{done, files, finish, refused, tool, with_animation};

#[test]
fn ranges_that_make_no_sense_are_refused_and_the_longest_are_accepted() {
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
        "10-4294967295",
        "10",
        "4294967295",
        "10-4294967295x1000000000",
    ] {
        refused(
            here,
            &["render", "small.toml", "--frames", range, "-o", "f_#.png"],
            2,
            &["there is no frame", "1 to 9"],
        );
    }
    for range in ["1-3,2-4,3,8-9x1,9", "8-4294967295", "1-9999999x10000000"] {
        done(
            here,
            &["render", "small.toml", "--frames", range, "-o", "f_#.png"],
        );
    }
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
fn names_may_lead_upwards_and_have_any_bytes() {
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
        vec![render, OsStr::new("--require-table"), table, name(b"\xff")],
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

/// Guards against file names that are read as options, and against names that control the terminal.
#[test]
fn names_that_look_like_options_or_patterns_are_taken_as_names() {
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
    let mut job = tool(here, &["bash", "job.sh"]);
    finish(job.env("SLURM_ARRAY_TASK_ID", "0"));
    assert!(here.join("-o_2.png").is_file());
    let (code, said) = typed(here, &words(&["render", "\u{1b}[31m.toml"]));
    assert_eq!(code, 2);
    is_sentence(&said);
}
