//! Guards against outputs that replace what is not the program's own, and against links and modes that are lost.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;

use tempfile::tempdir;

use crate::harness::{done, files, listing, printed, refused, with_animation, with_draft};

/// The mode of a file.
fn mode(path: &Path) -> u32 {
    fs::metadata(path).unwrap().permissions().mode() & 0o7777
}

/// Writes a file that nobody may write.
fn write_read_only(path: &Path) {
    fs::write(path, "kept").unwrap();
    fs::set_permissions(path, Permissions::from_mode(0o444)).unwrap();
}

#[test]
fn a_file_that_another_program_made_is_not_replaced_by_a_frame() {
    let folder = with_animation(9);
    let here = folder.path();
    for (extension, other) in [("png", "exr"), ("exr", "npz"), ("npz", "png")] {
        let pattern = format!("{extension}/f_#.{extension}");
        let render = ["render", "small.toml", "-o", &pattern];
        done(here, &render);
        let out = here.join(extension);
        let first = files(&out);
        let file = |number: u32| out.join(format!("f_{number}.{extension}"));

        // Another format's file, a text, an empty file, a head with another program's name, and one without its start.
        let foreign = format!("{extension}/other_#.{other}");
        done(
            here,
            &["render", "small.toml", "--frames", "2", "-o", &foreign],
        );
        fs::rename(out.join(format!("other_2.{other}")), file(2)).unwrap();
        fs::write(file(3), "a diary").unwrap();
        fs::write(file(4), "").unwrap();
        let name = format!("f_5.{extension}");
        let mut renamed = first[&name].clone();
        renamed[1] ^= 1;
        fs::write(file(5), renamed).unwrap();
        fs::remove_file(file(6)).unwrap();
        let before = files(&out);
        let refusal = format!("{extension}/f_2.{extension}, {extension}/f_3.{extension}, ");
        refused(
            here,
            &render,
            1,
            &[
                &refusal,
                "and 1 more: made by another program",
                "--overwrite",
            ],
        );
        assert!(files(&out) == before);
        let dry = printed(here, &[&render[..], &["--dry-run"]].concat());
        assert_eq!(dry.matches("\tin the way\t").count(), 4, "{dry}");
        assert_eq!(dry.matches("\tto draw\t").count(), 1, "{dry}");

        // Frames beside them are drawn, and with --overwrite all are.
        done(here, &[&render[..], &["--frames", "1,6-9"]].concat());
        assert!(files(&out)[&name] == before[&name]);
        done(here, &[&render[..], &["--overwrite"]].concat());
        assert!(files(&out) == first);
    }
}

#[test]
fn a_file_that_another_program_made_is_not_replaced_by_a_picture_that_was_given_no_name() {
    let folder = with_draft();
    let here = folder.path();
    let render = ["render", "--table", "a.table", "--size", "64x36"];
    fs::write(here.join("classic.png"), "a photograph").unwrap();
    refused(here, &render, 1, &["classic.png: made by another program"]);
    assert_eq!(fs::read(here.join("classic.png")).unwrap(), b"a photograph");
    done(here, &[&render[..], &["--overwrite"]].concat());
    let drawn = fs::read(here.join("classic.png")).unwrap();
    done(here, &render);
    fs::write(here.join("x.png"), "named by the user").unwrap();
    done(here, &[&render[..], &["-o", "x.png"]].concat());
    assert!(fs::read(here.join("x.png")).unwrap() == drawn);
}

#[test]
fn frames_that_a_shortened_animation_no_longer_has_are_told_of_and_kept() {
    let folder = with_animation(12);
    let here = folder.path();
    let render = ["render", "small.toml", "-o", "out/f_##.png"];
    done(here, &render);
    fs::write(here.join("out/f_99.png"), "another's").unwrap();
    let scene = fs::read_to_string(here.join("small.toml")).unwrap();
    fs::write(
        here.join("small.toml"),
        scene.replace("frames = 12", "frames = 8"),
    )
    .unwrap();
    let (_, stderr) = done(here, &render);
    assert!(
        stderr.contains("out/f_09.png, out/f_10.png, out/f_11.png and 1 more: left from before")
            && stderr.contains("whose frames are 1-8"),
        "{stderr}"
    );
    assert_eq!(files(&here.join("out")).len(), 13);
    // The frames that a worker is not asked for are not left over.
    for number in 9..=12 {
        fs::remove_file(here.join(format!("out/f_{number:02}.png"))).unwrap();
    }
    let (_, stderr) = done(here, &[&render[..], &["--frames", "1-2"]].concat());
    assert!(!stderr.contains("left from"), "{stderr}");
}

#[test]
fn a_range_that_goes_beyond_the_animation_draws_the_frames_that_there_are() {
    let folder = with_animation(9);
    let here = folder.path();
    let render = ["render", "small.toml", "-o", "out/f_#.png", "--frames"];
    let (_, stderr) = done(here, &[&render[..], &["8-10,20"]].concat());
    assert!(
        stderr.contains("--frames 8-10,20") && stderr.contains("1-9"),
        "{stderr}"
    );
    assert_eq!(listing(&here.join("out")), ["f_8.png", "f_9.png"]);
    refused(
        here,
        &[&render[..], &["10-12"]].concat(),
        2,
        &["--frames 10-12", "1 to 9"],
    );
}

#[test]
fn a_link_that_leads_to_no_file_yet_is_followed() {
    let folder = with_animation(3);
    let here = folder.path();
    fs::create_dir(here.join("disk")).unwrap();
    for (link, args) in [
        ("p.png", &["render", "classic", "--size", "64x36"][..]),
        ("f.y4m", &["render", "small.toml"]),
        ("t.table", &["table", "draft"]),
    ] {
        let target = here.join("disk").join(link);
        symlink(&target, here.join(link)).unwrap();
        done(here, &[args, &["-o", link]].concat());
        assert!(here.join(link).is_symlink() && target.is_file(), "{link}");
    }
    symlink("disk/new", here.join("out")).unwrap();
    fs::create_dir(here.join("disk/frames")).unwrap();
    done(here, &["render", "small.toml", "-o", "out/f_#.png"]);
    assert!(here.join("out").is_symlink());
    assert_eq!(
        listing(&here.join("disk/new")),
        ["f_1.png", "f_2.png", "f_3.png"]
    );
    fs::rename(here.join("disk/new/f_2.png"), here.join("disk/2.png")).unwrap();
    symlink("../2.png", here.join("disk/new/f_2.png")).unwrap();
    fs::remove_file(here.join("disk/2.png")).unwrap();
    done(here, &["render", "small.toml", "-o", "out/f_#.png"]);
    assert!(here.join("out/f_2.png").is_symlink() && here.join("disk/2.png").is_file());

    symlink("nowhere/p.png", here.join("q.png")).unwrap();
    done(here, &["render", "-o", "q.png"]);
    assert!(here.join("nowhere/p.png").is_file());
    symlink("round.png", here.join("round.png")).unwrap();
    refused(
        here,
        &["render", "-o", "round.png"],
        1,
        &["round.png", "circle"],
    );
    assert!(here.join("q.png").is_symlink() && here.join("round.png").is_symlink());
}

#[test]
fn a_read_only_file_is_not_replaced_and_the_mode_of_another_is_kept() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (name, args) in [
        (
            "p.png",
            &["render", "classic", "--size", "64x36", "--overwrite"][..],
        ),
        (
            "f.y4m",
            &["render", "orbit", "--size", "64x36", "--frames", "1-2"],
        ),
        ("d.table", &["table", "draft", "--force"]),
    ] {
        let path = here.join(name);
        write_read_only(&path);
        let args = [args, &["-o", name]].concat();
        refused(here, &args, 1, &[name, "read-only"]);
        assert_eq!(fs::read(&path).unwrap(), b"kept");
        assert_eq!(mode(&path), 0o444);
        for kept in [0o600, 0o660] {
            fs::set_permissions(&path, Permissions::from_mode(kept)).unwrap();
            done(here, &args);
            assert_eq!(mode(&path), kept, "{name}");
        }
    }
    // A frame that may not be written stops no other.
    fs::create_dir(here.join("out")).unwrap();
    write_read_only(&here.join("out/f_1.png"));
    let frames = [
        "--size",
        "64x36",
        "--frames",
        "1-2",
        "-o",
        "out/f_#.png",
        "--overwrite",
    ];
    let render = [&["render", "orbit"], &frames[..]].concat();
    refused(here, &render, 1, &["1: out/f_1.png: ", "read-only"]);
    assert_eq!(fs::read(here.join("out/f_1.png")).unwrap(), b"kept");
    assert_eq!(listing(&here.join("out")), ["f_1.png", "f_2.png"]);
}
