//! Guards against pictures that are too large, and against memory that the system refuses.

use std::fs;
use std::process::Command;

use super::is_sentence;
use crate::harness::{PROGRAM, done, files, refused, with_animation};

/// Guards against a picture that takes the memory of everything else that runs.
#[test]
fn pictures_that_are_too_large_are_refused_before_memory_is_allocated() {
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
    // In a scene file too.
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
    // The limit can be changed, and frames that do not fit together are drawn one by one.
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

/// Guards against a process that ends without a sentence when the system refuses memory.
#[test]
#[cfg(target_os = "linux")]
fn memory_that_the_system_refuses_is_reported() {
    let folder = with_animation(1);
    let here = folder.path();
    let mut refused = 0;
    // Kilobytes of address space: from too little to start, over too little for the frame, to enough.
    for limit in (16_000..300_000).step_by(12_000) {
        for antialias in [true, false] {
            let line = format!(
                "ulimit -v {limit}; exec '{PROGRAM}' render classic --size 12000x8000 --threads 1 --quiet \
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
                // The system's own loader speaks before the program begins.
                Some(127) if said.contains("error while loading shared libraries") => {}
                _ => panic!("{limit} KiB: {}: {said}", output.status),
            }
        }
    }
    assert!(refused > 3, "{refused} refused");
}
