//! Files of panoramas: what each format gives, and a sentence for each file that is none.

use std::fs;
use std::path::{Path, PathBuf};

use darkness::light::srgb;
use darkness::sky::{Panorama, PanoramaProblem, SkyError};
use exr::prelude::{Image as ExrImage, SpecificChannels, Vec2, WritableImage, f16};
use image::codecs::hdr::HdrEncoder;
use image::{
    DynamicImage, GrayAlphaImage, ImageBuffer, ImageFormat, Luma, Rgb, RgbImage, Rgba, RgbaImage,
};

const PLENTY: u64 = 1 << 30;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Opens a panorama, and returns what it has at a texel of its first size.
fn texel(path: &Path, exposure: f64, column: usize, row: usize) -> [f32; 3] {
    let panorama = Panorama::open(path, exposure, PLENTY).expect("a panorama");
    let u = (column as f32 + 0.5) / panorama.width() as f32;
    let v = 1.0 - (row as f32 + 0.5) / panorama.height() as f32;
    panorama.mean([u, v], [0.0; 2], [0.0; 2])
}

fn problem(path: &Path, max_bytes: u64) -> (PanoramaProblem, String) {
    let error = Panorama::open(path, 0.0, max_bytes).map(|_| ());
    let error = error.expect_err("no panorama");
    let sentence = error.to_string();
    let SkyError::Panorama { problem, .. } = error else {
        panic!("{error}");
    };
    assert!(
        sentence.starts_with(&format!("panorama {}: ", path.display())),
        "{sentence}"
    );
    assert!(
        !sentence.contains('\n') && sentence.len() < path.as_os_str().len() + 300,
        "{sentence}"
    );
    (problem, sentence)
}

fn near(found: [f32; 3], expected: [f64; 3], tolerance: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!(
            (f64::from(found) - expected).abs() <= tolerance * expected.max(1e-3),
            "{found} {expected}"
        );
    }
}

fn save(image: &DynamicImage, path: &Path, format: ImageFormat) {
    image.save_with_format(path, format).expect("saved");
}

#[test]
fn png_of_8_bits_is_srgb() {
    let folder = folder();
    // The name's ending tells nothing.
    let path = folder.path().join("sky.jpg");
    let image = RgbaImage::from_fn(8, 4, |x, y| Rgba([(30 * x) as u8, (60 * y) as u8, 200, 17]));
    save(&image.into(), &path, ImageFormat::Png);
    let expected = [90, 120, 200].map(|code| srgb::decode(f64::from(code) / 255.0));
    near(texel(&path, 0.0, 3, 2), expected, 1e-6);
    near(texel(&path, 2.0, 3, 2), expected.map(|x| 4.0 * x), 1e-6);
}

#[test]
fn png_of_16_bits_is_srgb_too() {
    let folder = folder();
    let path = folder.path().join("sky.png");
    let image = ImageBuffer::from_fn(8, 4, |x, y| {
        Rgb([(7000 * x) as u16, (20_000 * y) as u16, 65535])
    });
    save(&DynamicImage::ImageRgb16(image), &path, ImageFormat::Png);
    let expected = [21_000, 40_000, 65_535].map(|code| srgb::decode(f64::from(code) / 65535.0));
    near(texel(&path, 0.0, 3, 2), expected, 1e-6);
}

#[test]
fn grey_is_white_light() {
    let folder = folder();
    let path = folder.path().join("sky.png");
    let expected = [srgb::decode(40.0 / 255.0); 3];
    let alpha = GrayAlphaImage::from_pixel(4, 2, image::LumaA([40, 3]));
    save(&alpha.into(), &path, ImageFormat::Png);
    near(texel(&path, 0.0, 1, 1), expected, 1e-6);
    let wide = ImageBuffer::from_pixel(4, 2, Luma([40_u16 * 257]));
    save(&DynamicImage::ImageLuma16(wide), &path, ImageFormat::Png);
    near(texel(&path, 0.0, 1, 1), expected, 1e-6);
}

#[test]
fn jpeg_is_srgb() {
    let folder = folder();
    let path = folder.path().join("sky");
    save(
        &RgbImage::from_pixel(32, 16, Rgb([200, 120, 40])).into(),
        &path,
        ImageFormat::Jpeg,
    );
    let expected = [200, 120, 40].map(|code| srgb::decode(f64::from(code) / 255.0));
    // A code or two, by the format's loss.
    near(texel(&path, 0.0, 20, 5), expected, 0.06);
}

#[test]
fn radiance_is_linear() {
    let folder = folder();
    let path = folder.path().join("sky.hdr");
    let pixels: Vec<Rgb<f32>> = (0..8_u8)
        .map(|i| Rgb([10.0 * f32::from(i), 0.5, 100.0]))
        .collect();
    let file = fs::File::create(&path).expect("created");
    HdrEncoder::new(file)
        .encode(&pixels, 4, 2)
        .expect("encoded");
    let [red, green, blue] = texel(&path, -1.0, 2, 1);
    // The three share an exponent: they are multiples of a 256th of 128.
    assert!(
        (red - 30.0).abs() <= 0.25 && (green - 0.25).abs() <= 0.25 && (blue - 50.0).abs() <= 0.25
    );
}

/// Writes an `OpenEXR` file of 4 × 2 pixels, with half floats where `half`, with alpha where `alpha`.
fn write_exr(path: &Path, half: bool, alpha: bool) {
    let value = |place: Vec2<usize>| match (place.x(), place.y()) {
        (0, 0) => (f32::NAN, f32::NEG_INFINITY, -3.0),
        (1, 0) => (f32::INFINITY, 0.0, -0.0),
        (x, y) => (x as f32, 0.25, 100.0 * y as f32),
    };
    let to_half = move |place| {
        let (r, g, b) = value(place);
        (f16::from_f32(r), f16::from_f32(g), f16::from_f32(b))
    };
    let with_alpha = move |place| {
        let (r, g, b) = value(place);
        (r, g, b, 0.5_f32)
    };
    let size = (4, 2);
    match (half, alpha) {
        (true, _) => ExrImage::from_channels(size, SpecificChannels::rgb(to_half))
            .write()
            .to_file(path),
        (_, true) => ExrImage::from_channels(size, SpecificChannels::rgba(with_alpha))
            .write()
            .to_file(path),
        _ => ExrImage::from_channels(size, SpecificChannels::rgb(value))
            .write()
            .to_file(path),
    }
    .expect("written");
}

#[test]
fn exr_is_linear() {
    let folder = folder();
    let path = folder.path().join("sky.exr");
    for (half, alpha) in [(true, false), (false, false), (false, true)] {
        write_exr(&path, half, alpha);
        assert_eq!(texel(&path, 0.0, 3, 1), [3.0, 0.25, 100.0]);
        assert_eq!(texel(&path, 1.0, 2, 1), [4.0, 0.5, 200.0]);
        // No light is negative, and none is without end.
        assert_eq!(texel(&path, 0.0, 0, 0), [0.0; 3]);
        assert_eq!(texel(&path, 0.0, 1, 0), [1e30, 0.0, 0.0]);
    }
}

#[test]
fn what_is_no_picture_is_refused() {
    let folder = folder();
    let named = |name: &str, bytes: &[u8]| -> PathBuf {
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("written");
        path
    };
    for path in [
        named("empty.png", b""),
        named(
            "text.png",
            b"no picture at all, and longer than any format's signature",
        ),
        named(
            "other.png",
            b"GIF89a and what follows, of a format that is known but not read",
        ),
    ] {
        assert!(matches!(
            problem(&path, PLENTY).0,
            PanoramaProblem::UnknownFormat
        ));
    }
    assert!(matches!(
        problem(&folder.path().join("none"), PLENTY).0,
        PanoramaProblem::Unreadable(_)
    ));
    assert!(matches!(
        problem(folder.path(), PLENTY).0,
        PanoramaProblem::NotAFile
    ));
    if Path::new("/dev/zero").exists() {
        assert!(matches!(
            problem(Path::new("/dev/zero"), PLENTY).0,
            PanoramaProblem::NotAFile
        ));
    }
}

#[test]
fn a_wrong_shape_is_refused() {
    let folder = folder();
    let path = folder.path().join("sky.png");
    save(&RgbImage::new(6, 4).into(), &path, ImageFormat::Png);
    let (problem, sentence) = problem(&path, PLENTY);
    assert!(matches!(
        problem,
        PanoramaProblem::Shape {
            width: 6,
            height: 4
        }
    ));
    assert!(
        sentence.contains("6 × 4") && sentence.contains("twice as wide as high"),
        "{sentence}"
    );
}

/// Each format's bytes, of 64 × 32 pixels.
fn each_format(folder: &Path) -> Vec<Vec<u8>> {
    let path = folder.join("picture");
    let picture = DynamicImage::from(RgbImage::from_fn(64, 32, |x, y| {
        Rgb([(3 * x) as u8, (5 * y) as u8, 90])
    }));
    let mut files = Vec::new();
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        save(&picture, &path, format);
        files.push(fs::read(&path).expect("read"));
    }
    save(&picture.to_rgb32f().into(), &path, ImageFormat::Hdr);
    files.push(fs::read(&path).expect("read"));
    let colour = |place: Vec2<usize>| (place.x() as f32, place.y() as f32, 1.0_f32);
    ExrImage::from_channels((64, 32), SpecificChannels::rgb(colour))
        .write()
        .to_file(&path)
        .expect("written");
    files.push(fs::read(&path).expect("read"));
    files
}

#[test]
fn a_truncated_file_is_refused() {
    let folder = folder();
    let path = folder.path().join("sky");
    for bytes in each_format(folder.path()) {
        fs::write(&path, &bytes).expect("written");
        Panorama::open(&path, 0.0, PLENTY).expect("whole");
        for share in [0.02, 0.3, 0.6, 0.9] {
            let length = (bytes.len() as f64 * share) as usize;
            fs::write(&path, &bytes[..length]).expect("written");
            let (cut, sentence) = problem(&path, PLENTY);
            println!("{length} of {} bytes: {sentence}", bytes.len());
            // Of less than a format's signature nothing else is known.
            let is_told = matches!(cut, PanoramaProblem::Truncated) || length < 16;
            assert!(is_told, "{sentence}");
        }
    }
}

#[test]
fn damaged_files_never_panic() {
    let folder = folder();
    let path = folder.path().join("sky");
    let mut random = crate::noise::Random(8);
    for bytes in each_format(folder.path()) {
        for _ in 0..150 {
            let mut bytes = bytes.clone();
            // Mostly in the header.
            let end = if random.number() < 0.7 {
                bytes.len().min(400)
            } else {
                bytes.len()
            };
            for _ in 0..3 {
                bytes[(random.number() * end as f64) as usize] = (random.number() * 256.0) as u8;
            }
            fs::write(&path, bytes).expect("written");
            if Panorama::open(&path, 0.0, 1 << 26).is_err() {
                problem(&path, 1 << 26);
            }
        }
    }
}

/// A PNG's first bytes, with a size and the checksum that goes with it; numbers are big-endian.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(width.to_le_bytes().iter().rev());
    chunk.extend(height.to_le_bytes().iter().rev());
    chunk.extend([8, 2, 0, 0, 0]);
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend(&chunk);
    bytes.extend(crc32fast::hash(&chunk).to_le_bytes().iter().rev());
    bytes.extend(b"\0\0\0\x10IDAT");
    bytes.extend([0; 64]);
    bytes
}

#[test]
fn a_claimed_size_takes_no_memory() {
    let folder = folder();
    let path = folder.path().join("sky.png");
    fs::write(&path, png_header(44_720, 22_360)).expect("written");
    let (large, sentence) = problem(&path, PLENTY);
    assert!(
        matches!(
            large,
            PanoramaProblem::TooLarge {
                width: 44_720,
                height: 22_360
            }
        ),
        "{sentence}"
    );
    assert!(
        sentence.contains("44720 × 22360") && sentence.contains("16384 × 8192"),
        "{sentence}"
    );

    fs::write(&path, png_header(16_384, 8192)).expect("written");
    let (memory, sentence) = problem(&path, PLENTY);
    assert!(
        matches!(memory, PanoramaProblem::Memory { .. }),
        "{sentence}"
    );
    assert!(
        sentence.contains("2148 MB")
            && sentence.contains("1073 MB")
            && sentence.contains("--max-memory")
    );

    // The same of Radiance, whose lines could also go on without end.
    let path = folder.path().join("sky.hdr");
    fs::write(
        &path,
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 22360 +X 44720\n",
    )
    .expect("written");
    assert!(matches!(
        problem(&path, PLENTY).0,
        PanoramaProblem::TooLarge { .. }
    ));
    let file = fs::File::create(&path).expect("created");
    std::io::Write::write_all(&mut &file, b"#?RADIANCE\n").expect("written");
    file.set_len(1 << 40).expect("a sparse file");
    assert!(matches!(
        problem(&path, PLENTY).0,
        PanoramaProblem::Undecodable(_)
    ));

    // A JPEG claims at most 65535 pixels a side.
    let mut jpeg = each_format(folder.path()).swap_remove(1);
    let frame = jpeg
        .windows(5)
        .position(|bytes| bytes == b"\xFF\xC0\0\x11\x08");
    let size = [0x75, 0x30, 0xEA, 0x60];
    jpeg[frame.expect("a frame's header") + 5..][..4].copy_from_slice(&size);
    fs::write(&path, jpeg).expect("written");
    let large = problem(&path, PLENTY).0;
    assert!(
        matches!(
            large,
            PanoramaProblem::TooLarge {
                width: 60_000,
                height: 30_000
            }
        ),
        "{large}"
    );

    // Too little memory even for a decoder is told as too little memory.
    let path = folder.path().join("sky.png");
    save(&RgbImage::new(64, 32).into(), &path, ImageFormat::Png);
    let memory = problem(&path, 100).0;
    assert!(
        matches!(memory, PanoramaProblem::Memory { allowed: 100, .. }),
        "{memory}"
    );
    let path = folder.path().join("sky.hdr");

    // A JPEG is held as a whole.
    let file = fs::File::create(&path).expect("created");
    std::io::Write::write_all(&mut &file, b"\xff\xd8\xff\xe0").expect("written");
    file.set_len(1 << 40).expect("a sparse file");
    assert!(matches!(
        problem(&path, PLENTY).0,
        PanoramaProblem::Memory { .. }
    ));
}

#[test]
fn sizes() {
    let folder = folder();
    let path = folder.path().join("sky.png");
    save(&RgbImage::new(20, 10).into(), &path, ImageFormat::Png);
    let panorama = Panorama::open(&path, 0.0, PLENTY).expect("a panorama");
    assert_eq!((panorama.width(), panorama.height()), (20, 10));
    // 10, 5, 2, 1.
    assert_eq!(panorama.levels(), 4);
    assert_eq!(panorama.bytes(), 4 * (6 * (100 + 25 + 4 + 1) + 4));
}
