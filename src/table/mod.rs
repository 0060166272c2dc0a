//! The table: the swept angles of every ray, solved once over a dense grid and read from a mapped file.
//!
//! A table holds no disk and no camera. It answers the same question as every other method (see [`crate::orbit`]),
//! for all rays outside the horizon. [`charts`] says what is stored and why that is smooth, [`mod@format`] draws the
//! file, and cubic splines interpolate between the nodes.

#[cfg(target_endian = "big")]
compile_error!(
    "a table's numbers are read in place as little-endian f64: darkness needs a little-endian machine"
);

pub mod charts;
mod file;
pub mod format;
mod generate;
mod logarithm;
mod lookup;
mod measure;
mod spec;
pub(crate) mod spline;

pub use file::{Table, TableError};
pub use format::{FormatError, Metadata};
pub use generate::RowProgress;
pub use lookup::Lookup;
pub use measure::{MeasuredError, measure};
pub use spec::{ChartNodes, Spec, SpecError};
