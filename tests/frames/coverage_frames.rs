//! Guards against greys that depend on how the frame was drawn: on how many threads, into whose buffer, on which side
//! of a mirror.

use darkness::isoradial::Isoradials;
use darkness::render::{RenderError, coverage, mask};
use darkness::scene::{Scene, View, builtins};

use crate::shares::Picture;
use crate::tables::table;

fn picture(scene: &Scene) -> Picture {
    Picture::new(scene, &table("standard").lookup())
}

fn resized(name: &str, (width, height): (u32, u32)) -> Picture {
    picture(
        &Scene::builtin(name)
            .unwrap()
            .with_size(width, height)
            .unwrap(),
    )
}

fn smooth(picture: &Picture) -> Vec<u8> {
    coverage::render(&picture.view, &picture.curves).unwrap()
}

/// Guards against light where nothing is seen: through a wide lens all of the disk is half a pixel, seen from within
/// its plane.
#[test]
fn a_disk_within_one_pixel_lights_that_pixel_alone() {
    let text = "[camera]\nposition = [99.99999987854646, 0.0, -0.004928560257966286]\n\
                focus = [0.014648543438582351, 0.0, 1.7066550325120646]\nup = [0.0, 0.2, 1.0]\nfov = 160.0\n\
                [disk]\ninner = 3.0\nouter = 12.0\n[image]\nwidth = 33\nheight = 59\n";
    let frame = smooth(&picture(&Scene::from_toml(text).unwrap()));
    let lit: Vec<usize> = (0..frame.len()).filter(|&k| frame[k] > 0).collect();
    assert_eq!(
        lit,
        [29 * 33 + 16],
        "the pixel in the direction of the hole"
    );
}

/// How a frame is drawn into a caller's buffer.
type Into = fn(&View, &Isoradials, &mut [u8], usize) -> Result<(), RenderError>;

const BOTH: [(&str, Into); 2] = [
    ("smooth", coverage::render_into),
    ("hard", mask::render_into),
];

/// Guards against bytes between the rows that are written over, and against those of an earlier frame that stay.
#[test]
fn a_caller_s_buffer_keeps_what_is_between_the_rows_and_nothing_else() {
    const BEFORE: u8 = 77;
    for (name, render_into) in BOTH {
        for scene in ["classic", "inside", "photon-ring"] {
            for (width, height) in [(130, 67), (64, 64), (1, 131), (131, 1)] {
                let picture = resized(scene, (width, height));
                let (width, height) = (width as usize, height as usize);
                let mut tight = vec![BEFORE; width * height];
                render_into(&picture.view, &picture.curves, &mut tight, width).unwrap();
                let rendered = match name {
                    "smooth" => smooth(&picture),
                    _ => mask::render(&picture.view, &picture.curves).unwrap(),
                };
                assert!(tight == rendered, "{name}, {scene}, {width} × {height}");

                let stride = width + 13;
                // The last row needs no room after it; what is there all the same is left too.
                for after in [0, 5, 13, 200] {
                    let mut buffer = vec![BEFORE; stride * (height - 1) + width + after];
                    render_into(&picture.view, &picture.curves, &mut buffer, stride).unwrap();
                    for (k, &value) in buffer.iter().enumerate() {
                        let (row, column) = (k / stride, k % stride);
                        let expected = if row < height && column < width {
                            rendered[row * width + column]
                        } else {
                            BEFORE
                        };
                        assert_eq!(
                            value, expected,
                            "{name}, {scene}, {width} × {height}: row {row}, byte {column}"
                        );
                    }
                }
            }
        }
    }
}

/// Guards against a frame that is drawn past its buffer's end, or in part.
#[test]
fn a_buffer_that_is_too_small_is_refused_untouched() {
    let picture = resized("classic", (130, 67));
    for (name, render_into) in BOTH {
        for (bytes, stride) in [
            (130 * 67 - 1, 130),
            (140 * 66 + 129, 140),
            (130 * 67, 129),
            (130 * 67, 131),
            (1 << 20, 0),
            (0, 130),
            (1 << 20, usize::MAX),
            (1 << 20, usize::MAX / 66 + 1),
        ] {
            let mut buffer = vec![7; bytes];
            let error =
                render_into(&picture.view, &picture.curves, &mut buffer, stride).unwrap_err();
            let told = RenderError::Buffer {
                width: 130,
                height: 67,
                stride,
                bytes,
            };
            assert_eq!(error, told, "{name}");
            assert!(
                buffer.iter().all(|&value| value == 7),
                "{name}, {bytes} bytes, {stride} apart"
            );
        }
        for (bytes, stride) in [(130 * 67, 130), (140 * 66 + 130, 140)] {
            let mut buffer = vec![7; bytes];
            render_into(&picture.view, &picture.curves, &mut buffer, stride).unwrap();
        }
    }
}

/// Guards against greys that depend on which thread was first.
#[test]
fn one_thread_and_two_draw_the_same_bytes() {
    for builtin in builtins() {
        let picture = resized(builtin.name(), (321, 203));
        let frames = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                assert_eq!(rayon::current_num_threads(), threads);
                (
                    smooth(&picture),
                    mask::render(&picture.view, &picture.curves).unwrap(),
                )
            })
        });
        assert!(
            frames[0] == frames[1] && frames[0] == frames[2],
            "{}",
            builtin.name()
        );
    }
}

fn mirrored(frame: &[u8], width: usize) -> Vec<u8> {
    frame
        .chunks(width)
        .flat_map(|row| row.iter().rev())
        .copied()
        .collect()
}

fn flipped(frame: &[u8], width: usize) -> Vec<u8> {
    frame.chunks(width).rev().flatten().copied().collect()
}

fn upright(
    position: &str,
    focus: &str,
    fov: f64,
    outer: f64,
    (width, height): (u32, u32),
) -> Picture {
    let text = format!(
        "[camera]\nposition = {position}\nfocus = {focus}\nfov = {fov:?}\n[disk]\ninner = 3.0\nouter = {outer:?}\n\
         [image]\nwidth = {width}\nheight = {height}\n"
    );
    picture(&Scene::from_toml(&text).unwrap())
}

fn is_grey(frame: &[u8]) -> bool {
    frame.iter().any(|value| (1..255).contains(value))
}

/// The greys of frames that were compared with their mirror images.
#[derive(Default)]
struct Alike {
    unlike: usize,
    greys: usize,
}

impl Alike {
    /// Asserts that no value differs by more than one.
    fn compare(&mut self, frame: &[u8], other: &[u8], of: &str) {
        let most = frame.iter().zip(other).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most <= Some(1), "{of}: {most:?} greys");
        self.unlike += frame.iter().zip(other).filter(|(a, b)| a != b).count();
        self.greys += frame
            .iter()
            .filter(|value| (1..255).contains(*value))
            .count();
    }

    /// Asserts that fewer than one grey in so many differs.
    fn assert_most_are(&self, one_in: usize) {
        let Self { unlike, greys } = self;
        println!("{unlike} of {greys} greys are not alike");
        assert!(
            unlike * one_in < *greys,
            "{unlike} of {greys} greys are not alike"
        );
    }
}

/// Guards against a pixel's sides being treated unlike each other: left and right. The path's ends are rounded to a
/// grid of 2⁻¹⁴ pixels, which has no mirror image, so that a share may be rounded to the next grey.
#[test]
fn left_and_right_are_alike_to_one_grey() {
    let mut alike = Alike::default();
    for (position, focus, fov) in [
        ("[29.5442, 0, 5.2094]", "[0, 0, 0]", 30.0),
        ("[29.5442, 0, -0.02]", "[0, 0, 0]", 30.0),
        ("[1.2, 0, 0.5]", "[2.4, 0, 1]", 120.0),
        ("[2e6, 0, 1e6]", "[0, 0, 2.55]", 3e-5),
        ("[5.2, 0, 3]", "[0, 0, 0]", 100.0),
    ] {
        for outer in [12.0, 3.05] {
            for size in [(320, 180), (321, 181), (9, 7)] {
                let picture = upright(position, focus, fov, outer, size);
                let frame = smooth(&picture);
                assert!(is_grey(&frame), "{position}");
                let other = mirrored(&frame, picture.width());
                alike.compare(&frame, &other, &format!("{position}, {outer}, {size:?}"));
            }
        }
    }
    alike.assert_most_are(20);
}

/// Guards against the same between top and bottom; from within the disk's plane what is above it is what is below.
///
/// A ray above meets the plane at the angles `kπ` of one quarter turn's curves, the ray below it at those of the
/// other's end: two splines of the same curve, each of which may be off by the scene's tolerance. So a share differs by
/// two thousandths of a pixel times √2 at most, which is less than a grey.
#[test]
fn top_and_bottom_are_alike_to_one_grey_from_within_the_disks_plane() {
    let mut alike = Alike::default();
    for (position, focus, fov) in [
        ("[20, 0, 0]", "[0, 0, 0]", 40.0),
        ("[2, 0, 0]", "[0, 0, 0]", 150.0),
        ("[-9, 12, 0]", "[0, 0, 0]", 60.0),
        ("[1.3, 0, 0]", "[1.3, 5, 0]", 150.0),
        ("[20, 0, 0]", "[0, 2.7, 0]", 0.5),
    ] {
        for outer in [12.0, 3.05] {
            for size in [(160, 90), (161, 91), (9, 7)] {
                let picture = upright(position, focus, fov, outer, size);
                assert_eq!(picture.view.n_p(), 0.0);
                let frame = smooth(&picture);
                assert!(
                    is_grey(&frame) || outer < 4.0,
                    "{position}, {outer}, {size:?}"
                );
                let other = flipped(&frame, picture.width());
                alike.compare(&frame, &other, &format!("{position}, {outer}, {size:?}"));
            }
        }
    }
    // Measured: 28 of 7,500. The splines are off by some 4e-4 pixels, a tenth of a grey, where they are worst.
    alike.assert_most_are(50);
}
