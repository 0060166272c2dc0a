//! Draws an exact curve as cubics.
//!
//! A cubic interpolates four exact points, at the parameters 0, 1/3, 2/3 and 1. Where the curve is nearly a quartic,
//! its distance from the cubic is proportional to `t(t − 1/3)(t − 2/3)(1 − t)`, which is at most 1/81, and 0.94/81 at
//! t = 1/6 and 5/6. The distance is measured there and at 1/2, and half the tolerance is left for what is not a
//! quartic.

use kurbo::{BezPath, Point};

/// A part of the curve is halved no more often than this.
const DEEPEST: u32 = 40;

/// A path has no more checked cubics than this. Most have some dozens. In pictures of a field of view so narrow that
/// rounding is more than the tolerance, halves are no better than the whole.
const MOST_PARTS: u32 = 1 << 12;

/// A part is halved this often before it may be left out: what its seven points do not show is then narrow.
const SHALLOWEST: u32 = 2;

/// Parts of curves farther beyond the picture than this, in pixels, are left out.
const MARGIN: f64 = 8.0;

/// Ends of parts that are as near as this, in pixels, are one point up to rounding.
const ONE_POINT: f64 = 1e-6;

/// Draws curves as cubics into a path.
pub(super) struct Pen {
    size: (f64, f64),
    tolerance: f64,
    path: BezPath,
    /// How many parts were tried.
    parts: u32,
    /// The last subpath's beginning and end, if a part can follow it.
    open: Option<(Point, Point)>,
}

impl Pen {
    /// Creates a pen for a picture of `size`, in pixels, and for paths right to `tolerance` pixels.
    pub(super) fn new(size: (f64, f64), tolerance: f64) -> Self {
        Self {
            size,
            tolerance,
            path: BezPath::new(),
            parts: 0,
            open: None,
        }
    }

    /// Draws a curve between two parameters. It follows the part before where it begins at that part's end.
    pub(super) fn draw(&mut self, curve: &impl Fn(f64) -> Option<Point>, from: f64, to: f64) {
        self.part(curve, from, to, 0);
    }

    /// Ends a curve: a subpath that has come back to its beginning is closed.
    pub(super) fn lift(&mut self) {
        if let Some((first, last)) = self.open.take()
            && first.distance(last) <= ONE_POINT
        {
            self.path.close_path();
        }
    }

    /// Returns the path.
    pub(super) fn finish(mut self) -> BezPath {
        self.lift();
        self.path
    }

    fn part(&mut self, curve: &impl Fn(f64) -> Option<Point>, from: f64, to: f64, depth: u32) {
        let points: [Option<Point>; 7] =
            core::array::from_fn(|i| curve(from + (to - from) * (i as f64 / 6.0)));
        self.parts += 1;
        let is_spent = self.parts > MOST_PARTS;
        let is_out = depth >= SHALLOWEST && self.is_beyond(&points);
        let is_whole = points.iter().all(Option::is_some);
        if is_out || depth > DEEPEST || (is_spent && !is_whole) {
            self.lift();
            return;
        }
        if let [
            Some(p0),
            Some(c1),
            Some(p1),
            Some(c2),
            Some(p2),
            Some(c3),
            Some(p3),
        ] = points
            && let cubic = through([p0, p1, p2, p3])
            && let near = [(1.0 / 6.0, c1), (0.5, c2), (5.0 / 6.0, c3)]
                .into_iter()
                .all(|(t, exact)| at(&cubic, t).distance(exact) <= 0.5 * self.tolerance)
            && (near || is_spent)
        {
            self.add(cubic);
            return;
        }
        let middle = 0.5 * (from + to);
        self.part(curve, from, middle, depth + 1);
        self.part(curve, middle, to, depth + 1);
    }

    /// Returns whether all points are behind the camera, or beyond one side of the picture.
    fn is_beyond(&self, points: &[Option<Point>]) -> bool {
        let (width, height) = self.size;
        let sides: [fn(Point, f64, f64) -> bool; 4] = [
            |p, _, _| p.x < -MARGIN,
            |p, width, _| p.x > width + MARGIN,
            |p, _, _| p.y < -MARGIN,
            |p, _, height| p.y > height + MARGIN,
        ];
        sides.iter().any(|is_beyond| {
            let mut points = points.iter();
            points.all(|point| point.is_none_or(|point| is_beyond(point, width, height)))
        })
    }

    fn add(&mut self, [p0, p1, p2, p3]: [Point; 4]) {
        let first = match self.open {
            Some((first, last)) if last.distance(p0) <= ONE_POINT => first,
            _ => {
                self.lift();
                self.path.move_to(p0);
                p0
            }
        };
        self.path.curve_to(p1, p2, p3);
        self.open = Some((first, p3));
    }
}

/// Returns the Bézier points of the cubic through four points at the parameters 0, 1/3, 2/3 and 1.
fn through([p0, p1, p2, p3]: [Point; 4]) -> [Point; 4] {
    let inner = |near: Point, a: Point, b: Point, far: Point| {
        let sum = |n: f64, a: f64, b: f64, f: f64| (-5.0 * n + 18.0 * a - 9.0 * b + 2.0 * f) / 6.0;
        Point::new(sum(near.x, a.x, b.x, far.x), sum(near.y, a.y, b.y, far.y))
    };
    [p0, inner(p0, p1, p2, p3), inner(p3, p2, p1, p0), p3]
}

/// Returns a cubic's point.
fn at(&[p0, p1, p2, p3]: &[Point; 4], t: f64) -> Point {
    kurbo::ParamCurve::eval(&kurbo::CubicBez::new(p0, p1, p2, p3), t)
}
