//! Guards against photon rings that are only right while they are thinner than a pixel. The camera is zoomed in until
//! the image of order 2, 3, 4 or 5 is 20 pixels thick. Both of its edges are located along a line across it, by the
//! curves and by each point's own exact ray; the exact ray is checked against quadrature.

use core::f64::consts::PI;

use darkness::orbit::exact::Exact;
use darkness::orbit::{Event, EventKind, Fate, Orbits, Ray};
use darkness::scene::{DEFAULT_TOLERANCE, Scene, View};
use glam::DVec3;

use crate::methods::{SeenByCurves, sees_disk, sees_disk_by};
use crate::natural;
use crate::quadrature::TrueRay;
use crate::tables::table;

const EDGES: [f64; 2] = [3.0, 12.0];

/// How thick the ring is in the picture, in pixels.
const THICKNESS: f64 = 20.0;

/// The picture's sides, in pixels.
const SIDE: u32 = 48;

/// A camera, and the half-plane through the line to the hole in which it looks at the ring.
struct Place {
    position: DVec3,
    /// Unit vector across the line to the hole.
    aside: DVec3,
}

impl Place {
    fn new(radius: f64, direction: DVec3, azimuth: f64) -> Self {
        let p = direction.normalize();
        let (a, b) = p.any_orthonormal_pair();
        Self {
            position: p * radius,
            aside: a * libm::cos(azimuth) + b * libm::sin(azimuth),
        }
    }

    /// A view that only serves to ask for the orbit angles of its middle column.
    fn view(&self) -> View {
        View::new(&self.scene(1.0, 1e-3))
    }

    /// The direction of the ray with inward part κ and transverse part 1.
    fn towards(&self, kappa: f64) -> DVec3 {
        (self.aside - self.position.normalize() * kappa).normalize()
    }

    /// A picture of `fov` radians about the ray of κ; what is up in it is nearly across the ring.
    fn scene(&self, kappa: f64, fov: f64) -> Scene {
        let radius = self.position.length();
        let focus = self.position + self.towards(kappa) * radius;
        let p = self.position.normalize();
        let up = (p + self.aside * kappa).normalize() + 0.1 * p.cross(self.aside);
        let vector = |v: DVec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
        let text = format!(
            "[camera]\nposition = {}\nfocus = {}\nup = {}\nfov = {:?}\n[disk]\ninner = {:?}\nouter = {:?}\n\
             [image]\nwidth = {SIDE}\nheight = {SIDE}\n",
            vector(self.position),
            vector(focus),
            vector(up),
            fov.to_degrees(),
            EDGES[0],
            EDGES[1]
        );
        Scene::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }
}

/// A line across the ring of one order.
struct Line {
    scene: Scene,
    view: View,
    order: u32,
    /// The angle between neighbouring pixels, in radians.
    pixel: f64,
}

const MIDDLE: f64 = 0.5 * SIDE as f64;

impl Line {
    /// The picture's middle column, across the ring that is half as thick again.
    fn new(place: &Place, order: u32) -> Self {
        let view = place.view();
        let angle = first_crossing(&view, MIDDLE) + f64::from(order) * PI;
        let kappa = EDGES.map(|edge| kappa_of(&view, edge, angle));
        let [inner, outer] = kappa.map(|kappa| libm::atan2(1.0, kappa));
        let pixel = (outer - inner) / THICKNESS;
        let scene = place.scene(0.5 * (kappa[0] + kappa[1]), f64::from(SIDE) * pixel);
        Self {
            view: View::new(&scene),
            scene,
            order,
            pixel,
        }
    }

    fn name(&self) -> String {
        let first = first_crossing(&self.view, MIDDLE);
        format!(
            "r = {}, φ₁ = {first:.3}, order {}",
            self.view.radius(),
            self.order
        )
    }

    /// Where the row is at which the disk comes into sight, between the middle of the ring and `black`.
    fn edge(&self, name: &str, sees: impl Fn(f64, f64) -> bool, mut black: f64) -> f64 {
        let sees = |row: f64| sees(MIDDLE, row);
        let mut white = MIDDLE;
        assert!(
            sees(white) && !sees(black),
            "{}, {name}: no edge between the rows {white} and {black}",
            self.name()
        );
        while (white - black).abs() > RESOLUTION {
            let row = 0.5 * (white + black);
            if sees(row) {
                white = row;
            } else {
                black = row;
            }
        }
        0.5 * (white + black)
    }

    /// Asserts, by quadrature, that `radius` is crossed in the disk's plane and in the line's order at `row`.
    fn assert_on_edge(&self, row: f64, radius: f64) {
        let ray = self
            .view
            .ray_at(self.view.x_at(MIDDLE), self.view.y_at(row));
        let angle = first_crossing(&self.view, row) + f64::from(self.order) * PI;
        let truth = TrueRay::new(self.view.u0(), self.view.dudphi(ray));
        let event = Event {
            kind: EventKind::Outbound,
            radius,
            angle,
        };
        // A row off by δ is an angle to the hole off by δ pixel; ln κ, for κ its cotangent, is off by (κ + 1/κ) times
        // that.
        let kappa = ray.z / ray.transverse();
        let off = RESOLUTION * self.pixel * (kappa + 1.0 / kappa).abs() + 16.0 * f64::EPSILON;
        let allowed = 1e-12 + off * truth.condition(&event);
        let error = (truth.angle(&event) - angle).abs();
        assert!(
            error <= allowed,
            "{}: r = {radius} is crossed {error:e} from the plane at row {row}",
            self.name()
        );
        // Orders are π apart: no other one is as near.
        assert!(allowed < 0.1, "{}: {allowed}", self.name());
    }
}

/// To how many pixels an edge is located.
const RESOLUTION: f64 = 1e-6;

/// φ₁ in the picture's middle column.
fn first_crossing(view: &View, row: f64) -> f64 {
    let ray = view.ray_at(view.x_at(MIDDLE), view.y_at(row));
    view.plane_crossing(ray.ta, ray.transverse())
}

/// Whether a ray is inside a radius at a swept angle.
fn is_inside(events: &[Event], starts_inside: bool, angle: f64) -> bool {
    let before = events.iter().take_while(|event| event.angle <= angle);
    before
        .last()
        .map_or(starts_inside, |event| match event.kind {
            EventKind::Inbound | EventKind::End(Fate::Capture) => true,
            EventKind::Outbound | EventKind::End(Fate::Escape) => false,
        })
}

/// The κ with which a ray from `view` is at `radius` at the orbit angle: u rises with κ.
fn kappa_of(view: &View, radius: f64, angle: f64) -> f64 {
    let (mut low, mut high) = (-1e3, 1e3 * view.radius());
    for _ in 0..200 {
        let kappa = 0.5 * (low + high);
        let ray = Ray::new(view.u0(), view.slope_scale() * kappa).unwrap();
        let events = Exact.follow(ray, &[radius]).unwrap();
        if is_inside(&events, view.radius() < radius, angle) {
            high = kappa;
        } else {
            low = kappa;
        }
    }
    low
}

/// Cameras far and near, on both sides of the photon sphere, each looking across the rings in several directions.
fn places() -> Vec<Place> {
    let mut places = Vec::new();
    for (radius, direction) in [
        (30.0, DVec3::new(0.985, 0.0, 0.17)),
        (30.0, DVec3::Z),
        (1000.0, DVec3::new(0.5, 0.6, -0.3)),
        (1e6, DVec3::new(0.9, 0.1, 0.2)),
        (1.9, DVec3::new(0.8, 0.3, 0.4)),
        (1.4, DVec3::new(0.8, 0.0, 0.6)),
        (1.05, DVec3::new(0.1, 0.3, 0.6)),
    ] {
        for azimuth in [0.3, 2.0, 3.1, 4.4, 5.5] {
            places.push(Place::new(radius, direction, azimuth));
        }
    }
    places
}

/// Whether rays next to critical meet the disk on their way in too, where its nearer image hides the rings.
fn is_hidden(place: &Place) -> bool {
    let view = place.view();
    let first = first_crossing(&view, MIDDLE);
    let slope = natural::critical_slope(view.u0());
    let w = if view.radius() > 1.5 { slope } else { -slope };
    let events = Exact
        .follow(Ray::new(view.u0(), w).unwrap(), &EDGES)
        .unwrap();
    let inbound = events
        .iter()
        .filter(|event| event.kind == EventKind::Inbound);
    let angles: Vec<f64> = inbound.map(|event| event.angle).collect();
    match angles[..] {
        [from, to] => [first, first + PI]
            .iter()
            .any(|angle| (from - 0.01..to + 0.01).contains(angle)),
        _ => false,
    }
}

#[test]
fn photon_rings_through_a_long_lens_are_where_exact_rays_see_them() {
    let (mut compared, mut worst) = (0, 0.0_f64);
    for place in places().iter().filter(|place| !is_hidden(place)) {
        for order in 2..=5 {
            let line = Line::new(place, order);
            let (scene, view) = (&line.scene, &line.view);
            let curves = ["draft", "standard", "fine"]
                .map(|name| (name, SeenByCurves::new(scene, &table(name).lookup())));
            // Away from the hole and towards it: the picture's top is on the far side of the ring.
            for (black, radius) in [(-0.6, EDGES[1]), (0.6, EDGES[0])] {
                let black = MIDDLE + black * THICKNESS;
                let exact = |column: f64, row: f64| sees_disk(scene, view, column, row);
                let known = line.edge("exact", exact, black);
                line.assert_on_edge(known, radius);
                // An angle off by δ is a share δ of the edge's distance from critical, which is some thicknesses at
                // most: 1e-4 pixels for the draft table. What the curves themselves add is a tenth of the tolerance.
                let mut check = |name: &str, found: f64| {
                    let off = (found - known).abs();
                    assert!(
                        off <= DEFAULT_TOLERANCE,
                        "{}, r = {radius}, {name}: {off} pixels off",
                        line.name()
                    );
                    worst = worst.max(off);
                    compared += 1;
                };
                for (name, curves) in &curves {
                    let see = |column: f64, row: f64| curves.see(column, row);
                    check(name, line.edge(name, see, black));
                }
                // What is drawn where the curves do not reach.
                let see = |column: f64, row: f64| {
                    sees_disk_by(table("standard"), scene, view, column, row)
                };
                check("pixel by pixel", line.edge("pixel by pixel", see, black));
            }
        }
    }
    println!("{compared} edges, {worst:e} pixels off at most");
    assert!(compared > 500, "{compared} edges");
}
