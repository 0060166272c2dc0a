//! A camera that is steered by hand: about the hole, towards it, and aside.
//!
//! # Derivation
//! The camera stands at a radius r, an inclination i from +z and an azimuth a from +x. Its frame is right-handed: p̂
//! away from the hole, `û = −∂p̂/∂i` up and `r̂ = û × p̂` to the right. All are defined and smooth at every angle, so
//! that the camera passes over a pole upside down instead of turning about.
//!
//! The camera looks at the hole, turned by a yaw about û to the right, then by a pitch upwards, then by a roll about
//! its view: `f = −p̂ cos y cos p + r̂ sin y cos p + û sin p`. The focus is a point on this line. Where the camera
//! looks within 60° of the hole it is the point beside the hole, `r (r̂ tan y + û tan p / cos y)`: a sum of small
//! numbers, which keeps the digits of a far camera with a narrow field of view.
//!
//! # The disk's matter
//! A camera in the disk's plane between its edges is inside matter. A step of the navigator goes as far as it can
//! without passing through: above and below the disk it keeps an elevation of [`CLEARANCE`].

use glam::DVec3;

use super::angles::{outward_and_up, radius_and_angles, sine_and_cosine};
use super::checked::Scene;
use super::projection::Projection;
use super::validate::{HORIZON_RADIUS, NARROWEST_FOV};
use super::values::{Camera, Disk};
use super::vector::{cosine, direction, norm};

/// The sine of the smallest elevation at which a camera passes over the disk's matter.
const CLEARANCE: f64 = 1e-4;

/// The elevation's sine up to which a camera counts as in the disk's plane: a few times its rounding error.
const IN_PLANE: f64 = 16.0 * f64::EPSILON;

/// The distances from the horizon within which the camera is moved, in Schwarzschild radii.
const DISTANCES: (f64, f64) = (1e-3, 1e9);

/// The widest field of view of a flat picture, in degrees.
const WIDEST_FOV: f64 = 150.0;

/// The widest of a fisheye, in degrees.
const WIDEST_FISHEYE: f64 = 360.0;

/// Below this sine of the inclination a camera is at a pole, where every azimuth is right.
const AT_POLE: f64 = 1e-9;

/// How many neighbours of a position are tried, in each component and direction.
const NEIGHBOURS: u32 = 256;

/// The number of halvings by which the end of a step is found.
const HALVINGS: u32 = 40;

/// A camera that is steered by hand.
///
/// ```
/// use darkness::scene::{Camera, Navigator, Scene};
///
/// let scene = Scene::builtin("classic")?;
/// let mut navigator = Navigator::new(&scene);
/// assert_eq!(navigator.camera(), *scene.camera());
/// navigator.turn(0.0, -20.0);
/// navigator.zoom(0.5);
/// let turned = scene.clone().with_camera(navigator.camera())?;
/// assert!(turned.radius() < scene.radius());
/// # Ok::<(), darkness::scene::SceneError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Navigator {
    /// The camera that it began with, while it stands there and looks as it did.
    given: Option<Camera>,
    radius: f64,
    /// From +z, in degrees, of any size; likewise the others.
    inclination: f64,
    azimuth: f64,
    yaw: f64,
    pitch: f64,
    roll: f64,
    fov: f64,
    projection: Projection,
    disk: Option<Disk>,
}

impl Navigator {
    /// Starts at a scene's camera.
    pub fn new(scene: &Scene) -> Self {
        let camera = *scene.camera();
        let [_, inclination, mut azimuth] = radius_and_angles(camera.position);
        let view = direction(camera.focus - camera.position);
        let right = direction(view.cross(direction(camera.up)));
        let true_up = right.cross(view);
        if sine_and_cosine(inclination).0.abs() < AT_POLE {
            // Up is −cos i (cos a, sin a, 0) there.
            let side = -camera.position.z.signum();
            azimuth = libm::atan2(side * true_up.y, side * true_up.x).to_degrees();
        }
        let (outward, up) = outward_and_up(inclination, azimuth);
        let beside = up.cross(outward);
        let (yaw, pitch) = if norm(camera.focus) == 0.0 {
            (0.0, 0.0)
        } else {
            let across = view.dot(beside);
            let inward = -view.dot(outward);
            (
                libm::atan2(across, inward).to_degrees(),
                libm::atan2(view.dot(up), libm::hypot(across, inward)).to_degrees(),
            )
        };
        let level = Self {
            given: Some(camera),
            radius: scene.radius(),
            inclination,
            azimuth,
            yaw,
            pitch,
            roll: 0.0,
            fov: camera.fov_degrees,
            projection: camera.projection,
            disk: scene.disk().copied(),
        };
        let [_, up, right] = level.axes();
        // A positive roll turns the camera counterclockwise.
        let roll = libm::atan2(-true_up.dot(right), true_up.dot(up)).to_degrees();
        Self { roll, ..level }
    }

    /// Returns the same camera before another scene, if it was moved and may stand there; else the scene's own.
    #[must_use]
    pub fn carried_to(&self, scene: &Scene) -> Self {
        let kept = Self {
            disk: scene.disk().copied(),
            ..self.clone()
        };
        if self.is_at_start() || scene.clone().with_camera(kept.camera()).is_err() {
            return Self::new(scene);
        }
        kept
    }

    /// Returns the camera.
    pub fn camera(&self) -> Camera {
        if let Some(camera) = self.given {
            return Camera {
                fov_degrees: self.fov,
                ..camera
            };
        }
        let (outward, orbit_up) = outward_and_up(self.inclination, self.azimuth);
        let position = at_radius(outward, self.radius);
        let [view, up, right] = self.axes();
        let (sin_roll, cos_roll) = sine_and_cosine(self.roll);
        let inward = -view.dot(outward);
        let focus = if self.yaw == 0.0 && self.pitch == 0.0 {
            DVec3::ZERO
        } else if inward > 0.5 {
            let beside = orbit_up.cross(outward);
            let across = beside * view.dot(beside) + orbit_up * view.dot(orbit_up);
            across * (self.radius / inward)
        } else {
            position + view * self.radius
        };
        Camera {
            position,
            focus,
            up: up * cos_roll - right * sin_roll,
            fov_degrees: self.fov,
            projection: self.projection,
        }
    }

    /// The directions of the view, of up and of right before the roll.
    fn axes(&self) -> [DVec3; 3] {
        let (outward, orbit_up) = outward_and_up(self.inclination, self.azimuth);
        let beside = orbit_up.cross(outward);
        let (sin_yaw, cos_yaw) = sine_and_cosine(self.yaw);
        let (sin_pitch, cos_pitch) = sine_and_cosine(self.pitch);
        let ahead = beside * sin_yaw - outward * cos_yaw;
        let right = beside * cos_yaw + outward * sin_yaw;
        let view = ahead * cos_pitch + orbit_up * sin_pitch;
        [view, orbit_up * cos_pitch - ahead * sin_pitch, right]
    }

    /// The radius, in Schwarzschild radii.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The inclination from +z, 0 to 180 degrees.
    pub fn inclination(&self) -> f64 {
        let turned = self.inclination.rem_euclid(360.0);
        turned.min(360.0 - turned)
    }

    /// The vertical field of view, in degrees.
    pub fn fov_degrees(&self) -> f64 {
        self.fov
    }

    /// Whether it stands and looks as it did at first.
    pub fn is_at_start(&self) -> bool {
        self.given
            .is_some_and(|camera| camera.fov_degrees == self.fov)
    }

    /// Turns what is seen about the hole: to the right and downwards in the picture, in degrees. On a level camera the
    /// first changes the azimuth, the second the inclination. A step ends where the disk's matter is in the way.
    pub fn turn(&mut self, right: f64, down: f64) {
        let (sin, cos) = sine_and_cosine(self.roll);
        let (right, down) = (right * cos + down * sin, down * cos - right * sin);
        // Upside down, a growing azimuth leads to the left.
        let side = if sine_and_cosine(self.inclination).0 < 0.0 {
            -1.0
        } else {
            1.0
        };
        self.step(|share, next| {
            next.azimuth -= share * side * right;
            next.inclination -= share * down;
        });
    }

    /// Multiplies the distance from the horizon, r − 1. A step ends where the disk's matter is in the way.
    pub fn zoom(&mut self, factor: f64) {
        let exponent = libm::log(factor);
        self.step(|share, next| {
            let distance = (next.radius - HORIZON_RADIUS) * libm::exp(share * exponent);
            // A camera that was given nearer or farther may stay there.
            let (nearest, farthest) = DISTANCES;
            let is_inside = (nearest..=farthest).contains(&distance);
            let leads_inside = (distance < nearest) == (exponent > 0.0);
            if is_inside || leads_inside {
                next.radius = HORIZON_RADIUS + distance;
            }
        });
    }

    /// Looks aside: to the right and downwards in the picture, in degrees.
    pub fn look(&mut self, right: f64, down: f64) {
        let (sin, cos) = sine_and_cosine(self.roll);
        self.given = None;
        // The yaw turns about the frame's up, to which the view is at an angle of 90° less the pitch.
        let (right, down) = (right * cos + down * sin, down * cos - right * sin);
        let upright = sine_and_cosine(self.pitch).1;
        self.yaw += right / upright.abs().max(0.1).copysign(upright);
        self.pitch -= down;
    }

    /// Multiplies the tangent of half the field of view, or a fisheye's whole angle. The whole sphere stays whole.
    pub fn scale_fov(&mut self, factor: f64) {
        let (fov, widest) = match self.projection {
            Projection::Perspective => {
                let half = libm::tan(self.fov.to_radians() / 2.0);
                (2.0 * libm::atan(half * factor).to_degrees(), WIDEST_FOV)
            }
            Projection::Fisheye => (self.fov * factor, WIDEST_FISHEYE),
            Projection::Equirectangular => return,
        };
        // A field of view that was given wider may stay.
        self.fov = fov.clamp(NARROWEST_FOV, widest.max(self.fov));
    }

    /// Changes the navigator by as much of a step as leads through no matter. `change` takes the share of the step.
    fn step(&mut self, change: impl Fn(f64, &mut Self)) {
        let at = |share| {
            let mut next = Self {
                given: None,
                ..self.clone()
            };
            change(share, &mut next);
            next
        };
        let whole = at(1.0);
        if self.leads_to(&whole) {
            *self = whole;
            return;
        }
        let (mut free, mut blocked) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (free + blocked);
            if self.leads_to(&at(middle)) {
                free = middle;
            } else {
                blocked = middle;
            }
        }
        if free > 0.0 {
            *self = at(free);
        }
    }

    /// Whether a camera that moves to `next`, at one radius or in one direction, stays clear of the disk's matter.
    fn leads_to(&self, next: &Self) -> bool {
        let Some(disk) = self.disk else {
            return true;
        };
        let (near, far) = (self.radius.min(next.radius), self.radius.max(next.radius));
        if near > disk.outer || far < disk.inner {
            return true;
        }
        let elevation = |navigator: &Self| {
            let (outward, _) = outward_and_up(navigator.inclination, navigator.azimuth);
            cosine(outward, disk.normal)
        };
        let (from, to) = (elevation(self), elevation(next));
        from * to > IN_PLANE * IN_PLANE && to.abs() >= CLEARANCE.min(from.abs())
    }
}

/// Returns the position in a direction whose length rounds to exactly `radius`, where a neighbour in one component has
/// it (all but one in some hundreds do): the curves of one radius serve all frames of a turn.
fn at_radius(outward: DVec3, radius: f64) -> DVec3 {
    let position = direction(outward) * radius;
    for steps in 0..NEIGHBOURS {
        for axis in 0..3 {
            let step = position[axis].next_up() - position[axis];
            // Exact zeros are planes that the camera stays in.
            if position[axis] == 0.0 {
                continue;
            }
            for sign in [1.0, -1.0] {
                let mut neighbour = position;
                neighbour[axis] += sign * f64::from(steps) * step;
                if norm(neighbour) == radius {
                    return neighbour;
                }
            }
        }
    }
    position
}

#[cfg(test)]
mod tests;
