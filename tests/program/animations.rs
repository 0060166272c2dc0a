//! Guards against animations that are drawn otherwise than asked for, that go on after an error, or whose errors do not
//! say what is wrong.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;

use tempfile::tempdir;

use crate::harness::{PATTERN, done, files, printed, refused, run, with_animation};

#[test]
fn frames_are_numbered_files_that_record_what_they_were_made_of() {
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
    // The output of `sha256sum` for the table's file.
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
    // Hard and smooth frames show the same camera.
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
fn a_film_consists_of_its_header_and_its_frames() {
    let folder = with_animation(6);
    let here = folder.path();
    let (raw, _) = done(
        here,
        &["render", "small.toml", "-o", "-", "--format", "raw"],
    );
    let film = |format: &str| {
        let args = ["render", "small.toml", "-o", "-", "--format", format];
        done(here, &args).0
    };
    // Black is 16, white 235, and no colour 128.
    let limited = |grey: &u8| 16 + ((u32::from(*grey) * 219 + 127) / 255) as u8;
    let header = b"YUV4MPEG2 W96 H54 F24:1 Ip A1:1 C420mpeg2 XCOLORRANGE=LIMITED\n";
    let mut expected = header.to_vec();
    let mut grey = b"YUV4MPEG2 W96 H54 F24:1 Ip A1:1 Cmono XCOLORRANGE=FULL\n".to_vec();
    for frame in raw.chunks(96 * 54) {
        expected.extend(b"FRAME\n");
        expected.extend(frame.iter().map(limited));
        expected.extend([128; 96 * 54 / 2]);
        grey.extend(b"FRAME\n");
        grey.extend(frame);
    }
    assert!(film("y4m-gray") == grey);
    let film = film("y4m");
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
    assert!(
        still.starts_with(b"YUV4MPEG2 W96") && still.len() == header.len() + 6 + 96 * 54 * 3 / 2
    );
}

#[test]
fn an_invalid_frame_does_not_affect_the_others() {
    let folder = with_animation(101);
    let here = folder.path();
    // The camera reaches its focus at frame 51, the middle one.
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
        2,
        &["frame 51", "camera.focus"],
    );
}

#[test]
fn misuse_is_reported_before_anything_is_done() {
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
    misused(
        &["small.toml", "-o", "tables"],
        &["tables is a folder", "tables/small_####.png"],
    );
    misused(&["small.toml", "-o", "new/"], &["new/small_####.png"]);
    misused(
        &["small.toml", "-o", "f_##.gif"],
        &[".png, .exr, .npz, .y4m"],
    );
    misused(&["small.toml", "--frames", "21-22"], &["21-22", "1 to 20"]);
    misused(
        &["small.toml", "--frames", "5-1"],
        &["5-1", "before it begins"],
    );
    misused(
        &["small.toml", "--frames", "-3-0"],
        &["no frame 0", "1 to 20"],
    );
    misused(&["small.toml", "--frames", "1..4"], &["1..4", "1-240"]);
    misused(&["small.toml", "--frames", "21-4294967295"], &["1 to 20"]);
    misused(&["classic", "--frames", "2"], &["no frame 2"]);
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
fn a_job_writes_the_files_that_render_writes_and_refuses_others_in_the_same_words() {
    let folder = with_animation(3);
    let here = folder.path();
    let toml = fs::read_to_string(here.join("small.toml")).unwrap();
    let layered = toml.replace("[image]", "[image]\nlayers = [\"radius\"]");
    fs::write(here.join("layered.toml"), layered).unwrap();
    // What data need.
    done(here, &["table", "standard"]);
    let program = Path::new(env!("CARGO_BIN_EXE_darkness")).parent().unwrap();
    let path = std::env::join_paths([program, Path::new("/usr/bin"), Path::new("/bin")]).unwrap();
    for (args, files_of_render) in [
        (&["layered.toml"] as &[_], "frames/layered_####.exr"),
        (&["small.toml", "-o", "n/f_%02d.npz"], "n/f_%02d.npz"),
    ] {
        let job = printed(here, &[&["job", "slurm"], args].concat());
        let stem = args[0].trim_end_matches(".toml");
        for line in [
            format!("#SBATCH --job-name=darkness-{stem}"),
            "##SBATCH --partition=PARTITION".into(),
            "##SBATCH --time=HH:MM:SS".into(),
            "##SBATCH --mem=4G".into(),
        ] {
            assert!(job.lines().any(|its| its == line), "{line}: {job}");
        }
        let task = Command::new("bash")
            .args(["-c", &job])
            .env("PATH", &path)
            .env("SLURM_ARRAY_TASK_ID", "0")
            .current_dir(here)
            .output()
            .unwrap();
        assert!(task.status.success(), "{task:?}");
        let out = here.join(files_of_render).parent().unwrap().to_path_buf();
        let of_task = files(&out);
        assert_eq!(of_task.len(), 3);
        fs::remove_dir_all(&out).unwrap();
        done(here, &["render", args[0], "-o", files_of_render]);
        assert!(of_task == files(&out));
    }
    for args in [
        ["layered.toml", "-o", "f_####.png"],
        ["small.toml", "-o", "f.exr"],
    ] {
        let (job, of_job) = run(here, &[&["job", "openjd"], &args[..]].concat());
        let (_, of_render) = run(here, &[&["render"], &args[..]].concat());
        assert_eq!(job.status.code(), Some(2));
        assert_eq!(of_job, of_render);
    }
    refused(
        here,
        &["job", "slurm", "small.toml", "-o", "film_##.mp4"],
        2,
        &["unsupported extension; expected .png, .exr or .npz"],
    );
}

#[test]
fn a_camera_path_through_the_disk_or_hole_is_refused_before_the_first_frame() {
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
        refused(here, &["render", "bad.toml", "-o", PATTERN], 2, &words);
        assert!(!here.join("out").exists());
    }
}

/// Guards against frames that are all equal because a key has no effect.
#[test]
fn a_position_without_effect_and_an_animation_in_which_nothing_moves_are_told_of() {
    let folder = with_animation(3);
    let here = folder.path();
    let toml = fs::read_to_string(here.join("small.toml")).unwrap();
    let write = |text: &str| fs::write(here.join("bad.toml"), text).unwrap();
    let render = ["render", "bad.toml", "-o", PATTERN];
    write(&toml.replace("[camera]", "[camera]\nposition = [20, 0, 5]"));
    let words = ["camera.position means nothing beside animation.orbit"];
    refused(here, &render, 2, &words);
    assert!(!here.join("out").exists());

    let still = toml.replace("[0.0, 360.0]", "0.0");
    write(&still);
    let (_, stderr) = done(here, &render);
    assert!(
        stderr.contains("nothing moves in this animation: its 3 frames"),
        "{stderr}"
    );
    let frames = files(&here.join("out"));
    assert_eq!(frames.len(), 3);
    let key =
        |frame: u32, fov: u32| format!("\n[[animation.keyframe]]\nframe = {frame}\nfov = {fov}\n");
    write(&format!("{still}{}{}", key(1, 30), key(3, 31)));
    assert!(!done(here, &render).1.contains("nothing moves"));

    let orbit = toml.lines().find(|line| line.starts_with("orbit")).unwrap();
    let positions = "[[animation.keyframe]]\nframe = 1\nposition = [30, 0, 5]\n\
                     [[animation.keyframe]]\nframe = 3\nposition = [20, 0, 5]\n";
    let positions = toml.replace(orbit, positions);
    write(&positions);
    assert!(!done(here, &render).1.contains("camera.position"));
    write(&positions.replace("[camera]", "[camera]\nposition = [9, 9, 9]"));
    let (_, stderr) = done(here, &render);
    assert!(stderr.contains("camera.position has no effect"), "{stderr}");
}

#[test]
fn a_worker_makes_no_table_unless_asked_to() {
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
fn frames_are_numbered_from_where_the_animation_says() {
    let folder = with_animation(8);
    let here = folder.path();
    let toml = fs::read_to_string(here.join("small.toml")).unwrap();
    for (first, names) in [
        (1001, ["f_1001.png", "f_1004.png", "f_1008.png"]),
        (-4, ["f_-004.png", "f_-001.png", "f_0003.png"]),
    ] {
        let shifted = toml.replace("frames = 8", &format!("frames = 8\nfirst = {first}"));
        fs::write(here.join("shifted.toml"), shifted).unwrap();
        let render = ["render", "shifted.toml", "-o", PATTERN];
        let some = format!("{}-{}", first, first + 3);
        let (_, stderr) = done(here, &[&render[..], &["--frames", &some]].concat());
        assert!(stderr.contains("4 frames"), "{stderr}");
        // The same command draws the rest.
        let (_, stderr) = done(here, &render);
        assert!(stderr.contains("4 were finished before"), "{stderr}");
        let all = files(&here.join("out"));
        assert_eq!(all.len(), 8);
        assert!(
            names.iter().all(|name| all.contains_key(*name)),
            "{:?}",
            all.keys()
        );
        let listed = printed(here, &[&render[..], &["--dry-run"]].concat());
        assert!(
            listed.starts_with(&format!("{first}\tfinished\tout/{}\n", names[0])),
            "{listed}"
        );
        // They show what the frames show that are numbered from 1.
        done(here, &["render", "small.toml", "-o", "one/f_####.png"]);
        let pixels = |path: &str| image::open(here.join(path)).unwrap().into_luma8();
        assert!(pixels(&format!("out/{}", names[0])) == pixels("one/f_0001.png"));
        assert!(pixels(&format!("out/{}", names[2])) == pixels("one/f_0008.png"));
        let wrong = format!("{}", first - 1);
        let words = [&*wrong, "the frames are", &first.to_string()];
        refused(
            here,
            &[&render[..], &["--frames", &wrong]].concat(),
            2,
            &words,
        );

        fs::remove_dir_all(here.join("out")).unwrap();
        let job = printed(
            here,
            &[
                "job",
                "slurm",
                "shifted.toml",
                "--chunk",
                "5",
                "-o",
                PATTERN,
            ],
        );
        let program = Path::new(env!("CARGO_BIN_EXE_darkness")).parent().unwrap();
        for task in ["0", "1"] {
            let path = format!("{}:/usr/bin:/bin", program.display());
            let mut command = Command::new("bash");
            let command = command
                .args(["-c", &job])
                .env("PATH", path)
                .current_dir(here);
            let output = command.env("SLURM_ARRAY_TASK_ID", task).output().unwrap();
            assert!(output.status.success(), "{output:?}");
        }
        assert!(files(&here.join("out")) == all);
        let job = printed(here, &["job", "openjd", "shifted.toml"]);
        assert!(
            job.contains(&format!("default: \"{first}-{}\"", first + 7)),
            "{job}"
        );
        fs::remove_dir_all(here.join("out")).unwrap();
    }
}
