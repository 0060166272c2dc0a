//! The reference rays of `tests/reference/rays.csv`.

use darkness::orbit::{EventKind, Fate};

/// One event of one ray, known to 17 digits or more.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ReferenceRay {
    /// The difficulty that the ray tests.
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

/// The rows of `tests/reference/rays.csv`, in the file's order. All events of a ray are consecutive.
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
