//! Light: what a ray that meets the disk shows.
//!
//! ```text
//! radius ──flux──▶ √(F/F_max) ──redshift──▶ amplitude y ──radiance──▶ linear Rec. 709 ──tone, srgb──▶ codes
//!                                               └───────────────────palette──────────────────────────▶ codes
//! ```
//!
//! A ray's redshift g and the flux of the ring that it meets make one number, the *amplitude* `y = g² √(F/F_max)`. All
//! colours follow from it: [`Radiance`] gives linear light, [`RadianceTable`] the same in a few nanoseconds, and a
//! [`DisplayTransform`] turns linear light into a picture's codes. A pixel that the disk covers wholly needs no linear
//! light, and a [`Palette`] leads from its amplitude to its bytes.
//!
//! ```
//! use darkness::light::{DisplayTransform, Palette, Radiance, RadianceTable, flux};
//! use darkness::scene::{Light, Tone};
//!
//! let radiance = Radiance::new(Light::BlackBody { temperature: 7000.0 });
//! let display = DisplayTransform::new(0.0, Tone::Neutral);
//! // The ring at r = 5, with all frequencies raised by a tenth.
//! let amplitude = 1.1 * 1.1 * flux::signed_root(1.0 / 5.0);
//! let [red, green, blue] = display.encode(radiance.rgb(amplitude));
//! assert!(red < green && green < blue);
//!
//! let palette = Palette::new(&RadianceTable::new(&radiance), &display);
//! let code = f64::from(palette.rgb8(amplitude as f32)[0]);
//! assert!((code - 255.0 * red).abs() <= 0.6);
//! ```

pub mod black_body;
mod black_body_curve;
mod cubic;
pub mod flux;
mod palette;
mod radiance;
pub mod rec709;
mod redshift;
mod sight;
pub mod srgb;
mod tone;

pub use palette::Palette;
pub use radiance::{Radiance, RadianceTable};
pub use redshift::{AngularMomentum, SightGeometry, emission_cosine, redshift};
pub use sight::Sight;
pub use tone::DisplayTransform;
