//! Making a table: every chart's function on its nodes, then their splines.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::charts::{self, CriticalRow};
use super::format::{self, CONVENTIONS, Layout, Metadata};
use super::interpolation::{Cubic, Interpolation};
use super::lookup::Lookup;
use super::measure::{Measured, measure};
use super::spec::{Axes, Spec};
use super::{Memory, Table};

/// Told how far the making of a table has come: rows done, of how many.
pub type Progress<'a> = dyn Fn(u64, u64) + Sync + 'a;

/// Makes the table that `spec` describes, on all threads of the current rayon pool, and measures its error.
///
/// `None` where `spec` asks for a grid that no table can have (an axis under 6 or over 4096 nodes).
///
/// ```
/// use darkness::orbit::{Orbits, Ray};
/// use darkness::table::{Spec, generate};
///
/// let spec = Spec::named("draft").ok_or("no such table")?;
/// let table = generate(&spec, &|_, _| ()).ok_or("no such grid")?;
/// let events = table.follow(Ray::new(1.0 / 30.0, 0.3)?, &[3.0, 12.0])?;
/// assert_eq!(events.len(), 5); // in through 12 and 3, out through 3 and 12, escape
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn generate(spec: &Spec, progress: &Progress<'_>) -> Option<Table<Memory>> {
    if !spec.is_sound() {
        return None;
    }
    let total = rows(spec);
    let done = AtomicU64::new(0);
    let numbers = numbers::<Cubic>(spec, &|| {
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
    });
    let lookup = Lookup::new(spec, &numbers, spec.tolerance, Cubic);
    let Measured { error, angles } = measure(spec, &lookup);
    let metadata = Metadata {
        conventions: CONVENTIONS.into(),
        spec: spec.clone(),
        measured_error: error,
        measured_angles: angles,
    };
    let numbers: &[u8] = bytemuck::cast_slice(&numbers);
    let header = format::header(&metadata, numbers)?;
    let numbers_at = header.len();
    let mut memory = vec![0; (numbers_at + numbers.len()) / 8];
    let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut memory);
    bytes[..numbers_at].copy_from_slice(&header);
    bytes[numbers_at..].copy_from_slice(numbers);
    Some(Table {
        bytes: Memory(memory),
        layout: Layout {
            metadata,
            numbers_at,
        },
    })
}

/// All numbers of the table that `spec` describes, to be read by `K`, chart after chart; `row_done` is called once for
/// each row of nodes (see [`rows`]).
pub(super) fn numbers<K: Interpolation>(spec: &Spec, row_done: &(dyn Fn() + Sync)) -> Vec<f64> {
    let axis = spec.critical_axes().orbit;
    let amplitudes: Vec<f64> = (0..axis.nodes)
        .map(|i| CriticalRow::new(axis.node(i)).amplitude())
        .collect();
    let mut numbers = K::keep(amplitudes);
    numbers.extend(chart::<K, _>(spec.critical_axes(), row_done, |e| {
        let row = CriticalRow::new(e);
        move |gamma| row.value(gamma)
    }));
    numbers.extend(chart::<K, _>(spec.weak_axes(), row_done, |t| {
        move |v| charts::weak(v, t)
    }));
    numbers.extend(chart::<K, _>(spec.trapped_axes(), row_done, |t| {
        move |u| charts::trapped(u, t)
    }));
    numbers.extend(chart::<K, _>(spec.radial_axes(), row_done, |b2| {
        move |u| charts::radial(u, b2)
    }));
    numbers
}

/// How many rows of nodes the table has.
fn rows(spec: &Spec) -> u64 {
    [spec.critical, spec.weak, spec.trapped, spec.radial]
        .iter()
        .map(|n| u64::from(n.orbit))
        .sum()
}

/// What is kept of one chart. `row` makes, of a node on the orbit's axis, the stored function of the place. Each
/// node's value depends on that node alone, so the threads' number and order change nothing.
fn chart<K: Interpolation, F: Fn(f64) -> f64>(
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
    K::keep_2d(values.concat(), axes.place.nodes as usize)
}
