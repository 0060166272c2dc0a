//! Random scenes of every kind.

use darkness::scene::Scene;
use glam::DVec3;
use proptest::prelude::*;

/// The difficulty of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Anywhere, looking anywhere, through any lens; the disk from a thread to a plain.
    Any,
    /// A long lens on the photon ring.
    PhotonRing,
    /// From inside the photon sphere.
    Inside,
    /// From the disk's plane, or close to it.
    InPlane,
    /// From the disk's axis.
    OnAxis,
    /// From so far away that the whole disk is a few pixels.
    Distant,
}

pub(crate) const KINDS: [Kind; 6] = [
    Kind::Any,
    Kind::PhotonRing,
    Kind::Inside,
    Kind::InPlane,
    Kind::OnAxis,
    Kind::Distant,
];

/// Numbers between 0 and 1 that a scene is made from.
type Numbers = ([f64; 4], [f64; 4], (u32, u32));

/// A scene of a kind, some tens of pixels wide and high.
pub(crate) fn any_scene() -> impl Strategy<Value = (Kind, Scene)> {
    let unit = || 0.0..1.0_f64;
    let numbers = (
        [unit(), unit(), unit(), unit()],
        [unit(), unit(), unit(), unit()],
        (20..130_u32, 20..90_u32),
    );
    (proptest::sample::select(&KINDS[..]), numbers).prop_filter_map(
        "it stands in the disk or looks nowhere",
        |(kind, numbers)| Some((kind, made(kind, numbers)?)),
    )
}

/// A number between two, evenly in its logarithm.
fn log(share: f64, from: f64, to: f64) -> f64 {
    from * libm::pow(to / from, share)
}

fn made(kind: Kind, ([a, b, c, d], [e, f, g, h], (width, height)): Numbers) -> Option<Scene> {
    let radius = match kind {
        Kind::Inside => 1.0 + log(a, 1e-4, 0.5),
        Kind::Distant => log(a, 1e2, 1e12),
        _ => log(a, 1.01, 400.0),
    };
    let z = match kind {
        Kind::InPlane if b < 0.7 => 0.0,
        Kind::InPlane => log(b, 1e-9, 0.1),
        Kind::OnAxis => (b - 0.5).signum(),
        _ => 2.0 * b - 1.0,
    };
    let across = (1.0 - z * z).sqrt();
    let (sine, cosine) = libm::sincos(6.3 * c);
    let place = DVec3::new(across * cosine, across * sine, z);
    let (u, v) = place.any_orthonormal_pair();
    let aside = u * libm::cos(6.3 * d) + v * libm::sin(6.3 * d);
    let position = place * radius;
    // The critical ray's angle to the hole's direction: sin ψ = b_c √(1 − 1/r)/r, more than a right angle inside.
    let critical = {
        let sine = (6.75 * (1.0 - 1.0 / radius)).sqrt() / radius;
        let angle = libm::asin(sine.min(1.0));
        if radius < 1.5 {
            core::f64::consts::PI - angle
        } else {
            angle
        }
    };
    let pixels = f64::from(height);
    // How far from the hole's direction the picture's centre is, and how far its edge is from that, in radians.
    let (away, half) = match kind {
        Kind::PhotonRing => (critical, critical * log(e, 1e-6, 1e-1)),
        // The disk of 24 radii is from a hundredth of a pixel to three quarters of the picture.
        Kind::Distant => (
            critical * f,
            0.5 * pixels * 24.0 / radius / log(e, 1e-2, 0.7 * pixels),
        ),
        _ => (critical * 2.5 * f * f, critical * log(e, 0.05, 8.0)),
    };
    let fov = (2.0 * half).to_degrees().min(160.0);
    let direction = aside * libm::sin(away) - place * libm::cos(away);
    let focus = position + direction * radius;
    // From a thread to a plain.
    let outer = 3.0
        + if kind == Kind::Distant {
            9.0
        } else {
            log(g, 1e-6, 300.0)
        };
    let normal = if kind == Kind::Any {
        [0.3 * h, 0.2, 1.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    let list = |v: DVec3| format!("[{:e}, {:e}, {:e}]", v.x, v.y, v.z);
    let text = format!(
        "[camera]\nposition = {}\nfocus = {}\nup = [{:?}, 0.2, 1.0]\nfov = {fov:e}\n\
         [disk]\ninner = 3.0\nouter = {outer:?}\nnormal = {normal:?}\n[image]\nwidth = {width}\nheight = {height}\n",
        list(position),
        list(focus),
        h,
    );
    Scene::from_toml(&text).ok()
}
