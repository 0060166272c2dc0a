//! `darkness table`: makes, inspects and verifies tables.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::builder::PossibleValuesParser;
use clap::{Args, Subcommand};
use serde::Serialize;

use super::method::{self, DEFAULT_TABLE};
use super::misuse::misuse;
use super::progress::{Report, duration};
use super::remedy::with_remedy;
use super::stdio::StdoutError;
use super::table_path::default_path;
use super::threads::{ThreadArgs, start_threads};
use super::writable::{self, OUTPUT};
use crate::table::{self, ChartNodes, Metadata, Spec, Table, TableError, format};

/// Make a table of all light rays, or inspect or verify one
///
/// The error of an angle is at most 1e-6 radians in draft, 1e-9 in standard and 1e-12 in fine.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(super) struct TableArgs {
    #[command(subcommand)]
    action: Option<Action>,
    /// Which table to make
    #[arg(value_name = "NAME", default_value = DEFAULT_TABLE, value_parser = PossibleValuesParser::new(Spec::NAMES))]
    name: String,
    /// Where to write the table [default: NAME.table in the folder tables if there is one, else in the user's cache]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    threads: ThreadArgs,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Print a table's description of itself
    Inspect {
        /// The table's file
        file: PathBuf,
        /// Print it as JSON
        #[arg(long)]
        json: bool,
    },
    /// Compare a table byte by byte with one made anew, and measure its error again
    Verify {
        /// The table's file
        file: PathBuf,
        #[command(flatten)]
        threads: ThreadArgs,
    },
}

/// Runs the verb.
pub(super) fn run(args: &TableArgs, report: Report) -> anyhow::Result<()> {
    match &args.action {
        None => make(args, report),
        Some(Action::Inspect { file, json }) => inspect(file, *json),
        Some(Action::Verify { file, threads }) => {
            start_threads(threads.threads)?;
            verify(file, report)
        }
    }
}

fn make(args: &TableArgs, report: Report) -> anyhow::Result<()> {
    let spec = method::spec(&args.name)?;
    let default = || default_path(&args.name);
    let path = args.output.clone().unwrap_or_else(default);
    if path == Path::new("-") {
        return Err(misuse(
            "a table cannot go to the standard output; name a file with -o",
        ));
    }
    writable::check(&path, OUTPUT)?;
    if !args.force && is_made(&path, &spec)? {
        report.note(format_args!(
            "{}: the table {} is already there; nothing to do",
            path.display(),
            spec.name
        ));
        return Ok(());
    }
    start_threads(args.threads.threads)?;

    let start = Instant::now();
    let table = method::make(&spec, report)?;
    let time = duration(start.elapsed());
    table.save(&path).map_err(|error| with_remedy(&error))?;
    report.note(format_args!(
        "{}: table {}, {} bytes, error {:.1e}, made in {time}",
        path.display(),
        spec.name,
        table.bytes().len(),
        table.metadata().measured_error
    ));
    Ok(())
}

/// Returns whether `path` holds the table of `spec` already.
///
/// # Errors
/// Something else is at `path`.
fn is_made(path: &Path, spec: &Spec) -> anyhow::Result<bool> {
    let name = path.display();
    match Table::open(path) {
        Ok(found) if found.metadata().spec == *spec => Ok(true),
        Ok(found) => anyhow::bail!(
            "{name}: another table, {}, is there already; --force replaces it",
            found.metadata().spec.name
        ),
        Err(TableError::Missing { .. }) => Ok(false),
        Err(TableError::Unusable { problem, .. }) => {
            anyhow::bail!("{name}: a file is there already, and {problem}; --force replaces it")
        }
        Err(error) => anyhow::bail!("{error}; --force replaces the file"),
    }
}

/// What `inspect` prints.
#[derive(Debug, Serialize)]
struct Inspection<'a> {
    name: &'a str,
    tolerance: f64,
    format_version: u32,
    conventions: &'a str,
    file_bytes: usize,
    measured_error: f64,
    measured_angles: u64,
    grid: GridNodes,
}

/// The nodes of each chart.
#[derive(Debug, Serialize)]
struct GridNodes {
    critical: ChartNodes,
    weak: ChartNodes,
    trapped: ChartNodes,
    radial: ChartNodes,
}

impl<'a> Inspection<'a> {
    fn new(metadata: &'a Metadata, file_bytes: usize) -> Self {
        let spec = &metadata.spec;
        Self {
            name: &spec.name,
            tolerance: spec.tolerance,
            format_version: format::VERSION,
            conventions: &metadata.conventions,
            file_bytes,
            measured_error: metadata.measured_error,
            measured_angles: metadata.measured_angles,
            grid: GridNodes {
                critical: spec.critical,
                weak: spec.weak,
                trapped: spec.trapped,
                radial: spec.radial,
            },
        }
    }

    fn print(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "name             {}", self.name)?;
        writeln!(out, "tolerance        {:e} rad", self.tolerance)?;
        writeln!(
            out,
            "measured error   {:.2e} rad, the largest of {} angles",
            self.measured_error, self.measured_angles
        )?;
        writeln!(out, "file size        {} bytes", self.file_bytes)?;
        writeln!(out, "format version   {}", self.format_version)?;
        writeln!(out, "conventions      {}", self.conventions)?;
        let charts = [
            ("critical", self.grid.critical),
            ("weak", self.grid.weak),
            ("trapped", self.grid.trapped),
            ("radial", self.grid.radial),
        ];
        for (name, ChartNodes { place, orbit }) in charts {
            writeln!(out, "{name:<16} {place} × {orbit} nodes (place × orbit)")?;
        }
        Ok(())
    }
}

/// Opens a table that the command line names.
///
/// # Errors
/// A misuse if it is not there; a table that cannot be read.
fn open(file: &Path) -> anyhow::Result<Table> {
    Table::open(file).map_err(|error| match error {
        TableError::Missing { .. } => misuse(with_remedy(&error).to_string()),
        _ => with_remedy(&error),
    })
}

fn inspect(file: &Path, json: bool) -> anyhow::Result<()> {
    let table = open(file)?;
    let inspection = Inspection::new(table.metadata(), table.bytes().len());
    let mut stdout = io::stdout().lock();
    let printed = if json {
        let text = serde_json::to_string_pretty(&inspection)?;
        writeln!(stdout, "{text}")
    } else {
        inspection.print(&mut stdout)
    };
    printed.and_then(|()| stdout.flush()).map_err(StdoutError)?;
    Ok(())
}

fn verify(file: &Path, report: Report) -> anyhow::Result<()> {
    let table = open(file)?;
    let metadata = table.metadata();
    let anew = method::make(&metadata.spec, report)?;
    let measured = table::measure(&metadata.spec, &table.lookup());
    let (name, bytes) = (file.display(), table.bytes());

    if bytes != anew.bytes() {
        let same = bytes.iter().zip(anew.bytes()).take_while(|(a, b)| a == b);
        anyhow::bail!(
            "{name}: the table is intact, but it is not the one that its specification gives: made anew, it differs \
             from byte {} on",
            same.count()
        );
    }
    if measured.error != metadata.measured_error || measured.angles != metadata.measured_angles {
        anyhow::bail!(
            "{name}: the table states an error of {:e} on {} angles, but it is {:e} on {}",
            metadata.measured_error,
            metadata.measured_angles,
            measured.error,
            measured.angles
        );
    }
    let mut stdout = io::stdout().lock();
    writeln!(
        stdout,
        "{name}: table {} is right\n\
         every check of the file passes\n\
         made anew, all {} bytes are the same\n\
         measured again, its error is the stated one: {:.2e} rad, the largest of {} angles",
        metadata.spec.name,
        bytes.len(),
        measured.error,
        measured.angles
    )
    .and_then(|()| stdout.flush())
    .map_err(StdoutError)?;
    Ok(())
}
