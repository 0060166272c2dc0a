//! Makes tables: evaluates each chart's function on its nodes, then computes the splines through them.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::charts::{self, CriticalRow};
use super::file::Table;
use super::format::{CONVENTIONS, Metadata};
use super::lookup::Lookup;
use super::measure::{MeasuredError, measure};
use super::spec::{Axes, Spec, SpecError};
use super::spline;

/// Called with the rows of nodes done, and how many there are.
pub type RowProgress<'a> = dyn Fn(u64, u64) + Sync + 'a;

impl Table {
    /// Makes the table that `spec` describes, on all threads of the current rayon pool, and measures its error. The
    /// draft takes milliseconds, the standard table tens of milliseconds, the fine one a second or more.
    ///
    /// ```
    /// use darkness::orbit::Ray;
    /// use darkness::table::{Spec, Table};
    ///
    /// let table = Table::generate(&Spec::standard())?;
    /// let events = table.trace(Ray::new(1.0 / 30.0, 0.3)?, &[3.0, 12.0])?;
    /// assert_eq!(events.len(), 5); // in through 12 and 3, out through 3 and 12, escape
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SpecError`] where no table can have this specification.
    pub fn generate(spec: &Spec) -> Result<Self, SpecError> {
        Self::generate_with_progress(spec, &|_, _| ())
    }

    /// Makes the table that `spec` describes, as [`generate`](Self::generate) does, and reports each row done. Threads
    /// finish rows in any order.
    ///
    /// # Errors
    /// [`SpecError`] where no table can have this specification.
    pub fn generate_with_progress(
        spec: &Spec,
        progress: &RowProgress<'_>,
    ) -> Result<Self, SpecError> {
        if !spec.is_sound() {
            return Err(SpecError);
        }
        let total = spec.rows();
        let done = AtomicU64::new(0);
        let numbers = numbers(spec, &|| {
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
        });
        let lookup = Lookup::new(spec, &numbers, spec.tolerance);
        let MeasuredError { error, angles } = measure(spec, &lookup);
        let metadata = Metadata {
            conventions: CONVENTIONS.into(),
            spec: spec.clone(),
            measured_error: error,
            measured_angles: angles,
        };
        // Metadata is too long only where the name is.
        Self::from_numbers(metadata, &numbers).ok_or(SpecError)
    }
}

/// Computes all numbers of the table that `spec` describes, chart after chart. Calls `row_done` for each row of nodes.
fn numbers(spec: &Spec, row_done: &(dyn Fn() + Sync)) -> Vec<f64> {
    let axis = spec.critical_axes().orbit;
    let amplitudes: Vec<f64> = (0..axis.nodes)
        .map(|i| CriticalRow::new(axis.node(i)).amplitude())
        .collect();
    let mut numbers = spline::coefficients(&amplitudes);
    numbers.extend(chart(spec.critical_axes(), row_done, |e| {
        let row = CriticalRow::new(e);
        move |gamma| row.value(gamma)
    }));
    numbers.extend(chart(spec.weak_axes(), row_done, |t| {
        move |v| charts::weak(v, t)
    }));
    numbers.extend(chart(spec.trapped_axes(), row_done, |t| {
        move |u| charts::trapped(u, t)
    }));
    numbers.extend(chart(spec.radial_axes(), row_done, |b2| {
        move |u| charts::radial(u, b2)
    }));
    numbers
}

/// Computes one chart's coefficients. `row` returns, for a node of the orbit's axis, the stored function of the place.
/// Each node's value depends on that node alone, so that the result does not depend on the threads.
fn chart<F: Fn(f64) -> f64>(
    axes: Axes,
    row_done: &(dyn Fn() + Sync),
    row: impl Fn(f64) -> F + Sync,
) -> Vec<f64> {
    let values: Vec<Vec<f64>> = (0..axes.orbit.nodes)
        .into_par_iter()
        .map(|i| {
            let function = row(axes.orbit.node(i));
            let values = (0..axes.place.nodes)
                .map(|j| function(axes.place.node(j)))
                .collect();
            row_done();
            values
        })
        .collect();
    spline::coefficients_2d(&values.concat(), axes.place.nodes as usize)
}
