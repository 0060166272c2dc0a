//! The rows of `trace` without `--paths`: what happens to a ray.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use super::csv_field;
use crate::cli::rays::ListedRay;
use crate::orbit::{Event, EventKind, Fate, OrbitError, Orbits, Ray};

pub(super) const HEADER: &str = "id,u0,dudphi,b,event,radius,angle,windings,deflection";

/// Appends the rows of one ray.
///
/// # Errors
/// Those of [`Orbits::follow`].
pub(super) fn write_events(
    orbits: &impl Orbits,
    listed: &ListedRay,
    radii: &[f64],
    rows: &mut String,
) -> Result<(), OrbitError> {
    let ray = listed.ray;
    let events = orbits.follow(ray, radii)?;
    let turning = orbits.turning_point(ray)?;
    let deflection = deflection(orbits, ray, &events)?;
    let id = csv_field(&listed.id);
    let mut row = |event, radius, angle: f64| {
        let (u0, dudphi, b) = (ray.u(), ray.dudphi(), ray.impact_parameter());
        let radius = number(radius);
        let windings = angle / TAU;
        // Writing to a string does not fail. `{:?}` prints the shortest decimal that reads back to the same number, and
        // 17 significant digits do so too.
        let _ = writeln!(
            rows,
            "{id},{u0:?},{dudphi:?},{b:?},{event},{radius},{angle:.16e},{windings:?},{deflection:?}"
        );
    };
    // The crossings on the way to the turning point come first.
    let inward = turning.is_some_and(|point| point.u > ray.u());
    let (name, towards) = if inward {
        ("periapsis", EventKind::Inbound)
    } else {
        ("apoapsis", EventKind::Outbound)
    };
    let before = events.partition_point(|event| turning.is_some() && event.kind == towards);
    let (before, after) = events.split_at(before);
    for event in before {
        row(event_name(event.kind), event.radius, event.angle);
    }
    if let Some(point) = turning {
        row(name, 1.0 / point.u, point.angle);
    }
    for event in after {
        row(event_name(event.kind), event.radius, event.angle);
    }
    Ok(())
}

/// Computes the deflection of the whole path, from infinity to infinity: the angle that it sweeps, less the π of a
/// straight line. It depends on the impact parameter alone. NaN for a path that begins or ends at the horizon.
fn deflection(orbits: &impl Orbits, ray: Ray, events: &[Event]) -> Result<f64, OrbitError> {
    let Some(after) = escape(events) else {
        return Ok(f64::NAN);
    };
    let before = orbits.follow(ray.reversed(), &[])?;
    Ok(escape(&before).map_or(f64::NAN, |before| before + after - PI))
}

/// Returns the angle at which a ray escapes, if it does.
fn escape(events: &[Event]) -> Option<f64> {
    let end = events.last()?;
    (end.kind == EventKind::End(Fate::Escape)).then_some(end.angle)
}

fn event_name(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Inbound => "inbound",
        EventKind::Outbound => "outbound",
        EventKind::End(Fate::Capture) => "capture",
        EventKind::End(Fate::Escape) => "escape",
    }
}

/// Returns the shortest decimal that reads back to the same number, a whole one without its ".0".
fn number(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}
