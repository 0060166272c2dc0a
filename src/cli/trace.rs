//! `darkness trace`: follows each ray of a list.

use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use super::destination::stdout_onto_input;
use super::method::{DEFAULT_TABLE, Method, MethodArgs};
use super::misuse::misuse;
use super::progress::{Report, count, warn};
use super::rays::RayReader;
use super::stdio::{StdoutError, is_stdout};
use super::threads::start_threads;
use crate::orbit::exact::Exact;
use crate::orbit::{EventKind, Fate, MIN_U, OrbitError, Orbits, Ray};

/// Follow single rays: CSV in, CSV out
///
/// Reads CSV with a header that names the columns u0 (the inverse radius where the ray starts, in inverse Schwarzschild
/// radii) and dudphi (du/dφ there; inf is straight in and -inf straight out). Other columns, blank lines and lines that
/// begin with # are ignored.
///
/// Writes the columns u0,dudphi,event,radius,angle. For each ray these are, in the order in which they happen, its
/// inbound and outbound crossings of each radius, then its capture (radius 1) or escape (radius inf), each with the
/// angle swept from the start, in radians.
#[derive(Debug, Args)]
pub(super) struct TraceArgs {
    /// The CSV file, or - for the standard input [default: -]
    #[arg(value_name = "FILE")]
    input: Option<PathBuf>,
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

fn radius(text: &str) -> Result<f64, String> {
    let radius: f64 = text
        .trim()
        .parse()
        .map_err(|_| "a radius is a number above 1, in Schwarzschild radii".to_owned())?;
    if radius > 1.0 && radius <= 1.0 / MIN_U {
        Ok(radius)
    } else {
        Err(OrbitError::Radius { radius }.to_string())
    }
}

/// How many of the refused rows are reported one by one.
const MOST_REPORTED: u64 = 100;

/// The size of the buffers in bytes.
const BUFFER: usize = 1 << 16;

/// Runs the verb.
pub(super) fn run(args: &TraceArgs, report: Report) -> anyhow::Result<()> {
    let method = args.method.check(Some(DEFAULT_TABLE))?;
    let (input, name) = open(args.input.as_deref())?;
    let mut rays = RayReader::new(input, name)?;
    start_threads(None)?;

    let method = method.ready(report)?;
    let mut out = BufWriter::with_capacity(BUFFER, io::stdout().lock());
    let traced = match &method {
        Method::Table(table) => trace(&table.lookup(), &mut rays, &args.radii, &mut out),
        Method::Exact | Method::NoTable => trace(&Exact, &mut rays, &args.radii, &mut out),
        Method::Integrate(adaptive) => trace(adaptive, &mut rays, &args.radii, &mut out),
    };
    // The rays that were traced are right, whatever went wrong later.
    let flushed = out.flush().map_err(StdoutError);
    traced?;
    Ok(flushed?)
}

/// Opens the input, and returns its name for messages.
fn open(input: Option<&Path>) -> anyhow::Result<(Box<dyn BufRead>, String)> {
    match input {
        Some(path) if path != Path::new("-") => {
            let name = path.display().to_string();
            let file = File::open(path).map_err(|error| {
                let text = format!("{name}: the rays cannot be read: {error}");
                match error.kind() {
                    io::ErrorKind::NotFound => misuse(text),
                    _ => anyhow::anyhow!(text),
                }
            })?;
            check_is_not_written(&file, path)?;
            Ok((Box::new(BufReader::with_capacity(BUFFER, file)), name))
        }
        // Without a word the program would seem to hang.
        None if io::stdin().is_terminal() => Err(misuse(
            "there are no rays to trace; name a CSV file with the columns u0 and dudphi, or send one to the standard \
             input (`-` reads it from the terminal)",
        )),
        _ => {
            let name = "standard input";
            if let Ok(list) = stdin() {
                check_is_not_written(&list, Path::new(name))?;
            }
            Ok((Box::new(io::stdin().lock()), name.into()))
        }
    }
}

/// Refuses to print to the end of the list that is read, since each line would be read in its turn, without end.
fn check_is_not_written(list: &File, name: &Path) -> anyhow::Result<()> {
    if list.metadata().is_ok_and(|file| is_stdout(&file)) {
        return Err(stdout_onto_input(name, "list"));
    }
    Ok(())
}

/// Returns the standard input as a file, to find out what it is.
fn stdin() -> io::Result<File> {
    #[cfg(unix)]
    let owned = std::os::fd::AsFd::as_fd(&io::stdin()).try_clone_to_owned()?;
    #[cfg(windows)]
    let owned = std::os::windows::io::AsHandle::as_handle(&io::stdin()).try_clone_to_owned()?;
    Ok(File::from(owned))
}

fn trace(
    orbits: &impl Orbits,
    rays: &mut RayReader<impl BufRead>,
    radii: &[f64],
    out: &mut impl Write,
) -> anyhow::Result<()> {
    writeln!(out, "u0,dudphi,event,radius,angle").map_err(StdoutError)?;
    let (mut rows, mut refused) = (0_u64, 0_u64);
    while let Some(ray) = rays.next() {
        rows += 1;
        let followed = ray.and_then(|ray| {
            let events = orbits.follow(ray, radii);
            let events = events.map_err(|error| rays.error(&error))?;
            Ok((ray, events))
        });
        match followed {
            Ok((ray, events)) => {
                for event in events {
                    write_event(out, ray, event.kind, event.radius, event.angle)
                        .map_err(StdoutError)?;
                }
            }
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
        _ if refused == rows => anyhow::bail!(
            "none of {} holds a ray that can be followed",
            count(rows, "row")
        ),
        1 => anyhow::bail!(
            "1 of {rows} rows holds no ray that can be followed; the others are traced"
        ),
        _ => anyhow::bail!(
            "{refused} of {rows} rows hold no ray that can be followed; the others are traced"
        ),
    }
}

/// Writes one row. `{:?}` prints the shortest decimal that reads back to the same number, and the angle has 17
/// significant digits, which do so too.
fn write_event(
    out: &mut impl Write,
    ray: Ray,
    kind: EventKind,
    radius: f64,
    angle: f64,
) -> io::Result<()> {
    let event = match kind {
        EventKind::Inbound => "inbound",
        EventKind::Outbound => "outbound",
        EventKind::End(Fate::Capture) => "capture",
        EventKind::End(Fate::Escape) => "escape",
    };
    let radius = format!("{radius:?}");
    let radius = radius.strip_suffix(".0").unwrap_or(&radius);
    let (u0, dudphi) = (ray.u(), ray.dudphi());
    writeln!(out, "{u0:?},{dudphi:?},{event},{radius},{angle:.16e}")
}
