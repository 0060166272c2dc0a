//! Areas of polygons in the plane.

/// Returns the edges of a polygon.
pub(super) fn edges(polygon: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let ends = polygon.iter().cycle().skip(1);
    polygon.iter().copied().zip(ends.copied())
}

/// Returns the part of a convex polygon in which the linear function `inside` is not negative.
pub(super) fn clip(polygon: &[[f64; 2]], inside: impl Fn([f64; 2]) -> f64) -> Vec<[f64; 2]> {
    let mut clipped = Vec::with_capacity(8);
    for (start, end) in edges(polygon) {
        let (at_start, at_end) = (inside(start), inside(end));
        if at_start >= 0.0 {
            clipped.push(start);
        }
        if (at_start >= 0.0) != (at_end >= 0.0) {
            clipped.push(between(start, end, at_start / (at_start - at_end)));
        }
    }
    clipped
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
