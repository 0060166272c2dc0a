//! Guards against files of a sky that are missing, damaged, endless or not what they claim: the program must exit with
//! one sentence that names the file, within little memory, and leave nothing.
#![cfg(unix)]

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output};

use exr::prelude::write_rgb_file;
use image::{ImageFormat, RgbImage};
use tempfile::{TempDir, tempdir};

use crate::harness::{PROGRAM, done, fails, files, listing};

/// A scene of four frames before what `sky` names.
fn scene(sky: &str) -> String {
    format!(
        "[camera]\nfov = 50\n[sky]\n{sky}\n[image]\nwidth = 64\nheight = 36\n\
         [animation]\nframes = 4\norbit = {{ radius = 20.0, inclination = 75.0, azimuth = [0.0, 360.0] }}\n"
    )
}

/// A folder with a scene before a panorama, one before a catalogue, and a table.
fn prepared() -> TempDir {
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("p.toml"), scene("panorama = \"sky.png\"")).unwrap();
    fs::write(here.join("s.toml"), scene("stars = \"stars.csv\"")).unwrap();
    done(here, &["table", "standard"]);
    folder
}

/// Runs the program with at most 1 GB of address space, and for at most a minute.
fn limited(here: &Path, line: &str) -> Output {
    limited_to(1_000_000, here, line)
}

/// Runs the program with at most so many KiB of address space.
fn limited_to(kibibytes: u32, here: &Path, line: &str) -> Output {
    let line = format!("ulimit -v {kibibytes}; exec timeout 60 '{PROGRAM}' {line}");
    let mut command = Command::new("sh");
    command
        .current_dir(here)
        .env_remove("DARKNESS_TABLE")
        .env("DARKNESS_CACHE", "tables");
    command.args(["-c", &line]).output().unwrap()
}

/// Asserts that frames and films of a scene are refused in one sentence with these words, and that nothing is left.
fn is_refused(here: &Path, scene: &str, options: &str, code: i32, words: &[&str]) {
    let before = listing(here);
    for output in ["out/f_#.png", "a.raw"] {
        let output = limited(here, &format!("render {scene} -o {output} {options}"));
        fails(&output, code, words);
        let sentence = String::from_utf8(output.stderr).unwrap();
        assert_eq!(sentence.lines().count(), 1, "{sentence}");
        assert!(sentence.len() < 500, "{sentence}");
        assert_eq!(listing(here), before);
    }
}

/// The files of panoramas of 64 × 32 pixels: PNG, JPEG, `OpenEXR` and Radiance HDR.
fn pictures(here: &Path) -> [Vec<u8>; 4] {
    let path = here.join("whole");
    let noise = |x: u32, y: u32| {
        let value = x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503);
        image::Rgb([value as u8, (value >> 8) as u8, (value >> 16) as u8])
    };
    let picture = RgbImage::from_fn(64, 32, noise);
    let encoded = [ImageFormat::Png, ImageFormat::Jpeg].map(|format| {
        picture.save_with_format(&path, format).unwrap();
        fs::read(&path).unwrap()
    });
    write_rgb_file(&path, 64, 32, |x, y| (x as f32, y as f32, 0.5)).unwrap();
    let exr = fs::read(&path).unwrap();
    let linear = image::DynamicImage::from(picture).to_rgb32f();
    linear.save_with_format(&path, ImageFormat::Hdr).unwrap();
    let hdr = fs::read(&path).unwrap();
    fs::remove_file(path).unwrap();
    let [png, jpeg] = encoded;
    [png, jpeg, exr, hdr]
}

/// A chunk of a PNG file.
#[expect(clippy::big_endian_bytes, reason = "PNG is big-endian")]
fn chunk(name: &[u8], content: &[u8]) -> Vec<u8> {
    let named = [name, content].concat();
    let mut crc = flate2::Crc::new();
    crc.update(&named);
    let (length, sum) = (content.len() as u32, crc.sum());
    [&length.to_be_bytes(), &named[..], &sum.to_be_bytes()].concat()
}

/// A PNG file's header that claims so many pixels, and nothing after it.
#[expect(clippy::big_endian_bytes, reason = "PNG is big-endian")]
fn claim(width: u32, height: u32) -> Vec<u8> {
    let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
    let header = chunk(b"IHDR", &[&size[..], &[8, 2, 0, 0, 0]].concat());
    let mut bytes = [b"\x89PNG\r\n\x1A\n", &header[..]].concat();
    // A chunk of pixels begins, and the file ends.
    bytes.extend(b"\0\0\x10\0IDAT");
    bytes
}

#[test]
fn a_panorama_that_is_none_is_refused() {
    let folder = prepared();
    let here = folder.path();
    let path = here.join("sky.png");
    let refused = |words: &[&str]| {
        is_refused(
            here,
            "p.toml",
            "",
            1,
            &[&["panorama sky.png: "], words].concat(),
        );
    };
    let words = ["panorama sky.png: ", "cannot be read", "No such file"];
    is_refused(here, "p.toml", "", 2, &words);
    fs::create_dir(&path).unwrap();
    refused(&["not a regular file"]);
    fs::remove_dir(&path).unwrap();
    let made = Command::new("mkfifo").arg(&path).status().unwrap();
    assert!(made.success());
    refused(&["not a regular file"]);
    fs::remove_file(&path).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
    refused(&["not a regular file"]);
    fs::remove_file(&path).unwrap();

    let not_a_picture = &["not a PNG, JPEG, Radiance HDR or OpenEXR picture"];
    for content in [
        &b""[..],
        b"ra,dec,magnitude\n1,2,3\n",
        &[0; 5000],
        b"BM\0\0",
    ] {
        fs::write(&path, content).unwrap();
        refused(not_a_picture);
    }
    let cut = &["the file ends early: copy it again"];
    for picture in pictures(here) {
        for length in [picture.len() / 20, picture.len() / 2, picture.len() - 20] {
            fs::write(&path, &picture[..length]).unwrap();
            refused(cut);
        }
    }
    let too_large =
        ["2000000000 × 1000000000 pixels, and at most 16384 × 8192 are read: make it smaller"];
    for (width, height, words) in [
        (
            30_000,
            33_333,
            &["30000 × 33333 pixels", "2:1", "equirectangular"][..],
        ),
        (60_000, 30_000, &["60000 × 30000 pixels", "16384 × 8192"]),
        (2_000_000_000, 1_000_000_000, &too_large),
        (
            4_000_000_000,
            4_000_000_000,
            &["4000000000 × 4000000000 pixels", "2:1"],
        ),
        (2048, 1024, cut),
    ] {
        fs::write(&path, claim(width, height)).unwrap();
        refused(words);
    }
    fs::write(
        &path,
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000000 +X 2000000000\n",
    )
    .unwrap();
    refused(&too_large);
    let [png, _, mut exr, _] = pictures(here);
    let window = [0, 0, 1_999_999_999, 999_999_999_i32];
    let window: Vec<u8> = window.into_iter().flat_map(i32::to_le_bytes).collect();
    let mark = b"displayWindow\0box2i\0\x10\0\0\0";
    let at = exr.windows(mark.len()).position(|bytes| bytes == mark);
    exr[at.unwrap() + mark.len()..][..16].copy_from_slice(&window);
    fs::write(&path, exr).unwrap();
    refused(&too_large);
    // Whole, but a byte of its pixels is another one.
    let mut damaged = png.clone();
    damaged[png.len() / 2] ^= 1;
    fs::write(&path, damaged).unwrap();
    refused(&[
        "damaged or of an unsupported kind: save it again as PNG, JPEG, Radiance HDR or OpenEXR (",
    ]);
    RgbImage::new(64, 33).save(&path).unwrap();
    refused(&["64 × 33 pixels", "twice as wide as high"]);
}

/// A colour profile of a kilobyte or two may claim to hold a gigabyte. It is ignored, and takes no memory.
#[test]
fn a_panoramas_colour_profile_takes_no_memory() {
    let folder = prepared();
    let here = folder.path();
    // Zeros in blocks that do not refer to the ones before.
    let (zeros, mut block) = (vec![0; 1 << 20], Vec::with_capacity(1 << 16));
    let mut compress = flate2::Compress::new(flate2::Compression::best(), false);
    let flush = flate2::FlushCompress::Full;
    compress.compress_vec(&zeros, &mut block, flush).unwrap();
    let profile = [b"x\0\0\x78\x9C", &block.repeat(1024)[..]].concat();
    let [png, ..] = pictures(here);
    let (head, rest) = png.split_at(8 + 25);
    let bomb = [head, &chunk(b"iCCP", &profile), rest].concat();
    fs::write(here.join("sky.png"), bomb).unwrap();
    let output = limited(here, "render p.toml -o a.raw");
    assert!(output.status.success(), "{output:?}");
    let bombed = fs::read(here.join("a.raw")).unwrap();
    fs::write(here.join("sky.png"), png).unwrap();
    done(here, &["render", "p.toml", "-o", "b.raw"]);
    assert!(fs::read(here.join("b.raw")).unwrap() == bombed);
}

#[test]
fn a_catalogue_that_is_none_is_refused() {
    let folder = prepared();
    let here = folder.path();
    let path = here.join("stars.csv");
    let refused = |words: &[&str]| {
        is_refused(
            here,
            "s.toml",
            "",
            1,
            &[&["star catalogue stars.csv: "], words].concat(),
        );
    };
    let words = [
        "star catalogue stars.csv: ",
        "cannot be read",
        "No such file",
    ];
    is_refused(here, "s.toml", "", 2, &words);
    fs::create_dir(&path).unwrap();
    refused(&["not a regular file"]);
    fs::remove_dir(&path).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
    refused(&["not a regular file"]);
    fs::remove_file(&path).unwrap();
    let long = ",".repeat(100_000);
    for (content, words) in [
        (&b""[..], &["the file is empty"][..]),
        (b"# only this\n", &["the file is empty"]),
        (
            b"ra,dec\n1,2\n",
            &["line 1, the header, has no column magnitude"],
        ),
        (b"ra,dec,magnitude,mag,bv\n", &["twice"]),
        (b"ra,dec,magnitude,bv\n", &["no row is a star"]),
        (
            b"ra,dec,magnitude,bv\nx,1,2,0\n",
            &["no row is a star", "line 2"],
        ),
        (b"\x89PNG\r\n\x1A\n\xFF\xFE", &["the header"]),
        (long.as_bytes(), &["line 1 is longer than 65536 bytes"]),
    ] {
        fs::write(&path, content).unwrap();
        refused(words);
    }
    // A gigabyte in one line.
    let file = fs::File::create(&path).unwrap();
    file.set_len(1 << 30).unwrap();
    refused(&["line 1 is longer than 65536 bytes"]);
}

/// Rows that are no stars are told of once, whatever the number of frames, and do not stop the run.
#[test]
fn bad_rows_of_a_catalogue_are_told_of_once() {
    let folder = prepared();
    let here = folder.path();
    let mut file = fs::File::create(here.join("stars.csv")).unwrap();
    writeln!(file, "ra,dec,magnitude,temperature").unwrap();
    for row in 0..40 {
        let declination = if row % 4 == 0 { 20 } else { 91 };
        writeln!(file, "{row},{declination},3,5800").unwrap();
    }
    let (_, told) = done(here, &["render", "s.toml", "-o", "out/f_#.png"]);
    assert_eq!(told.matches("star catalogue").count(), 1, "{told}");
    let words =
        "darkness: star catalogue stars.csv: 30 rows are no stars and are left out\n  line 3: ";
    assert!(told.contains(words), "{told}");
    assert!(
        told.contains("\n  line 8: ") && told.contains("\n  and 25 more\n"),
        "{told}"
    );
    assert!(!told.contains("\n  line 9: "));
    assert_eq!(files(&here.join("out")).len(), 4);
    // Quiet runs tell of what is wrong too. Runs that read no catalogue do not.
    fs::remove_file(here.join("out/f_2.png")).unwrap();
    let (_, told) = done(here, &["render", "s.toml", "-q", "-o", "out/f_#.png"]);
    assert!(told.starts_with("darkness: star catalogue"), "{told}");
    let (_, told) = done(here, &["render", "s.toml", "-o", "out/f_#.png"]);
    assert!(!told.contains("star catalogue"), "{told}");
    // One row.
    fs::write(
        here.join("stars.csv"),
        "ra,dec,mag,bv\n1,2,3,0\n\x1B[2J,2,3,0\n",
    )
    .unwrap();
    let (_, told) = done(here, &["render", "s.toml", "-q", "-o", "a.raw"]);
    assert!(
        told.contains("1 row is no star and is left out\n  line 3: "),
        "{told}"
    );
    assert!(!told.contains('\x1B'), "{told:?}");
}

/// The sky and the frames share `--max-memory`.
#[test]
fn a_sky_that_needs_more_memory_than_is_allowed_is_refused() {
    let folder = prepared();
    let here = folder.path();
    RgbImage::new(1024, 512).save(here.join("sky.png")).unwrap();
    // 64 × 36 pixels of colour, and as much for the file.
    let frame = 2 * 3 * 64 * 36;
    let panorama = darkness::sky::Panorama::open(&here.join("sky.png"), 0.0, 1 << 30).unwrap();
    let needed = panorama.bytes() + frame;
    let limit = |bytes: u64| format!("--max-memory {bytes}B");
    let words = [
        "panorama sky.png",
        "MiB of memory",
        "a frame 13.5 KiB",
        "allow more with --max-memory",
    ];
    is_refused(here, "p.toml", &limit(needed - 1), 2, &words);
    let args = |bytes| format!("render p.toml -o a.raw {}", limit(bytes));
    done(here, &args(needed).split(' ').collect::<Vec<_>>());

    let rows = "1,2,3,0\n".repeat(10_000);
    fs::write(here.join("stars.csv"), format!("ra,dec,mag,bv\n{rows}")).unwrap();
    let words = ["star catalogue stars.csv", "of memory", "--max-memory"];
    is_refused(here, "s.toml", "--max-memory 300kB", 2, &words);
    done(
        here,
        &["render", "s.toml", "-o", "b.raw", "--max-memory", "2MB"],
    );
    fs::write(
        here.join("r.toml"),
        scene("stars = { count = 100000, seed = 1 }"),
    )
    .unwrap();
    let words = ["100000 stars take", "of memory", "--max-memory"];
    is_refused(here, "r.toml", "--max-memory 1MB", 2, &words);
}

/// A panorama for which the system has no memory is refused too.
#[test]
#[cfg(target_os = "linux")]
fn a_panorama_that_the_system_has_no_memory_for_is_refused() {
    let folder = prepared();
    let here = folder.path();
    RgbImage::new(8192, 4096)
        .save(here.join("sky.png"))
        .unwrap();
    for kibibytes in (200_000..=500_000).step_by(50_000) {
        let output = limited_to(kibibytes, here, "render p.toml -o a.raw --threads 2");
        fails(&output, 1, &["panorama sky.png", "out of memory"]);
    }
}
