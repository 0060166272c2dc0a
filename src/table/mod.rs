//! The table: every ray's swept angles, solved once over a dense grid and read from a mapped file ever after.
//!
//! No disk and no camera is in it: it answers the same question as every other method (see [`crate::orbit`]), for all
//! rays outside the horizon. [`charts`] says what is stored and why that is smooth, [`mod@format`] draws the file;
//! between the nodes run cubic splines.

#[cfg(target_endian = "big")]
compile_error!(
    "a table's numbers are read in place as little-endian f64: darkness needs a little-endian machine"
);

pub mod charts;
mod file;
pub mod format;
mod generate;
mod interpolation;
mod logarithm;
mod lookup;
mod measure;
mod spec;
pub(crate) mod spline;

pub use file::{TableError, default_path, open, read, save};
pub use format::{FormatError, Metadata};
pub use generate::{Progress, generate};
pub use interpolation::{Cubic, Grid, Interpolation, Linear, Nearest};
pub use lookup::Lookup;
pub use measure::{Measured, measure};
pub use spec::{Nodes, Spec};

use crate::orbit::{Event, OrbitError, Orbits, Ray, TurningPoint};
use format::Layout;

/// A table over bytes that begin at a multiple of 8: a mapped file, or [`Memory`].
#[derive(Debug)]
pub struct Table<B> {
    bytes: B,
    layout: Layout,
}

/// The bytes of a table that is not in a file: aligned for its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Memory(Vec<u64>);

impl AsRef<[u8]> for Memory {
    fn as_ref(&self) -> &[u8] {
        bytemuck::cast_slice(&self.0)
    }
}

/// Bytes that stay where they are in memory while their owner moves, so that numbers aligned once stay aligned. An
/// array within its owner is none.
pub trait FixedBytes: AsRef<[u8]> {}

impl FixedBytes for memmap2::Mmap {}
impl FixedBytes for Memory {}
impl FixedBytes for &[u8] {}
impl FixedBytes for Vec<u8> {}
impl FixedBytes for Box<[u8]> {}

impl<B: FixedBytes> Table<B> {
    /// A table from its bytes, every one of which is checked: see [`mod@format`].
    ///
    /// # Errors
    /// [`FormatError`]: what is wrong with the bytes.
    pub fn from_bytes(bytes: B) -> Result<Self, FormatError> {
        let layout = format::parse(bytes.as_ref())?;
        Ok(Self { bytes, layout })
    }

    /// What the table says of itself.
    pub fn metadata(&self) -> &Metadata {
        &self.layout.metadata
    }

    /// The whole file.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.as_ref()
    }

    /// The table, ready for lookups. Take it once, outside the loop.
    pub fn lookup(&self) -> Lookup<'_> {
        // The cast was checked when the table was opened, and the bytes are where they were.
        let numbers = format::numbers(self.bytes(), self.layout.numbers_at).unwrap_or_default();
        let metadata = &self.layout.metadata;
        Lookup::new(&metadata.spec, numbers, metadata.measured_error, Cubic)
    }
}

impl<B: FixedBytes + Sync> Orbits for Table<B> {
    fn follow(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError> {
        self.lookup().follow(ray, radii)
    }

    fn turning_point(&self, ray: Ray) -> Result<Option<TurningPoint>, OrbitError> {
        self.lookup().turning_point(ray)
    }

    fn first_crossing(&self, ray: Ray, radius: f64) -> Result<Option<f64>, OrbitError> {
        self.lookup().first_crossing(ray, radius)
    }
}
