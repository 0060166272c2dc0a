//! What a sky is made of: a panorama, stars and a grid.

use std::path::{Path, PathBuf};

/// The angular radius of a star where none is given, in radians.
pub const DEFAULT_STAR_RADIUS: f64 = 1e-6;

/// What is behind the hole and the disk. Everything is optional: the default is a black sky.
///
/// ```
/// use darkness::scene::{Sky, StarSource, Stars};
///
/// let sky = Sky {
///     stars: Some(Stars::new(StarSource::Synthetic { count: 20_000, seed: 1 })),
///     grid: Some(15.0),
///     ..Sky::default()
/// };
/// assert!(sky.panorama.is_none());
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sky {
    /// A picture of the whole sky by longitude and latitude. Its centre is seen towards +x, its top towards +z.
    pub panorama: Option<SkyFile>,
    /// Yaw, pitch and roll, in degrees: the panorama and the stars are turned counterclockwise about z, y and x, in
    /// this order.
    pub rotation: [f64; 3],
    /// In stops: the panorama's light is multiplied by 2 to this power. It means nothing without a panorama.
    pub exposure: f64,
    /// The stars.
    pub stars: Option<Stars>,
    /// The distance of the lines of a grid, in degrees.
    pub grid: Option<f64>,
}

/// Stars and how they are shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Stars {
    /// Where they come from.
    pub source: StarSource,
    /// Stars with a greater magnitude, as seen without the hole, are left out.
    pub magnitude_limit: Option<f64>,
    /// In stops: a star of magnitude 0 has the irradiance 2 to this power.
    pub exposure: f64,
    /// The angular radius of every star, in radians. It limits the magnification straight behind the hole.
    pub radius: f64,
    /// Whether stars show the blue shift that a camera at rest near the hole sees.
    pub shift: bool,
}

impl Stars {
    /// All stars of a source, with the other values at their defaults.
    pub fn new(source: StarSource) -> Self {
        Self {
            source,
            magnitude_limit: None,
            exposure: 0.0,
            radius: DEFAULT_STAR_RADIUS,
            shift: true,
        }
    }
}

/// Where stars come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StarSource {
    /// A catalogue: a CSV file.
    File(SkyFile),
    /// A field of random stars that the program makes.
    Synthetic {
        /// The number of stars.
        count: u32,
        /// Another seed gives another field.
        seed: u64,
    },
}

/// A file that a sky is read from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SkyFile {
    /// The name as the scene's file has it.
    pub name: String,
    /// The path: the name, relative to the folder of the scene's file.
    pub path: PathBuf,
}

impl SkyFile {
    /// A file whose name is relative to the current folder.
    pub fn new(name: impl Into<String>) -> Self {
        let name = name.into();
        Self {
            path: PathBuf::from(&name),
            name,
        }
    }
}

impl Sky {
    /// Makes the names of files relative to `folder`.
    pub(super) fn resolve(&mut self, folder: &Path) {
        let stars = self.stars.as_mut().map(|stars| &mut stars.source);
        let catalogue = stars.and_then(|source| match source {
            StarSource::File(file) => Some(file),
            StarSource::Synthetic { .. } => None,
        });
        for file in self.panorama.iter_mut().chain(catalogue) {
            file.path = folder.join(&file.name);
        }
    }
}
