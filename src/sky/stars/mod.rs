//! Stars: where they are, how bright they are and which colour they have.
//!
//! ```
//! use darkness::sky::stars::{StarColours, StarField};
//!
//! let field = StarField::synthetic(1000, 1, None);
//! // As a camera sees them whose distance from the hole raises all frequencies by a tenth.
//! let colours = StarColours::new(1.1, 0.0);
//! let [red, green, blue] = colours.light(&field.stars[0]);
//! assert!(red > 0.0 && green > 0.0 && blue > 0.0);
//! ```
//!
//! # Catalogues
//! A catalogue is a CSV file:
//!
//! ```text
//! # Lines that start with # are comments.
//! name,ra,dec,magnitude,temperature,bv
//! Sirius,101.287155,-16.716116,-1.44,9940,
//! Betelgeuse,88.792939,7.407063,0.45,,1.50
//! ```
//!
//! The first other line is the header. It names the columns, in any order, in upper or lower case:
//!
//! | column | what it holds |
//! |---|---|
//! | `ra` | right ascension in degrees; any number, wraps at 360° |
//! | `dec` | declination in degrees, −90 to 90 |
//! | `magnitude` or `mag` | visual magnitude, −60 to 60 |
//! | `temperature` or `teff` | temperature in kelvin, 100 to 10⁹ |
//! | `bv` or `b-v` | colour index B−V, −0.4 to 4 |
//!
//! One of the last two columns is enough. Where both are given in a row, the temperature counts; where neither is, the
//! star has [`DEFAULT_TEMPERATURE`]. Other columns are ignored. A row with a mistake is skipped and reported.

mod catalogue;
mod colour;
mod columns;
mod fault;
mod record;
mod star;
mod synthetic;

pub use colour::StarColours;
pub use columns::DEFAULT_TEMPERATURE;
pub use fault::{BadRow, BadRows, CatalogueError, CatalogueFault};
pub use star::{Star, StarField};
