//! What a ray sees of the disk.

/// What a ray sees where it meets the disk first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The order of the image: the number of half turns between the first crossing of the disk's plane and this one.
    pub order: u32,
    /// The inverse radius of the disk's ring, in inverse Schwarzschild radii.
    pub u: f64,
    /// The azimuth about the disk's axis, counterclockwise, from the projection of +x on the disk's plane (of +y where
    /// the axis is within 1e-6 of ±x); 0 to 2π.
    pub azimuth: f64,
    /// The ratio of observed to emitted frequency, g.
    pub redshift: f64,
    /// The cosine of the angle between the light and the disk's normal, for the matter that emits it.
    pub emission_cosine: f64,
}
