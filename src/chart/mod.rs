//! Speed against accuracy: measures on this machine how long every method takes and how large its errors are.
//!
//! | panel | question | compared with |
//! |---|---|---|
//! | [`rays`] | the angle swept to a ray's first crossing of a radius | the time per ray |
//! | [`critical`] | fate and total angle of a ray | the ray's distance from the critical ray |
//! | [`scene`] | the position of the disk's edges in a scene's frame | the time per frame |
//! | [`light`] | the redshift and the colour of a lit frame's pixels | the time per frame |
//!
//! Errors are differences from the exact method. The error of the exact method itself is estimated by splitting each
//! of its integrals in two. All times come from median ratios over [interleaved] repetitions on one
//! thread.

pub mod critical;
mod csv;
pub mod data;
pub mod draw;
mod exact_self_check;
mod frame_times;
pub mod interleaved;
pub mod light;
mod machine;
pub mod measurement;
pub mod methods;
mod number_format;
mod pixel_choice;
pub mod rays;
pub mod scene;
mod verdict;

pub use csv::write_csv;
pub use data::ChartData;
pub use machine::machine;
pub use measurement::{
    ChartEffort, ChartError, ChartProgress, Measurement, Panel, Quantiles, Time,
};
