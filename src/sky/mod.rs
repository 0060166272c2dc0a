//! The sky: what a ray shows that neither meets the disk nor falls into the hole.

mod error;
mod orientation;
mod panorama;
mod source;
pub mod stars;

pub use error::{PanoramaProblem, SkyError};
pub use orientation::{Orientation, direction, place};
pub use panorama::Panorama;
pub use source::{DEFAULT_MEMORY, SkySource};
pub use stars::{BadRows, Star, StarColours, StarField};

// STUB
mod stub {
    use glam::DVec3;
    #[derive(Debug)]
    pub struct Grid;
    impl Grid {
        pub fn new(_: f64, _: DVec3, _: DVec3) -> Self {
            Self
        }
        pub fn mean(&self, p: [f32; 2], _: [f32; 2], _: [f32; 2]) -> [f32; 4] {
            let on = |x: f32| f32::from(u8::from((x * 24.0).fract() < 0.05));
            let c = on(p[0]).max(on(p[1] * 0.5));
            [c, c, c, c]
        }
    }
}
pub use stub::Grid;
