//! The section of a rectangle across a direction: a trapezium.

/// The section of a rectangle of the picture across a direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section {
    /// From the centre to the farthest corner, and to the nearer corner.
    pub(super) far: f64,
    near: f64,
}

impl Section {
    /// Across a unit vector, of a rectangle of this width and height.
    pub(super) fn new((x, y): (f64, f64), (width, height): (f64, f64)) -> Self {
        let (x, y) = (width * x.abs(), height * y.abs());
        Self {
            far: 0.5 * (x + y),
            near: 0.5 * (x - y).abs(),
        }
    }

    /// The relative length at a distance from the centre.
    pub(super) fn length(self, distance: f64) -> f64 {
        let beyond = distance.abs() - self.near;
        if beyond <= 0.0 {
            1.0
        } else {
            (1.0 - beyond / (self.far - self.near)).max(0.0)
        }
    }

    /// The share of the rectangle below a distance.
    pub(super) fn share_below(self, distance: f64) -> f64 {
        let t = distance.clamp(-self.far, self.far);
        let beyond = (t.abs() - self.near).max(0.0);
        let slope = self.far - self.near;
        let missing = if slope > 0.0 {
            0.5 * beyond * beyond / slope
        } else {
            0.0
        };
        let half = (t.abs() - missing) / (self.far + self.near);
        0.5 + half.copysign(t)
    }
}
