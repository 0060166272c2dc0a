//! The program itself, start-up included: 240 frames of `orbit`, 1920 × 1080, as bare bytes, as a film and as PNG
//! files, against the least that such bytes cost.
//!
//! `cargo bench --bench film`

mod interleaved;

use core::cell::RefCell;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use interleaved::{Contender, compare};

const FRAMES: usize = 240;

const PIXELS: usize = 1920 * 1080;

/// Runs the program in a folder that has its table; the number of frames, or none where it failed.
fn render(folder: &Path, args: &[&str]) -> f64 {
    let status = Command::new(env!("CARGO_BIN_EXE_darkness"))
        .current_dir(folder)
        .args(["--quiet", "render", "orbit", "--overwrite"])
        .args(args)
        .stdout(Stdio::null())
        .status();
    let done = status.is_ok_and(|status| status.success());
    if done { FRAMES as f64 } else { f64::NAN }
}

/// Files with the bytes of others.
fn copy(from: &Path, to: &Path) -> f64 {
    let _ = fs::create_dir_all(to);
    let Ok(entries) = fs::read_dir(from) else {
        return f64::NAN;
    };
    let copied = entries.flatten().filter(|entry| {
        let bytes = fs::read(entry.path());
        bytes.is_ok_and(|bytes| fs::write(to.join(entry.file_name()), bytes).is_ok())
    });
    copied.count() as f64
}

fn main() {
    let Ok(folder) = tempfile::tempdir() else {
        return;
    };
    let here = folder.path();
    render(here, &["--frames", "1-240:239"]);
    let buffer = RefCell::new(vec![0_u8; PIXELS]);
    let fill = || {
        for _ in 0..FRAMES {
            std::hint::black_box(&mut *buffer.borrow_mut()).fill(1);
        }
        FRAMES as f64
    };
    let all = RefCell::new(vec![1_u8; FRAMES * PIXELS]);
    let fill_all = || {
        std::hint::black_box(&mut *all.borrow_mut()).fill(1);
        FRAMES as f64
    };
    let one = ["-o", "-", "--format", "raw", "--threads", "1"];
    compare(
        "bare bytes into /dev/null, one thread, time per frame",
        FRAMES,
        15,
        &mut [
            Contender {
                name: "filling one buffer as often",
                run: Box::new(fill),
            },
            Contender {
                name: "filling all frames' bytes",
                run: Box::new(fill_all),
            },
            Contender {
                name: "hard edges",
                run: Box::new(|| render(here, &[&one[..], &["--antialias", "false"]].concat())),
            },
            Contender {
                name: "smooth edges",
                run: Box::new(|| render(here, &one)),
            },
        ],
    );

    drop(all);
    let memory = Path::new("/dev/shm");
    let shared = tempfile::tempdir_in(if memory.is_dir() { memory } else { here });
    let Ok(shared) = shared else {
        return;
    };
    let film = shared.path().join("film.y4m");
    let film = film.to_string_lossy();
    let copied = shared.path().join("copy");
    compare(
        "a film with smooth edges, all threads, time per frame",
        FRAMES,
        9,
        &mut [
            Contender {
                name: "as many bytes into a file in memory",
                run: Box::new(|| {
                    let Ok(mut file) = File::create(&copied) else {
                        return f64::NAN;
                    };
                    let written = (0..FRAMES).filter(|_| file.write_all(&buffer.borrow()).is_ok());
                    written.count() as f64
                }),
            },
            Contender {
                name: "y4m into a file in memory",
                run: Box::new(|| render(here, &["-o", &film])),
            },
            Contender {
                name: "y4m into /dev/null",
                run: Box::new(|| render(here, &["-o", "/dev/null", "--format", "y4m"])),
            },
        ],
    );

    let (source, target) = (here.join("frames"), here.join("copies"));
    render(here, &["-o", "frames/f_####.png"]);
    compare(
        "PNG files, all threads, time per frame",
        FRAMES,
        9,
        &mut [
            Contender {
                name: "copying the same files",
                run: Box::new(|| copy(&source, &target)),
            },
            Contender {
                name: "smooth edges",
                run: Box::new(|| render(here, &["-o", "frames/f_####.png"])),
            },
            Contender {
                name: "hard edges",
                run: Box::new(|| render(here, &["-o", "hard/f_####.png", "--antialias", "false"])),
            },
        ],
    );
}
