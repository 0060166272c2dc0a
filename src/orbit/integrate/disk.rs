//! Tells whether and where a ray meets the disk, in steps of one length: the renderer's baseline.

use core::f64::consts::PI;

use super::fixed::{FixedStep, Scheme, euler, rk4};
use super::flight::State;
use crate::orbit::Ray;

impl FixedStep {
    /// Returns whether a ray meets the disk: whether [`Self::disk_meeting`] finds a place.
    pub fn disk_hit(&self, ray: Ray, first_crossing: f64, u_inner: f64, u_outer: f64) -> bool {
        self.disk_meeting(ray, first_crossing, u_inner, u_outer)
            .is_some()
    }

    /// Returns where a ray meets the disk first: the order of the image, and u. That is where its u lies between
    /// `u_outer` and `u_inner` at any of the orbit angles `first_crossing + kπ`, k = 0, 1, 2 …, where it passes the
    /// disk's plane. The order counts the crossings before.
    ///
    /// `first_crossing` is in [0, π). At 0 the ray starts in the plane, which is not a crossing, and its first crossing
    /// is at π. Between two crossings the steps are equal, of `h` or a little less, so that each crossing is the end of
    /// a step and nothing is interpolated. Returns `None` for a ray that ends first, for du/dφ = ±∞ (which never meets
    /// the plane), and after `max_steps`.
    #[inline]
    pub fn disk_meeting(
        &self,
        ray: Ray,
        first_crossing: f64,
        u_inner: f64,
        u_outer: f64,
    ) -> Option<(u32, f64)> {
        match self.scheme {
            Scheme::Euler => self.disk_meeting_by(euler, ray, first_crossing, u_inner, u_outer),
            Scheme::Rk4 => self.disk_meeting_by(rk4, ray, first_crossing, u_inner, u_outer),
        }
    }

    #[inline]
    fn disk_meeting_by(
        &self,
        step: impl Fn(State, f64) -> State,
        ray: Ray,
        first_crossing: f64,
        u_inner: f64,
        u_outer: f64,
    ) -> Option<(u32, f64)> {
        if self.h.is_nan() || self.h <= 0.0 {
            return None;
        }
        // Inside the photon sphere rays that go inward do not turn, outside it rays that go outward do not.
        let lost_above = u_inner.max(2.0 / 3.0);
        let lost_below = u_outer.min(2.0 / 3.0);
        let mut state = State {
            u: ray.u(),
            w: ray.dudphi(),
        };
        let mut left = self.max_steps;
        let mut order = 0;
        let mut stretch = if first_crossing > 0.0 {
            first_crossing
        } else {
            PI
        };
        loop {
            let steps = (stretch / self.h).ceil().max(1.0);
            if steps > left as f64 {
                return None;
            }
            let h = stretch / steps;
            left -= steps as u64;
            for _ in 0..steps as u64 {
                state = step(state, h);
                let State { u, w } = state;
                // A state that overflowed to NaN is not in flight either.
                let in_flight = u > 0.0 && u < 1.0;
                if !in_flight || (w < 0.0 && u < lost_below) || (w > 0.0 && u > lost_above) {
                    return None;
                }
            }
            if u_outer <= state.u && state.u <= u_inner {
                return Some((order, state.u));
            }
            order += 1;
            stretch = PI;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::Orbits;
    use crate::orbit::integrate::Adaptive;

    #[test]
    fn disk_hits_agree_with_the_angles_of_the_crossings() {
        // A ray meets the annulus at an angle φ where its u(φ) lies in it: for a scattered ray, between the inbound
        // crossings of the outer and the inner radius, and between the outbound ones.
        let ray = Ray::new(0.02, 0.35).unwrap();
        let events = Adaptive::default().follow(ray, &[3.0, 12.0]).unwrap();
        let angles: Vec<f64> = events.iter().map(|event| event.angle).collect();
        let [enter, pass, emerge, leave, _] = angles[..] else {
            panic!("{events:?}")
        };
        let within = |phi: f64| (enter <= phi && phi <= pass) || (emerge <= phi && phi <= leave);
        let method = FixedStep::new(Scheme::Rk4, 0.02);
        let mut hits = 0;
        for i in 1..300_u32 {
            let first = PI * f64::from(i) / 300.0;
            let expected = within(first) || within(first + PI) || within(first + 2.0 * PI);
            assert_eq!(
                method.disk_hit(ray, first, 1.0 / 3.0, 1.0 / 12.0),
                expected,
                "φ₁ = {first}"
            );
            hits += u32::from(expected);
        }
        assert!(hits > 0 && hits < 299, "{hits}");
        let expected = within(PI) || within(2.0 * PI);
        assert_eq!(method.disk_hit(ray, 0.0, 1.0 / 3.0, 1.0 / 12.0), expected);
    }

    #[test]
    fn disk_hit_refuses_what_cannot_hit() {
        for scheme in [Scheme::Euler, Scheme::Rk4] {
            let method = FixedStep::new(scheme, 0.02);
            for w in [f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 1e5, -1e5] {
                assert!(
                    !method.disk_hit(Ray::new(0.1, w).unwrap(), 1.0, 1.0 / 3.0, 1.0 / 12.0),
                    "w = {w:e}"
                );
            }
            let ray = Ray::new(0.05, 0.2).unwrap();
            assert!(method.disk_hit(ray, 1.0, 1.0 / 3.0, 1.0 / 12.0));
            for h in [0.0, f64::NAN, 1e-9] {
                assert!(
                    !FixedStep::new(scheme, h).disk_hit(ray, 1.0, 1.0 / 3.0, 1.0 / 12.0),
                    "h = {h}"
                );
            }
        }
    }
}
