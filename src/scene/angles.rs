//! Places and turns given by angles in degrees.

use glam::DVec3;

use super::vector::{direction, norm};

/// Returns the unit vector away from the hole at an inclination i from +z and an azimuth a from +x, in degrees, and the
/// direction that is up there.
///
/// The first is `(sin i cos a, sin i sin a, cos i)`. Up is minus its derivative by i, which is defined at the poles
/// too.
pub(super) fn outward_and_up(inclination: f64, azimuth: f64) -> (DVec3, DVec3) {
    let (sin_i, cos_i) = sine_and_cosine(inclination);
    let (sin_a, cos_a) = sine_and_cosine(azimuth);
    (
        DVec3::new(sin_i * cos_a, sin_i * sin_a, cos_i),
        DVec3::new(-cos_i * cos_a, -cos_i * sin_a, sin_i),
    )
}

/// Returns the radius of a position, its inclination from +z (0 to 180) and its azimuth from +x (-180 to 180), in
/// degrees.
pub(super) fn radius_and_angles(position: DVec3) -> [f64; 3] {
    let DVec3 { x, y, z } = direction(position);
    let inclination = libm::atan2(libm::hypot(x, y), z).to_degrees();
    [norm(position), inclination, libm::atan2(y, x).to_degrees()]
}

/// Turns the direction that is up in the picture by an angle about the view, counterclockwise as seen from behind the
/// camera. Returns a unit vector across the view, or zero where up is parallel to it.
pub(super) fn rolled_up(view: DVec3, up: DVec3, degrees: f64) -> DVec3 {
    let forward = direction(view);
    let right = direction(forward.cross(direction(up)));
    let across = right.cross(forward);
    let (sine, cosine) = sine_and_cosine(degrees);
    direction(across * cosine - right * sine)
}

/// Returns the sine and the cosine of an angle in degrees, exact at multiples of 90: a camera at 90° is
/// exactly in the disk's plane.
pub(super) fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    // Both are exact: a remainder is, and so is a difference of two numbers within a factor of two.
    let turned = degrees % 360.0;
    let quarters = libm::rint(turned / 90.0);
    let rest = (turned - 90.0 * quarters).to_radians();
    let (sine, cosine) = (libm::sin(rest), libm::cos(rest));
    match (quarters as i32).rem_euclid(4) {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_are_exact_and_others_right() {
        for (degrees, sine, cosine) in [
            (0.0, 0.0, 1.0),
            (90.0, 1.0, 0.0),
            (180.0, 0.0, -1.0),
            (-90.0, -1.0, 0.0),
            (3690.0, 1.0, 0.0),
        ] {
            assert_eq!(sine_and_cosine(degrees), (sine, cosine), "{degrees}");
        }
        for tenths in -9000..9000 {
            let degrees = 0.1 * f64::from(tenths);
            let (sine, cosine) = sine_and_cosine(degrees);
            assert!((sine - libm::sin(degrees.to_radians())).abs() < 1e-14);
            assert!((cosine - libm::cos(degrees.to_radians())).abs() < 1e-14);
        }
    }

    #[test]
    fn angles_of_a_position_lead_back_to_it() {
        for position in [
            DVec3::new(29.5442, 0.0, 5.2094),
            DVec3::new(-3.0, 4e-9, -12.0),
            DVec3::new(0.0, -7.0, 0.0),
            DVec3::new(0.0, 0.0, -7.0),
        ] {
            let [radius, inclination, azimuth] = radius_and_angles(position);
            let back = outward_and_up(inclination, azimuth).0 * radius;
            assert!((back - position).length() < 1e-14 * radius, "{back}");
        }
    }

    #[test]
    fn a_roll_of_a_quarter_turn_puts_the_left_up() {
        // The view is along +y, so that right is +x.
        let rolled = |degrees| rolled_up(DVec3::Y * 3.0, DVec3::new(0.0, 9.0, 2.0), degrees);
        assert_eq!(rolled(0.0), DVec3::Z);
        assert_eq!(rolled(90.0), DVec3::NEG_X);
        assert_eq!(rolled(-90.0), DVec3::X);
        assert_eq!(rolled(180.0), DVec3::NEG_Z);
        assert_eq!(rolled_up(DVec3::Y, DVec3::NEG_Y, 30.0), DVec3::ZERO);
    }
}
