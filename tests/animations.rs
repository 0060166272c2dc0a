//! Guards against batches that write over what is good, lose what is finished, go on with what is wrong, or tell it badly.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use darkness::scene::Animation;
use tempfile::{TempDir, tempdir};

/// The program, in a folder, with these arguments and the standard error as text.
fn darkness(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(cargo_bin!("darkness"));
    command
        .current_dir(folder)
        .env_remove("DARKNESS_TABLE")
        .args(args);
    command
}

fn run(folder: &Path, args: &[&str]) -> (Output, String) {
    let output = darkness(folder, args).output().unwrap();
    let stderr = String::from_utf8(output.stderr.clone()).unwrap();
    (output, stderr)
}

fn done(folder: &Path, args: &[&str]) -> (Vec<u8>, String) {
    let (output, stderr) = run(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {stderr}");
    (output.stdout, stderr)
}

fn refused(folder: &Path, args: &[&str], code: i32, words: &[&str]) {
    let (output, stderr) = run(folder, args);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {stderr}");
    for word in words {
        assert!(
            stderr.contains(word),
            "{args:?}: {word:?} is not in: {stderr}"
        );
    }
    assert!(output.stdout.is_empty(), "{args:?} printed something");
}

/// A folder with an animation of so many small frames in `small.toml`, and a table.
fn with_animation(frames: u32) -> TempDir {
    let folder = tempdir().unwrap();
    let toml = Animation::load("orbit").unwrap().to_toml();
    let toml = toml
        .replace("frames = 240", &format!("frames = {frames}"))
        .replace("width = 1920", "width = 96")
        .replace("height = 1080", "height = 54");
    fs::write(folder.path().join("small.toml"), toml).unwrap();
    done(folder.path(), &["table", "draft"]);
    folder
}

/// The files of a folder and their bytes, hidden ones too.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap_or_default())
        })
        .collect()
}

const PATTERN: &str = "out/f_####.png";

#[test]
fn frames_are_numbered_files_that_say_what_they_were_made_of() {
    let folder = with_animation(12);
    let here = folder.path();
    let (_, stderr) = done(here, &["render", "small.toml", "-o", PATTERN]);
    assert!(
        stderr.contains("12 frames of 96 × 54") && stderr.contains("frames/s"),
        "{stderr}"
    );
    let smooth = files(&here.join("out"));
    let names: Vec<_> = (1..=12)
        .map(|number| format!("f_{number:04}.png"))
        .collect();
    assert_eq!(smooth.keys().cloned().collect::<Vec<_>>(), names);
    done(
        here,
        &[
            "render",
            "small.toml",
            "-o",
            "hard/%03d.png",
            "--antialias",
            "false",
            "--frames",
            "2-12x5",
        ],
    );
    let hard = files(&here.join("hard"));
    assert_eq!(
        hard.keys().map(String::as_str).collect::<Vec<_>>(),
        ["002.png", "007.png", "012.png"]
    );
    let texts = |file: &[u8]| {
        let reader = png::Decoder::new(io::Cursor::new(file))
            .read_info()
            .unwrap();
        let info = reader.info();
        let texts = info.uncompressed_latin1_text.iter();
        let texts: BTreeMap<_, _> = texts
            .map(|text| (text.keyword.clone(), text.text.clone()))
            .collect();
        (info.bit_depth as u8, texts)
    };
    let (depth, of_smooth) = texts(&smooth["f_0007.png"]);
    assert_eq!((depth, &*of_smooth["darkness:frame"]), (8, "7"));
    assert_eq!(
        of_smooth["Software"],
        concat!("darkness ", env!("CARGO_PKG_VERSION"))
    );
    assert_eq!(of_smooth["darkness:scene"].len(), 64);
    let (depth, of_hard) = texts(&hard["007.png"]);
    assert_eq!((depth, &*of_hard["darkness:frame"]), (1, "7"));
    assert_ne!(of_hard["darkness:scene"], of_smooth["darkness:scene"]);
    // What `sha256sum` says of the table's file.
    let sums = Command::new("sha256sum")
        .arg(here.join("tables/draft.table"))
        .output();
    if let Ok(sums) = sums {
        let sum = String::from_utf8(sums.stdout).unwrap();
        assert!(
            sum.starts_with(&of_smooth["darkness:table"]),
            "{sum} {of_smooth:?}"
        );
    }
    // Hard and smooth frames are of one place.
    let pixels = |file: &[u8]| image::load_from_memory(file).unwrap().into_luma8();
    let (smooth, hard) = (pixels(&smooth["f_0007.png"]), pixels(&hard["007.png"]));
    let apart = smooth
        .pixels()
        .zip(hard.pixels())
        .filter(|(a, b)| a.0[0].abs_diff(b.0[0]) > 150);
    assert!(apart.count() < 40 && hard.pixels().any(|pixel| pixel.0[0] == 255));
}

#[test]
fn any_chunks_on_any_threads_give_the_same_files() {
    let folder = with_animation(30);
    let here = folder.path();
    done(
        here,
        &[
            "render",
            "small.toml",
            "-o",
            "all/f_####.png",
            "--threads",
            "1",
        ],
    );
    for (frames, threads) in [
        ("21-30", "2"),
        ("1-30x3", "3"),
        ("2-20", "2"),
        ("1-30", "1"),
    ] {
        let args = [
            "render",
            "small.toml",
            "-o",
            "some/f_####.png",
            "--threads",
            threads,
            "--frames",
            frames,
        ];
        done(here, &args);
    }
    assert!(files(&here.join("all")) == files(&here.join("some")));
    let film = |threads: &str| {
        let args = [
            "render",
            "small.toml",
            "-o",
            "-",
            "--format",
            "raw",
            "--threads",
            threads,
        ];
        done(here, &args).0
    };
    let raw = film("1");
    assert_eq!(raw.len(), 30 * 96 * 54);
    assert!(raw == film("3"));
    let of_files: Vec<u8> = files(&here.join("all"))
        .values()
        .flat_map(|file| {
            image::load_from_memory(file)
                .unwrap()
                .into_luma8()
                .into_raw()
        })
        .collect();
    assert!(raw == of_files);
}

#[test]
fn a_rerun_draws_what_is_missing_damaged_or_of_something_else() {
    let folder = with_animation(10);
    let here = folder.path();
    let out = here.join("out");
    let drawn = |args: &[&str]| {
        let all = [&["render", "small.toml", "-o", PATTERN], args].concat();
        done(here, &all).1
    };
    drawn(&[]);
    let first = files(&out);
    assert!(drawn(&[]).contains("all frames were finished before"));
    fs::remove_file(out.join("f_0003.png")).unwrap();
    let mut damaged = first["f_0005.png"].clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 4;
    fs::write(out.join("f_0005.png"), damaged).unwrap();
    fs::write(out.join("f_0006.png"), &first["f_0007.png"]).unwrap();
    fs::write(out.join("f_0008.png"), &first["f_0008.png"][..100]).unwrap();
    fs::write(out.join("f_0009.png"), "").unwrap();
    assert!(drawn(&[]).contains("5 frames of"));
    assert!(files(&out) == first);
    // Another table is another origin, though here the pixels are the same.
    done(here, &["table", "standard", "-o", "b.table"]);
    assert!(drawn(&["--table", "b.table", "--frames", "1-4"]).contains("4 frames of"));
    assert!(drawn(&["--overwrite"]).contains("10 frames of"));
    assert!(files(&out) == first);
    assert!(drawn(&["--size", "32x18", "--frames", "2"]).contains("32 × 18"));
    assert!(drawn(&[]).contains("1 frames of") && files(&out) == first);
}

#[test]
fn what_a_killed_worker_left_is_removed_and_what_is_a_live_ones_or_somebody_elses_is_not() {
    let folder = with_animation(5);
    let here = folder.path();
    let out = here.join("out");
    let render = |frames: &str| {
        done(
            here,
            &["render", "small.toml", "-o", PATTERN, "--frames", frames],
        )
    };
    render("1-3");
    for name in [
        ".f_0001.png.Ab3xY9.part",
        ".f_0004.png.Ab3xY9.part",
        ".f_0005.png.Ab3xY9.part",
        ".other.png.Ab3xY9.part",
        ".f_0004.png.swp",
    ] {
        fs::write(out.join(name), "half").unwrap();
    }
    let live = fs::File::create(out.join(".f_0002.png.000000.part")).unwrap();
    live.lock().unwrap();
    render("1-4");
    let left: Vec<_> = files(&out)
        .into_keys()
        .filter(|name| name.starts_with('.'))
        .collect();
    assert_eq!(
        left,
        [
            ".f_0002.png.000000.part",
            ".f_0004.png.swp",
            ".f_0005.png.Ab3xY9.part",
            ".other.png.Ab3xY9.part"
        ]
    );
}

#[test]
fn one_frame_that_cannot_be_written_stops_no_other() {
    let folder = with_animation(12);
    let here = folder.path();
    for number in [3, 4, 9] {
        fs::create_dir_all(here.join(format!("out/f_{number:04}.png"))).unwrap();
    }
    let (output, stderr) = run(here, &["render", "small.toml", "-o", PATTERN]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr.contains("3 frames failed") && stderr.contains("3-4,9: out/f_####.png"),
        "{stderr}"
    );
    let whole = files(&here.join("out"))
        .values()
        .filter(|file| !file.is_empty())
        .count();
    assert_eq!(whole, 9);
    assert_eq!(files(&here.join("out")).len(), 12, "nothing is left behind");
}

#[test]
fn a_film_is_its_header_and_its_frames() {
    let folder = with_animation(6);
    let here = folder.path();
    let (raw, _) = done(
        here,
        &["render", "small.toml", "-o", "-", "--format", "raw"],
    );
    let (film, _) = done(
        here,
        &["render", "small.toml", "-o", "-", "--format", "y4m"],
    );
    let header = b"YUV4MPEG2 W96 H54 F24:1 Ip A1:1 Cmono XCOLORRANGE=FULL\n";
    let mut expected = header.to_vec();
    for frame in raw.chunks(96 * 54) {
        expected.extend(b"FRAME\n");
        expected.extend(frame);
    }
    assert!(film == expected);
    done(here, &["render", "small.toml", "-o", "a.y4m"]);
    done(
        here,
        &["render", "small.toml", "-o", "some.raw", "--frames", "2-3"],
    );
    assert!(fs::read(here.join("a.y4m")).unwrap() == film);
    assert!(fs::read(here.join("some.raw")).unwrap() == raw[96 * 54..3 * 96 * 54]);
    done(
        here,
        &["render", "small.toml", "-o", "/dev/null", "--format", "raw"],
    );
    assert!(fs::metadata("/dev/null").is_ok_and(|kind| !kind.is_file()));
    // A still picture is a film of one frame.
    let (still, _) = done(
        here,
        &[
            "render", "classic", "--size", "96x54", "-o", "-", "--format", "y4m",
        ],
    );
    assert!(still.starts_with(b"YUV4MPEG2 W96") && still.len() == header.len() + 6 + 96 * 54);
}

#[test]
fn a_reader_that_has_enough_ends_the_run_quietly() {
    let folder = with_animation(2000);
    for threads in ["1", "3"] {
        let args = [
            "render",
            "small.toml",
            "-o",
            "-",
            "--format",
            "y4m",
            "--threads",
            threads,
        ];
        let mut child = darkness(folder.path(), &args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut start = [0; 100];
        child
            .stdout
            .as_mut()
            .unwrap()
            .read_exact(&mut start)
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        assert!(
            output.stderr.is_empty(),
            "{:?}",
            String::from_utf8(output.stderr)
        );
    }
}

#[test]
fn a_film_that_cannot_be_written_is_not_left_half() {
    let folder = with_animation(3);
    let here = folder.path();
    fs::create_dir(here.join("a.y4m")).unwrap();
    refused(
        here,
        &["render", "small.toml", "-o", "a.y4m"],
        1,
        &["a.y4m", "folder"],
    );
    refused(
        here,
        &["render", "small.toml", "-o", "/dev/full", "--format", "raw"],
        1,
        &["/dev/full", "written"],
    );
    let huge = fs::read_to_string(here.join("small.toml")).unwrap();
    let huge = huge
        .replace("frames = 3", "frames = 90000000")
        .replace("width = 96", "width = 96000");
    fs::write(here.join("huge.toml"), huge).unwrap();
    refused(
        here,
        &[
            "render",
            "huge.toml",
            "-o",
            "b.y4m",
            "--frames",
            "1-90000000x900",
        ],
        1,
        &["are needed", "GB", "are free", "-o", "--frames"],
    );
    let left: Vec<_> = files(here).into_keys().collect();
    assert_eq!(left, ["a.y4m", "huge.toml", "small.toml", "tables"]);
}

#[test]
fn nothing_is_written_over_what_is_read_by_whatever_name() {
    let folder = with_animation(5);
    let here = folder.path();
    fs::copy(here.join("small.toml"), here.join("f_0003.png")).unwrap();
    fs::copy(here.join("tables/draft.table"), here.join("g_2.png")).unwrap();
    std::os::unix::fs::symlink("g_2.png", here.join("my.table")).unwrap();
    let before = files(here);
    refused(
        here,
        &["render", "f_0003.png", "-o", "f_####.png"],
        2,
        &["scene that is read"],
    );
    let args = [
        "render",
        "small.toml",
        "--table",
        "my.table",
        "-o",
        "g_#.png",
    ];
    refused(here, &args, 2, &["table that is read"]);
    let args = [
        "render",
        "small.toml",
        "-o",
        "tables/draft.table",
        "--format",
        "raw",
    ];
    refused(here, &args, 2, &["table that is read"]);
    assert!(files(here) == before);
    // A link is followed.
    std::os::unix::fs::symlink("real.y4m", here.join("link.y4m")).unwrap();
    fs::write(here.join("real.y4m"), "old").unwrap();
    done(here, &["render", "small.toml", "-o", "link.y4m"]);
    assert!(
        fs::symlink_metadata(here.join("link.y4m"))
            .unwrap()
            .is_symlink()
    );
    assert!(
        fs::read(here.join("real.y4m"))
            .unwrap()
            .starts_with(b"YUV4MPEG2")
    );
}

/// Guards against a wait for a pipe's other end, and for the end of what has none.
#[test]
fn pipes_and_devices_in_the_place_of_frames_are_failures_of_these_frames() {
    let folder = with_animation(6);
    let here = folder.path();
    fs::create_dir(here.join("out")).unwrap();
    for name in ["f_0002.png", ".f_0004.png.Ab3xY9.part"] {
        let made = Command::new("mkfifo")
            .arg(here.join("out").join(name))
            .status();
        assert!(made.unwrap().success());
    }
    std::os::unix::fs::symlink("/dev/zero", here.join("out/f_0003.png")).unwrap();
    let (output, stderr) = run(here, &["render", "small.toml", "-o", PATTERN]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr.contains("2-3: out/f_####.png") && stderr.contains("no regular file"),
        "{stderr}"
    );
    done(here, &["render", "small.toml", "-o", PATTERN, "--dry-run"]);
}

#[test]
fn a_frame_that_cannot_be_is_no_other_frames_matter() {
    let folder = with_animation(101);
    let here = folder.path();
    // The camera comes to its focus at frame 51, the middle one.
    let toml = fs::read_to_string(here.join("small.toml")).unwrap();
    let key = |frame: u32, focus: &str| {
        format!("[[animation.keyframe]]\nframe = {frame}\nfocus = {focus}\n")
    };
    let toml = toml
        .replace("[0.0, 360.0]", "0.0")
        .replace("inclination = 80.0", "inclination = 90.0");
    let keys = [
        key(50, "[0, 0, 0]"),
        key(51, "[30, 0, 0]"),
        key(52, "[0, 0, 0]"),
    ];
    fs::write(here.join("bad.toml"), format!("{toml}\n{}", keys.concat())).unwrap();
    done(
        here,
        &["render", "bad.toml", "-o", PATTERN, "--frames", "1-2,101"],
    );
    refused(
        here,
        &["render", "bad.toml", "-o", PATTERN],
        1,
        &["frame 51", "camera.focus"],
    );
}

/// Guards against a quota that ends the process: the signal of a file that grows too large.
#[test]
fn a_quota_is_an_error_and_leaves_nothing_half() {
    let folder = with_animation(20);
    let here = folder.path();
    let limited = |args: &str| {
        let program = cargo_bin!("darkness").display().to_string();
        let line = format!("ulimit -f 1; exec '{program}' {args}");
        let output = Command::new("sh")
            .current_dir(here)
            .args(["-c", &line])
            .output();
        let output = output.unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{args}: {stderr}");
        assert!(stderr.contains("cannot be written"), "{stderr}");
    };
    limited("render small.toml -o film.y4m");
    limited("render small.toml -o 'f_##.png' --size 960x540");
    limited("table draft -o b.table");
    limited("render classic --table tables/draft.table -o c.png");
    let left: Vec<_> = files(here).into_keys().collect();
    assert_eq!(left, ["small.toml", "tables"]);
}

#[test]
fn misuse_is_told_before_anything_is_done() {
    let folder = with_animation(20);
    let here = folder.path();
    let misused = |args: &[&str], words: &[&str]| {
        refused(here, &[&["render"], args].concat(), 2, words);
    };
    misused(
        &["small.toml", "-o", "f.png"],
        &["f.png", "20 frames", "####", "--frames", "y4m"],
    );
    misused(&["small.toml", "-o", "-"], &["pipe", "--format y4m"]);
    misused(&["small.toml", "-o", "f_#.y4m"], &["f_#.y4m", "film"]);
    misused(&["small.toml", "-o", "#/f.png"], &["folder's"]);
    misused(&["small.toml", "-o", "#_%d.png"], &["two places"]);
    misused(&["small.toml", "-o", "f_##.gif"], &[".png, .y4m and .raw"]);
    misused(&["small.toml", "--frames", "19-21"], &["19-21", "1 to 20"]);
    misused(
        &["small.toml", "--frames", "5-1"],
        &["5-1", "before it begins"],
    );
    misused(&["small.toml", "--frames", "0-4"], &["0-4", "from 1"]);
    misused(&["small.toml", "--frames", "1..4"], &["1..4", "1-240"]);
    misused(&["small.toml", "--frames", "1-4294967295"], &["1 to 20"]);
    misused(&["classic", "--frames", "2"], &["no frame 2"]);
    misused(
        &["small.toml", "--explain", "--frames", "2-3"],
        &["--explain", "one frame"],
    );
    misused(
        &["small.toml", "--require-table", "--method", "exact"],
        &["--require-table"],
    );
    misused(&["small.toml", "--progress", "loud"], &["openjd", "plain"]);
    let (_, stderr) = run(here, &["job", "openjd", "classic"]);
    assert!(stderr.contains("no [animation]"), "{stderr}");
    let left: Vec<_> = files(here).into_keys().collect();
    assert_eq!(left, ["small.toml", "tables"]);
}

#[test]
fn a_camera_that_goes_where_none_can_be_is_refused_before_the_first_frame() {
    let folder = with_animation(40);
    let here = folder.path();
    let toml = fs::read_to_string(here.join("small.toml")).unwrap();
    for (path, words) in [
        (
            "radius = [30, 0.9], inclination = 0",
            ["frame 39", "horizon"],
        ),
        ("radius = 6, inclination = 80", ["frame ", "disk's matter"]),
    ] {
        let bad = toml.replace("radius = 30.0, inclination = 80.0", path);
        fs::write(here.join("bad.toml"), bad).unwrap();
        refused(here, &["render", "bad.toml", "-o", PATTERN], 1, &words);
        assert!(!here.join("out").exists());
    }
}

#[test]
fn a_dry_run_lists_frames_and_files_and_draws_nothing() {
    let folder = with_animation(5);
    let here = folder.path();
    done(
        here,
        &["render", "small.toml", "-o", PATTERN, "--frames", "2"],
    );
    let before = files(&here.join("out"));
    let (list, _) = done(
        here,
        &[
            "render",
            "small.toml",
            "-o",
            PATTERN,
            "--frames",
            "1-3",
            "--dry-run",
        ],
    );
    let list = String::from_utf8(list).unwrap();
    assert_eq!(
        list,
        "1\tto draw\tout/f_0001.png\n2\tfinished\tout/f_0002.png\n3\tto draw\tout/f_0003.png\n"
    );
    assert!(files(&here.join("out")) == before);
    // Not even a table is made.
    let other = tempdir().unwrap();
    let (list, _) = done(
        other.path(),
        &["render", "orbit", "--frames", "7", "--dry-run"],
    );
    assert_eq!(list, b"7\tto draw\torbit_0007.png\n");
    assert!(files(other.path()).is_empty());
}

#[test]
fn a_worker_makes_no_table_unasked() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let args = [
        "render",
        "orbit",
        "--size",
        "96x54",
        "--frames",
        "1",
        "--require-table",
        "-o",
        "a_#.png",
    ];
    refused(
        here,
        &args,
        1,
        &["tables/draft.table", "darkness table draft"],
    );
    refused(
        here,
        &[&args[..], &["--table", "x.table"]].concat(),
        1,
        &["x.table"],
    );
    assert!(files(here).is_empty());
    done(here, &["table", "draft"]);
    done(here, &args);
}

#[test]
fn progress_is_told_as_it_is_asked_for() {
    let folder = with_animation(30);
    let here = folder.path();
    let stderr = |progress: &[&str]| {
        let args = [
            &["render", "small.toml", "-o", PATTERN, "--overwrite"],
            progress,
        ]
        .concat();
        done(here, &args).1
    };
    // A second is not over: nothing but the last line.
    let openjd = stderr(&["--progress", "openjd"]);
    let lines: Vec<_> = openjd.lines().collect();
    assert!(lines.contains(&"openjd_progress: 100.0"), "{openjd}");
    assert!(
        lines
            .iter()
            .any(|line| line.starts_with("openjd_status: 30 of 30 frames, ")),
        "{openjd}"
    );
    for how in ["auto", "plain", "none"] {
        let text = stderr(&["--progress", how]);
        assert_eq!(text.lines().count(), 1, "{text}");
    }
    assert_eq!(stderr(&["--quiet"]), "");
    let (_, failed) = run(
        here,
        &[
            "render",
            "small.toml",
            "--frames",
            "99",
            "--progress",
            "openjd",
        ],
    );
    assert!(failed.contains("openjd_fail: "), "{failed}");
    let timings = stderr(&["--timings"]);
    for part in ["curves", "render", "encode", "write", "frames/s"] {
        assert!(timings.contains(part), "{timings}");
    }
}

/// The program, drawing frames in the background.
fn start(folder: &Path, out: &str) -> Child {
    darkness(
        folder,
        &["render", "small.toml", "-o", out, "--progress", "none"],
    )
    .stdout(Stdio::null())
    .stderr(Stdio::piped())
    .spawn()
    .unwrap()
}

/// Waits until some frames are there.
fn wait_for(folder: &Path, frames: usize) {
    let start = Instant::now();
    let present = || fs::read_dir(folder).map_or(0, Iterator::count);
    while present() < frames {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn killed_at_any_moment_and_run_again_the_files_are_the_same() {
    let folder = with_animation(300);
    let here = folder.path();
    done(here, &["render", "small.toml", "-o", "whole/f_####.png"]);
    let whole = files(&here.join("whole"));
    let out = here.join("out");
    let mut kills = 0;
    for moment in 0..20_u64 {
        let mut child = start(here, PATTERN);
        // From before the first frame to after the last ones.
        std::thread::sleep(Duration::from_micros(2_000 + 7_919 * moment));
        if child.try_wait().unwrap().is_none() {
            kills += 1;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        fs::create_dir_all(&out).unwrap();
        for (name, file) in files(&out) {
            assert!(
                name.starts_with('.') || file == whole[&name],
                "{name} is not whole"
            );
        }
        if moment % 5 == 4 {
            for number in (1..=300).step_by(3) {
                let _ = fs::remove_file(out.join(format!("f_{number:04}.png")));
            }
        }
    }
    assert!(kills > 10, "only {kills} kills met the run");
    done(here, &["render", "small.toml", "-o", PATTERN]);
    assert!(files(&out) == whole, "{:?}", files(&out).keys());
}

#[test]
fn a_first_signal_finishes_the_frames_begun_and_a_rerun_the_rest() {
    let folder = with_animation(3000);
    let here = folder.path();
    let out = here.join("out");
    for (signal, code, name) in [("TERM", 143, "SIGTERM"), ("INT", 130, "Ctrl-C")] {
        let before = fs::read_dir(&out).map_or(0, Iterator::count);
        let child = start(here, PATTERN);
        wait_for(&out, before + 50);
        let sent = Command::new("kill")
            .args([&format!("-{signal}"), &child.id().to_string()])
            .status();
        assert!(sent.unwrap().success());
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{stderr}");
        assert!(
            stderr.contains(name) && stderr.contains("of 3000 frames are finished"),
            "{stderr}"
        );
        let left = files(&out);
        assert!(left.len() < 3000);
        assert!(left.iter().all(|(name, file)| !name.starts_with('.') && image::load_from_memory(file).is_ok()));
    }
    // A film that is not whole is not kept.
    let child = start(here, "film.y4m");
    std::thread::sleep(Duration::from_millis(100));
    Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status()
        .unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(143));
    let left: Vec<_> = files(here).into_keys().collect();
    assert_eq!(left, ["out", "small.toml", "tables"]);
}

/// Guards against memory that grows with the frames.
#[test]
#[cfg(target_os = "linux")]
fn memory_is_the_same_for_many_frames_as_for_few() {
    let folder = with_animation(4000);
    let most = |frames: &str| {
        let args = [
            "render",
            "small.toml",
            "--frames",
            frames,
            "-o",
            "/dev/null",
            "--format",
            "raw",
            "--threads",
            "2",
        ];
        let mut child = darkness(folder.path(), &args)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let status = format!("/proc/{}/status", child.id());
        let mut most = 0;
        while child.try_wait().unwrap().is_none() {
            let text = fs::read_to_string(&status).unwrap_or_default();
            let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
            let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
            most = most.max(kib.unwrap_or(0));
            std::thread::sleep(Duration::from_millis(2));
        }
        most
    };
    let (few, many) = (most("1-400"), most("1-4000"));
    println!("{few} KiB for 400 frames, {many} KiB for 4,000");
    assert!(few > 0 && many < few + 2048, "{few} KiB, {many} KiB");
}
