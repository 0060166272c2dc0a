//! Making a table: every chart's function on its nodes, then their splines.

use rayon::prelude::*;

use super::charts::{self, CriticalRow};
use super::spec::{Axes, Spec};
use super::spline;

/// All numbers of the table that `spec` describes, chart after chart; `row_done` is called once for each row of nodes
/// (see [`rows`]).
pub(crate) fn numbers(spec: &Spec, row_done: &(dyn Fn() + Sync)) -> Vec<f64> {
    let axis = spec.amplitude_axis();
    let amplitudes: Vec<f64> = (0..axis.nodes).map(|i| CriticalRow::new(axis.node(i)).amplitude()).collect();
    let mut numbers = spline::coefficients(&amplitudes);
    numbers.extend(chart(spec.critical_axes(), row_done, |e| {
        let row = CriticalRow::new(e);
        move |gamma| row.value(gamma)
    }));
    numbers.extend(chart(spec.weak_axes(), row_done, |t| move |v| charts::weak(v, t)));
    numbers.extend(chart(spec.trapped_axes(), row_done, |t| move |u| charts::trapped(u, t)));
    numbers.extend(chart(spec.radial_axes(), row_done, |b2| move |u| charts::radial(u, b2)));
    numbers
}

/// How many rows of nodes the table has.
pub(crate) fn rows(spec: &Spec) -> u64 {
    [spec.critical, spec.weak, spec.trapped, spec.radial].iter().map(|n| u64::from(n.orbit)).sum()
}

/// One chart's coefficients. `row` makes, of a node on the orbit's axis, the stored function of the place. Each node's value depends on that
/// node alone, so the threads' number and order change nothing.
fn chart<F: Fn(f64) -> f64>(axes: Axes, row_done: &(dyn Fn() + Sync), row: impl Fn(f64) -> F + Sync) -> Vec<f64> {
    let values: Vec<Vec<f64>> = (0..axes.orbit.nodes)
        .into_par_iter()
        .map(|i| {
            let function = row(axes.orbit.node(i));
            let values = (0..axes.place.nodes).map(|j| function(axes.place.node(j))).collect();
            row_done();
            values
        })
        .collect();
    spline::coefficients_2d(&values.concat(), axes.place.nodes as usize)
}
