//! Guards against frames that are drawn twice, lost or mixed where several runs draw one animation without a scheduler.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::io::{BufRead, BufReader, Read};
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::{TempDir, tempdir};

use crate::harness::{PATTERN, darkness, done, files, listing, refused, with_animation};

/// A folder with an animation in `small.toml`, and all its frames in `whole`.
fn with_frames(frames: u32) -> TempDir {
    let folder = with_animation(frames);
    done(
        folder.path(),
        &["render", "small.toml", "-o", "whole/f_####.png"],
    );
    folder
}

/// Starts a run that shares the frames in `out`.
fn start(here: &Path, more: &[&str]) -> Child {
    let args = ["render", "small.toml", "-o", PATTERN];
    let mut command = darkness(here, &[&args, more].concat());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Waits for a run to succeed, and returns how many frames it drew.
fn drawn_by(child: Child) -> u64 {
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    drawn(&said)
}

/// How many frames a run drew, by what it said at its end.
fn drawn(said: &str) -> u64 {
    let last = said.lines().last().unwrap();
    if last.contains("all frames were finished before") {
        return 0;
    }
    let count = last
        .split(": ")
        .nth(1)
        .and_then(|text| text.split_once(' '));
    count.unwrap().0.parse().unwrap()
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// Waits until something is so.
fn until(mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Asserts that `out` holds the frames of `whole` and nothing else.
fn is_whole(here: &Path) {
    let (out, whole) = (files(&here.join("out")), files(&here.join("whole")));
    assert!(out.keys().eq(whole.keys()), "{:?}", out.keys());
    assert!(out == whole);
}

/// The finished frames in a folder and their inodes: a frame that is drawn again has another.
fn inodes(folder: &Path) -> BTreeMap<String, u64> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let entries = entries.filter_map(|entry| {
        let name = entry.file_name().into_string().unwrap();
        // Unfinished files vanish.
        (!name.starts_with('.')).then(|| (name, entry.metadata().unwrap().ino()))
    });
    entries.collect()
}

/// Reads what a run says, up to a line with `word`.
fn read_to(child: &mut Child, word: &str) -> BufReader<ChildStderr> {
    let mut reader = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains(word) {
        line.clear();
        assert!(reader.read_line(&mut line).unwrap() > 0, "no {word}");
    }
    reader
}

/// Claims frame `number` as a run does.
fn claim(here: &Path, number: u32) -> File {
    fs::create_dir_all(here.join("out")).unwrap();
    let file = File::create_new(claimed(here, number)).unwrap();
    file.lock().unwrap();
    file
}

fn claimed(here: &Path, number: u32) -> std::path::PathBuf {
    here.join(format!("out/.f_{number:04}.png.shared.part"))
}

#[test]
fn four_runs_draw_each_frame_once() {
    const FRAMES: u32 = 600;
    let folder = with_frames(FRAMES);
    let here = folder.path();
    for threads in ["1", "3"] {
        let _ = fs::remove_dir_all(here.join("out"));
        let runs: Vec<Child> = (0..4)
            .map(|_| start(here, &["--threads", threads]))
            .collect();
        let drawn: Vec<u64> = runs.into_iter().map(drawn_by).collect();
        assert_eq!(drawn.iter().sum::<u64>(), u64::from(FRAMES), "{drawn:?}");
        assert!(drawn.iter().filter(|&&drawn| drawn > 0).count() > 1);
        is_whole(here);
    }
}

#[test]
fn runs_that_are_killed_leave_the_rest_to_the_others() {
    let folder = with_frames(600);
    let here = folder.path();
    let out = here.join("out");
    let mut runs: Vec<Child> = (0..4).map(|_| start(here, &[])).collect();
    let mut before = BTreeMap::new();
    for (kill, frames) in [(3, 50), (1, 100), (0, 150)] {
        until(|| inodes(&out).len() >= frames);
        let mut killed = runs.remove(kill);
        killed.kill().unwrap();
        killed.wait().unwrap();
        before = inodes(&out);
    }
    let last = drawn_by(runs.pop().unwrap());
    assert!(last > 0 && last < 600, "{last}");
    let after = inodes(&out);
    assert!(before.iter().all(|(name, inode)| after[name] == *inode));
    is_whole(here);
}

#[test]
fn a_run_waits_for_the_frames_of_a_stopped_one() {
    let folder = with_frames(300);
    let here = folder.path();
    let out = here.join("out");
    for end in ["-CONT", "-KILL"] {
        let _ = fs::remove_dir_all(&out);
        let mut stopped = start(here, &["--threads", "1"]);
        // A file that is not locked yet is not claimed.
        let is_locked = |name: &&String| {
            let file = File::open(out.join(name)).map(|file| file.try_lock());
            name.ends_with(".shared.part") && matches!(file, Ok(Err(TryLockError::WouldBlock)))
        };
        let holds = || listing(&out).iter().any(|name| is_locked(&name));
        until(|| {
            signal(&stopped, "-CONT");
            std::thread::sleep(Duration::from_millis(3));
            signal(&stopped, "-STOP");
            std::thread::sleep(Duration::from_millis(3));
            out.exists() && inodes(&out).len() > 10 && holds()
        });
        let before = inodes(&out).len() as u64;
        let mut waits = start(here, &[]);
        let mut reader = read_to(
            &mut waits,
            "waiting for 1 frame that other runs are drawing",
        );
        assert_eq!(inodes(&out).len(), 299);
        assert!(waits.try_wait().unwrap().is_none() && holds());
        signal(&stopped, end);
        assert!(waits.wait().unwrap().success());
        assert_eq!(stopped.wait().unwrap().success(), end == "-CONT");
        let mut said = String::new();
        reader.read_to_string(&mut said).unwrap();
        // The stopped run drew the frames that were there, and the one that it held where it went on.
        let others = before + u64::from(end == "-CONT");
        assert_eq!(drawn(&said), 300 - others, "{said}");
        is_whole(here);
    }
}

#[test]
fn a_signal_ends_the_waiting_and_what_others_drew_is_checked() {
    let folder = with_frames(20);
    let here = folder.path();
    let out = here.join("out");
    let held = claim(here, 7);
    let mut waits = start(here, &[]);
    let mut reader = read_to(&mut waits, "waiting for 1 frame");
    signal(&waits, "-INT");
    assert_eq!(waits.wait().unwrap().code(), Some(130));
    let mut said = String::new();
    reader.read_to_string(&mut said).unwrap();
    assert!(said.contains("19 of 20 frames are finished"), "{said}");

    // What the other run leaves is no frame of this scene.
    let mut waits = start(here, &[]);
    let _reader = read_to(&mut waits, "waiting for 1 frame");
    fs::copy(here.join("whole/f_0008.png"), claimed(here, 7)).unwrap();
    fs::rename(claimed(here, 7), out.join("f_0007.png")).unwrap();
    drop(held);
    assert!(waits.wait().unwrap().success());
    is_whole(here);
}

#[test]
fn frames_that_another_run_overwrites_meanwhile_are_not_drawn_again() {
    let folder = with_frames(20);
    let here = folder.path();
    let out = here.join("out");
    done(here, &["render", "small.toml", "-o", PATTERN]);
    let held = claim(here, 7);
    let mut waits = start(here, &["--overwrite"]);
    let mut reader = read_to(&mut waits, "waiting for 1 frame");
    fs::copy(here.join("whole/f_0007.png"), claimed(here, 7)).unwrap();
    fs::rename(claimed(here, 7), out.join("f_0007.png")).unwrap();
    // What a run leaves that is killed where it claims a frame that is there.
    fs::write(claimed(here, 3), "").unwrap();
    drop(held);
    assert!(waits.wait().unwrap().success());
    let mut said = String::new();
    reader.read_to_string(&mut said).unwrap();
    assert!(
        said.contains("19 frames of") && said.contains("other runs drew 1"),
        "{said}"
    );
    is_whole(here);

    // Without a frame of the same origin the claim alone does not count.
    let held = claim(here, 7);
    let mut waits = start(here, &["--overwrite"]);
    let mut reader = read_to(&mut waits, "waiting for 1 frame");
    drop(held);
    assert!(waits.wait().unwrap().success());
    let mut said = String::new();
    reader.read_to_string(&mut said).unwrap();
    assert!(said.contains("20 frames of"), "{said}");
    is_whole(here);
}

#[test]
fn a_run_with_other_settings_is_refused_while_one_is_drawing() {
    let folder = with_frames(300);
    let here = folder.path();
    let out = here.join("out");
    let mut first = start(here, &[]);
    until(|| out.exists() && !inodes(&out).is_empty());
    signal(&first, "-STOP");
    let before = inodes(&out);
    let other = ["render", "small.toml", "-o", "out/f_%04d.png", "--fov", "9"];
    refused(here, &other, 1, &["another run is drawing", "-o"]);
    let after = inodes(&out);
    assert!(before.iter().all(|(name, inode)| after[name] == *inode));
    // Another name is another sequence.
    let elsewhere = ["render", "small.toml", "-o", "out/g_#.png", "--fov", "9"];
    done(here, &[&elsewhere[..], &["--frames", "1"]].concat());
    fs::remove_file(out.join("g_1.png")).unwrap();
    signal(&first, "-CONT");
    assert!(first.wait().unwrap().success());
    is_whole(here);

    // What a killed run left refuses nobody.
    fs::remove_file(out.join("f_0300.png")).unwrap();
    let held = claim(here, 300);
    let mut killed = start(here, &[]);
    let _reader = read_to(&mut killed, "waiting");
    killed.kill().unwrap();
    killed.wait().unwrap();
    drop(held);
    let left = |name: &&String| name.starts_with(".f_####.png.");
    assert_eq!(listing(&out).iter().filter(left).count(), 1);
    done(here, &other);
    assert_eq!(listing(&out).len(), 300);
}

#[test]
fn an_empty_folder_name_is_the_current_one() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    crate::harness::write_animation(&here.join("small.toml"), 3);
    done(here, &["render", "small.toml", "-o", "f_#.png"]);
    let names = listing(here);
    assert_eq!(
        names,
        ["f_1.png", "f_2.png", "f_3.png", "small.toml", "tables"]
    );
}
