//! The columns of a list of rays, and the ray that a line's fields describe.

use glam::DVec3;

use super::{fields, listed, quoted};
use crate::orbit::{OrbitError, Ray};

/// A ray with the name that its rows of output have.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedRay {
    /// The field of the column `id`, else the ray's number in the list, from 1.
    pub id: String,
    /// The ray.
    pub ray: Ray,
    /// The plane of a ray that a scene's camera sees: the directions of φ = 0 and φ = 90°, in the scene's axes.
    pub plane: Option<[DVec3; 2]>,
}

/// How a direction is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Direction {
    /// du/dφ, in inverse Schwarzschild radii.
    Slope,
    /// The impact parameter of a ray that goes inward, in Schwarzschild radii.
    ImpactParameter,
    /// The angle from the hole's direction that a static observer sees, in degrees.
    Degrees,
}

impl Direction {
    /// The columns of each, the first one found counts.
    const COLUMNS: [(&str, Self); 3] = [
        ("dudphi", Self::Slope),
        ("b", Self::ImpactParameter),
        ("angle", Self::Degrees),
    ];

    fn column(self) -> &'static str {
        let mut columns = Self::COLUMNS.into_iter();
        columns
            .find(|&(_, known)| known == self)
            .map_or("", |c| c.0)
    }

    /// Returns the ray that starts at a radius in this direction.
    ///
    /// # Errors
    /// A sentence about a value that is not allowed.
    pub(in super::super) fn ray(self, radius: f64, value: f64) -> Result<Ray, String> {
        let ray = match self {
            Self::Slope => Ray::new(1.0 / radius, value),
            Self::ImpactParameter => Ray::from_impact_parameter(radius, value),
            Self::Degrees if !(0.0..=180.0).contains(&value) => {
                return Err(format!(
                    "the angle {value:?} is not allowed: the angle from the hole's direction lies from 0 to 180 degrees"
                ));
            }
            // No number of radians gives a slope of exactly 0, or of -inf.
            Self::Degrees if value == 90.0 => Ray::new(1.0 / radius, 0.0),
            Self::Degrees if value > 90.0 => {
                Ray::from_angle(radius, (180.0 - value).to_radians()).map(Ray::reversed)
            }
            Self::Degrees => Ray::from_angle(radius, value.to_radians()),
        };
        ray.map_err(|error| match error {
            OrbitError::Outside { .. } => format!(
                "the start's radius {radius:?} is not allowed: a ray starts outside the horizon, 1 < r0 ≤ 1e100"
            ),
            error => error.to_string(),
        })
    }
}

/// Where the start of each ray stands.
#[derive(Debug, Clone, Copy)]
enum Start {
    InverseRadius(usize),
    Radius(usize),
    /// All rays start at this radius.
    Fixed(f64),
}

/// How many columns there are, and which of them tell what of a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    count: usize,
    id: Option<usize>,
    start: Start,
    direction: Direction,
    direction_column: usize,
}

impl Columns {
    /// Reads a header. The rays of a list without a column for their start begin at the radius `from`.
    pub(super) fn new(line: &str, from: Option<f64>) -> Result<Self, String> {
        let names = fields(line)?;
        let [u0, r0] = [position(&names, "u0")?, position(&names, "r0")?];
        let start = match (u0, r0, from) {
            (Some(_), Some(_), _) => {
                return Err("the header names both u0 and r0, and a ray has one start".into());
            }
            (Some(_), _, Some(_)) | (_, Some(_), Some(_)) => {
                return Err(
                    "the list has a column for the start of its rays; leave out --from".into(),
                );
            }
            (Some(column), ..) => Start::InverseRadius(column),
            (_, Some(column), _) => Start::Radius(column),
            (_, _, Some(radius)) => Start::Fixed(radius),
            _ => {
                return Err(format!(
                    "the header names no column u0 and no r0, where the rays start (--from gives all of them one \
                     start), and has {}",
                    listed(&names)
                ));
            }
        };
        let mut direction = None;
        for (name, known) in Direction::COLUMNS {
            // A column that is named twice is refused even where another one decides.
            let column = position(&names, name)?;
            direction = direction.or(column.map(|column| (known, column)));
        }
        let (direction, direction_column) = direction.ok_or_else(|| {
            format!(
                "the header names no column dudphi, b or angle, the direction of the rays, and has {}",
                listed(&names)
            )
        })?;
        Ok(Self {
            count: names.len(),
            id: position(&names, "id")?,
            start,
            direction,
            direction_column,
        })
    }

    /// Reads a line, the list's ray of this number.
    pub(super) fn ray(&self, line: &str, number: u64) -> Result<ListedRay, String> {
        let fields = fields(line)?;
        if fields.len() != self.count {
            return Err(format!(
                "the line has {} fields and the header {}; each line has one for each column",
                fields.len(),
                self.count
            ));
        }
        let id = match self.id.map(|column| fields[column]) {
            Some("") => return Err("the id is empty".into()),
            Some(id) => id.to_owned(),
            None => number.to_string(),
        };
        let (direction, column) = (self.direction, self.direction_column);
        let value = || number_in(direction.column(), fields[column]);
        let ray = match self.start {
            Start::Fixed(radius) => direction.ray(radius, value()?)?,
            Start::Radius(column) => direction.ray(number_in("r0", fields[column])?, value()?)?,
            Start::InverseRadius(column) => {
                let u0 = number_in("u0", fields[column])?;
                let at = |dudphi| Ray::new(u0, dudphi).map_err(|error| error.to_string());
                if direction == Direction::Slope {
                    at(value()?)?
                } else {
                    // Checks the start first: its message names u0. Going over the radius could change its last bit.
                    at(0.0)?;
                    at(direction.ray(1.0 / u0, value()?)?.dudphi())?
                }
            }
        };
        Ok(ListedRay {
            id,
            ray,
            plane: None,
        })
    }
}

fn position(names: &[&str], column: &str) -> Result<Option<usize>, String> {
    let mut places = (0..names.len()).filter(|&k| names[k] == column);
    match (places.next(), places.next()) {
        (Some(_), Some(_)) => Err(format!("the header names the column {column} twice")),
        (place, _) => Ok(place),
    }
}

fn number_in(column: &str, text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| {
        format!(
            "{column} is {}, which is not a number: write 0.25 or 2.5e-1 (and inf or -inf for a dudphi straight in or \
             out)",
            quoted(text)
        )
    })
}
