//! A longitude–latitude picture of the sky, and its mean over a pixel's footprint.

mod filter;
pub(crate) mod lattice;
mod mip_level;
mod open;
pub(crate) mod simd;

use mip_level::MipLevel;

/// A longitude–latitude picture of the sky in linear light, at its own size and at smaller ones.
#[derive(Debug)]
pub struct Panorama {
    /// From the picture's own size to a height of 1, each half as high and as wide as the one before.
    levels: Vec<MipLevel>,
    /// Width and height.
    size: [f32; 2],
}

impl Panorama {
    /// Makes a panorama of linear Rec. 709 light: three floats a texel, rows from the top. The width is twice the
    /// height.
    ///
    /// # Panics
    /// If `texels` has not `6 height²` floats, or the height is 0 or above 8192.
    pub fn from_linear(height: usize, mut texels: Vec<f32>) -> Self {
        assert!((1..=open::MOST_ROWS).contains(&height));
        texels.push(0.0);
        Self::with_levels(MipLevel::new(height, texels))
    }

    /// Makes the smaller sizes.
    fn with_levels(first: MipLevel) -> Self {
        let height = first.height() as f32;
        let mut levels = vec![first];
        while let Some(next) = levels[levels.len() - 1].halved() {
            levels.push(next);
        }
        Self {
            levels,
            size: [2.0 * height, height],
        }
    }

    /// Returns the width in texels: twice the height.
    pub fn width(&self) -> usize {
        2 * self.height()
    }

    /// Returns the height in texels.
    pub fn height(&self) -> usize {
        self.levels[0].height()
    }

    /// Returns the memory that all sizes take, in bytes.
    pub fn bytes(&self) -> u64 {
        Self::bytes_of(self.height())
    }

    /// Returns the memory that all sizes of a panorama of this height take, in bytes.
    fn bytes_of(height: usize) -> u64 {
        let heights = std::iter::successors(Some(height), |height| Some(height / 2));
        let floats = heights
            .take_while(|&height| height > 0)
            .map(MipLevel::length);
        (size_of::<f32>() * floats.sum::<usize>()) as u64
    }

    /// Returns the number of sizes, the first included.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }
}
