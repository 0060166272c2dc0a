//! Luminet's figure: curves of constant radius, redshift and flux in a picture, as Bézier paths.
//!
//! J.-P. Luminet, *Image of a spherical black hole with thin accretion disk*, Astronomy and Astrophysics 75, 228
//! (1979), figures 5 to 10. [`contours`] returns the curves, [`svg`] draws them, [`write_csv`] writes their points.
//! [`crate::render::disk_outline`] returns the outline of the disk itself.
//!
//! | quantity | what is constant | how it is found |
//! |---|---|---|
//! | [`Quantity::Radius`] | r, in Schwarzschild radii | one isoradial curve, point by point |
//! | [`Quantity::Redshift`] | g, the ratio of observed to emitted frequency, 1/(1 + z) | roots along isoradial curves |
//! | [`Quantity::Flux`] | `g⁴ F/F_max`, the observed bolometric flux | roots along isoradial curves |
//!
//! # Accuracy
//! Every point that a path interpolates is exact up to rounding: it comes from elliptic integrals, by
//! [`crate::isoradial::height_at`]. Between these points
//! a cubic is at most [`TOLERANCE`] pixels off, as measured at three more exact points.

mod contour;
mod csv;
mod disk_image;
mod level;
mod pen;
mod svg;

pub use contour::{Contour, Level, Quantity, contours};
pub use csv::write_csv;
pub use kurbo;
pub use svg::{Paper, outline_svg, svg};

/// How far a path may be from the exact curve, in pixels.
pub const TOLERANCE: f64 = 1e-3;
