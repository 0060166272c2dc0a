//! Areas of polygons in the plane.

/// A parallelogram, or what some cuts along straight lines leave of it.
#[derive(Clone, Copy)]
pub(super) struct Polygon {
    corners: [[f64; 2]; Self::MOST],
    count: usize,
}

impl Polygon {
    /// Four corners, and one more for each of four cuts.
    const MOST: usize = 8;

    /// The square about the origin whose sides are 1 long.
    pub(super) const UNIT_SQUARE: Self = {
        let mut corners = [[0.0; 2]; Self::MOST];
        corners[0] = [-0.5, -0.5];
        corners[1] = [0.5, -0.5];
        corners[2] = [0.5, 0.5];
        corners[3] = [-0.5, 0.5];
        Self { corners, count: 4 }
    };

    fn corners(&self) -> &[[f64; 2]] {
        &self.corners[..self.count]
    }

    /// Keeps the part in which the linear function `inside` is not negative. At most four cuts have room.
    pub(super) fn cut(&mut self, inside: impl Fn([f64; 2]) -> f64) {
        let whole = *self;
        self.count = 0;
        let Some(mut start) = whole.corners().last().copied() else {
            return;
        };
        let mut at_start = inside(start);
        for &end in whole.corners() {
            let at_end = inside(end);
            if (at_start >= 0.0) != (at_end >= 0.0) {
                self.push(between(start, end, at_start / (at_start - at_end)));
            }
            if at_end >= 0.0 {
                self.push(end);
            }
            (start, at_start) = (end, at_end);
        }
    }

    /// Adds a corner. Where rounding makes more corners than there is room for, those left out cut off next to nothing.
    fn push(&mut self, corner: [f64; 2]) {
        if let Some(free) = self.corners.get_mut(self.count) {
            *free = corner;
            self.count += 1;
        }
    }

    /// Returns the area, which is positive for corners in counterclockwise order.
    pub(super) fn area(&self) -> f64 {
        let crosses = edges(self.corners()).map(|(start, end)| cross(start, end));
        0.5 * crosses.sum::<f64>()
    }
}

/// Returns the edges of a polygon with these corners.
pub(super) fn edges(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let ends = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(ends.copied())
}

/// Returns the signed area that a circle about the origin covers of the triangle of the origin and an edge.
pub(super) fn area_in_circle(radius: f64, start: [f64; 2], end: [f64; 2]) -> f64 {
    let sector = |a, b| 0.5 * radius * radius * libm::atan2(cross(a, b), dot(a, b));
    // Where the edge is in the circle: middle − half to middle + half, of its length.
    let side = [end[0] - start[0], end[1] - start[1]];
    let square = dot(side, side);
    if square == 0.0 {
        return 0.0;
    }
    let distance = cross(start, side);
    let middle = -dot(start, side) / square;
    let half = (radius * radius * square - distance * distance)
        .max(0.0)
        .sqrt()
        / square;
    let (enter, leave) = ((middle - half).max(0.0), (middle + half).min(1.0));
    if enter >= leave {
        return sector(start, end);
    }
    let (inner_start, inner_end) = (between(start, end, enter), between(start, end, leave));
    let triangle = 0.5 * cross(inner_start, inner_end);
    sector(start, inner_start) + triangle + sector(inner_end, end)
}

fn between(a: [f64; 2], b: [f64; 2], t: f64) -> [f64; 2] {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
