//! Guards against batches that overwrite what is good, lose what is finished, or cannot continue after an interruption.
#![cfg(unix)]

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::harness::{PATTERN, PROGRAM, darkness, done, files, refused, run, with_animation};

#[test]
fn a_rerun_draws_frames_that_are_missing_damaged_or_of_another_scene_or_table() {
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
    assert!(drawn(&[]).contains("4 frames of"));
    assert!(files(&out) == first);
    // Another table counts as another origin, although the pixels are the same here.
    done(here, &["table", "standard", "-o", "b.table"]);
    assert!(drawn(&["--table", "b.table", "--frames", "1-4"]).contains("4 frames of"));
    assert!(drawn(&["--overwrite"]).contains("10 frames of"));
    assert!(files(&out) == first);
    assert!(drawn(&["--size", "32x18", "--frames", "2"]).contains("32 × 18"));
    assert!(drawn(&[]).contains("1 frame of") && files(&out) == first);
}

#[test]
fn files_of_a_killed_worker_are_removed_and_those_of_others_are_kept() {
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
fn a_frame_that_cannot_be_written_stops_no_other() {
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
fn a_file_that_is_read_is_not_overwritten_under_any_name() {
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
    // One frame's name is a link to the scene, another's a link to the table: neither is replaced, even if all other
    // files are.
    fs::create_dir(here.join("out")).unwrap();
    std::os::unix::fs::symlink("../small.toml", here.join("out/f_0002.png")).unwrap();
    std::os::unix::fs::symlink("../my.table", here.join("out/f_0004.png")).unwrap();
    let args = [
        &["render", "small.toml", "-o", PATTERN][..],
        &["--table", "my.table"],
    ]
    .concat();
    refused(
        here,
        &args,
        1,
        &["out/f_0002.png, out/f_0004.png: ", "--overwrite"],
    );
    assert_eq!(files(&here.join("out")).len(), 2);
    let args = [&args[..], &["--overwrite"]].concat();
    let (output, stderr) = run(here, &args);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr.contains("2,4: out/f_####.png") && stderr.contains("a link to"),
        "{stderr}"
    );
    assert_eq!(files(&here.join("out")).len(), 5);
    for name in ["small.toml", "g_2.png"] {
        assert!(fs::read(here.join(name)).unwrap() == before[name], "{name}");
    }
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

/// Guards against waiting for a pipe's other end, and for the end of a device that has none.
#[test]
fn a_pipe_or_device_in_place_of_a_frame_fails_that_frame_only() {
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
        stderr.contains("2-3: out/f_####.png") && stderr.contains("not a regular file"),
        "{stderr}"
    );
    done(here, &["render", "small.toml", "-o", PATTERN, "--dry-run"]);
}

/// Starts the program, which draws frames in the background.
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

/// Waits until some frames exist.
fn wait_for(folder: &Path, frames: usize) {
    let start = Instant::now();
    let present = || fs::read_dir(folder).map_or(0, Iterator::count);
    while present() < frames {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_batch_killed_at_any_moment_and_run_again_gives_the_same_files() {
    let folder = with_animation(300);
    let here = folder.path();
    let begun = Instant::now();
    done(here, &["render", "small.toml", "-o", "whole/f_####.png"]);
    let time = begun.elapsed();
    let whole = files(&here.join("whole"));
    let out = here.join("out");
    let mut kills = 0;
    for moment in 0..20_u32 {
        let mut child = start(here, PATTERN);
        // At moments from before the first frame to after the last.
        std::thread::sleep(time * moment / 20);
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
    assert!(kills > 0);
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
    // An unfinished film is not kept.
    let child = start(here, "film.y4m");
    // Its file appears once the program handles signals.
    let begun = || files(here).keys().any(|name| name.starts_with(".film.y4m"));
    let start = Instant::now();
    while !begun() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
    Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status()
        .unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(143));
    let left: Vec<_> = files(here).into_keys().collect();
    assert_eq!(left, ["out", "small.toml", "tables"]);
}

/// Guards against a Ctrl-C that ends a background job: shells start those with the signal ignored.
#[test]
#[cfg(target_os = "linux")]
fn a_signal_that_is_ignored_from_the_start_is_ignored() {
    // Enough to be still at work when the signal comes.
    const FRAMES: u32 = 10_000;
    let folder = with_animation(FRAMES);
    let here = folder.path();
    let line = format!(
        "trap '' INT; '{PROGRAM}' render small.toml -o film.raw & sleep 0.05; kill -INT $! || exit 9; wait $!"
    );
    let ended = Command::new("sh")
        .current_dir(here)
        .args(["-c", &line])
        .status();
    assert_eq!(ended.unwrap().code(), Some(0));
    assert_eq!(
        fs::metadata(here.join("film.raw")).unwrap().len(),
        u64::from(FRAMES) * 96 * 54
    );
}
