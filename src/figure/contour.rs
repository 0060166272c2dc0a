//! The curves on which a quantity is constant.

use core::f64::consts::TAU;

use kurbo::{BezPath, PathEl};

use super::TOLERANCE;
use super::disk_image::{DiskImage, SeenPlace};
use super::level::LevelGrid;
use super::pen::Pen;
use crate::scene::View;

/// A curve of constant radius is drawn in so many parts at least.
const PARTS: u32 = 16;

/// What is constant along a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// The radius in the disk's plane, in Schwarzschild radii.
    Radius,
    /// g, the ratio of observed to emitted frequency: 1/(1 + z).
    Redshift,
    /// `g⁴ F/F_max`: the observed bolometric flux over the greatest one that the disk emits (Page & Thorne 1974).
    Flux,
}

impl Quantity {
    /// Returns its name: `radius`, `redshift` or `flux`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radius => "radius",
            Self::Redshift => "redshift",
            Self::Flux => "flux",
        }
    }
}

/// One value of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The quantity.
    pub quantity: Quantity,
    /// Its value: a radius above 1, or a redshift or flux above 0.
    pub value: f64,
}

/// The curve of one level in the image of one order.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// What is constant along it.
    pub level: Level,
    /// The order of the image: 0 for the direct image, 1 for the ghost image.
    pub order: u32,
    /// The curve in pixels from the picture's left and top, as one subpath for each connected part. A part that is
    /// closed ends with `ClosePath`. What is farther than some pixels beyond the picture is left out.
    pub path: BezPath,
}

impl Contour {
    /// Returns whether all its parts are closed.
    pub fn is_closed(&self) -> bool {
        let count = |of: fn(&PathEl) -> bool| self.path.iter().filter(of).count();
        count(|element| matches!(element, PathEl::ClosePath))
            == count(|element| matches!(element, PathEl::MoveTo(_)))
    }
}

/// Returns the curves of all `levels` in the images of the first `orders` orders, by rising order; levels that a view
/// does not show have none.
///
/// Curves of constant radius are whole: they do not end where another image is in front. Redshift and flux are those of
/// the disk between its radii `inner ≥ 3` and `outer`. Their curves end at its edges, and are closed where they reach
/// none. The levels are sought on a grid over the disk: a closed curve that is narrower than 1/64 of the disk's width
/// may be missed.
pub fn contours(
    view: &View,
    (inner, outer): (f64, f64),
    levels: &[Level],
    orders: u32,
) -> Vec<Contour> {
    let size = (f64::from(view.width()), f64::from(view.height()));
    let mut contours = Vec::new();
    for order in 0..orders {
        let image = DiskImage::new(view, order);
        let needs_grid = levels
            .iter()
            .any(|level| level.quantity != Quantity::Radius);
        let grid = needs_grid.then(|| LevelGrid::new(&image, (inner, outer)));
        for &level in levels {
            let mut pen = Pen::new(size, TOLERANCE);
            match (level.quantity, &grid) {
                (Quantity::Redshift, Some(grid)) => {
                    grid.draw(SeenPlace::redshift, level.value, &mut pen);
                }
                (Quantity::Flux, Some(grid)) => grid.draw(SeenPlace::flux, level.value, &mut pen),
                _ => draw_isoradial(&image, level.value, &mut pen),
            }
            let path = pen.finish();
            if !path.is_empty() {
                contours.push(Contour { level, order, path });
            }
        }
    }
    contours
}

/// Draws the curve of one radius.
fn draw_isoradial(image: &DiskImage<'_>, radius: f64, pen: &mut Pen) {
    let curve = |s: f64| image.point(&image.see(1.0 / radius, s));
    for part in 0..PARTS {
        let at = |part: u32| TAU * f64::from(part) / f64::from(PARTS);
        pen.draw(&curve, at(part), at(part + 1));
    }
}
