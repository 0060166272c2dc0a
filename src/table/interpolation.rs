//! How a table is read between its nodes: by cubic splines, as every table file is, or in the two ways they are to be
//! compared with.

use wide::f64x2;

use super::generate::numbers;
use super::lookup::Lookup;
use super::measure::{Measured, measure};
use super::spec::Spec;
use super::spline::{self, Scale, Stencil, StencilPair};

/// A way to read between nodes: [`Cubic`], [`Linear`] or [`Nearest`].
pub trait Interpolation: kernel::Kernel {}

/// Cubic splines (see `spline.rs`): sixteen numbers a value.
#[derive(Debug, Clone, Copy)]
pub struct Cubic;

/// Straight lines along both axes: four numbers a value.
#[derive(Debug, Clone, Copy)]
pub struct Linear;

/// The nearest node's value: one number.
#[derive(Debug, Clone, Copy)]
pub struct Nearest;

impl Interpolation for Cubic {}
impl Interpolation for Linear {}
impl Interpolation for Nearest {}

/// The four charts on a grid of any size, in memory only, read in any way: what tells the charts' share of a table's
/// accuracy from the splines'.
#[derive(Debug, Clone)]
pub struct Grid<K> {
    spec: Spec,
    numbers: Vec<f64>,
    kernel: K,
    /// The largest error of a swept angle.
    error: f64,
}

impl<K: Interpolation> Grid<K> {
    /// The charts on the nodes of `spec`, and what error their angles have; `None` where it asks for a grid that no
    /// table can have.
    pub fn new(spec: &Spec, kernel: K) -> Option<Self> {
        spec.is_sound().then(|| {
            let numbers = numbers::<K>(spec, &|| ());
            let lookup = Lookup::new(spec, &numbers, spec.tolerance, kernel);
            let Measured { error, .. } = measure(spec, &lookup);
            Self {
                spec: spec.clone(),
                numbers,
                kernel,
                error,
            }
        })
    }

    /// The grid, ready for lookups.
    pub fn lookup(&self) -> Lookup<'_, K> {
        Lookup::new(&self.spec, &self.numbers, self.error, self.kernel)
    }

    /// How many bytes its numbers take.
    pub fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice())
    }
}

/// The parts of an interpolation that a lookup is put together from.
pub(super) mod kernel {
    use super::{Scale, f64x2};

    /// Numbers kept for the nodes, where to find those about a place, and how to weigh them.
    pub trait Kernel: core::fmt::Debug + Copy + Send + Sync {
        /// How many numbers an axis has beyond one a node.
        const BEYOND: usize;
        /// What is found of one place on one axis.
        type Place: Copy;
        /// The same of two places, side by side.
        type Places: Copy;

        /// The place `x` on `axis`.
        fn place(axis: Scale, x: f64) -> Self::Place;
        /// The places `x` on `axis`.
        fn places(axis: Scale, x: f64x2) -> Self::Places;
        /// The value of a function of one variable.
        fn value(numbers: &[f64], place: &Self::Place) -> f64;
        /// The values, at two columns of one row, of a function of two variables, stored in rows of `width`.
        fn values_2d(
            numbers: &[f64],
            width: usize,
            row: &Self::Place,
            columns: &Self::Places,
        ) -> f64x2;
        /// What is kept of a function's `values` on the nodes.
        fn keep(values: Vec<f64>) -> Vec<f64>;
        /// What is kept of the `values` of a function of two variables, in rows of `columns` nodes.
        fn keep_2d(values: Vec<f64>, columns: usize) -> Vec<f64>;
    }
}

impl kernel::Kernel for Cubic {
    const BEYOND: usize = 2;
    type Place = Stencil;
    type Places = StencilPair;

    #[inline(always)]
    fn place(axis: Scale, x: f64) -> Stencil {
        axis.stencil(x)
    }

    #[inline(always)]
    fn places(axis: Scale, x: f64x2) -> StencilPair {
        axis.stencils(x)
    }

    #[inline(always)]
    fn value(numbers: &[f64], place: &Stencil) -> f64 {
        spline::value(numbers, place)
    }

    #[inline(always)]
    fn values_2d(numbers: &[f64], width: usize, row: &Stencil, columns: &StencilPair) -> f64x2 {
        spline::values_2d(numbers, width, row, columns)
    }

    fn keep(values: Vec<f64>) -> Vec<f64> {
        spline::coefficients(&values)
    }

    fn keep_2d(values: Vec<f64>, columns: usize) -> Vec<f64> {
        spline::coefficients_2d(&values, columns)
    }
}

impl kernel::Kernel for Linear {
    const BEYOND: usize = 0;
    /// A cell, and how much of it lies before the place.
    type Place = (usize, f64);
    type Places = [(usize, f64); 2];

    #[inline(always)]
    fn place(axis: Scale, x: f64) -> Self::Place {
        axis.cell_and_share(x)
    }

    #[inline(always)]
    fn places(axis: Scale, x: f64x2) -> Self::Places {
        x.to_array().map(|x| axis.cell_and_share(x))
    }

    #[inline(always)]
    fn value(numbers: &[f64], &(cell, share): &Self::Place) -> f64 {
        let n = &numbers[cell..cell + 2];
        n[0] + share * (n[1] - n[0])
    }

    #[inline(always)]
    fn values_2d(
        numbers: &[f64],
        width: usize,
        &(row, share): &Self::Place,
        columns: &Self::Places,
    ) -> f64x2 {
        f64x2::new(columns.map(|column| {
            let first = Self::value(&numbers[row * width..], &column);
            let second = Self::value(&numbers[(row + 1) * width..], &column);
            first + share * (second - first)
        }))
    }

    fn keep(values: Vec<f64>) -> Vec<f64> {
        values
    }

    fn keep_2d(values: Vec<f64>, _: usize) -> Vec<f64> {
        values
    }
}

impl kernel::Kernel for Nearest {
    const BEYOND: usize = 0;
    type Place = usize;
    type Places = [usize; 2];

    #[inline(always)]
    fn place(axis: Scale, x: f64) -> usize {
        axis.nearest(x)
    }

    #[inline(always)]
    fn places(axis: Scale, x: f64x2) -> [usize; 2] {
        x.to_array().map(|x| axis.nearest(x))
    }

    #[inline(always)]
    fn value(numbers: &[f64], &node: &usize) -> f64 {
        numbers[node]
    }

    #[inline(always)]
    fn values_2d(numbers: &[f64], width: usize, &row: &usize, columns: &[usize; 2]) -> f64x2 {
        f64x2::new(columns.map(|column| numbers[row * width + column]))
    }

    fn keep(values: Vec<f64>) -> Vec<f64> {
        values
    }

    fn keep_2d(values: Vec<f64>, _: usize) -> Vec<f64> {
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::exact::Exact;
    use crate::orbit::{Orbits, Ray};

    /// The largest error on some rays that cross r = 6, on the standard grid with `factor` as many nodes.
    fn worst(kernel: impl Interpolation, factor: f64) -> f64 {
        let spec = Spec::named("standard").unwrap().scaled(factor);
        let grid = Grid::new(&spec, kernel).unwrap();
        let lookup = grid.lookup();
        let rays = (1..400).map(|i| Ray::new(0.03, 0.01 * f64::from(i)).unwrap());
        let errors = rays.filter_map(|ray| {
            let truth = Exact.first_crossing(ray, 6.0).unwrap()?;
            let found = lookup.first_crossing(ray, 6.0).unwrap().unwrap();
            Some((found - truth).abs())
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn errors_fall_by_each_ways_order() {
        for (name, ratio, orders) in [
            (
                "nearest",
                worst(Nearest, 0.5) / worst(Nearest, 2.0),
                0.5..1.7,
            ),
            ("linear", worst(Linear, 0.5) / worst(Linear, 2.0), 1.5..2.5),
            ("cubic", worst(Cubic, 0.5) / worst(Cubic, 2.0), 3.4..4.8),
        ] {
            let order = 0.5 * libm::log2(ratio);
            assert!(orders.contains(&order), "{name}: {order}");
        }
    }
}
