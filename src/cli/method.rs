//! The method that answers what happens to a ray, and the table it may need.

use std::fmt;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use memmap2::Mmap;

use super::misuse::misuse;
use super::progress::{Report, warn};
use crate::orbit::integrate::Adaptive;
use crate::table::{self, Lookup, Memory, Metadata, Spec, Table, TableError};

/// The table that is good for rays of all kinds.
pub(super) const DEFAULT_TABLE: &str = "standard";

/// Names the table where `--table` does not.
const TABLE_VARIABLE: &str = "DARKNESS_TABLE";

const TABLE_HELP: &str = "The table to read with --method table [env: DARKNESS_TABLE] \
    [default: tables/standard.table; a picture that needs less or more takes tables/draft.table or tables/fine.table; \
    made where it is missing]";

/// What [`Adaptive`] can be asked for: above, it takes the upper bound; at the lower one steps are long since as
/// short as helps.
const TOLERANCES: RangeInclusive<f64> = 1e-13..=1e-3;

/// The options of every verb that follows rays.
#[derive(Debug, Args)]
pub(super) struct MethodArgs {
    /// How rays are followed
    #[arg(long, value_name = "METHOD", value_enum, default_value_t = MethodName::Table)]
    method: MethodName,
    #[arg(long, value_name = "FILE", help = TABLE_HELP)]
    table: Option<PathBuf>,
    /// Read the table into memory, in place of mapping its file: for network disks, and for files that others may cut short
    #[arg(long)]
    no_mmap: bool,
    /// The error aimed at in an angle by --method integrate, in radians, 1e-13 to 1e-3; rays that wind for more than
    /// ten radians near the photon sphere may miss it, and their fate [default: 1e-9]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    integrate_tolerance: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Read from a table, solved beforehand
    Table,
    /// Elliptic integrals, ray by ray
    Exact,
    /// The equation itself, integrated ray by ray
    Integrate,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(tolerance) if TOLERANCES.contains(&tolerance) => Ok(tolerance),
        _ => Err("a tolerance is a number from 1e-13 to 1e-3 (radians)".into()),
    }
}

/// A method whose options are checked; what it needs is there, or is known to be makable.
#[derive(Debug)]
pub(super) enum Checked {
    /// Ready.
    Ready(Method),
    /// The table of that name is yet to be made.
    TableMissing { name: &'static str, path: PathBuf },
}

/// A method, ready to follow rays.
#[derive(Debug)]
pub(super) enum Method {
    Table(AnyTable),
    /// In place of a table, where no table is good enough.
    NoTable,
    Exact,
    Integrate(Adaptive),
}

/// A table: a file that is mapped, or numbers in memory.
#[derive(Debug)]
pub(super) enum AnyTable {
    Mapped(Table<Mmap>),
    Held(Table<Memory>),
}

impl AnyTable {
    /// The table, ready for lookups.
    pub(super) fn lookup(&self) -> Lookup<'_> {
        match self {
            Self::Mapped(table) => table.lookup(),
            Self::Held(table) => table.lookup(),
        }
    }

    /// The table's file.
    pub(super) fn bytes(&self) -> &[u8] {
        match self {
            Self::Mapped(table) => table.bytes(),
            Self::Held(table) => table.bytes(),
        }
    }

    pub(super) fn metadata(&self) -> &Metadata {
        match self {
            Self::Mapped(table) => table.metadata(),
            Self::Held(table) => table.metadata(),
        }
    }
}

impl MethodArgs {
    /// Checks the options, and the table's file to its last byte. Where nobody names a table, the one called `needed`
    /// is taken, which is none where no table is good enough.
    ///
    /// # Errors
    /// A misuse, or a table that cannot be read. A damaged table is never replaced unasked, nor is one made where the
    /// user names a file: only the default one is.
    pub(super) fn check(&self, needed: Option<&'static str>) -> anyhow::Result<Checked> {
        if self.integrate_tolerance.is_some() && self.method != MethodName::Integrate {
            return Err(misuse("--integrate-tolerance needs --method integrate"));
        }
        if self.no_mmap && self.method != MethodName::Table {
            return Err(misuse("--no-mmap needs --method table"));
        }
        let method = match self.method {
            MethodName::Exact => Method::Exact,
            MethodName::Integrate => Method::Integrate(
                self.integrate_tolerance
                    .map_or_else(Adaptive::default, Adaptive::new),
            ),
            MethodName::Table => {
                let Some(place) = self.place(needed) else {
                    return Ok(Checked::Ready(Method::NoTable));
                };
                let opened = if self.no_mmap {
                    table::read(&place.path).map(AnyTable::Held)
                } else {
                    table::open(&place.path).map(AnyTable::Mapped)
                };
                match (opened, needed) {
                    (Ok(table), _) => Method::Table(table),
                    (Err(TableError::Missing { path }), Some(name))
                        if place.origin == Origin::Default =>
                    {
                        return Ok(Checked::TableMissing { name, path });
                    }
                    (Err(error), _) if place.origin == Origin::Variable => {
                        anyhow::bail!(
                            "{error} (the environment's {TABLE_VARIABLE} names this file)"
                        )
                    }
                    (Err(error), _) => return Err(error.into()),
                }
            }
        };
        Ok(Checked::Ready(method))
    }

    /// Whether rays are read from a table, or from curves drawn with one.
    pub(super) fn is_table(&self) -> bool {
        self.method == MethodName::Table
    }

    /// The table's file, where the method reads one.
    pub(super) fn table_path(&self, needed: Option<&'static str>) -> Option<PathBuf> {
        let place = self.is_table().then(|| self.place(needed))?;
        place.map(|place| place.path)
    }

    /// Flag, environment, default. An empty variable counts as none, as everywhere.
    fn place(&self, needed: Option<&str>) -> Option<Place> {
        let variable = || std::env::var_os(TABLE_VARIABLE).filter(|name| !name.is_empty());
        let flag = self.table.clone().map(|path| (path, Origin::Flag));
        let named = flag.or_else(|| variable().map(|path| (path.into(), Origin::Variable)));
        let default = || needed.map(|name| (table::default_path(name), Origin::Default));
        let (path, origin) = named.or_else(default)?;
        Some(Place { path, origin })
    }
}

/// A table's file, and who named it.
struct Place {
    path: PathBuf,
    origin: Origin,
}

#[derive(Debug, PartialEq, Eq)]
enum Origin {
    Flag,
    Variable,
    Default,
}

impl Checked {
    /// The method, if nothing is missing.
    ///
    /// # Errors
    /// [`TableError::Missing`]
    pub(super) fn without_making(self) -> Result<Method, TableError> {
        match self {
            Self::Ready(method) => Ok(method),
            Self::TableMissing { path, .. } => Err(TableError::Missing { path }),
        }
    }

    /// The method, after its table is made where it is missing.
    ///
    /// # Errors
    /// A table that cannot be made.
    pub(super) fn ready(self, report: Report) -> anyhow::Result<Method> {
        let (name, path) = match self {
            Self::Ready(method) => return Ok(method),
            Self::TableMissing { name, path } => (name, path),
        };
        report.note(format_args!(
            "{} is not there yet: making it, this once",
            path.display()
        ));
        let table = make(&spec(name)?, report)?;
        if let Err(error) = table::save(&table, &path) {
            let reason = match error {
                TableError::Unwritable { source, .. } => source.to_string(),
                other => other.to_string(),
            };
            warn(format_args!(
                "{}: the table cannot be kept ({reason}); this run goes on with it in memory, the next will have to make it again",
                path.display()
            ));
        }
        Ok(Method::Table(AnyTable::Held(table)))
    }
}

impl Method {
    /// What a frame's bytes depend on, beside its scene: the SHA-256 of the table's file, or the method in place of one.
    pub(super) fn fingerprint(&self) -> String {
        match self {
            Self::Table(table) => hex(table.bytes()),
            Self::NoTable => "none, exact curves".into(),
            Self::Exact => "none, exact rays".into(),
            Self::Integrate(method) => format!("none, integrated to {:e}", method.tolerance),
        }
    }
}

/// The SHA-256 of some bytes, as hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write;

    use sha2::Digest;
    let digest = sha2::Sha256::digest(bytes);
    digest.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Table(table) => {
                let metadata = table.metadata();
                let error = metadata.measured_error;
                write!(f, "table {} (error {error:.1e})", metadata.spec.name)
            }
            Self::NoTable => write!(f, "exact curves"),
            Self::Exact => write!(f, "exact"),
            Self::Integrate(method) => write!(f, "integrate (tolerance {:e})", method.tolerance),
        }
    }
}

/// The specification called `name`.
///
/// # Errors
/// A name that is none of [`Spec::NAMES`].
pub(super) fn spec(name: &str) -> anyhow::Result<Spec> {
    Spec::named(name).ok_or_else(|| {
        anyhow::anyhow!(
            "there is no specification of a table called {name}, only {}",
            Spec::NAMES.join(", ")
        )
    })
}

/// Makes a table, with a bar.
///
/// # Errors
/// A grid that no table can have.
pub(super) fn make(spec: &Spec, report: Report) -> anyhow::Result<Table<Memory>> {
    let bar = report.bar(0, "making the table", "rows");
    let made = table::generate(spec, &|_, total| {
        bar.set_length(total);
        // Threads finish rows in any order; counted here, the bar never runs backwards.
        bar.inc(1);
    });
    made.ok_or_else(|| {
        anyhow::anyhow!(
            "the table {} asks for a grid that no table can have",
            spec.name
        )
    })
}
