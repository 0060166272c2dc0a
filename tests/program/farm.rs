//! Guards against films and jobs that other programs do not accept: ffmpeg, Open Job Description's `openjd`, and Slurm
//! in a cluster of one machine.
//!
//! A program that is not installed is skipped, unless `DARKNESS_TOOLS` names it.
#![cfg(unix)]

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use darkness::scene::Animation;
use tempfile::tempdir;

use crate::harness::{PROGRAM, files};
use crate::tools;

/// Returns whether all the tools are installed.
fn has(tools: &[&str]) -> bool {
    tools.iter().all(|tool| tools::has(tool))
}

/// The search path, with the program under test first.
fn path() -> OsString {
    let ours = Path::new(PROGRAM).parent().unwrap().to_owned();
    let others = env::var_os("PATH").unwrap_or_default();
    let daemons = ["/usr/sbin".into(), "/sbin".into()];
    env::join_paths(
        [ours]
            .into_iter()
            .chain(env::split_paths(&others))
            .chain(daemons),
    )
    .unwrap()
}

fn run(folder: &Path, program: &str, args: &[&str]) -> Output {
    let mut command = Command::new(program);
    command
        .current_dir(folder)
        .env("PATH", path())
        .env_remove("DARKNESS_TABLE")
        .args(args);
    let output = command.output().unwrap();
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// Writes an animation of 30 small frames.
fn write_scene(path: &Path) {
    let toml = Animation::load("orbit").unwrap().to_toml();
    let toml = toml
        .replace("frames = 240", "frames = 30")
        .replace("width = 1920", "width = 160")
        .replace("height = 1080", "height = 90");
    fs::write(path, toml).unwrap();
}

#[test]
fn the_command_in_the_readme_makes_a_film_with_the_right_range_and_colours() {
    if !has(&["ffmpeg", "ffprobe"]) {
        return;
    }
    let folder = tempdir().unwrap();
    let here = folder.path();
    let readme = include_str!("../../README.md");
    let line = readme
        .lines()
        .find(|line| line.contains("-o orbit.mp4"))
        .unwrap();
    let small = line.replace("render orbit", "render orbit --size 320x180 --frames 1-24");
    assert_ne!(small, line);
    run(here, "sh", &["-c", &small]);
    let entries = "stream=width,height,pix_fmt,color_range,color_space,color_transfer,color_primaries,r_frame_rate,nb_frames";
    let args = [
        "-v",
        "error",
        "-show_entries",
        entries,
        "-of",
        "default=nw=1",
        "orbit.mp4",
    ];
    let told = String::from_utf8(run(here, "ffprobe", &args).stdout).unwrap();
    for entry in [
        "width=320",
        "height=180",
        "pix_fmt=yuv420p",
        "color_range=tv",
        "color_space=bt709",
        "color_transfer=bt709",
        "color_primaries=bt709",
        "r_frame_rate=24/1",
        "nb_frames=24",
    ] {
        assert!(told.lines().any(|line| line == entry), "{entry}: {told}");
    }
    // Converted back to grey from 0 to 255, it equals the frame up to the film's compression.
    let args = [
        "-v",
        "error",
        "-i",
        "orbit.mp4",
        "-vf",
        "scale=out_range=pc,format=gray",
        "-frames:v",
        "1",
        "-f",
        "rawvideo",
        "film.raw",
    ];
    run(here, "ffmpeg", &args);
    run(
        here,
        "darkness",
        &[
            "render",
            "orbit",
            "--size",
            "320x180",
            "--frames",
            "1",
            "-o",
            "frame.raw",
        ],
    );
    let [film, frame] = ["film.raw", "frame.raw"].map(|name| fs::read(here.join(name)).unwrap());
    assert_eq!(film.len(), frame.len());
    let apart: u32 = film
        .iter()
        .zip(&frame)
        .map(|(a, b)| u32::from(a.abs_diff(*b)))
        .sum();
    let mean = f64::from(apart) / frame.len() as f64;
    assert!(mean < 2.0, "{mean} greys apart");
    assert!(film.contains(&0) && film.contains(&255));
}

#[test]
fn ffmpeg_reads_a_film_to_the_last_bit() {
    if !has(&["ffmpeg"]) {
        return;
    }
    let folder = tempdir().unwrap();
    let here = folder.path();
    write_scene(&here.join("small.toml"));
    run(
        here,
        "darkness",
        &[
            "render",
            "small.toml",
            "--format",
            "y4m-gray",
            "-o",
            "film.y4m",
        ],
    );
    run(
        here,
        "darkness",
        &["render", "small.toml", "-o", "frames.raw"],
    );
    let read = run(
        here,
        "ffmpeg",
        &["-v", "error", "-i", "film.y4m", "-f", "rawvideo", "-"],
    )
    .stdout;
    assert!(read == fs::read(here.join("frames.raw")).unwrap());
}

#[test]
fn openjd_runs_the_job_and_its_chunks_give_the_files_of_one_process() {
    if !has(&["openjd"]) {
        return;
    }
    let folder = tempdir().unwrap();
    // A name that a shell would split.
    let here = &folder.path().join("it's a \"farm\" $HOME");
    fs::create_dir(here).unwrap();
    let scene = "my scene.toml";
    write_scene(&here.join(scene));
    let job = run(here, "darkness", &["job", "openjd", scene, "--chunk", "10"]).stdout;
    fs::write(here.join("job.yaml"), job).unwrap();
    run(here, "openjd", &["check", "job.yaml"]);
    let told = run(here, "openjd", &["run", "job.yaml"]).stdout;
    let told = String::from_utf8_lossy(&told).into_owned();
    assert!(told.contains("Chunks run: 4"), "{told}");
    assert!(told.contains("openjd_progress: 100.0"), "{told}");
    let one = [
        "render",
        scene,
        "--require-table",
        "-o",
        "one/my scene_####.png",
    ];
    run(here, "darkness", &one);
    let frames = files(&here.join("frames"));
    assert!(frames.len() == 30 && frames == files(&here.join("one")));

    // With an absolute scene file and other values than the defaults.
    let absolute = here.join(scene);
    let args = [
        "job",
        "openjd",
        absolute.to_str().unwrap(),
        "--table",
        "t/a.table",
        "-o",
        "f_%03d.png",
    ];
    fs::write(here.join("other.yaml"), run(here, "darkness", &args).stdout).unwrap();
    let scene = format!("Scene={}", absolute.display());
    let args = [
        "run",
        "other.yaml",
        "-p",
        &scene,
        "-p",
        "Frames=1-9:4,30",
        "-p",
        "Chunk=2",
        "-p",
        "OutputDir=some",
    ];
    run(here, "openjd", &args);
    let some = files(&here.join("some"));
    assert_eq!(
        some.keys().map(String::as_str).collect::<Vec<_>>(),
        ["f_001.png", "f_005.png", "f_009.png", "f_030.png"]
    );
    assert!(some["f_005.png"] == frames["my scene_0005.png"]);
}

#[test]
fn slurm_runs_the_job_to_its_last_frame() {
    if !has(&["sbatch", "slurmctld", "slurmd", "munged"]) {
        return;
    }
    let folder = tempdir().unwrap();
    let here = &folder.path().join("it's a farm");
    fs::create_dir(here).unwrap();
    write_scene(&here.join("small.toml"));
    // 30 frames in chunks of 7: the last task has two frames.
    let job = run(
        here,
        "darkness",
        &["job", "slurm", "small.toml", "--chunk", "7"],
    )
    .stdout;
    let job = String::from_utf8(job).unwrap();
    assert!(job.contains("--array=0-4\n"), "{job}");
    fs::write(here.join("job.sh"), &job).unwrap();
    let line = job
        .lines()
        .find(|line| line.starts_with("#   darkness table"))
        .unwrap();
    run(here, "sh", &["-c", line.trim_start_matches("#   ")]);
    let cluster = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/farm/slurm.sh");
    run(here, cluster, &["job.sh"]);
    run(
        here,
        "darkness",
        &[
            "render",
            "small.toml",
            "--require-table",
            "-o",
            "one/small_####.png",
        ],
    );
    let frames = files(&here.join("frames"));
    assert!(frames.len() == 30 && frames == files(&here.join("one")));
}
