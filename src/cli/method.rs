//! The method by which rays are followed, and the table that it may need.

use std::fmt;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::misuse::misuse;
use super::progress::{Report, warn};
use super::remedy::with_remedy;
use super::table_path::default_path;
use crate::orbit::integrate::Adaptive;
use crate::table::{Spec, SpecError, Table, TableError};

/// The table for rays of all kinds.
pub(super) const DEFAULT_TABLE: &str = "standard";

/// The environment variable that names the table where `--table` does not.
const TABLE_VARIABLE: &str = "DARKNESS_TABLE";

const TABLE_HELP: &str = "The table to read with --method table, made where it is missing: the one that the file is \
    named after, else the one that the picture needs, standard at least [env: DARKNESS_TABLE] [default: \
    standard.table; a picture that needs less or more takes draft.table or fine.table; all in the folder tables, or \
    without such a folder in the user's cache (~/.cache/darkness, or the folder that DARKNESS_CACHE names)]";

/// The tolerances that [`Adaptive`] can be given. Above them it takes the upper bound; at the lower bound its steps are
/// as short as helps.
const TOLERANCES: RangeInclusive<f64> = 1e-13..=1e-3;

/// The options of every verb that follows rays.
#[derive(Debug, Args)]
pub(super) struct MethodArgs {
    /// How rays are followed
    #[arg(long, value_name = "METHOD", value_enum, default_value_t = MethodName::Table)]
    method: MethodName,
    #[arg(long, value_name = "FILE", help = TABLE_HELP)]
    table: Option<PathBuf>,
    /// Read the table into memory instead of mapping its file: for network disks, and for files that others may cut
    /// short
    #[arg(long)]
    no_mmap: bool,
    /// The error of an angle that --method integrate aims at, in radians, 1e-13 to 1e-3. Rays that wind for more than
    /// ten radians near the photon sphere may have larger errors, or another fate [default: 1e-9]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    integrate_tolerance: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Read rays from a table, solved beforehand
    Table,
    /// Compute elliptic integrals, ray by ray
    Exact,
    /// Integrate the equation itself, ray by ray
    Integrate,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(tolerance) if TOLERANCES.contains(&tolerance) => Ok(tolerance),
        _ => Err("a tolerance is a number from 1e-13 to 1e-3 (radians)".into()),
    }
}

/// A method whose options have been checked, and what it still needs.
#[derive(Debug)]
pub(super) enum Checked {
    /// It needs nothing.
    Ready(Method),
    /// It needs the table of that name, which has to be made.
    TableMissing {
        name: &'static str,
        path: PathBuf,
        named_by: NamedBy,
    },
}

/// A method, ready to follow rays.
#[derive(Debug)]
pub(super) enum Method {
    Table(Table),
    /// Exact curves, where no table is accurate enough.
    NoTable,
    Exact,
    Integrate(Adaptive),
}

impl MethodArgs {
    /// The options of a verb that only draws with a table, perhaps a file that the user names.
    #[cfg(feature = "view")]
    pub(super) fn of_table(table: Option<PathBuf>) -> Self {
        Self {
            method: MethodName::Table,
            table,
            no_mmap: false,
            integrate_tolerance: None,
        }
    }

    /// Checks the options and every byte of the table's file. Where the user names no table, the one called `needed` is
    /// taken; it is `None` where no table is accurate enough.
    ///
    /// # Errors
    /// A misuse, or a table that cannot be read. A missing table can be made; a damaged one is never replaced.
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
                let Some(file) = self.table_file(needed) else {
                    return Ok(Checked::Ready(Method::NoTable));
                };
                let opened = if self.no_mmap {
                    Table::read(&file.path)
                } else {
                    Table::open(&file.path)
                };
                match opened {
                    Ok(table) => Method::Table(table),
                    Err(TableError::Missing { path }) => {
                        return Ok(Checked::TableMissing {
                            name: file.table_name(needed),
                            path,
                            named_by: file.named_by,
                        });
                    }
                    Err(error) => return Err(file.named_by.refuse(&error)),
                }
            }
        };
        Ok(Checked::Ready(method))
    }

    /// Returns whether rays are read from a table, or from curves made with one.
    pub(super) fn is_table(&self) -> bool {
        self.method == MethodName::Table
    }

    /// Returns the path of the table's file, where the method reads one.
    pub(super) fn table_path(&self, needed: Option<&'static str>) -> Option<PathBuf> {
        let file = self.is_table().then(|| self.table_file(needed))?;
        file.map(|file| file.path)
    }

    /// Finds the table's file: named by the flag, by the environment, or by default. An empty variable counts as none.
    fn table_file(&self, needed: Option<&str>) -> Option<TableFile> {
        let variable = || std::env::var_os(TABLE_VARIABLE).filter(|name| !name.is_empty());
        let flag = self.table.clone().map(|path| (path, NamedBy::Flag));
        let named = flag.or_else(|| variable().map(|path| (path.into(), NamedBy::Variable)));
        let default = || needed.map(|name| (default_path(name), NamedBy::Default));
        let (path, named_by) = named.or_else(default)?;
        Some(TableFile { path, named_by })
    }
}

/// A table's file, and what named it.
struct TableFile {
    path: PathBuf,
    named_by: NamedBy,
}

impl TableFile {
    /// Returns the name of the table that is made here: the one that the file is named after. Else it is the one that
    /// is needed, but at least the standard one, which serves other pictures too.
    fn table_name(&self, needed: Option<&'static str>) -> &'static str {
        let stem = self.path.file_stem().unwrap_or_default();
        let of_file = Spec::NAMES.into_iter().find(|&name| stem == name);
        of_file.unwrap_or(match needed {
            Some("draft") => DEFAULT_TABLE,
            Some(name) => name,
            None => "fine",
        })
    }
}

/// What named a table's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NamedBy {
    Flag,
    Variable,
    Default,
}

impl NamedBy {
    /// Returns the error of a table's file, with what can be done about it.
    fn refuse(self, error: &TableError) -> anyhow::Error {
        let error = with_remedy(error);
        match self {
            Self::Variable => {
                anyhow::anyhow!("{error} (the environment's {TABLE_VARIABLE} names this file)")
            }
            Self::Flag | Self::Default => error,
        }
    }
}

impl Checked {
    /// Returns the method, if nothing is missing.
    ///
    /// # Errors
    /// A table that is missing.
    pub(super) fn without_making(self) -> anyhow::Result<Method> {
        match self {
            Self::Ready(method) => Ok(method),
            Self::TableMissing { path, named_by, .. } => {
                Err(named_by.refuse(&TableError::Missing { path }))
            }
        }
    }

    /// Returns the method, and makes its table first where it is missing.
    ///
    /// # Errors
    /// A table that cannot be made.
    pub(super) fn ready(self, report: Report) -> anyhow::Result<Method> {
        let (name, path) = match self {
            Self::Ready(method) => return Ok(method),
            Self::TableMissing { name, path, .. } => (name, path),
        };
        report.note(format_args!(
            "{} is not there yet: making the {name} table, once",
            path.display()
        ));
        let table = make(&spec(name)?, report)?;
        if let Err(error) = table.save(&path) {
            let reason = match error {
                TableError::Unwritable { source, .. } => source.to_string(),
                other => other.to_string(),
            };
            warn(format_args!(
                "{}: the table cannot be kept ({reason}); this run uses it from memory, and the next will make it \
                 again",
                path.display()
            ));
        }
        Ok(Method::Table(table))
    }
}

impl Method {
    /// Returns what a frame's bytes depend on besides its scene: the SHA-256 of the table's file, or the method's name.
    pub(super) fn fingerprint(&self) -> String {
        match self {
            Self::Table(table) => hex(table.bytes()),
            Self::NoTable => "none, exact curves".into(),
            Self::Exact => "none, exact rays".into(),
            Self::Integrate(method) => format!("none, integrated to {:e}", method.tolerance),
        }
    }
}

/// Returns the SHA-256 of some bytes, in hexadecimal.
pub(super) fn hex(bytes: &[u8]) -> String {
    use sha2::Digest;
    digits(&sha2::Sha256::digest(bytes))
}

/// Returns bytes as hexadecimal digits.
pub(super) fn digits(bytes: &[u8]) -> String {
    use std::fmt::Write;

    bytes.iter().fold(String::new(), |mut text, byte| {
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

/// Returns the specification called `name`.
///
/// # Errors
/// A name that is not one of [`Spec::NAMES`].
pub(super) fn spec(name: &str) -> anyhow::Result<Spec> {
    Spec::named(name).ok_or_else(|| {
        anyhow::anyhow!(
            "there is no table called {name}; the tables are {}",
            Spec::NAMES.join(", ")
        )
    })
}

/// Makes a table and shows a progress bar.
///
/// # Errors
/// A specification that no table can have.
pub(super) fn make(spec: &Spec, report: Report) -> Result<Table, SpecError> {
    let bar = report.bar(0, "making the table", "rows");
    Table::generate_with_progress(spec, &|_, total| {
        bar.set_length(total);
        // Threads finish rows in any order. Counted here, the bar never runs backwards.
        bar.inc(1);
    })
}
