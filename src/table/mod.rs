//! The table.

mod charts;
pub mod generate;
pub mod lookup;
pub mod spec;
mod spline;
pub fn tmp_numbers(spec: &spec::Spec) -> Vec<f64> { generate::numbers(spec, &||()) }
pub fn tmp_lookup<'a>(spec: &spec::Spec, n: &'a [f64]) -> lookup::Lookup<'a> { lookup::Lookup::new(spec, n) }
