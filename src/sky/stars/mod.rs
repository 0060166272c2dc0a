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

mod catalogue;
mod colour;
mod record;
mod star;
mod synthetic;

pub use catalogue::{BadRow, BadRows, CatalogueError, CatalogueFault, DEFAULT_TEMPERATURE};
pub use colour::StarColours;
pub use star::{Star, StarField};
