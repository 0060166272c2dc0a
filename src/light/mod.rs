//! Light: what a ray that meets the disk shows.

pub mod black_body;
mod black_body_curve;
mod cubic;
pub mod flux;
mod palette;
mod radiance;
pub mod rec709;
mod sight;
pub mod srgb;
mod tone;

pub use palette::Palette;
pub use radiance::{Radiance, RadianceTable};
pub use sight::Sight;
pub use tone::DisplayTransform;
