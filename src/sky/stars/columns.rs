//! The columns of a star catalogue, as the documentation of the parent module lists them.

use super::fault::CatalogueFault;
use super::record::{LineReader, Record};
use super::star::Star;
use crate::quotation;

/// The temperature, in kelvin, of a star whose row tells neither temperature nor B−V: about that of the Sun.
pub const DEFAULT_TEMPERATURE: f64 = 5800.0;

const RIGHT_ASCENSION: &[&str] = &["ra"];
const DECLINATION: &[&str] = &["dec"];
const MAGNITUDE: &[&str] = &["magnitude", "mag"];
const TEMPERATURE: &[&str] = &["temperature", "teff"];
const COLOUR_INDEX: &[&str] = &["bv", "b-v"];

/// The index of each column.
pub(super) struct Columns {
    right_ascension: usize,
    declination: usize,
    magnitude: usize,
    temperature: Option<usize>,
    colour_index: Option<usize>,
}

impl Columns {
    pub(super) fn read(
        lines: &mut LineReader,
        record: &mut Record,
    ) -> Result<Self, CatalogueFault> {
        if !lines.next()? {
            return Err(CatalogueFault::NoHeader);
        }
        let line = lines.number;
        let bad_header = |reason| CatalogueFault::BadHeader { line, reason };
        if let Err(error) = std::str::from_utf8(&lines.line) {
            return Err(bad_header(error.to_string()));
        }
        if lines.line.contains(&0) {
            return Err(bad_header("it holds zero bytes".into()));
        }
        record.parse(&lines.line).map_err(bad_header)?;
        let find = |names: &[&'static str]| {
            let is_named = |field: &[u8]| {
                names
                    .iter()
                    .any(|name| field.eq_ignore_ascii_case(name.as_bytes()))
            };
            let mut found = record.fields().enumerate().filter(|(_, f)| is_named(f));
            let index = found.next().map(|(index, _)| index);
            if found.next().is_some() {
                let column = names[0];
                return Err(CatalogueFault::TwoColumns { line, column });
            }
            Ok(index)
        };
        let demand = |names: &[&'static str]| {
            let column = names[0];
            find(names)?.ok_or(CatalogueFault::NoColumn { line, column })
        };
        let columns = Self {
            right_ascension: demand(RIGHT_ASCENSION)?,
            declination: demand(DECLINATION)?,
            magnitude: demand(MAGNITUDE)?,
            temperature: find(TEMPERATURE)?,
            colour_index: find(COLOUR_INDEX)?,
        };
        if columns.temperature.is_none() && columns.colour_index.is_none() {
            let column = "temperature or bv";
            return Err(CatalogueFault::NoColumn { line, column });
        }
        Ok(columns)
    }

    /// Returns the values of a row, or what is wrong with it.
    pub(super) fn values(&self, record: &Record) -> Result<Row, String> {
        let optional = |index: Option<usize>, name, range| match index {
            Some(index) => number(record.field(index), name, range),
            None => Ok(None),
        };
        let needed = |index, name, range| {
            number(record.field(index), name, range)?.ok_or_else(|| format!("{name} is missing"))
        };
        let right_ascension = needed(self.right_ascension, "ra", [f64::MIN, f64::MAX])?;
        let declination = needed(self.declination, "dec", [-90.0, 90.0])?;
        let magnitude = needed(self.magnitude, "magnitude", [-60.0, 60.0])?;
        let temperature = optional(self.temperature, "temperature", [100.0, 1e9])?;
        let colour_index = optional(self.colour_index, "B−V", [-0.4, 4.0])?;
        Ok(Row {
            right_ascension,
            declination,
            magnitude,
            temperature: temperature
                .or(colour_index.map(temperature_of_colour_index))
                .unwrap_or(DEFAULT_TEMPERATURE),
        })
    }
}

pub(super) struct Row {
    right_ascension: f64,
    declination: f64,
    pub(super) magnitude: f64,
    temperature: f64,
}

impl Row {
    pub(super) fn star(&self) -> Star {
        Star::new(
            self.right_ascension,
            self.declination,
            self.magnitude,
            self.temperature,
        )
    }
}

/// Returns a field's value, nothing if it is empty, or what is wrong with it.
fn number(field: &[u8], name: &str, [least, most]: [f64; 2]) -> Result<Option<f64>, String> {
    if field.is_empty() {
        return Ok(None);
    }
    let text = String::from_utf8_lossy(field);
    let quoted = quotation::beginning(&text, 20);
    match text.parse::<f64>() {
        Ok(value) if (least..=most).contains(&value) => Ok(Some(value)),
        Ok(value) if value.is_finite() => {
            Err(format!("{name} = {quoted} is not within {least} to {most}"))
        }
        _ => Err(format!("{name} = {quoted:?} is not a number")),
    }
}

/// Returns the temperature in kelvin of a star with this B−V: Ballesteros 2012, EPL 97, 34008, equation (14).
pub(super) fn temperature_of_colour_index(b_v: f64) -> f64 {
    4600.0 * (1.0 / (0.92 * b_v + 1.7) + 1.0 / (0.92 * b_v + 0.62))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temperatures_of_colour_indices() {
        // Ballesteros 2012, the text below equation (14): the Sun's B−V of 0.65 gives 5770 K to 5800 K.
        assert!((temperature_of_colour_index(0.65) - 5780.0).abs() < 20.0);
        assert!(temperature_of_colour_index(-0.4) < 22_000.0);
        assert!(temperature_of_colour_index(4.0) > 1900.0);
    }
}
