//! A scene's sky, read and ready to be drawn.

use super::{BadRows, Panorama, SkyError, StarField};
use crate::scene::{Sky, StarSource};

/// The memory that a sky may take where no limit is given, in bytes.
pub const DEFAULT_MEMORY: u64 = 4 << 30;

/// What a scene's sky is made of, in memory.
#[derive(Debug)]
pub struct SkySource {
    panorama: Option<Panorama>,
    stars: Option<StarField>,
    bad_rows: Option<BadRows>,
    grid: Option<f64>,
}

impl SkySource {
    /// Reads the files of a sky, which may take at most `max_bytes` of memory, and makes its synthetic stars.
    ///
    /// # Errors
    /// [`SkyError`] for a file that cannot be read.
    pub fn open(sky: &Sky, max_bytes: u64) -> Result<Self, SkyError> {
        let open =
            |file: &crate::scene::SkyFile| Panorama::open(&file.path, sky.exposure, max_bytes);
        let panorama = sky.panorama.as_ref().map(open).transpose()?;
        let left = max_bytes - panorama.as_ref().map_or(0, Panorama::bytes).min(max_bytes);
        let (stars, bad_rows) = match sky.stars.as_ref().map(|stars| (stars, &stars.source)) {
            None => (None, None),
            Some((stars, StarSource::File(file))) => {
                let (field, bad_rows) = StarField::read(&file.path, stars.magnitude_limit, left)?;
                (Some(field), Some(bad_rows))
            }
            Some((stars, &StarSource::Synthetic { count, seed })) => {
                let field = StarField::synthetic(count, seed, stars.magnitude_limit);
                (Some(field), None)
            }
        };
        Ok(Self {
            panorama,
            stars,
            bad_rows,
            grid: sky.grid,
        })
    }

    /// A sky that is in memory already.
    pub fn new(panorama: Option<Panorama>, stars: Option<StarField>, grid: Option<f64>) -> Self {
        Self {
            panorama,
            stars,
            bad_rows: None,
            grid,
        }
    }

    /// Returns the panorama.
    pub fn panorama(&self) -> Option<&Panorama> {
        self.panorama.as_ref()
    }

    /// Returns the stars.
    pub fn stars(&self) -> Option<&StarField> {
        self.stars.as_ref()
    }

    /// Returns the rows of the catalogue that are no stars.
    pub fn bad_rows(&self) -> Option<&BadRows> {
        self.bad_rows.as_ref()
    }

    /// Returns the distance of the grid's lines, in degrees.
    pub fn grid(&self) -> Option<f64> {
        self.grid
    }
}
