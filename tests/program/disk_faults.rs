//! Guards against a disk that is full, read-only or limited by a quota, for everything that the program writes. It must
//! exit with 1 and a sentence that names the file, and leave no partial file; no signal may end it.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Output};

use crate::harness::{PROGRAM, done, files, with_animation};
use crate::tools;

/// Commands that write a file of each kind into the folder `out`, where `{}` stands for the program.
const WRITERS: [(&str, &str); 12] = [
    ("t.table", "{} table draft -o out/t.table"),
    ("deep", "{} table draft -o out/deep/t.table"),
    (
        "p.png",
        "{} render classic --table tables/draft.table --size 1280x720 -o out/p.png",
    ),
    ("out", "{} render small.toml --size 960x540 -o out/f_##.png"),
    ("out", "{} render small.toml --size 960x540 -o out/f_##.exr"),
    ("out", "{} render small.toml --size 960x540 -o out/f_##.npz"),
    (
        "out",
        "{} render lit-orbit --frames 1-2 --size 960x540 -o out/f_##.png",
    ),
    (
        "out",
        "{} render lit-orbit --frames 1-2 --size 960x540 --layers colour,radius -o out/f_##.exr",
    ),
    ("a.y4m", "{} render small.toml -o out/a.y4m"),
    ("a.raw", "{} render small.toml -o out/a.raw"),
    (
        "r.csv",
        "{} chart tiny.toml --quick --csv out/r.csv -o - >/dev/null",
    ),
    ("c.svg", "{} chart tiny.toml --quick -o out/c.svg"),
];

/// A folder with an animation, a still scene of few pixels, and a list of rays.
fn prepared() -> tempfile::TempDir {
    let folder = with_animation(20);
    let here = folder.path();
    let scene = darkness::scene::Scene::builtin("classic").unwrap();
    fs::write(
        here.join("tiny.toml"),
        scene.with_size(16, 9).unwrap().to_toml(),
    )
    .unwrap();
    fs::write(
        here.join("rays.csv"),
        format!("u0,dudphi\n{}", "0.03,0.1\n".repeat(2000)),
    )
    .unwrap();
    folder
}

/// Runs a line of the shell, with the program in place of `{}`.
fn shell(here: &Path, line: &str) -> (Output, String) {
    let program = format!("'{PROGRAM}'");
    let mut command = Command::new("sh");
    command
        .current_dir(here)
        .env_remove("DARKNESS_TABLE")
        .env("DARKNESS_CACHE", "tables")
        .args(["-c", &line.replace("{}", &program)]);
    told(&mut command)
}

/// Runs a command, and returns its output and its standard error as text.
fn told(command: &mut Command) -> (Output, String) {
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr.clone()).unwrap();
    (output, said)
}

/// Asserts that a run failed in a sentence that names what could not be written.
fn failed(line: &str, (output, said): &(Output, String), names: &str) {
    assert_eq!(
        output.status.code(),
        Some(1),
        "{line}: {}: {said}",
        output.status
    );
    let sentence = said
        .lines()
        .find(|line| line.starts_with("darkness: "))
        .unwrap_or_default();
    assert!(
        !sentence.is_empty() && (said.contains(names) || said.contains("out: about")),
        "{line}: {said}"
    );
    assert!(!said.contains("panicked"), "{said}");
}

/// The names of the files in `out`, hidden ones too.
fn left(here: &Path) -> Vec<String> {
    files(&here.join("out")).into_keys().collect()
}

#[test]
fn a_quota_is_reported_and_leaves_no_partial_file() {
    let folder = prepared();
    let here = folder.path();
    fs::create_dir(here.join("out")).unwrap();
    for (name, line) in WRITERS {
        // Blocks of 512 bytes.
        let run = shell(here, &format!("ulimit -f 1; {line}"));
        failed(line, &run, name);
        let _ = fs::remove_dir(here.join("out/deep"));
        assert!(left(here).is_empty(), "{line}: {:?}", left(here));
    }
    // As with any program, printed output fills the file up to the quota.
    for line in [
        "{} trace rays.csv > out/r",
        "{} job slurm small.toml > out/j",
    ] {
        let run = shell(here, &format!("ulimit -f 1; {line}"));
        failed(line, &run, "standard output");
    }
}

/// Uses a disk of its own of one page, if the system lets users mount one.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_reported_and_leaves_no_partial_file() {
    if !tools::has("unshare") {
        return;
    }
    let folder = prepared();
    let here = folder.path();
    fs::create_dir(here.join("out")).unwrap();
    let mounted = |size: &str, line: &str| {
        let line = line.replace("{}", &format!("'{PROGRAM}'"));
        let line = format!(
            "mount -t tmpfs -o size={size} none out || exit 99; {line}; code=$?; ls -A out >left; exit $code"
        );
        let mut command = Command::new("unshare");
        command
            .current_dir(here)
            .env_remove("DARKNESS_TABLE")
            .env("DARKNESS_CACHE", "tables")
            .args(["--map-root-user", "--mount", "sh", "-c", &line]);
        told(&mut command)
    };
    let (probe, said) = mounted("64k", "true");
    if !probe.status.success() {
        eprintln!("no disk can be mounted here: {said}");
        return;
    }
    for (name, line) in WRITERS {
        // With the one page taken, and with it free.
        for line in [
            format!("head -c 4096 /dev/zero >out/taken; {line}"),
            line.to_owned(),
        ] {
            let run = mounted("4k", &line);
            failed(&line, &run, name);
            let left = fs::read_to_string(here.join("left")).unwrap();
            let left: Vec<_> = left
                .lines()
                .filter(|name| !["taken", "deep"].contains(name))
                .collect();
            assert!(left.is_empty(), "{line}: {left:?}");
        }
    }
    let line = "{} trace rays.csv > out/r";
    failed(line, &mounted("4k", line), "standard output");
    // With more room the same command succeeds.
    let (output, said) = mounted("1m", WRITERS[0].1);
    assert!(output.status.success(), "{said}");
}

/// Runs as a user without rights to the files: as an ordinary user if root runs the tests.
#[test]
fn files_without_permission_are_reported_and_left_alone() {
    let folder = prepared();
    let here = folder.path();
    let mode = |name: &str, mode: u32| {
        fs::set_permissions(here.join(name), Permissions::from_mode(mode)).unwrap();
    };
    let is_root = shell(here, "test $(id -u) = 0").0.status.success();
    // Other users may have no access to the program's own folder.
    let program = here.join("darkness");
    fs::copy(PROGRAM, &program).unwrap();
    for name in ["", "darkness", "tables"] {
        mode(name, 0o755);
    }
    let ordinary = |line: &str| {
        let mut command = Command::new("sh");
        command
            .current_dir(here)
            .env_remove("DARKNESS_TABLE")
            .env("DARKNESS_CACHE", "tables")
            .args(["-c", &line.replace("{}", "./darkness")]);
        if is_root {
            command.uid(65534).gid(65534);
        }
        told(&mut command)
    };

    let (probe, said) = ordinary("{} --version");
    if !probe.status.success() {
        eprintln!("an ordinary user cannot come here: {said}");
        return;
    }

    fs::create_dir(here.join("out")).unwrap();
    fs::write(here.join("out/t.table"), "old").unwrap();
    fs::write(here.join("c.svg"), "old").unwrap();
    mode("out", 0o555);
    mode("", 0o555);
    for (name, line) in WRITERS {
        let line = line.replace("table draft", "table draft --force");
        failed(&line, &ordinary(&line), name);
        assert_eq!(left(here), ["t.table"], "{line}");
    }
    mode("out", 0o755);
    assert_eq!(fs::read(here.join("out/t.table")).unwrap(), b"old");

    // A table that cannot be saved is used all the same, and the program says so.
    mode("", 0o755);
    fs::remove_dir_all(here.join("tables")).unwrap();
    mode("", 0o555);
    let (output, said) = ordinary("{} render classic --size 32x18 -o - >/dev/null");
    assert!(
        output.status.success() && said.contains("cannot be kept"),
        "{said}"
    );

    mode("", 0o755);
    done(here, &["table", "draft", "-o", "closed.table"]);
    for name in ["closed.table", "tiny.toml", "rays.csv"] {
        mode(name, 0o000);
    }
    for (name, line) in [
        (
            "closed.table",
            "{} render --table closed.table -o - >/dev/null",
        ),
        ("closed.table", "{} table inspect closed.table"),
        (
            "closed.table",
            "{} render --table closed.table --no-mmap -o - >/dev/null",
        ),
        ("tiny.toml", "{} render tiny.toml -o - >/dev/null"),
        ("rays.csv", "{} trace rays.csv --method exact"),
    ] {
        failed(line, &ordinary(line), name);
    }
}
