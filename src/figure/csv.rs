//! The points of curves as CSV.

use std::io::{self, Write};

use kurbo::{BezPath, PathEl};

use super::contour::Contour;
use crate::scene::View;

/// Between two rows a curve is at most this far from a straight line, in pixels.
const FLAT: f64 = 5e-3;

/// Writes one row for each point of the curves, after a header: `curve,quantity,level,order,closed,x,y,b,alpha`.
///
/// * `curve`: the number of the connected curve, from 1. Its points follow one another, and a closed curve ends with
///   its first point. Straight lines between them are at most 0.01 pixels from the exact curve.
/// * `quantity`, `level`: what is constant along it: `radius` in Schwarzschild radii, `redshift` as g = 1/(1 + z),
///   `flux` as `g⁴ F/F_max`.
/// * `order`: 0 for the direct image, 1 for the ghost image. `closed`: true or false.
/// * `x`, `y`: pixels from the picture's left and top.
/// * `b`: the ray's impact parameter in Schwarzschild radii. `alpha`: the azimuth in radians about the hole in the
///   picture, counterclockwise from where the near side of the disk is seen, −π to π.
///
/// # Errors
/// Those of `out`.
pub fn write_csv(contours: &[Contour], view: &View, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "curve,quantity,level,order,closed,x,y,b,alpha")?;
    let mut curve = 0;
    for contour in contours {
        let (name, value, order) = (
            contour.level.quantity.name(),
            contour.level.value,
            contour.order,
        );
        for (closed, points) in polylines(&contour.path) {
            curve += 1;
            for (x, y) in points {
                let (b, alpha) = on_the_plate(view, x, y);
                writeln!(
                    out,
                    "{curve},{name},{value},{order},{closed},{x:.5},{y:.5},{b:.9e},{alpha:.9}"
                )?;
            }
        }
    }
    Ok(())
}

/// Returns the points of each subpath, and whether it is closed.
fn polylines(path: &BezPath) -> Vec<(bool, Vec<(f64, f64)>)> {
    let mut lines: Vec<(bool, Vec<(f64, f64)>)> = Vec::new();
    kurbo::flatten(path.iter(), FLAT, |element| {
        match (element, lines.last_mut()) {
            (PathEl::MoveTo(point), _) => lines.push((false, vec![point.into()])),
            (PathEl::LineTo(point), Some((_, points))) => points.push(point.into()),
            (PathEl::ClosePath, Some((closed, points))) => {
                *closed = true;
                // The last point is the first up to rounding.
                let first = points[0];
                if let Some(last) = points.last_mut() {
                    *last = first;
                }
            }
            _ => {}
        }
    });
    lines
}

/// Returns the impact parameter and the azimuth of the ray at a place of the picture: Luminet's coordinates on the
/// photographic plate.
fn on_the_plate(view: &View, x: f64, y: f64) -> (f64, f64) {
    let ray = view.ray_at(view.x_at(x), view.y_at(y));
    let s = ray.transverse();
    let b = s / ((ray.z * ray.z + s * s).sqrt() * view.slope_scale());
    // φ₁ is small, so that the near side is seen, where `plane_slope t_a` is positive. b̂ is to the left where â is up.
    let side = 1.0_f64.copysign(view.plane_slope());
    (b, libm::atan2(side * ray.tb, side * ray.ta))
}
