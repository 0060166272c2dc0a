//! Rays that the command line gives: by impact parameters, by angles, or by a scene's pixels.

use std::path::Path;

use crate::cli::misuse::misuse;
use crate::cli::rays::{Direction, ListedRay};
use crate::orbit::Ray;
use crate::scene::{Scene, View};

/// A pixel, counted from the left and from the top, from 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelIndex {
    i: u32,
    j: u32,
}

/// Reads the value of `--pixel`.
pub(super) fn pixel_index(text: &str) -> Result<PixelIndex, String> {
    let numbers = text.split_once(',').and_then(|(i, j)| {
        Some(PixelIndex {
            i: i.trim().parse().ok()?,
            j: j.trim().parse().ok()?,
        })
    });
    numbers.ok_or_else(|| {
        "a pixel is two whole numbers, its column from the left and its row from the top, as 960,540".into()
    })
}

/// Returns the rays that start at the radius `from` with impact parameters `b` and at `angles`, in degrees.
///
/// # Errors
/// A misuse about a value that is not allowed.
pub(super) fn rays_from(from: f64, b: &[f64], angles: &[f64]) -> anyhow::Result<Vec<ListedRay>> {
    let b = b.iter().map(|&b| ("--b", Direction::ImpactParameter, b));
    let angles = angles
        .iter()
        .map(|&angle| ("--angle", Direction::Degrees, angle));
    let ray = |(k, (option, direction, value)): (usize, (&str, Direction, f64))| {
        let ray = direction
            .ray(from, value)
            .map_err(|problem| misuse(format!("{option}: {problem}")))?;
        Ok(ListedRay {
            id: (k + 1).to_string(),
            ray,
            plane: None,
        })
    };
    b.chain(angles).enumerate().map(ray).collect()
}

/// Returns the rays that the centres of a scene's pixels see, traced back from the camera.
///
/// # Errors
/// A scene that cannot be read, a pixel outside of its picture.
pub(super) fn rays_of_pixels(
    scene: &Path,
    pixels: &[PixelIndex],
) -> anyhow::Result<Vec<ListedRay>> {
    let view = View::new(&Scene::load(scene)?);
    let [start, a, b] = view.axes();
    let ray = |(k, &PixelIndex { i, j }): (usize, &PixelIndex)| {
        let (width, height) = (view.width(), view.height());
        if i >= width || j >= height {
            return Err(misuse(format!(
                "--pixel {i},{j} is outside of the picture, which has {width}x{height} pixels: columns 0 to {} and \
                 rows 0 to {}",
                width - 1,
                height - 1
            )));
        }
        if !view.shows((f64::from(i) + 0.5, f64::from(j) + 0.5)) {
            return Err(misuse(format!(
                "--pixel {i},{j} is beyond the fisheye's rim, where there is no ray; choose one nearer to the centre"
            )));
        }
        let pixel = view.pixel(i, j);
        let across = a * pixel.ta + b * pixel.tb;
        Ok(ListedRay {
            id: (k + 1).to_string(),
            ray: Ray::new(view.u0(), view.dudphi(pixel))?,
            // A radial ray lies in every plane through the camera and the hole.
            plane: Some([start, across.try_normalize().unwrap_or(a)]),
        })
    };
    pixels.iter().enumerate().map(ray).collect()
}
