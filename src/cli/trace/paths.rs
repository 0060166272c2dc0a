//! The rows of `trace --paths`: points of a ray's path.

use std::fmt::Write;

use super::csv_field;
use crate::cli::rays::ListedRay;
use crate::orbit::{OrbitError, arc_points};

pub(super) const HEADER: &str = "id,phi,r,x,y";

/// The header of paths in a scene's space.
pub(super) const SCENE_HEADER: &str = "id,phi,r,x,y,scene_x,scene_y,scene_z";

/// The radius at which the path of an escaping ray ends at least, where none is given, in Schwarzschild radii.
const LEAST_END: f64 = 30.0;

/// The radius beyond which no path goes.
const FARTHEST: f64 = 1e100;

/// Appends the rows of one ray: `count` points from its start to the horizon, or to the radius `farthest`.
///
/// # Errors
/// Those of [`arc_points`].
pub(super) fn write_path(
    listed: &ListedRay,
    count: usize,
    farthest: Option<f64>,
    rows: &mut String,
) -> Result<(), OrbitError> {
    let farthest = farthest.unwrap_or((2.0 / listed.ray.u()).clamp(LEAST_END, FARTHEST));
    let id = csv_field(&listed.id);
    for point in arc_points(listed.ray, count, farthest)? {
        let (phi, r) = (point.angle, point.radius());
        let (sine, cosine) = libm::sincos(phi);
        let (x, y) = (r * cosine, r * sine);
        // Writing to a string does not fail.
        let _ = write!(rows, "{id},{phi:?},{r:?},{x:?},{y:?}");
        if let Some([start, across]) = listed.plane {
            let place = start * x + across * y;
            let _ = write!(rows, ",{:?},{:?},{:?}", place.x, place.y, place.z);
        }
        rows.push('\n');
    }
    Ok(())
}
