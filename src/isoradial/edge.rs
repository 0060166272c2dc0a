//! The disk's two edges, and how far their curves may be off.

/// One of the disk's edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// The inner edge.
    Inner,
    /// The outer edge.
    Outer,
}

/// The bound of an edge's error in the picture, in pixels, by its sources.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EdgeError {
    /// The error of the nodes and of the spline between them.
    pub interpolation: f64,
    /// The effect of the error of the method's angles.
    pub angles: f64,
    /// The effect of rounding.
    pub rounding: f64,
}

impl EdgeError {
    /// Returns the sum of all sources.
    pub fn total(&self) -> f64 {
        self.interpolation + self.angles + self.rounding
    }
}
