//! The sky: what a ray shows that neither meets the disk nor falls into the hole.

mod orientation;
mod panorama;
mod source;
pub mod stars;

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
    #[derive(Debug, thiserror::Error)]
    #[error("x")]
    pub struct SkyError;
    impl From<super::stars::CatalogueError> for SkyError {
        fn from(_: super::stars::CatalogueError) -> Self {
            Self
        }
    }
    impl super::Panorama {
        pub fn open(_: &std::path::Path, _: f64, _: u64) -> Result<Self, SkyError> {
            let (w, h) = (4096usize, 2048usize);
            let mut t = vec![0.0f32; 3 * w * h];
            for y in 0..h {
                for x in 0..w {
                    let i = 3 * (y * w + x);
                    let c = ((x / 64 + y / 64) % 2) as f32;
                    t[i] = c * (x as f32 / w as f32);
                    t[i + 1] = c * (y as f32 / h as f32);
                    t[i + 2] = c * 0.5;
                }
            }
            Ok(Self::from_linear(h, t))
        }
    }
}
pub use stub::{Grid, SkyError};
