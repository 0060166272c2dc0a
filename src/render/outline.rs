//! The outline of the disk's image as a closed path: what other programs can fill.
//!
//! The arcs of [`OutlinePath`] are cubics, so they are Bézier curves as they are. Each begins where another ends, up to
//! the parts beyond the picture's sides, which are left out. So the arcs make chains. A chain whose ends are beyond the
//! sides is continued outwards to a frame around everything, and the ends there are joined along the frame.
//!
//! All arcs have the disk on their left, so the disk has the winding number 1. Along the frame the winding number is
//! known up to a constant. One place of the picture, of which it is known whether the disk is seen there, gives that
//! constant.

use std::collections::HashMap;

use kurbo::{BezPath, Point, Rect, Shape};

use super::banded::{COARSE, distance};
use super::centre::front;
use super::edge_map::EdgeMap;
use super::frame::covers;
use super::path::OutlinePath;
use crate::isoradial::Isoradials;
use crate::scene::View;

/// Ends of chains that are as near as this, in pixels, are one point up to rounding.
const ONE_POINT: f64 = 1.0 / 1024.0;

/// The places of the picture that are tried, along each side of a grid.
const PLACES: u32 = 16;

/// Returns the outline of the disk's image, in pixels from the picture's left and top: a closed path that winds once
/// around what the disk covers, in the direction of −1 of [`Shape::winding`], and not around what it does not cover.
/// It is at most `tolerance` pixels off the edges of `curves`. Beyond the picture it may be anywhere.
///
/// Returns `None` if the curves are more rounding than outline.
pub fn disk_outline(view: &View, curves: &Isoradials, tolerance: f64) -> Option<BezPath> {
    let map = EdgeMap::new(view, curves);
    let mut outline = OutlinePath::default();
    let half = &mut OutlinePath::default();
    outline.draw(half, &map, tolerance, covers, false);
    if curves.error().rounding > COARSE || !outline.is_complete() {
        return None;
    }
    let size = (f64::from(view.width()), f64::from(view.height()));
    let mut path = BezPath::new();
    let mut open = Vec::new();
    for chain in chains(&outline) {
        let (first, last) = (chain[0][0], chain[chain.len() - 1][3]);
        if first.distance(last) <= ONE_POINT {
            path.extend(&subpath(&chain));
            path.close_path();
        } else {
            open.push(chain);
        }
    }
    let frame = frame(size, &open);
    join_along(frame, size, &open, &mut path);
    let place = best_place(&outline, size);
    let is_seen = front(view, curves, (place.x, place.y)).is_some();
    let winding = -path.winding(place);
    let missing = i32::from(is_seen) - winding;
    for _ in 0..missing.abs() {
        let corners = corners(frame);
        let order = if missing > 0 {
            [0, 1, 2, 3]
        } else {
            [3, 2, 1, 0]
        };
        path.move_to(corners[order[0]]);
        order[1..].iter().for_each(|&i| path.line_to(corners[i]));
        path.close_path();
    }
    Some(path)
}

/// Cubics, each of which begins where the one before ends.
type Chain = Vec<[Point; 4]>;

/// Puts the arcs into chains, as long as they get.
fn chains(outline: &OutlinePath) -> Vec<Chain> {
    let arcs = outline.arcs.iter().map(|arc| arc.bezier().map(Point::from));
    let arcs: Chain = arcs.collect();
    // −0 and 0 are one number.
    let key = |point: Point| ((point.x + 0.0).to_bits(), (point.y + 0.0).to_bits());
    let mut starts: HashMap<_, Vec<usize>> = HashMap::new();
    let mut surplus: HashMap<_, i32> = HashMap::new();
    for (i, arc) in arcs.iter().enumerate() {
        starts.entry(key(arc[0])).or_default().push(i);
        *surplus.entry(key(arc[0])).or_default() += 1;
        *surplus.entry(key(arc[3])).or_default() -= 1;
    }
    let mut chains: Vec<Chain> = Vec::new();
    // Chains that begin where no arc ends come first: what is left is closed.
    let firsts = arcs.iter().filter(|arc| surplus[&key(arc[0])] > 0);
    for first in firsts.chain(&arcs) {
        let mut chain = Chain::new();
        let mut at = key(first[0]);
        while let Some(next) = starts.get_mut(&at).and_then(Vec::pop) {
            chain.push(arcs[next]);
            at = key(arcs[next][3]);
        }
        if !chain.is_empty() {
            chains.push(chain);
        }
    }
    join_near(chains)
}

/// Joins chains where one begins up to rounding where another ends.
fn join_near(mut chains: Vec<Chain>) -> Vec<Chain> {
    let mut joined = Vec::new();
    while let Some(mut chain) = chains.pop() {
        while chain[0][0].distance(chain[chain.len() - 1][3]) > ONE_POINT
            && let end = chain[chain.len() - 1][3]
            && let Some(next) = chains
                .iter()
                .position(|next| next[0][0].distance(end) <= ONE_POINT)
        {
            chain.extend(chains.swap_remove(next));
        }
        // The chain may be the end of one that was joined before.
        match joined.iter_mut().find(|other: &&mut Chain| {
            let end = chain[chain.len() - 1][3];
            other[0][0].distance(end) <= ONE_POINT
        }) {
            Some(other) => {
                chain.append(other);
                *other = chain;
            }
            None => joined.push(chain),
        }
    }
    joined
}

fn subpath(chain: &Chain) -> BezPath {
    let mut path = BezPath::new();
    path.move_to(chain[0][0]);
    for &[_, p1, p2, p3] in chain {
        path.curve_to(p1, p2, p3);
    }
    path
}

/// Returns a frame around the picture and the ends of all chains.
fn frame((width, height): (f64, f64), open: &[Chain]) -> Rect {
    let ends = open
        .iter()
        .flat_map(|chain| [chain[0][0], chain[chain.len() - 1][3]]);
    let all = ends.fold(Rect::new(0.0, 0.0, width, height), |all, end| {
        all.union_pt(end)
    });
    all.inflate(1.0, 1.0)
}

/// Returns the frame's corners, counterclockwise as seen in the picture, from the top left.
fn corners(frame: Rect) -> [Point; 4] {
    [
        Point::new(frame.x0, frame.y0),
        Point::new(frame.x0, frame.y1),
        Point::new(frame.x1, frame.y1),
        Point::new(frame.x1, frame.y0),
    ]
}

/// Returns where a point beyond a side of the picture comes straight outwards to the frame, and how far that is along
/// the frame: the number of corners passed, and a share of the side.
fn outwards(frame: Rect, (width, height): (f64, f64), point: Point) -> (Point, f64) {
    let beyond = [-point.x, point.y - height, point.x - width, -point.y];
    let side = (0..4).fold(0, |most, i| if beyond[i] > beyond[most] { i } else { most });
    let (x, y) = (
        (point.x - frame.x0) / frame.width(),
        (point.y - frame.y0) / frame.height(),
    );
    match side {
        0 => (Point::new(frame.x0, point.y), y),
        1 => (Point::new(point.x, frame.y1), 1.0 + x),
        2 => (Point::new(frame.x1, point.y), 3.0 - y),
        _ => (Point::new(point.x, frame.y0), 4.0 - x),
    }
}

/// Adds the open chains to a path: each is continued along the frame to the next one that begins there.
fn join_along(frame: Rect, size: (f64, f64), open: &[Chain], path: &mut BezPath) {
    let mut starts: Vec<(f64, usize)> = open
        .iter()
        .enumerate()
        .map(|(i, chain)| (outwards(frame, size, chain[0][0]).1, i))
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut is_drawn = vec![false; open.len()];
    for first in 0..open.len() {
        let mut next = first;
        if is_drawn[first] {
            continue;
        }
        path.move_to(open[first][0][0]);
        while !is_drawn[next] {
            is_drawn[next] = true;
            let chain = &open[next];
            for &[_, p1, p2, p3] in chain {
                path.curve_to(p1, p2, p3);
            }
            let end = chain[chain.len() - 1][3];
            let (out, from) = outwards(frame, size, end);
            path.line_to(out);
            // The next chain that begins along the frame and is not drawn, or the one that began this loop.
            let is_free = |&&(_, i): &&(f64, usize)| !is_drawn[i] || i == first;
            let ahead = starts.iter().filter(is_free).find(|&&(at, _)| at >= from);
            let Some(&(to, i)) = ahead.or_else(|| starts.iter().find(is_free)) else {
                break;
            };
            let last = if to >= from { to } else { to + 4.0 };
            let (mut corner, all) = (from.floor() as usize + 1, corners(frame));
            while (corner as f64) <= last {
                path.line_to(all[corner % 4]);
                corner += 1;
            }
            path.line_to(outwards(frame, size, open[i][0][0]).0);
            path.line_to(open[i][0][0]);
            next = i;
        }
        path.close_path();
    }
}

/// Returns a place of the picture that is far from the outline.
fn best_place(outline: &OutlinePath, (width, height): (f64, f64)) -> Point {
    let share = |i: u32| (f64::from(i) + 0.5) / f64::from(PLACES);
    let places = (0..PLACES * PLACES).map(|i| {
        let place = (share(i % PLACES) * width, share(i / PLACES) * height);
        (distance(outline, place), Point::from(place))
    });
    let best = places.fold((-1.0, Point::ZERO), |best, place| {
        if place.0 > best.0 { place } else { best }
    });
    best.1
}
