//! `darkness isoradials`: curves of constant radius, redshift and flux, as SVG or CSV.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};

use super::destination::{Destination, has_extension, onto_input, unsupported_extension};
use super::misuse::{check_flat, misuse};
use super::progress::{Report, count, duration, warn};
use super::radius::radius;
use super::threads::start_threads;
use super::writable::{self, OUTPUT};
use crate::figure::{Level, Paper, Quantity, contours, svg, write_csv};
use crate::scene::{Animation, ImageSize, Override, Scene, View};

/// The radii that are drawn where nothing is asked for: Luminet's 6M, 10M, 20M and 30M.
const LUMINET: [f64; 4] = [3.0, 5.0, 10.0, 15.0];

/// The most orders: the ring of the next is thinner than rounding.
const MOST_ORDERS: i64 = 8;

/// The longest file that is drawn over, in bytes.
const LONGEST_PICTURE: u64 = 1 << 30;

/// Draw curves of constant radius, redshift and flux, as SVG or CSV
///
/// Without options this is Luminet's figure of 1979: the rings of the disk at 6M, 10M, 20M and 30M (3, 5, 10 and 15
/// Schwarzschild radii), 80 degrees from its axis, in the direct image (solid) and the ghost image (dashed). Curves are
/// right to 0.01 pixels. They are computed exactly, and need no table.
///
/// The CSV has a row for each point: curve (the number of the connected curve), quantity, level, order (0 direct, 1
/// ghost), closed, x and y (pixels from the left and the top), b (the impact parameter, in Schwarzschild radii) and
/// alpha (radians about the hole in the picture, counterclockwise from the near side).
#[derive(Debug, Args)]
pub(super) struct IsoradialsArgs {
    /// A scene's TOML file, or the name of a built-in scene (`darkness scene` lists them); of an animation, the first
    /// frame
    #[arg(value_name = "SCENE", default_value = "luminet")]
    scene: PathBuf,
    /// The output: a .svg or .csv file, or - for the standard output
    #[arg(short, long, value_name = "OUT", default_value = "isoradials.svg")]
    output: PathBuf,
    /// The format, where the extension does not name it
    #[arg(long, value_name = "FORMAT", value_enum)]
    format: Option<FigureFormat>,
    /// Radii in Schwarzschild radii, with commas: the images of whole rings, whatever the scene's disk [default:
    /// 3,5,10,15, if no curves are asked for]
    #[arg(
        long = "radius",
        value_name = "R",
        value_parser = radius,
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    radii: Vec<f64>,
    /// Redshifts of the scene's disk, with commas: g, the ratio of observed to emitted frequency, which is 1/(1 + z). 1
    /// is no shift, more is a blueshift
    #[arg(
        long = "redshift",
        value_name = "G",
        value_parser = positive,
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    redshifts: Vec<f64>,
    /// Observed bolometric fluxes of the scene's disk, with commas: g⁴ F, where g is the redshift and F
    /// the emitted flux (Page and Thorne 1974) over its greatest value
    #[arg(
        long = "flux",
        value_name = "F",
        value_parser = positive,
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    fluxes: Vec<f64>,
    /// The number of images: 1 for the direct image, 2 for the ghost image too, up to 8
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=MOST_ORDERS))]
    orders: u32,
    /// A PNG picture of the scene to draw over, as `darkness render` makes it; it becomes a part of the SVG file
    #[arg(long, value_name = "PICTURE.png")]
    over: Option<PathBuf>,
    /// Give any key of the scene another value, one of TOML: --set camera.inclination=60, --set image.width=1080
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = Override::parse)]
    set: Vec<Override>,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FigureFormat {
    /// Bézier paths
    Svg,
    /// The curves' points
    Csv,
}

impl FigureFormat {
    fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Csv => "csv",
        }
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let value = text.trim().parse().ok();
    let value = value.filter(|value: &f64| value.is_finite() && *value > 0.0);
    value.ok_or_else(|| "write a finite number above 0".into())
}

/// Runs the verb.
pub(super) fn run(args: &IsoradialsArgs, report: Report) -> anyhow::Result<()> {
    let animation = Animation::load_with(&args.scene, &args.set)?;
    let scene = animation.check(animation.first())?;
    check_flat(&scene, "a figure of curves")?;
    let levels = levels(args);
    let needs_disk = levels
        .iter()
        .any(|level| level.quantity != Quantity::Radius);
    let Some(disk) = scene
        .disk()
        .map(|disk| (disk.inner, disk.outer))
        .or((!needs_disk).then_some((0.0, 0.0)))
    else {
        return Err(misuse(
            "--redshift and --flux are of a disk, and this scene has none; give it a [disk], or draw --radius alone",
        ));
    };
    let (format, destination) = output(args)?;
    let picture = args.over.as_deref().map(|path| read_picture(path, &scene));
    let picture = picture.transpose()?;
    start_threads(None)?;

    let start = Instant::now();
    let view = View::new(&scene);
    let contours = contours(&view, disk, &levels, args.orders);
    for Level { quantity, value } in &levels {
        if !contours.iter().any(|contour| {
            contour.level
                == Level {
                    quantity: *quantity,
                    value: *value,
                }
        }) {
            warn(format_args!(
                "{} {value}: the picture shows no such place",
                quantity.name()
            ));
        }
    }
    let file = match format {
        FigureFormat::Svg => {
            let paper = picture.as_deref().map_or(Paper::White, Paper::Png);
            svg(&contours, &scene, paper).into_bytes()
        }
        FigureFormat::Csv => {
            let mut file = Vec::new();
            write_csv(&contours, &view, &mut file)?;
            file
        }
    };
    destination.write(&file)?;
    let curves = count(contours.len() as u64, "curve");
    report.note(format_args!(
        "{destination}: {curves} in {}",
        duration(start.elapsed())
    ));
    Ok(())
}

/// Returns what is asked for, or Luminet's radii.
fn levels(args: &IsoradialsArgs) -> Vec<Level> {
    let of = |quantity, values: &[f64]| -> Vec<Level> {
        values
            .iter()
            .map(|&value| Level { quantity, value })
            .collect()
    };
    let levels = [
        of(Quantity::Radius, &args.radii),
        of(Quantity::Redshift, &args.redshifts),
        of(Quantity::Flux, &args.fluxes),
    ]
    .concat();
    if levels.is_empty() {
        of(Quantity::Radius, &LUMINET)
    } else {
        levels
    }
}

/// Returns the format and the destination.
///
/// # Errors
/// The options contradict each other, or the destination cannot be written.
fn output(args: &IsoradialsArgs) -> anyhow::Result<(FigureFormat, Destination)> {
    let path = &args.output;
    let named = FigureFormat::value_variants()
        .iter()
        .copied()
        .find(|format| has_extension(path, format.extension()));
    let is_stdout = path == Path::new("-");
    let format = match (args.format, named) {
        (Some(format), _) | (None, Some(format)) => format,
        (None, None) if is_stdout => FigureFormat::Svg,
        (None, None) => return Err(unsupported_extension(path, ".svg or .csv")),
    };
    if let Some(over) = &args.over {
        if format == FigureFormat::Csv {
            return Err(misuse(
                "--over draws on a picture, and .csv files hold none; leave it out, or write a .svg file",
            ));
        }
        if !is_stdout && writable::same_place(path, over) {
            return Err(onto_input(OUTPUT, path, "picture"));
        }
    }
    let destination = Destination::of_picture(path.clone(), format.extension(), &args.scene)?;
    Ok((format, destination))
}

/// Reads a PNG file that has the shape of the scene's picture.
///
/// # Errors
/// The file cannot be read, is no PNG file, or has another shape.
fn read_picture(path: &Path, scene: &Scene) -> anyhow::Result<Vec<u8>> {
    let name = path.display();
    let mut bytes = Vec::new();
    fs::File::open(path)
        .and_then(|file| file.take(LONGEST_PICTURE + 1).read_to_end(&mut bytes))
        .map_err(|error| {
            misuse(format!(
                "{name}: --over names a picture that cannot be read: {error}"
            ))
        })?;
    if bytes.len() as u64 > LONGEST_PICTURE {
        return Err(misuse(format!(
            "{name}: the picture has more than a gigabyte; give --over a smaller one"
        )));
    }
    let decoder = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info();
    let reader =
        decoder.map_err(|error| misuse(format!("{name}: --over needs a PNG picture: {error}")))?;
    let (width, height) = reader.info().size();
    let ImageSize {
        width: w,
        height: h,
    } = scene.size();
    if u64::from(width) * u64::from(h) != u64::from(height) * u64::from(w) {
        return Err(misuse(format!(
            "{name}: this picture has {width} × {height} pixels and the scene's has {w} × {h}; give --over a picture \
             of this scene"
        )));
    }
    Ok(bytes)
}
