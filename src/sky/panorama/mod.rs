//! A longitude–latitude picture of the sky, and its mean over a pixel's footprint.

pub mod filter;
mod mip_level;

use mip_level::MipLevel;

/// A longitude–latitude picture of the sky in linear light, at its own size and at smaller ones.
#[derive(Debug)]
pub struct Panorama {
    /// From the picture's own size to a height of 1, each half as high and as wide as the one before.
    levels: Vec<MipLevel>,
    size: [f32; 2],
}

impl Panorama {
    /// Makes a panorama of linear Rec. 709 light: three floats a texel, rows from the top.
    ///
    /// # Panics
    /// If the width is not twice the height, the height is 0, or `texels` has another length.
    pub fn from_linear(width: usize, height: usize, texels: Vec<f32>) -> Self {
        assert!(height > 0 && width == 2 * height && texels.len() == 3 * width * height);
        Self::with_levels(MipLevel::new(height, texels))
    }

    /// Makes the smaller sizes.
    fn with_levels(first: MipLevel) -> Self {
        let mut levels = vec![first];
        while let Some(next) = levels[levels.len() - 1].halved() {
            levels.push(next);
        }
        let size = [levels[0].width() as f32, levels[0].height() as f32];
        Self { levels, size }
    }

    /// Returns the width in texels: twice the height.
    pub fn width(&self) -> usize {
        self.levels[0].width()
    }

    /// Returns the height in texels.
    pub fn height(&self) -> usize {
        self.levels[0].height()
    }

    /// Returns the memory that all sizes take.
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(MipLevel::bytes).sum()
    }

    /// Returns the number of sizes, the first included.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }
}
