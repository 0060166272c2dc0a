//! A light ray where it starts.

/// The least inverse radius at which a ray may start. Beyond r = 1e100 the squares of `u` would underflow.
pub const MIN_U: f64 = 1e-100;

/// The |du/dφ| from which a ray's path is straight in (φ, u) to the last bit. Between the horizon and infinity
/// `w² = e² − u²(1 − u)` varies by at most 4/27, and so w by a share of at most 2/(27w²), which is less than 2⁻⁵⁵ here.
pub(super) const STRAIGHT: f64 = (1_u64 << 26) as f64;

/// Returns whether an inverse radius lies between infinity and the horizon.
#[inline]
pub(super) fn within_flight(u: f64) -> bool {
    0.0 < u && u < 1.0
}

/// Returns the inverse radius of a straight ray after `angle` > 0; `None` where it has ended.
pub(super) fn straight_u_at(ray_u: f64, dudphi: f64, angle: f64) -> Option<f64> {
    Some(ray_u + dudphi * angle).filter(|&u| within_flight(u))
}

/// A light ray: where it starts and how steeply, in its own plane.
///
/// ```
/// use darkness::orbit::Ray;
///
/// let ray = Ray::from_impact_parameter(30.0, 5.0)?; // from r = 30 inward, b = 5
/// assert!((ray.impact_parameter() - 5.0).abs() < 1e-14);
/// assert!(ray.reversed().dudphi() < 0.0); // the same path, away from the hole
/// # Ok::<(), darkness::orbit::OrbitError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    u: f64,
    dudphi: f64,
}

impl Ray {
    /// Creates a ray at inverse radius `u` (`1e-100 ≤ u < 1`, outside the horizon) with slope `dudphi` (any number; ∞
    /// is straight in and −∞ straight out).
    ///
    /// # Errors
    /// [`OrbitError::Outside`] where `u` is not within those bounds, [`OrbitError::NoSlope`] where `dudphi` is NaN.
    pub fn new(u: f64, dudphi: f64) -> Result<Self, OrbitError> {
        if !(MIN_U..1.0).contains(&u) {
            return Err(OrbitError::Outside { u });
        }
        if dudphi.is_nan() {
            return Err(OrbitError::NoSlope);
        }
        Ok(Self { u, dudphi })
    }

    /// Creates a ray that starts at `radius` (Schwarzschild radii, `1 < radius ≤ 1e100`) and goes inward with impact
    /// parameter `b`, `0 ≤ b ≤ radius/√(1 − 1/radius)`. At the greatest b it starts at its turning point; at b = 0 it
    /// falls straight in. [`reversed`](Self::reversed) makes it go outward.
    ///
    /// From the first integral, `du/dφ = √(1/b² − u²(1 − u))`, `u = 1/radius`.
    ///
    /// # Errors
    /// [`OrbitError::Outside`] for a radius not within its bounds, [`OrbitError::ImpactParameter`] for a b not within
    /// its own: such a ray never comes to this radius.
    pub fn from_impact_parameter(radius: f64, b: f64) -> Result<Self, OrbitError> {
        let ray = Self::new(1.0 / radius, 0.0)?;
        let greatest = radius / (1.0 - ray.u).sqrt();
        if !(0.0..=greatest).contains(&b) {
            return Err(OrbitError::ImpactParameter { b, greatest });
        }
        // In two factors the difference keeps its digits near the turning point, and no square overflows.
        let (e, tangential) = (1.0 / b, 1.0 / greatest);
        let dudphi = (e - tangential).max(0.0).sqrt() * (e + tangential).sqrt();
        Ok(Self { dudphi, ..ray })
    }

    /// Creates a ray that starts at `radius` (Schwarzschild radii, `1 < radius ≤ 1e100`) at the angle `psi` from the
    /// direction of the hole, `0 ≤ psi ≤ π` radians, as a static observer there sees it. At 0 it goes straight in, up
    /// to π/2 inward, and from there on outward.
    ///
    /// `du/dφ = u √(1 − u) cot ψ`, `u = 1/radius`: the observer's lengths along the radius are `dr/√(1 − u)`, across it
    /// `r dφ`. So `sin ψ = b √(1 − u) u`.
    ///
    /// # Errors
    /// [`OrbitError::Outside`] for a radius not within its bounds, [`OrbitError::Angle`] for an angle not within its
    /// own.
    pub fn from_angle(radius: f64, psi: f64) -> Result<Self, OrbitError> {
        let ray = Self::new(1.0 / radius, 0.0)?;
        if !(0.0..=core::f64::consts::PI).contains(&psi) {
            return Err(OrbitError::Angle { psi });
        }
        let (sine, cosine) = libm::sincos(psi);
        let dudphi = ray.u * (1.0 - ray.u).sqrt() * (cosine / sine);
        Ok(Self { dudphi, ..ray })
    }

    /// Returns the ray that starts at the same place and goes the other way along the radius: `du/dφ` changes sign.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self {
            dudphi: -self.dudphi,
            ..self
        }
    }

    /// Returns the inverse radius `u = 1/r` where the ray starts, between 0 and 1.
    pub fn u(self) -> f64 {
        self.u
    }

    /// Returns `du/dφ` where the ray starts, positive where it goes inward.
    pub fn dudphi(self) -> f64 {
        self.dudphi
    }

    /// Returns the impact parameter `b = 1/√((du/dφ)² + u²(1 − u))` in Schwarzschild radii.
    pub fn impact_parameter(self) -> f64 {
        1.0 / libm::hypot(self.dudphi, self.u * (1.0 - self.u).sqrt())
    }
}

/// Why a ray could not be followed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum OrbitError {
    /// The ray does not start outside the horizon, or starts too far away.
    #[error(
        "u0 = {u:?} is not allowed: a ray starts outside the horizon and within 1e100 radii of it, 1e-100 ≤ u0 < 1"
    )]
    Outside {
        /// The inverse radius given.
        u: f64,
    },
    /// The ray has no direction.
    #[error(
        "dudphi is not a number; it is inf or -inf for a ray straight into or away from the hole"
    )]
    NoSlope,
    /// No ray with this impact parameter comes to the radius.
    #[error(
        "the impact parameter {b:?} is not allowed: at this radius it lies from 0 to {greatest:?}"
    )]
    ImpactParameter {
        /// The impact parameter given.
        b: f64,
        /// The greatest one, at which the ray moves across the radius.
        greatest: f64,
    },
    /// An angle from the direction of the hole is not between 0 and π.
    #[error(
        "the angle {psi:?} is not allowed: the angle from the hole's direction lies from 0 to π radians"
    )]
    Angle {
        /// The angle given, in radians.
        psi: f64,
    },
    /// A radius whose crossings are asked for does not lie outside the horizon.
    #[error(
        "radius {radius:?} is not allowed: crossings are reported for radii above 1, the horizon, up to 1e100"
    )]
    Radius {
        /// The radius given.
        radius: f64,
    },
    /// A path that ends at a radius does not lead there.
    #[error(
        "the ray does not go outward through radius {radius:?}, where its path was to end: it starts or turns at or \
         beyond it; end the path farther out"
    )]
    NotThrough {
        /// The radius given.
        radius: f64,
    },
    /// A stepped solution did not end.
    #[error(
        "no end found within {steps} steps (reached φ = {angle:?}): the ray winds near the photon sphere; use a larger \
         step limit or the exact method"
    )]
    StepLimit {
        /// The steps taken.
        steps: u64,
        /// The angle reached, in radians.
        angle: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Radii from next to the horizon to far away.
    fn radii() -> impl Strategy<Value = f64> {
        (-6.0..12.0).prop_map(|exponent| 1.0 + libm::pow(10.0, exponent))
    }

    fn greatest(radius: f64) -> f64 {
        radius / (1.0 - 1.0 / radius).sqrt()
    }

    proptest! {
        /// `e² = 1/b²` comes back, inward and outward, and so does the sign of du/dφ.
        #[test]
        fn impact_parameters_come_back(radius in radii(), share in 0.0..=1.0_f64) {
            let b = share * greatest(radius);
            let ray = Ray::from_impact_parameter(radius, b).unwrap();
            prop_assert_eq!(ray.u(), 1.0 / radius);
            prop_assert!(ray.dudphi() >= 0.0 && ray.reversed().dudphi() == -ray.dudphi());
            for ray in [ray, ray.reversed()] {
                // Some roundings on the way there and as many on the way back.
                let error = (ray.impact_parameter() - b).abs();
                prop_assert!(error <= 16.0 * f64::EPSILON * b, "{} for {}", ray.impact_parameter(), b);
            }
        }

        /// `sin ψ = b √(1 − 1/r)/r`, and ψ < π/2 goes inward.
        #[test]
        fn angles_agree_with_impact_parameters(radius in radii(), psi in 0.0..=core::f64::consts::PI) {
            let ray = Ray::from_angle(radius, psi).unwrap();
            let sine = ray.impact_parameter() / greatest(radius);
            prop_assert!((sine - libm::sin(psi)).abs() <= 16.0 * f64::EPSILON * sine.max(1e-16));
            prop_assert_eq!(ray.dudphi() > 0.0, psi < core::f64::consts::FRAC_PI_2);
            // The asin is badly conditioned where the ray goes across the radius.
            if (psi - core::f64::consts::FRAC_PI_2).abs() > 1e-3 {
                let same = Ray::from_impact_parameter(radius, ray.impact_parameter()).unwrap();
                let error = (same.dudphi() - ray.dudphi().abs()).abs();
                prop_assert!(error <= 1e-9 * same.dudphi());
            }
        }

        #[test]
        fn what_is_not_a_ray_is_refused(radius in radii(), beyond in 1e-9..10.0_f64) {
            let b = greatest(radius) * (1.0 + beyond);
            let refused = Ray::from_impact_parameter(radius, b);
            let known = OrbitError::ImpactParameter { b, greatest: greatest(radius) };
            prop_assert_eq!(refused, Err(known));
            prop_assert!(Ray::from_impact_parameter(radius, -beyond).is_err());
            prop_assert!(Ray::from_angle(radius, -beyond).is_err());
            prop_assert!(Ray::from_angle(radius, core::f64::consts::PI + beyond).is_err());
        }
    }

    #[test]
    fn ends_of_the_ranges_are_allowed() {
        for radius in [1.5, 3.0, 30.0] {
            let at_rest = Ray::from_impact_parameter(radius, greatest(radius)).unwrap();
            assert_eq!(at_rest.dudphi(), 0.0);
            let steep = Ray::from_impact_parameter(radius, 1e-200).unwrap();
            assert!((steep.dudphi() * 1e-200 - 1.0).abs() < 1e-15);
            for straight in [
                Ray::from_impact_parameter(radius, 0.0),
                Ray::from_angle(radius, 0.0),
            ] {
                assert_eq!(straight.unwrap().dudphi(), f64::INFINITY);
            }
            assert!(
                Ray::from_angle(radius, core::f64::consts::PI)
                    .unwrap()
                    .dudphi()
                    < -1e12
            );
        }
        for radius in [1.0, 0.5, 0.0, -3.0, 1e101, f64::NAN, f64::INFINITY] {
            assert!(Ray::from_impact_parameter(radius, 1.0).is_err(), "{radius}");
            assert!(Ray::from_angle(radius, 1.0).is_err(), "{radius}");
        }
        assert!(Ray::from_impact_parameter(3.0, f64::NAN).is_err());
        assert!(Ray::from_angle(3.0, f64::NAN).is_err());
    }
}
