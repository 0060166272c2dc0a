//! Guards against failures that only show in time: memory and open files that grow with the number of frames, a process
//! that is paused and resumed, a reader that is slower than the program, and clocks that jump.
//!
//! `cargo test --release --test program long_runs -- --ignored --nocapture` draws a hundred thousand frames in each
//! form.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::harness::{PROGRAM, darkness, done, files, with_animation};
use crate::tools;

/// The most memory and open files that a process had at any time.
#[derive(Debug, Clone, Copy, Default)]
struct Held {
    kib: u64,
    files: usize,
}

/// Waits for a process to succeed, and measures what it holds meanwhile.
fn watched(mut child: Child) -> Held {
    let place = Path::new("/proc").join(child.id().to_string());
    let mut most = Held::default();
    while child.try_wait().unwrap().is_none() {
        // Between fork and exec the process is a copy of this one.
        let is_begun = fs::read_link(place.join("exe")).is_ok_and(|exe| exe == Path::new(PROGRAM));
        if !is_begun {
            continue;
        }
        let status = fs::read_to_string(place.join("status")).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        most.kib = most.kib.max(kib.unwrap_or(0));
        let open = fs::read_dir(place.join("fd")).map_or(0, Iterator::count);
        most.files = most.files.max(open);
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    most
}

/// The most that a run over so many frames holds, written in this form.
fn most_held(here: &Path, frames: u32, output: &str) -> Held {
    let range = format!("1-{frames}");
    let args = [
        "render",
        "small.toml",
        "--frames",
        &range,
        "-o",
        output,
        "--threads",
        "2",
    ];
    let format: &[&str] = if output == "-" {
        &["--format", "y4m"]
    } else {
        &[]
    };
    let mut command = darkness(here, &[&args[..], format].concat());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    watched(command.spawn().unwrap())
}

/// Asserts that many frames take no more memory or open files than few: as files, and as films to a file and a pipe.
fn is_flat(few: u32, many: u32) {
    let folder = with_animation(many);
    let here = folder.path();
    for output in ["few/f_######.png", "few.y4m", "-"] {
        let little = most_held(here, few, output);
        let much = most_held(here, many, &output.replace("few", "many"));
        println!("{output}: {few} frames {little:?}, {many} frames {much:?}");
        assert!(
            little.kib > 0 && much.kib < little.kib + 2048,
            "{output}: {little:?}, {much:?}"
        );
        assert!(
            little.files > 0 && much.files <= little.files + 2,
            "{output}: {little:?}, {much:?}"
        );
    }
    assert_eq!(files(&here.join("many")).len(), many as usize);
}

#[test]
fn memory_and_open_files_are_the_same_for_many_frames_as_for_few() {
    is_flat(200, 2000);
}

#[test]
#[ignore = "takes some minutes: see tests/README.md"]
fn memory_and_open_files_are_the_same_for_a_hundred_thousand_frames() {
    is_flat(1000, 100_000);
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// Guards against an interrupted system call that is reported as a failure, and against a lock that is lost.
#[test]
fn a_run_that_is_paused_and_resumed_does_all_its_work() {
    let folder = with_animation(1000);
    let here = folder.path();
    done(here, &["render", "small.toml", "-o", "whole.y4m"]);
    done(here, &["render", "small.toml", "-o", "whole/f_####.png"]);
    for output in ["stopped/f_####.png", "stopped.y4m"] {
        let mut command = darkness(here, &["render", "small.toml", "-o", output]);
        let mut child = command.stderr(Stdio::null()).spawn().unwrap();
        let mut stops = 0;
        while child.try_wait().unwrap().is_none() {
            signal(&child, "-STOP");
            std::thread::sleep(Duration::from_millis(20));
            signal(&child, "-CONT");
            // All of the work takes some tens of milliseconds.
            std::thread::sleep(Duration::from_millis(5));
            stops += 1;
        }
        assert!(
            child.wait().unwrap().success() && stops > 3,
            "{stops} stops"
        );
    }
    assert!(files(&here.join("stopped")) == files(&here.join("whole")));
    assert!(
        fs::read(here.join("stopped.y4m")).unwrap() == fs::read(here.join("whole.y4m")).unwrap()
    );
}

/// Guards against frames that pile up in memory, are lost, or are written twice.
#[test]
fn a_slow_reader_gets_every_frame_and_no_frames_pile_up() {
    let folder = with_animation(1500);
    let here = folder.path();
    done(here, &["render", "small.toml", "-o", "whole.y4m"]);
    let whole = fs::read(here.join("whole.y4m")).unwrap();
    let quick = most_held(here, 1500, "quick.y4m");
    let args = [
        "render",
        "small.toml",
        "-o",
        "-",
        "--format",
        "y4m",
        "--threads",
        "2",
    ];
    let mut child = darkness(here, &args)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut pipe = child.stdout.take().unwrap();
    let reader = std::thread::spawn(move || {
        // Reads a few bytes at a time at first, then a few frames.
        let (mut read, mut buffer): (Vec<u8>, _) = (Vec::new(), vec![0_u8; 1 << 16]);
        for turn in 0.. {
            let some = if turn < 100 { 97 } else { 1 << 16 };
            match pipe.read(&mut buffer[..some]).unwrap() {
                0 => break,
                length => read.extend(&buffer[..length]),
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        read
    });
    let slow = watched(child);
    assert!(reader.join().unwrap() == whole);
    println!("{quick:?} for a quick reader, {slow:?} for a slow one");
    assert!(slow.kib < quick.kib + 2048, "{quick:?}, {slow:?}");
}

/// Guards against waits and figures that depend on a clock that is set while frames are drawn: forward by a year, back
/// by ten. (The monotonic clock is turned too, although no system turns it back.)
#[test]
fn clocks_that_jump_change_nothing() {
    if !tools::has("faketime") {
        return;
    }
    let folder = with_animation(1000);
    let here = folder.path();
    done(here, &["render", "small.toml", "-o", "whole/f_####.png"]);
    let clock = here.join("clock");
    let set = |shift: &str| fs::write(&clock, shift).unwrap();
    for progress in ["plain", "openjd"] {
        let _ = fs::remove_dir_all(here.join("jumped"));
        set("+0");
        let mut child = Command::new("faketime")
            .current_dir(here)
            .env_remove("DARKNESS_TABLE")
            .env("DARKNESS_CACHE", "tables")
            .env("FAKETIME_TIMESTAMP_FILE", &clock)
            .env("FAKETIME_NO_CACHE", "1")
            .args(["+0 days"])
            .arg(PROGRAM)
            .args([
                "render",
                "small.toml",
                "-o",
                "jumped/f_####.png",
                "--timings",
                "--progress",
                progress,
            ])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = child.stderr.take().unwrap();
        let said = std::thread::spawn(move || {
            let mut text = String::new();
            said.read_to_string(&mut text).unwrap();
            text
        });
        for shift in ["+365d", "-3650d", "+10", "-10", "+100000d", "-1d"]
            .iter()
            .cycle()
        {
            if child.try_wait().unwrap().is_some() {
                break;
            }
            set(shift);
            std::thread::sleep(Duration::from_millis(10));
        }
        let said = said.join().unwrap();
        assert!(child.wait().unwrap().success(), "{said}");
        assert!(
            !said.contains("panicked") && !said.contains("NaN"),
            "{said}"
        );
        assert!(files(&here.join("jumped")) == files(&here.join("whole")));
    }
}
