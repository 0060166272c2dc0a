//! The reference rays, grouped by ray.

use crate::reference_rays::{ReferenceRay, reference_rays};

impl ReferenceRay {
    /// Describes the row, for a failing test.
    pub(crate) fn name(&self) -> String {
        format!(
            "{}, u0 = {:?}, dudphi = {:?}, {:?} at {}",
            self.case, self.u0, self.dudphi, self.kind, self.radius
        )
    }
}

/// The radii whose crossings are in the reference.
pub(crate) const RADII: [f64; 4] = [3.0, 6.0, 12.0, 30.0];

/// The reference's rays, each with all its events in the order they happen.
pub(crate) fn flights() -> Vec<Vec<ReferenceRay>> {
    let rows = reference_rays();
    assert!(rows.len() > 2000, "only {} rows", rows.len());
    let same_ray = |a: &ReferenceRay, b: &ReferenceRay| {
        a.u0.to_bits() == b.u0.to_bits() && a.dudphi.to_bits() == b.dudphi.to_bits()
    };
    let mut flights: Vec<_> = rows.chunk_by(same_ray).map(<[_]>::to_vec).collect();
    for flight in &mut flights {
        flight.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    }
    flights
}
