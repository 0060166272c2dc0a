//! Light as colours, and its means over pixels.

use std::sync::OnceLock;

use super::Part;
use crate::light::{DisplayTransform, Palette, Radiance, RadianceTable};
use crate::render::mixture::Mixture;
use crate::render::patch::Patch;
use crate::render::planes::Form;
use crate::render::tiles::TILE;
use crate::scene::{Light, Scene, Tone};

/// How light becomes colours.
#[derive(Debug)]
pub(in crate::render) struct Colours {
    pub(in crate::render) radiance: RadianceTable,
    pub(in crate::render) display: DisplayTransform,
    pub(in crate::render) palette: Palette,
    /// Whether all of the disk has radiance 1: it has no light of its own, and is before a sky.
    pub(in crate::render) is_white: bool,
    /// How fast the logarithm of the hottest ring's light changes with its amplitude.
    slope: f64,
}

/// Linear light of pixels of a row, side by side, at most as many as a tile has columns.
pub(super) type RowLight = [[f32; 3]; TILE.0];

impl Colours {
    /// Prepares the colours of a scene, with light of the disk or without.
    pub(in crate::render) fn new(light: Option<Light>, exposure: f64, tone: Tone) -> Self {
        let exact = Radiance::new(light.unwrap_or(Light::Bolometric));
        let radiance = RadianceTable::new(&exact);
        let display = DisplayTransform::new(exposure, tone);
        Self {
            palette: Palette::new(&radiance, &display),
            radiance,
            display,
            is_white: light.is_none(),
            slope: exact.slope(1.0),
        }
    }

    /// Returns the linear light of an amplitude.
    pub(in crate::render) fn light(&self, amplitude: f32) -> [f32; 3] {
        if self.is_white {
            [1.0; 3]
        } else {
            self.radiance.rgb(amplitude)
        }
    }

    /// Returns over how many places a side of a pixel its light is averaged. The last quantity of the patch is the
    /// amplitude.
    pub(super) fn parts<const N: usize>(&self, patch: &Patch<N>, averaging: Averaging) -> usize {
        match (averaging, self.slope * patch.steepness()) {
            (Averaging::Centre, _) => 1,
            (Averaging::Square, flat) if flat <= FLAT => 1,
            (Averaging::Square, steep) if steep <= STEEP => 2,
            (Averaging::Square, steep) if steep <= 2.0 * STEEP => 4,
            (Averaging::Square, _) => MOST_PARTS,
        }
    }

    /// Returns the linear light of `count` pixels of a row from their amplitude, the given quantity of a patch: its
    /// mean over `parts` places a side of each. The centre of the first one is at a place of the picture.
    pub(super) fn of_row<const N: usize>(
        &self,
        (patch, quantity): (&Patch<N>, usize),
        (x, y): (f64, f64),
        count: usize,
        parts: usize,
    ) -> RowLight {
        let (mut light, mut amplitudes) = ([[0.0; 3]; TILE.0], [0.0; TILE.0]);
        let share = 1.0 / (parts * parts) as f32;
        for j in 0..parts {
            let row = patch.row(quantity, y + offset(j, parts));
            for i in 0..parts {
                row.fill(x + offset(i, parts), &mut amplitudes[..count]);
                for (light, amplitude) in light.iter_mut().zip(&amplitudes[..count]) {
                    let rgb = self.radiance.rgb(*amplitude);
                    for (sum, c) in light.iter_mut().zip(rgb) {
                        *sum += share * c;
                    }
                }
            }
        }
        light
    }

    /// Returns the linear light of a pixel that is covered in part: that of the disk times its share, and of what is
    /// `beside` it times the rest.
    pub(super) fn mixed(
        &self,
        parts: &[Part],
        mixture: &Mixture<'_>,
        beside: [f32; 3],
    ) -> [f32; 3] {
        let covered = parts.iter().map(|part| part.share).sum::<f32>().min(1.0);
        let mut sum = beside.map(|c| c * (1.0 - covered));
        for part in parts {
            let mean = if self.is_white {
                [1.0; 3]
            } else {
                mixture.mean(part.order, f64::from(part.share), |y| {
                    self.radiance.rgb(y as f32)
                })
            };
            for (sum, c) in sum.iter_mut().zip(mean) {
                *sum += part.share * c;
            }
        }
        sum
    }
}

/// The colours of an animation, computed when a frame first needs them: light, exposure and tone are those of all its
/// frames.
#[derive(Debug, Default)]
pub(in crate::render) struct SharedColours(OnceLock<Colours>);

impl SharedColours {
    /// The colours of a scene, where it shows any and the form does.
    pub(in crate::render) fn of(&self, scene: &Scene, form: Form) -> Option<&Colours> {
        let new = || Colours::new(scene.light(), scene.exposure(), scene.tone());
        (scene.shows_colour() && form.shows_light()).then(|| self.0.get_or_init(new))
    }
}

/// What of a pixel's light is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) enum Averaging {
    /// The mean over its square.
    Square,
    /// Its centre's.
    Centre,
}

/// The most places a side of a pixel over which its light is averaged.
const MOST_PARTS: usize = 8;

/// Where the light's logarithm changes by less than this from a pixel to the next, the light of the centre is the mean.
/// It is off by about `δ²/24` of itself where the logarithm changes by δ.
const FLAT: f64 = 0.2;

/// Two places a side, at ±1/√12, are exact to the fourth power of the change. They do up to this change.
const STEEP: f64 = 0.8;

/// Returns where the i-th of `parts` places of a pixel's side is, from its middle: pairs of Gauss's places.
fn offset(i: usize, parts: usize) -> f64 {
    /// `1/√12`
    const GAUSS: f64 = 0.288_675_134_594_812_9;
    if parts == 1 {
        return 0.0;
    }
    let pairs = (parts / 2) as f64;
    let pair = ((i / 2) as f64 + 0.5) / pairs - 0.5;
    pair + (if i.is_multiple_of(2) { -GAUSS } else { GAUSS }) / pairs
}
