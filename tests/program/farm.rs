//! Guards against jobs that other programs do not accept: Open Job Description's `openjd`, and Slurm in a cluster of
//! one machine.
//!
//! A program that is not installed is skipped, unless `DARKNESS_TOOLS` names it.
#![cfg(unix)]

use std::fs;

use tempfile::tempdir;

use crate::harness::{done, files, tool_prints, write_animation};
use crate::tools;

/// Returns whether all the tools are installed.
fn has(tools: &[&str]) -> bool {
    tools.iter().all(|tool| tools::has(tool))
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
    write_animation(&here.join(scene), 30);
    let job = done(here, &["job", "openjd", scene, "--chunk", "10"]).0;
    fs::write(here.join("job.yaml"), job).unwrap();
    tool_prints(here, &["openjd", "check", "job.yaml"]);
    let told = tool_prints(here, &["openjd", "run", "job.yaml"]);
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
    done(here, &one);
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
    fs::write(here.join("other.yaml"), done(here, &args).0).unwrap();
    let scene = format!("Scene={}", absolute.display());
    let line = [
        "openjd",
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
    tool_prints(here, &line);
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
    write_animation(&here.join("small.toml"), 30);
    // 30 frames in chunks of 7: the last task has two frames.
    let job = done(here, &["job", "slurm", "small.toml", "--chunk", "7"]).0;
    let job = String::from_utf8(job).unwrap();
    assert!(job.contains("--array=0-4\n"), "{job}");
    fs::write(here.join("job.sh"), &job).unwrap();
    let line = job
        .lines()
        .find(|line| line.starts_with("#   darkness table"))
        .unwrap();
    tool_prints(here, &["sh", "-c", line.trim_start_matches("#   ")]);
    let cluster = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/farm/slurm.sh");
    tool_prints(here, &[cluster, "job.sh"]);
    let one = [
        "render",
        "small.toml",
        "--require-table",
        "-o",
        "one/small_####.png",
    ];
    done(here, &one);
    let frames = files(&here.join("frames"));
    assert!(frames.len() == 30 && frames == files(&here.join("one")));
}
