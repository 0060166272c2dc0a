//! What several tests read: the reference rays.

// Each test is a program of its own, and takes what it needs.
#![allow(dead_code)]

use darkness::orbit::{EventKind, Fate};

/// One event of one ray, known to 17 digits or more.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ReferenceRay {
    /// What is hard about the ray.
    pub(crate) case: String,
    /// Inverse radius where the ray starts.
    pub(crate) u0: f64,
    /// du/dφ where it starts.
    pub(crate) dudphi: f64,
    /// What happens.
    pub(crate) kind: EventKind,
    /// The radius where it happens; 1 at capture, infinite at escape.
    pub(crate) radius: f64,
    /// The angle swept until then.
    pub(crate) angle: f64,
    /// |∂angle/∂ln dudphi| + |∂angle/∂ln u0|.
    pub(crate) condition: f64,
}

impl ReferenceRay {
    /// The row in words, for a failing test.
    pub(crate) fn name(&self) -> String {
        format!(
            "{}, u0 = {:?}, dudphi = {:?}, {:?} at {}",
            self.case, self.u0, self.dudphi, self.kind, self.radius
        )
    }
}

/// The radii whose crossings the reference knows.
pub(crate) const RADII: [f64; 4] = [3.0, 6.0, 12.0, 30.0];

/// The reference's rays, each with all its events in the order they happen.
pub(crate) fn flights() -> Vec<Vec<ReferenceRay>> {
    let rows = reference_rays();
    assert!(rows.len() > 2000, "only {} rows", rows.len());
    let same_ray = |a: &ReferenceRay, b: &ReferenceRay| {
        a.u0.to_bits() == b.u0.to_bits() && a.dudphi.to_bits() == b.dudphi.to_bits()
    };
    let mut flights: Vec<_> = rows.chunk_by(same_ray).map(<[_]>::to_vec).collect();
    for flight in &mut flights {
        flight.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    }
    flights
}

/// The rows of `tests/reference/rays.csv`, in the file's order: all events of one ray stand together.
pub(crate) fn reference_rays() -> Vec<ReferenceRay> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/rays.csv");
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("case,u0,dudphi,event,radius,angle,condition"),
        "header of {path}"
    );
    lines
        .map(|line| parse(line).unwrap_or_else(|| panic!("{path}: not a row: {line}")))
        .collect()
}

fn parse(line: &str) -> Option<ReferenceRay> {
    let fields: Vec<&str> = line.split(',').collect();
    let [case, u0, dudphi, event, radius, angle, condition] = fields[..] else {
        return None;
    };
    let number = |field: &str| field.parse::<f64>().ok();
    Some(ReferenceRay {
        case: case.to_owned(),
        u0: number(u0)?,
        dudphi: number(dudphi)?,
        kind: match event {
            "inbound" => EventKind::Inbound,
            "outbound" => EventKind::Outbound,
            "capture" => EventKind::End(Fate::Capture),
            "escape" => EventKind::End(Fate::Escape),
            _ => return None,
        },
        radius: number(radius)?,
        angle: number(angle)?,
        condition: number(condition)?,
    })
}
