//! The outline of the disk's image in one view, as arcs.
//!
//! # The path
//! Each boundary of each sector of the curves (see [`crate::isoradial`]) is walked from azimuth to azimuth, twice: once
//! on either side of the line from the hole along â. Where the boundaries change, radial lines lead from one to the
//! next, so that the path is closed. Then the disk is where the path winds around once.
//!
//! Parts beyond one of the picture's sides are left out, so the path may begin and end anywhere out there. Only the
//! left side needs care, because sums run along the rows from there. An arc that begins or ends beyond the left side
//! leaves a [`LeftCrossing`], which stands for the parts that were left out.
//!
//! # What is beyond a side
//! Of each side there is a linear form of `(κ, cos α, sin α)` that is negative beyond it, whether ahead of the camera
//! or behind. Over a wedge of azimuths between two places, the transverse part `(cos α, sin α)` is at most
//! `1 − cos(Δ/2)` off its chord, and κ at most `max|h″| δ²/8` off its own over the wedge's x, of length δ; where
//! `f = x h` is kept, h lies between its ends but for `max|f″| δ²/8` over the lesser x. So the form is at most the sum
//! of its parts' greatest values at the ends and of their sizes times these. Where that is negative, no ray of the
//! wedge's curve is in the picture. A wedge of which some part is behind the camera is halved until each half is ahead
//! or beyond a side.
//!
//! That is for flat pictures. Others have seams in place of a back: `round.rs` follows edges across them.

use super::arc::EdgeArc;
use super::edge_map::{Azimuth, EdgeMap, Place, Quadrant};
use crate::isoradial::{Boundary, Sector};

/// The cosine of the widest wedge that is drawn as one arc: an eighth of a right angle to either side of its middle.
const WIDEST: f64 = 0.923_879_532_511_286_8;

/// From one end of an arc to the other `x̂ = N/(N + D)` changes by no more than this factor,
const STEEPEST_SHARE: f64 = 3.0;

/// or by no more than this. Beside the disk's plane it runs through many times that within a narrow wedge, and no
/// polynomial follows.
const SMALLEST_SHARE: f64 = 1.0 / 64.0;

/// The most halvings of a wedge. What remains is as narrow as rounding.
const DEEPEST: u32 = 60;

/// Half an outline is drawn of no more wedges than this. Most take some hundreds. Where the camera stands on the disk's
/// rim to the last digit the curves are noise, and would take all there are.
const MOST_WEDGES: u32 = 1 << 16;

/// The places of an arc are ahead of the camera. Their distances from its plane differ by this factor at most.
const PERSPECTIVE: f64 = 8.0;

/// A part of an edge that is shorter than this, in pixels, is drawn as a straight line.
const SHORT: f64 = 1.0 / 1024.0;

/// Ends of arcs this near to the picture's left side, in pixels, count as beyond it: the path may end on the side
/// itself, up to rounding. Two arcs that meet so near to it leave crossings that cancel.
const AT_LEFT: f64 = 0.25;

/// Where the disk begins or ends along the picture's left side, going down.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeftCrossing {
    /// Rows from the top.
    pub(super) y: f64,
    /// How much more of the disk there is from there on: 1 or −1.
    pub(super) weight: i32,
}

/// The outline of the disk's image in the picture.
#[derive(Debug, Default)]
pub(super) struct OutlinePath {
    pub(super) arcs: Vec<EdgeArc>,
    pub(super) left_crossings: Vec<LeftCrossing>,
    /// How many wedges it took.
    wedges: u32,
    /// The ends of boundaries at this junction and at the next: azimuths at which the boundaries change.
    junction: Vec<End>,
    next_junction: Vec<End>,
}

/// Where a boundary ends at a junction.
#[derive(Debug, Clone, Copy)]
struct End {
    kappa: f64,
    /// `(w, w x, w y)`.
    seen: [f64; 3],
    /// The boundary's weight where it ends there, the opposite where it begins there.
    weight: i32,
}

impl OutlinePath {
    /// Draws the outline in a view, right to `tolerance` pixels. `weight` tells how much more of what is drawn there is
    /// on the greater κ's side of a boundary than on the other: 1, 0 or −1.
    ///
    /// It is drawn in two halves, on two threads of the current rayon pool if `on_all_threads`. `half` is memory for
    /// one.
    pub(super) fn draw(
        &mut self,
        half: &mut Self,
        map: &EdgeMap<'_>,
        tolerance: f64,
        weight: impl Fn(&Boundary) -> i32 + Sync,
        on_all_threads: bool,
    ) {
        let draw = |path: &mut Self, across| {
            path.arcs.clear();
            path.left_crossings.clear();
            path.wedges = 0;
            let mut pen = Pen {
                map,
                sides: map.sides(),
                tolerance,
                path,
            };
            pen.half_turn(across, &weight);
        };
        if on_all_threads {
            rayon::join(|| draw(self, 1.0), || draw(half, -1.0));
        } else {
            draw(self, 1.0);
            draw(half, -1.0);
        }
        self.arcs.append(&mut half.arcs);
        self.left_crossings.append(&mut half.left_crossings);
        self.wedges = self.wedges.max(half.wedges);
    }

    /// Returns whether the whole outline is drawn.
    pub(super) fn is_complete(&self) -> bool {
        self.wedges < MOST_WEDGES
    }
}

/// Draws a path.
struct Pen<'a> {
    map: &'a EdgeMap<'a>,
    sides: [[f64; 3]; 4],
    tolerance: f64,
    path: &'a mut OutlinePath,
}

/// A boundary that is walked, and the weight of its arcs.
#[derive(Clone, Copy)]
struct BoundaryWalk<'a> {
    quadrant: Quadrant,
    boundary: &'a Boundary,
    weight: i32,
}

impl Pen<'_> {
    /// Walks half a turn about the hole, from one end of the line along â to the other: through one quarter turn of φ₁
    /// to the border, and through the other from there on.
    fn half_turn(&mut self, across: f64, weight: &impl Fn(&Boundary) -> i32) {
        let map = self.map;
        let [first, second] = map.quadrants(across);
        // Up to the border β falls.
        let side = -map.handedness(first);
        let mut end_before = None;
        for (quadrant, rises) in [(first, false), (second, true)] {
            let sectors = map.curves.sectors(quadrant.quarter);
            // x falls with β in the first quarter turn.
            let by_rising_x = rises == (quadrant.quarter == 1);
            for i in 0..sectors.len() {
                let sector = &sectors[if by_rising_x {
                    i
                } else {
                    sectors.len() - 1 - i
                }];
                let Some([near, far]) = azimuths(map, quadrant.quarter, sector) else {
                    continue;
                };
                let (from, to) = if rises { (near, far) } else { (far, near) };
                self.path.next_junction.clear();
                for boundary in &sector.boundaries {
                    let weight = side * weight(boundary);
                    if weight != 0 && !map.is_at_the_camera(quadrant, boundary) {
                        self.track(
                            BoundaryWalk {
                                quadrant,
                                boundary,
                                weight,
                            },
                            from,
                            to,
                        );
                    }
                }
                if end_before == Some(from) {
                    self.join();
                }
                core::mem::swap(&mut self.path.junction, &mut self.path.next_junction);
                end_before = Some(to);
            }
        }
        self.path.junction.clear();
    }

    /// Joins the ends at a junction by radial lines.
    ///
    /// An arc of weight w from A to B leaves −w at A and w at B. A closed path leaves nothing anywhere. So the ends are
    /// sorted by κ, and a line leads from each to the next, with the sum of the weights so far.
    fn join(&mut self) {
        self.path
            .junction
            .sort_by(|a, b| a.kappa.total_cmp(&b.kappa));
        let mut weight = 0;
        for i in 1..self.path.junction.len() {
            let [a, b] = [self.path.junction[i - 1], self.path.junction[i]];
            weight += a.weight;
            if weight != 0 && a.seen != b.seen {
                self.line(a.seen, b.seen, weight, 0);
            }
        }
        self.path.junction.clear();
    }

    /// Draws a line between two points, each as [`Place::seen`].
    fn line(&mut self, a: [f64; 3], b: [f64; 3], weight: i32, depth: u32) {
        if !self.map.is_flat {
            let (map, tolerance) = (self.map, self.tolerance);
            let push = &mut |arc: &EdgeArc| self.push(arc);
            return map.line((a, b), weight, tolerance, push, DEEPEST);
        }
        let (width, height) = (self.map.width, self.map.height);
        let beyond = |[w, wx, wy]: [f64; 3]| [wx < 0.0, width * w < wx, wy < 0.0, height * w < wy];
        if beyond(a).into_iter().zip(beyond(b)).any(|(a, b)| a && b) || depth > DEEPEST {
            return;
        }
        if is_level([a[0], b[0]].into_iter()) {
            let point = |[w, wx, wy]: [f64; 3]| (wx / w, wy / w);
            if let Some(arc) = EdgeArc::straight(point(a), point(b), weight) {
                self.push(&arc);
            }
            return;
        }
        let unit = |p: [f64; 3]| {
            let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
            p.map(|part| part / length)
        };
        let (a, b) = (unit(a), unit(b));
        let middle = core::array::from_fn(|i| a[i] + b[i]);
        self.line(a, middle, weight, depth + 1);
        self.line(middle, b, weight, depth + 1);
    }

    /// Draws a boundary between two azimuths.
    fn track(&mut self, track: BoundaryWalk<'_>, from: Azimuth, to: Azimuth) {
        let place = |azimuth| self.map.place(track.quadrant, track.boundary, azimuth);
        let (from, to) = (place(from), place(to));
        let end = |place: &Place, weight| End {
            kappa: place.kappa,
            seen: place.seen,
            weight,
        };
        self.path.junction.push(end(&from, -track.weight));
        self.path.next_junction.push(end(&to, track.weight));
        self.wedge(track, &from, &to, 0);
    }

    /// Draws a boundary between two places on it.
    fn wedge(&mut self, track: BoundaryWalk<'_>, from: &Place, to: &Place, depth: u32) {
        if self.path.wedges >= MOST_WEDGES {
            return;
        }
        self.path.wedges += 1;
        let to = &self.map.continued(*to, from);
        if self.is_beyond(track, from, to) {
            return;
        }
        let ahead = self.are_ahead(&[from, to]);
        if depth > DEEPEST || (ahead && (from.x - to.x).abs().max((from.y - to.y).abs()) <= SHORT) {
            let (from, to) = ((from.x, from.y), (to.x, to.y));
            if !ahead {
                let map = self.map;
                map.around(from, to, track.weight, &mut |arc| self.push(arc));
            } else if let Some(arc) = EdgeArc::straight(from, to, track.weight) {
                self.push(&arc);
            }
            return;
        }
        let azimuth = from.azimuth.between(to.azimuth);
        let middle = self.map.place(track.quadrant, track.boundary, azimuth);
        let middle = self.map.continued(middle, from);
        let arc = if ahead
            && from.azimuth.cosine_to(to.azimuth) >= WIDEST
            && is_even(track.quadrant, from, to)
            && self.are_ahead(&[from, &middle, to])
        {
            EdgeArc::new(from, &middle, to, track.weight, self.tolerance)
        } else {
            None
        };
        if let Some(arc) = arc {
            self.push(&arc);
        } else {
            self.wedge(track, from, &middle, depth + 1);
            self.wedge(track, &middle, to, depth + 1);
        }
    }

    /// Whether an edge may be drawn as one arc between places: ahead of the camera at similar distances, or with no
    /// seam between them.
    fn are_ahead(&self, places: &[&Place]) -> bool {
        if self.map.is_flat {
            return is_level(places.iter().map(|place| place.seen[0]));
        }
        let at = |place: &Place| (place.x, place.y);
        let mut pairs = places.windows(2);
        pairs.all(|pair| self.map.are_near(at(pair[0]), at(pair[1])))
    }

    /// Whether all of a boundary between two places is beyond one of the picture's sides: see the
    /// [module's page](self).
    fn is_beyond(&self, track: BoundaryWalk<'_>, from: &Place, to: &Place) -> bool {
        // What is beyond one side of another picture is behind another one.
        if !self.map.is_flat {
            return false;
        }
        let ([w0, x0, y0], [w1, x1, y1]) = (from.seen, to.seen);
        let (width, height) = (self.map.width, self.map.height);
        let beyond = [
            x0 < 0.0 && x1 < 0.0,
            width * w0 < x0 && width * w1 < x1,
            y0 < 0.0 && y1 < 0.0,
            height * w0 < y0 && height * w1 < y1,
        ];
        if !beyond.contains(&true) {
            return false;
        }
        let piece = &self.map.curves.quarter(track.quadrant.quarter)[track.boundary.piece];
        let x = (from.axis.min(to.axis), from.axis.max(to.axis));
        let off_chord = 0.125 * piece.bend(track.boundary.edge, x) * (x.1 - x.0) * (x.1 - x.0);
        let kappa_off = if piece.has_pole() {
            off_chord / x.0
        } else {
            off_chord
        };
        // 1 − cos(Δ/2) = sin²(Δ/2)/(1 + cos(Δ/2)) ≤ (1 − cos Δ)/2.
        let across_off = 0.5 * (1.0 - from.azimuth.cosine_to(to.azimuth)).max(0.0);
        let direction = |place: &Place| track.quadrant.direction(place.azimuth, place.kappa);
        let (from, to) = (direction(from), direction(to));
        self.sides.iter().zip(beyond).any(|(side, beyond)| {
            let radial = (side[0] * from[0]).max(side[0] * to[0]) + side[0].abs() * kappa_off;
            let along = |direction: [f64; 3]| side[1] * direction[1] + side[2] * direction[2];
            let size = (side[1] * side[1] + side[2] * side[2]).sqrt();
            beyond && radial + along(from).max(along(to)) + size * across_off < 0.0
        })
    }

    /// Adds an arc, if it is in the picture.
    fn push(&mut self, arc: &EdgeArc) {
        if self.map.is_flat {
            self.push_part(arc);
        } else {
            let map = self.map;
            map.in_turns(*arc, |arc| self.push_part(arc));
        }
    }

    fn push_part(&mut self, arc: &EdgeArc) {
        let (rows, columns) = (arc.rows(), arc.columns());
        let (width, height) = (self.map.width, self.map.height);
        if rows.1 < 0.0 || rows.0 > height || columns.1 < 0.0 || columns.0 > width {
            return;
        }
        self.path.arcs.push(*arc);
        let [first, last] = arc.ends();
        // The path comes up along the left side to an arc that begins beyond it. It goes down the side where one ends.
        for ((x, y), weight) in [(first, -arc.weight), (last, arc.weight)] {
            if x <= AT_LEFT {
                self.path.left_crossings.push(LeftCrossing { y, weight });
            }
        }
    }
}

/// Returns the part of a sector that the view shows, the azimuth nearer to the border first; none if it shows nothing.
fn azimuths(map: &EdgeMap<'_>, quarter: usize, sector: &Sector) -> Option<[Azimuth; 2]> {
    let (least, greatest) = map.reach(quarter);
    let (low, high) = (sector.x.0.max(least), sector.x.1.min(greatest));
    if low > high {
        return None;
    }
    if least == greatest {
        // Seen from the disk's plane or its axis x is the same all round.
        return Some([Azimuth::BORDER, Azimuth::FARTHEST]);
    }
    // A sector that the view only touches has no azimuths.
    let at = |x: f64| {
        let (border, farthest) = if quarter == 0 {
            (greatest, least)
        } else {
            (least, greatest)
        };
        if x == border {
            Azimuth::BORDER
        } else if x == farthest {
            Azimuth::FARTHEST
        } else {
            map.azimuth_at(quarter, x)
        }
    };
    let (near, far) = if quarter == 0 {
        (high, low)
    } else {
        (low, high)
    };
    (low < high).then(|| [at(near), at(far)])
}

/// Whether x̂ changes little enough between two places for one arc.
fn is_even(quadrant: Quadrant, from: &Place, to: &Place) -> bool {
    let share = |place: &Place| match quadrant.quarter {
        0 => place.axis,
        _ => 1.0 - place.axis,
    };
    let (from, to) = (share(from), share(to));
    from.max(to) <= STEEPEST_SHARE * from.min(to) || (from - to).abs() <= SMALLEST_SHARE
}

/// Whether places are ahead of the camera, and none is much nearer to its plane than another.
fn is_level(w: impl Iterator<Item = f64> + Clone) -> bool {
    let least = w.clone().fold(f64::INFINITY, f64::min);
    let greatest = w.fold(0.0, f64::max);
    least > 0.0 && greatest <= PERSPECTIVE * least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isoradial::{CurveSpec, Isoradials};
    use crate::orbit::exact::Exact;
    use crate::scene::{Scene, View, builtins};

    /// On either side of an arc, a little farther from it than it may be off, the disk begins or ends.
    #[test]
    fn arcs_are_where_the_disk_ends() {
        const TOLERANCE: f64 = 1.0 / 512.0;
        for builtin in builtins() {
            let scene = Scene::builtin(builtin.name()).unwrap();
            // Scenes with a sky have no disk, or show rings of order 3 that are as thin as an arc's error.
            if scene.sky().is_some() {
                continue;
            }
            // Orders as thin as an arc's error have both their edges on one side.
            let view = View::new(&scene);
            let curves = Isoradials::new(&CurveSpec::new(&scene, &view, 0.05), &Exact);
            let map = EdgeMap::new(&view, &curves);
            let mut path = OutlinePath::default();
            let weight = |boundary: &Boundary| {
                i32::from(boundary.above.is_some()) - i32::from(boundary.below.is_some())
            };
            let half = &mut OutlinePath::default();
            path.draw(half, &map, TOLERANCE, weight, false);
            let sees = |arc: &EdgeArc, u: f64, v: f64| {
                let place = if arc.steep { (v, u) } else { (u, v) };
                crate::render::centre::front(&view, &curves, place).is_some()
            };
            let (mut places, mut wrong) = (0, 0);
            // Lines that join the splines of two quarter turns are as short as these are wrong.
            let arcs = path.arcs.iter().filter(|arc| arc.u.1 - arc.u.0 > 0.05);
            for arc in arcs {
                for i in 0..16 {
                    let u = arc.u.0 + (arc.u.1 - arc.u.0) * (f64::from(i) + 0.5) / 16.0;
                    let (v, off) = (arc.at(u), 1.2 * TOLERANCE);
                    let jump = i32::from(sees(arc, u, v + off)) - i32::from(sees(arc, u, v - off));
                    // Downwards a steep arc has more of the disk on its right, a flat one above.
                    let expected = if arc.steep { arc.weight } else { -arc.weight };
                    places += 1;
                    wrong += i32::from(jump != expected);
                }
            }
            // Where two orders' edges cross there is another edge.
            assert!(
                places > 100 && wrong * 500 < places,
                "{}: {wrong} of {places}",
                builtin.name()
            );
        }
    }
}
