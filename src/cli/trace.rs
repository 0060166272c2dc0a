//! `darkness trace`: follows single rays.

mod events;
mod given;
mod input;
mod paths;

use std::borrow::Cow;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use clap::Args;
use given::{PixelIndex, pixel_index, rays_from, rays_of_pixels};

use super::method::{DEFAULT_TABLE, Method, MethodArgs};
use super::progress::{Report, count, warn};
use super::radius::radius;
use super::rays::{ListedRay, RayReader, RaysError};
use super::stdio::StdoutError;
use super::threads::start_threads;
use crate::orbit::OrbitError;
use crate::orbit::exact::Exact;

/// Follow single rays: what happens to them, or their paths, as CSV
///
/// Rays come from the CSV list FILE, from --from with --b or --angle, or from --camera with --pixel.
///
/// The header of a list names its columns. Where a ray starts: u0 (its inverse radius, in inverse Schwarzschild radii),
/// or r0 (its radius, in Schwarzschild radii), or else --from. Its direction, by the first one of these that is there:
/// dudphi (du/dφ, in inverse Schwarzschild radii; inf is straight in and -inf straight out), b (the impact parameter,
/// in Schwarzschild radii, of a ray that goes inward), angle (the angle from the hole's direction that a static
/// observer sees, in degrees: 0 is straight in, above 90 the ray goes outward). Its name: id, else rays are numbered
/// from 1. Other columns, blank lines and lines that begin with # are ignored.
///
/// Writes the columns id,u0,dudphi,b,event,radius,angle,windings,deflection, for each ray in the order in which they
/// happen: its inbound and outbound crossings of each --radius, its turning point (periapsis or apoapsis), then its
/// capture (radius 1) or escape (radius inf). radius is in Schwarzschild radii, angle is the angle swept from the start
/// in radians, windings the same in turns. deflection belongs to the whole path, from infinity to infinity: the angle
/// that it sweeps less π, in radians; NaN for a path that begins or ends at the horizon.
///
/// With --paths, writes points of each ray's path as columns id,phi,r,x,y instead: phi, the angle swept from the start,
/// is in radians, r in Schwarzschild radii, and so are x = r cos phi and y = r sin phi. x and y lie in the plane in
/// which the ray moves, with the hole at 0,0 and the start at y = 0. With --camera, the columns
/// `scene_x,scene_y,scene_z` follow: the same point in the scene's axes.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct TraceArgs {
    /// The CSV list of rays, or - for the standard input [default: -]
    #[arg(value_name = "FILE")]
    input: Option<PathBuf>,
    /// The radius at which the rays of --b and --angle start, and those of a list without a column u0 or r0, in
    /// Schwarzschild radii
    #[arg(long, value_name = "R", value_parser = radius, allow_negative_numbers = true)]
    from: Option<f64>,
    /// A ray that goes inward with this impact parameter, in Schwarzschild radii. Several are separated by commas, or
    /// by repeating the option
    #[arg(
        long,
        value_name = "B",
        value_delimiter = ',',
        allow_negative_numbers = true,
        requires = "from",
        conflicts_with = "input"
    )]
    b: Vec<f64>,
    /// A ray at this angle from the hole's direction, 0 to 180 degrees, as a static observer sees it. Several as with
    /// --b, which they follow
    #[arg(
        long,
        value_name = "DEGREES",
        value_delimiter = ',',
        allow_negative_numbers = true,
        requires = "from",
        conflicts_with = "input"
    )]
    angle: Vec<f64>,
    /// A scene whose camera sees the rays of --pixel: a TOML file or a built-in scene's name; of an animation its first
    /// frame
    #[arg(
        long,
        value_name = "SCENE",
        requires = "pixel",
        conflicts_with_all = ["input", "from", "b", "angle"]
    )]
    camera: Option<PathBuf>,
    /// The pixel of the scene of --camera whose centre sees the ray: its column from the left and its row from the top,
    /// both from 0. The ray is followed back from the camera. Several by repeating the option
    #[arg(long, value_name = "I,J", requires = "camera", value_parser = pixel_index, allow_hyphen_values = true)]
    pixel: Vec<PixelIndex>,
    /// Write N points of each ray's path, 3 to 1000000, from its start until it falls in (r = 1) or escapes to the
    /// radius of --to. They are equally spaced in arc: in length along the path, drawn in the flat plane of x and y.
    /// The periapsis or apoapsis is one of them, and the spacings before and after it may differ by a few parts in N.
    /// Paths are exact, by elliptic integrals
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(3..=1_000_000),
        conflicts_with_all = ["radii", "method", "table", "no_mmap", "integrate_tolerance"]
    )]
    paths: Option<u32>,
    /// The radius at which the path of an escaping ray ends, in Schwarzschild radii [default: twice the start's, and at
    /// least 30]
    #[arg(long, value_name = "R", value_parser = radius, allow_negative_numbers = true, requires = "paths")]
    to: Option<f64>,
    /// A radius whose crossings are printed, in Schwarzschild radii. Several are separated by commas, or by repeating
    /// the option
    #[arg(
        long = "radius",
        value_name = "R",
        value_parser = radius,
        value_delimiter = ',',
        allow_negative_numbers = true,
        default_values = ["3", "6", "12", "30"]
    )]
    radii: Vec<f64>,
    #[command(flatten)]
    method: MethodArgs,
}

const EXAMPLES: &str = "\
Examples:
  darkness trace --from 30 --b 2.5,2.6,3 --paths 200 > paths.csv
  darkness trace --from 30 --angle 4,5,6 --method exact
  darkness trace --camera classic --pixel 960,400 --paths 200
  printf 'id,r0,b\\nA,30,2.7\\n' | darkness trace --radius 3,12";

/// How many of the refused rays are reported one by one.
const MOST_REPORTED: u64 = 100;

/// The size of the buffers in bytes.
const BUFFER: usize = 1 << 16;

type Rays = Box<dyn Iterator<Item = Result<ListedRay, RaysError>>>;

/// Runs the verb.
pub(super) fn run(args: &TraceArgs, report: Report) -> anyhow::Result<()> {
    let method = match args.paths {
        Some(_) => None,
        None => Some(args.method.check(Some(DEFAULT_TABLE))?),
    };
    let rays = rays(args)?;
    start_threads(None)?;
    let method = method.map(|method| method.ready(report)).transpose()?;

    let mut out = BufWriter::with_capacity(BUFFER, io::stdout().lock());
    let traced = trace(rays, args, method.as_ref(), &mut out);
    // The rays that were traced are right, whatever went wrong later.
    let flushed = out.flush().map_err(StdoutError);
    traced?;
    Ok(flushed?)
}

/// Returns the rays that the command line asks for.
fn rays(args: &TraceArgs) -> anyhow::Result<Rays> {
    let given = match (&args.camera, args.from) {
        (Some(scene), _) => rays_of_pixels(scene, &args.pixel)?,
        (None, Some(from)) => rays_from(from, &args.b, &args.angle)?,
        (None, None) => Vec::new(),
    };
    if !given.is_empty() {
        return Ok(Box::new(given.into_iter().map(Ok)));
    }
    let (input, name) = input::open(args.input.as_deref())?;
    Ok(Box::new(RayReader::new(input, name, args.from)?))
}

/// Writes the rows of all rays: of their paths, or of their events by a method.
fn trace(
    rays: Rays,
    args: &TraceArgs,
    method: Option<&Method>,
    out: &mut impl Write,
) -> anyhow::Result<()> {
    let radii = &args.radii;
    if let Some(count) = args.paths {
        let header = if args.camera.is_some() {
            paths::SCENE_HEADER
        } else {
            paths::HEADER
        };
        return write_rows(rays, header, out, |ray, rows| {
            paths::write_path(ray, count as usize, args.to, rows)
        });
    }
    let header = events::HEADER;
    match method {
        Some(Method::Table(table)) => {
            let lookup = table.lookup();
            write_rows(rays, header, out, |ray, rows| {
                events::write_events(&lookup, ray, radii, rows)
            })
        }
        Some(Method::Integrate(adaptive)) => write_rows(rays, header, out, |ray, rows| {
            events::write_events(adaptive, ray, radii, rows)
        }),
        Some(Method::Exact | Method::NoTable) | None => {
            write_rows(rays, header, out, |ray, rows| {
                events::write_events(&Exact, ray, radii, rows)
            })
        }
    }
}

/// Writes a header, and the rows that `append` makes of each ray.
fn write_rows(
    rays: Rays,
    header: &str,
    out: &mut impl Write,
    mut append: impl FnMut(&ListedRay, &mut String) -> Result<(), OrbitError>,
) -> anyhow::Result<()> {
    writeln!(out, "{header}").map_err(StdoutError)?;
    let (mut all, mut refused) = (0_u64, 0_u64);
    let mut rows = String::new();
    for ray in rays {
        all += 1;
        rows.clear();
        let followed = ray.and_then(|ray| {
            append(&ray, &mut rows).map_err(|error| RaysError::unfollowed(&ray.id, error))
        });
        match followed {
            Ok(()) => out.write_all(rows.as_bytes()).map_err(StdoutError)?,
            Err(error) if error.is_final() => return Err(error.into()),
            Err(error) => {
                refused += 1;
                if refused <= MOST_REPORTED {
                    warn(error);
                }
            }
        }
    }
    match refused {
        0 => Ok(()),
        _ if refused == all => anyhow::bail!(
            "none of {} holds a ray that can be followed",
            count(all, "row")
        ),
        1 => anyhow::bail!(
            "1 of {all} rows holds no ray that can be followed; the others are traced"
        ),
        _ => anyhow::bail!(
            "{refused} of {all} rows hold no ray that can be followed; the others are traced"
        ),
    }
}

/// Returns an id as a field of CSV: in quotes where it holds a comma or a quote. Its quotes are doubled as in the
/// list.
fn csv_field(id: &str) -> Cow<'_, str> {
    if id.contains([',', '"']) {
        format!("\"{id}\"").into()
    } else {
        id.into()
    }
}
