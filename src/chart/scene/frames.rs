//! Counts the wrong pixels of a frame, compared with each pixel's own exact ray.

use rayon::prelude::*;

use super::super::methods::Stepper;
use super::super::pixel_choice::{affordable, rows};
use crate::orbit::OrbitError;
use crate::orbit::exact::Exact;
use crate::render::mask::WHITE;
use crate::render::{RenderError, pixelwise};
use crate::scene::{Scene, View};

/// The exact pixels of some rows.
pub(super) struct ExactPixels {
    rows: Vec<(u32, Vec<u8>)>,
}

impl ExactPixels {
    /// Computes rows of `scene` with the exact method, on all threads: every row, or evenly spread rows with at most
    /// `most` pixels in total, but at least one row.
    pub(super) fn new(scene: &Scene, view: &View, most: u64) -> Result<Self, RenderError> {
        let rows: Result<Vec<_>, _> = rows(view, most)
            .into_par_iter()
            .map(|j| {
                let row: Result<Vec<u8>, OrbitError> = (0..view.width())
                    .map(|i| {
                        let sees = pixelwise::sees(scene, view, &Exact, (i, j))?;
                        Ok(if sees { WHITE } else { 0 })
                    })
                    .collect();
                row.map(|row| (j, row))
            })
            .collect();
        Ok(Self { rows: rows? })
    }

    /// Returns the number of pixels computed.
    pub(super) fn pixels(&self) -> u64 {
        self.rows.iter().map(|(_, row)| row.len() as u64).sum()
    }

    /// Counts the wrong pixels of `frame`, and the pixels compared.
    pub(super) fn wrong_in(&self, frame: &[u8], view: &View) -> (u64, u64) {
        let width = view.width() as usize;
        let wrong = self.rows.iter().map(|(j, truth)| {
            let row = frame.chunks_exact(width).nth(*j as usize);
            let pairs = row.unwrap_or_default().iter().zip(truth);
            pairs.filter(|(pixel, truth)| pixel != truth).count() as u64
        });
        (wrong.sum(), self.pixels())
    }

    /// Counts the wrong pixels of a method that steps each ray, and the pixels compared: evenly spread rows with at
    /// most `budget` pixels in total, but at least one row.
    pub(super) fn wrong_of(
        &self,
        scene: &Scene,
        view: &View,
        stepper: &Stepper,
        budget: u64,
    ) -> (u64, u64) {
        let chosen = affordable(&self.rows, view, budget);
        let wrong = chosen.par_iter().map(|(j, truth)| {
            let row = (0..view.width()).zip(truth);
            row.filter(|(i, truth)| stepper.sees(scene, view, (*i, *j)) != (**truth == WHITE))
                .count() as u64
        });
        let compared = chosen.iter().map(|(_, row)| row.len() as u64).sum();
        (wrong.sum(), compared)
    }
}

/// Counts the pixels that see the disk, out of `pixels`.
pub(super) fn white(scene: &Scene, view: &View, stepper: &Stepper, pixels: &[(u32, u32)]) -> f64 {
    let seen = pixels
        .iter()
        .filter(|&&pixel| stepper.sees(scene, view, pixel));
    seen.count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isoradial::{CurveSpec, Isoradials};

    #[test]
    fn a_right_frame_has_no_wrong_pixel_and_a_coarse_method_has() {
        let scene = Scene::builtin("classic").unwrap();
        let scene = scene.with_size(160, 90).unwrap();
        let view = View::new(&scene);
        let truth = ExactPixels::new(&scene, &view, 160 * 30).unwrap();
        assert_eq!(truth.pixels(), 160 * 30);
        let curves = Isoradials::new(&CurveSpec::new(&scene, &view, 1e-3), &Exact);
        let mut frame = crate::render::mask::render(&view, &curves).unwrap();
        assert_eq!(truth.wrong_in(&frame, &view), (0, 160 * 30));
        let (row, _) = truth.rows[3];
        frame[row as usize * 160 + 5] ^= WHITE;
        assert_eq!(truth.wrong_in(&frame, &view), (1, 160 * 30));
        let (wrong, compared) = truth.wrong_of(&scene, &view, &Stepper::euler(0.1), 160 * 10);
        assert!(wrong > 0 && compared == 160 * 10, "{wrong} of {compared}");
        let adaptive = Stepper::adaptive(1e-9);
        assert_eq!(truth.wrong_of(&scene, &view, &adaptive, 1), (0, 160));
    }
}
