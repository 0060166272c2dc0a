//! Frames by each method, and how much two of them may differ.

use core::f64::consts::PI;

use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::orbit::path::SweptAngles;
use darkness::orbit::{EventKind, Orbits, Ray};
use darkness::render::{mask, pixelwise};
use darkness::scene::{Scene, View};

/// The frame from isoradial curves.
pub(crate) fn by_curves(scene: &Scene, angles: &impl SweptAngles) -> Vec<u8> {
    let view = View::new(scene);
    let spec = CurveSpec::new(scene, &view, scene.tolerance());
    let curves = Isoradials::new(&spec, angles);
    mask::render(&view, &curves).unwrap_or_else(|error| panic!("{error}"))
}

/// The frame from each pixel's own ray.
pub(crate) fn by_pixels(scene: &Scene, orbits: &impl Orbits) -> Vec<u8> {
    let view = View::new(scene);
    pixelwise::render(scene, &view, orbits, &|| ()).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether the disk is seen at a point of the picture, given in pixels from its top left corner: by definition. Of
/// the intervals of the swept angle that the ray spends between the disk's radii one holds a `φ₁ + kπ`.
pub(crate) fn sees_disk(scene: &Scene, view: &View, column: f64, row: f64) -> bool {
    sees_disk_by(&Exact, scene, view, column, row)
}

/// The same by the angles of another method.
pub(crate) fn sees_disk_by(
    orbits: &impl Orbits,
    scene: &Scene,
    view: &View,
    column: f64,
    row: f64,
) -> bool {
    let ray = view.ray_at(view.x_at(column), view.y_at(row));
    let s = ray.transverse();
    if s == 0.0 {
        return false;
    }
    let Some(disk) = scene.disk() else {
        return false;
    };
    let start = Ray::new(view.u0(), view.dudphi(ray)).unwrap();
    let events = orbits.follow(start, &[disk.inner, disk.outer]).unwrap();
    let first = view.plane_crossing(ray.ta, s);
    let crossings = (0..40).map(|k| first + f64::from(k) * PI);
    crossings.filter(|&angle| angle > 0.0).any(|angle| {
        // The last event up to this angle tells where the ray is.
        let before = events
            .iter()
            .take_while(|event| event.angle <= angle)
            .last();
        match before.map(|event| (event.kind, event.radius)) {
            // Within from the start where the first crossing leads out: so too for a camera on an edge's radius.
            None => match (events[0].kind, events[0].radius) {
                (EventKind::Inbound, radius) => radius == disk.inner,
                (EventKind::Outbound, radius) => radius == disk.outer,
                (EventKind::End(_), _) => false,
            },
            Some((EventKind::Inbound, radius)) => radius == disk.outer,
            Some((EventKind::Outbound, radius)) => radius == disk.inner,
            Some((EventKind::End(_), _)) => false,
        }
    })
}

/// What the curves of a scene see at any point of its picture.
pub(crate) struct SeenByCurves {
    view: View,
    curves: Isoradials,
    tolerance: f64,
}

impl SeenByCurves {
    pub(crate) fn new(scene: &Scene, angles: &impl SweptAngles) -> Self {
        let view = View::new(scene);
        let spec = CurveSpec::new(scene, &view, scene.tolerance());
        let curves = Isoradials::new(&spec, angles);
        Self {
            view,
            curves,
            tolerance: scene.tolerance(),
        }
    }

    /// Whether the curves are as accurate as frames require.
    pub(crate) fn reach(&self) -> bool {
        self.curves.error().total() <= self.tolerance
    }

    /// Whether the disk is seen at a point given in pixels from the picture's top left corner.
    pub(crate) fn see(&self, column: f64, row: f64) -> bool {
        let ray = self
            .view
            .ray_at(self.view.x_at(column), self.view.y_at(row));
        let s = ray.transverse();
        let (n, d) = (self.view.n_p().abs() * s, self.view.plane_slope() * ray.ta);
        s > 0.0 && self.curves.meets(ray.z, s, n, d)
    }
}

/// Whether moving the sample of pixel (i, j) by a thousandth of a pixel changes what it sees.
fn is_on_an_edge(scene: &Scene, view: &View, i: usize, j: usize) -> bool {
    const SHIFTS: [f64; 3] = [-1e-3, 0.0, 1e-3];
    let answers: Vec<bool> = SHIFTS
        .iter()
        .flat_map(|dx| SHIFTS.map(|dy| (i as f64 + 0.5 + dx, j as f64 + 0.5 + dy)))
        .map(|(column, row)| sees_disk(scene, view, column, row))
        .collect();
    answers.contains(&true) && answers.contains(&false)
}

/// How many pixels of two frames of `scene` differ; every one of them must lie on an edge, within a thousandth of a
/// pixel, which is what the curves promise ([`darkness::scene::DEFAULT_TOLERANCE`]).
pub(crate) fn differing(name: &str, scene: &Scene, a: &[u8], b: &[u8]) -> usize {
    let view = View::new(scene);
    let width = view.width() as usize;
    assert_eq!(a.len(), width * view.height() as usize, "{name}");
    assert_eq!(a.len(), b.len(), "{name}");
    let differing: Vec<(usize, usize)> = (0..a.len())
        .filter(|&k| a[k] != b[k])
        .map(|k| (k % width, k / width))
        .collect();
    let wrong: Vec<_> = differing
        .iter()
        .filter(|&&(i, j)| !is_on_an_edge(scene, &view, i, j))
        .collect();
    assert!(
        wrong.is_empty(),
        "{name}: {} pixels differ away from any edge, the first at {:?}",
        wrong.len(),
        wrong[0]
    );
    differing.len()
}
