//! Frames of a sky: `classic`'s camera and `lit` at 1920 × 1080, before a panorama, stars and a grid, on one thread and
//! on two, against filling the same memory and against `lit` without a sky; the escape curve.
//!
//! `cargo bench --bench sky`

mod interleaved;

use core::error::Error;
use core::time::Duration;
use std::sync::Arc;

use darkness::chart::interleaved::rounds;
use darkness::isoradial::EscapeCurve;
use darkness::orbit::invariants::Orbit;
use darkness::orbit::path::SweptAngles;
use darkness::render::{Form, FrameMemory};
use darkness::scene::{Camera, ImageSize, Layer, Scene, Sky, SkyFile, StarSource, Stars, View};
use darkness::sky::{Panorama, SkySource, StarField};
use darkness::table::{Lookup, Spec, Table};
use darkness::{Ray, Renderer};
use interleaved::{Contender, compare};
use rayon::{ThreadPool, ThreadPoolBuilder};

const SIZE: ImageSize = ImageSize {
    width: 1920,
    height: 1080,
};

/// The rows of the panorama. Its texels, and those of its smaller sizes, take 537 MB.
const PANORAMA_ROWS: usize = 4096;

const STARS: u32 = 120_000;

const ROUNDS: usize = 51;

/// Where the frames' times are among those of a round: two times of filling memory come first.
const FRAMES: usize = 2;

/// What is drawn.
struct Frame {
    name: &'static str,
    scene: Scene,
    source: Option<Arc<SkySource>>,
    form: Form,
    /// The most that it may take on one thread; empty where nothing is asked for.
    bound: &'static str,
    /// Whether it is drawn on two threads too.
    on_two: bool,
}

impl Frame {
    /// A picture in colour.
    fn new(name: &'static str, scene: Scene, source: Option<&Arc<SkySource>>) -> Self {
        Self {
            name,
            scene,
            source: source.cloned(),
            form: Form::Rgb8,
            bound: "",
            on_two: false,
        }
    }

    /// Draws the frame on two threads too, and asks for a time on one.
    fn on_both(self, bound: &'static str) -> Self {
        Self {
            bound,
            on_two: true,
            ..self
        }
    }

    /// Draws it in memory of its own, again and again.
    fn contender<'a>(&'a self, pool: &'a ThreadPool, table: &'a Table) -> Contender<'a> {
        let mut renderer: Renderer<Lookup<'a>> = Renderer::new(table);
        if let (Some(sky), Some(source)) = (self.scene.sky(), &self.source) {
            renderer = renderer.with_sky(sky.clone(), Arc::clone(source));
        }
        let mut memory = FrameMemory::new(self.form);
        Contender {
            name: self.name,
            // Not a number where it cannot be drawn.
            run: Box::new(move || {
                let drawn = pool.install(|| renderer.draw(&self.scene, &mut memory));
                drawn.map_or(f64::NAN, |_| 1.0)
            }),
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build();
    let (one, two) = (pool(1)?, pool(2)?);
    let table = Table::generate(&Spec::standard())?;
    let frames = frames()?;
    let view = View::new(&frames[0].scene);
    print_frames(&frames, &view, &table, (&one, &two));
    escape_curve(&view, &table);
    Ok(())
}

/// The frames, `lit` without a sky first.
fn frames() -> Result<Vec<Frame>, Box<dyn Error>> {
    let panorama = Sky {
        panorama: Some(SkyFile::new("made in memory")),
        ..Sky::default()
    };
    let stars = Sky {
        stars: Some(Stars {
            exposure: -10.0,
            ..Stars::new(StarSource::Synthetic {
                count: STARS,
                seed: 1,
            })
        }),
        ..Sky::default()
    };
    let texels = Panorama::from_linear(PANORAMA_ROWS, noise(PANORAMA_ROWS));
    let noise = &Arc::new(SkySource::new(Some(texels), None, None));
    let field = StarField::synthetic(STARS, 1, None);
    let field = &Arc::new(SkySource::new(None, Some(field), None));
    let position = Scene::builtin("classic")?.camera().position;
    let before = |sky: &Sky, fov| Scene::without_disk(Camera::at(position, fov), sky.clone(), SIZE);
    let lit = Scene::builtin("lit")?.with_size(SIZE.width, SIZE.height)?;
    let lit_before = |sky: &Sky| lit.clone().with_sky(Some(sky.clone()));
    let grid = Scene::builtin("grid")?.with_size(SIZE.width, SIZE.height)?;
    let directions = [Layer::Sky, Layer::SkyUv].into_iter().collect();
    Ok(vec![
        Frame::new("`lit` without a sky", lit.clone(), None).on_both(""),
        Frame::new("panorama, fov 30°", before(&panorama, 30.0)?, Some(noise))
            .on_both("30 ms, goal 12"),
        Frame::new("panorama, fov 50°", before(&panorama, 50.0)?, Some(noise))
            .on_both("30 ms, goal 12"),
        Frame::new("panorama, fov 90°", before(&panorama, 90.0)?, Some(noise))
            .on_both("30 ms, goal 12"),
        Frame::new("stars, fov 30°", before(&stars, 30.0)?, Some(field)).on_both("15 ms"),
        Frame::new("stars, fov 90°", before(&stars, 90.0)?, Some(field)).on_both("15 ms"),
        Frame::new("`lit` before the stars", lit_before(&stars)?, Some(field)).on_both(""),
        Frame::new(
            "`lit` before the panorama",
            lit_before(&panorama)?,
            Some(noise),
        )
        .on_both("40 ms"),
        Frame::new("`grid`", grid, None),
        Frame {
            form: Form::Layers(directions),
            ..Frame::new("layers `sky`, `sky_uv`", before(&panorama, 30.0)?, None)
        },
    ])
}

/// Draws the frames in turn, and makes the escape curve of their camera's radius. Prints the rows of a Markdown table.
fn print_frames(
    frames: &[Frame],
    view: &View,
    table: &Table,
    (one, two): (&ThreadPool, &ThreadPool),
) {
    let pixels = SIZE.width as usize * SIZE.height as usize;
    let filling = |name, bytes: usize| {
        let mut buffer = vec![0_u8; bytes * pixels];
        Contender {
            name,
            run: Box::new(move || {
                std::hint::black_box(&mut buffer).fill(1);
                f64::from(buffer[0])
            }),
        }
    };
    let directions = frames[frames.len() - 1].form;
    let lookup = table.lookup();
    let mut contenders = vec![
        filling("filling 3 bytes a pixel", Form::Rgb8.bytes()),
        filling("filling 20 bytes a pixel", directions.bytes()),
    ];
    contenders.extend(frames.iter().map(|frame| frame.contender(one, table)));
    let curve = contenders.len();
    contenders.push(Contender {
        name: "making the escape curve",
        run: Box::new(|| {
            let curve = EscapeCurve::new(view.u0(), view.slope_scale(), &lookup);
            curve.nodes() as f64
        }),
    });
    let on_two = frames.iter().filter(|frame| frame.on_two);
    contenders.extend(on_two.map(|frame| frame.contender(two, table)));
    let times = rounds(
        &mut contenders,
        ROUNDS,
        (Duration::ZERO, Duration::MAX),
        &mut || (),
    );

    println!(
        "1920 × 1080, one thread ({ROUNDS} rounds, sum {:.6e})",
        times.sum
    );
    println!("| | time | × filling | × `lit` | at most | two threads, at least 1.7 × |");
    println!("|---|---|---|---|---|---|");
    let row = |i: usize, fill: usize, bound: &str, on_two: &str| {
        println!(
            "| {:<25} | {:>7.3} ms | {:>6.2} × | {:>6.3} × | {bound:<14} | {on_two:<6} |",
            contenders[i].name,
            times.median(i) * 1e3,
            times.ratio(fill, i),
            times.ratio(FRAMES, i),
        );
    };
    row(0, 0, "", "");
    row(1, 1, "", "");
    let mut next_on_two = curve + 1;
    for (i, frame) in (FRAMES..).zip(frames) {
        let fill = usize::from(frame.form == directions);
        let mut gain = String::new();
        if frame.on_two {
            gain = format!("{:.2} ×", times.ratio(next_on_two, i));
            next_on_two += 1;
        }
        row(i, fill, frame.bound, &gain);
    }
    row(curve, 0, "", "");
}

/// One evaluation of the escape curve and one of its inverse, for rays of a picture, against an angle of the table.
fn escape_curve(view: &View, table: &Table) {
    let lookup = table.lookup();
    let curve = EscapeCurve::new(view.u0(), view.slope_scale(), &lookup);
    // No divisor of the picture's width, so that the pixels lie in all columns.
    let sampled = (0..SIZE.width * SIZE.height).step_by(49);
    let rays: Vec<(f64, f64, f64)> = sampled
        .filter_map(|k| {
            let ray = view.pixel(k % SIZE.width, k / SIZE.width);
            let (z, s) = (ray.z, ray.transverse());
            curve.at(z, s).map(|escape| (z, s, escape.angle))
        })
        .collect();
    compare(
        "the escape curve at rays of a picture, time per ray",
        rays.len(),
        ROUNDS,
        &mut [
            Contender {
                name: "the angle from the table",
                run: Box::new(|| {
                    let angle = |&(z, s, _): &(f64, f64, f64)| {
                        let ray = Ray::new(view.u0(), view.slope_scale() * z / s);
                        ray.map_or(f64::NAN, |ray| lookup.to_end(&Orbit::new(ray)))
                    };
                    rays.iter().map(angle).sum()
                }),
            },
            Contender {
                name: "the angle and its rate",
                run: Box::new(|| {
                    let escapes = rays.iter().filter_map(|&(z, s, _)| curve.at(z, s));
                    escapes.map(|escape| escape.angle + escape.rate).sum()
                }),
            },
            Contender {
                name: "the ray of an angle",
                run: Box::new(|| {
                    let images = rays.iter().map(|&(_, _, angle)| curve.image(angle));
                    images
                        .map(|image| image.cosine + image.sine + image.rate)
                        .sum()
                }),
            },
        ],
    );
}

/// Returns the texels of 1/f noise from 0 to 1, as much of it in each octave, down to single texels. `height` is a
/// power of two.
fn noise(height: usize) -> Vec<f32> {
    let mut random = 7_u64;
    let mut next = || {
        // Marsaglia's xorshift (2003).
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random >> 40) as f32 / (1 << 24) as f32
    };
    // A new texel lies in an old one's half, between its centre and a neighbour's: one more than this neighbour's
    // index.
    let after_second = |i: usize| i / 2 + 2 * (i % 2);
    let octaves = height.ilog2() + 1;
    let mut texels: Vec<f32> = (0..6).map(|_| next()).collect();
    let mut rows = 1;
    while rows < height {
        let columns = 2 * rows;
        let mut finer = Vec::with_capacity(4 * texels.len());
        for y in 0..2 * rows {
            let (near_row, far_row) = (y / 2, after_second(y).clamp(1, rows) - 1);
            for x in 0..2 * columns {
                let (near, far) = (x / 2, (after_second(x) + columns - 1) % columns);
                for c in 0..3 {
                    let across = |row: usize| {
                        let at = |column: usize| texels[3 * (row * columns + column) + c];
                        0.75 * at(near) + 0.25 * at(far)
                    };
                    finer.push(0.75 * across(near_row) + 0.25 * across(far_row) + next());
                }
            }
        }
        texels = finer;
        rows *= 2;
    }
    for texel in &mut texels {
        *texel /= octaves as f32;
    }
    texels
}
