//! The lines of a grid, magnified.

use darkness::Renderer;
use darkness::scene::Sky;
use darkness::sky::SkySource;
use glam::DVec3;

use super::sky_views::{light_of, looking, position};
use super::tables::table;

const STEP: f64 = 15.0;

/// Returns the red of a picture that looks away from the hole, turned by an angle about +z.
fn red(turned: f64, fov: f64, size: (u32, u32)) -> Vec<f64> {
    let place = position(30.0);
    let towards = DVec3::new(-0.2, 0.9, 0.3).normalize();
    let (sine, cosine) = (libm::sin(turned), libm::cos(turned));
    let towards = DVec3::new(
        cosine * towards.x - sine * towards.y,
        sine * towards.x + cosine * towards.y,
        towards.z,
    );
    let sky = Sky {
        grid: Some(STEP),
        ..Sky::default()
    };
    let scene = looking(place, towards, fov, size, &sky);
    let source = SkySource::new(None, None, Some(STEP));
    let (_, light) = light_of(Renderer::new(table("standard")), &scene, source);
    light.iter().map(|pixel| f64::from(pixel[0])).collect()
}

/// At a hundred-thousandth of a degree a pixel, single precision has not one step of longitude a pixel.
#[test]
fn edges_are_straight_however_magnified() {
    // From the middle of a meridian to beside it; where its edge is, to a thousandth of a pixel.
    let is_line = |turned: f64| red(turned, 1e-4, (1, 1))[0] > 0.1;
    let mut turned = (0..8000).map(|i| f64::from(i) * 1e-3);
    let mut on = turned.find(|&turned| is_line(turned)).expect("a line");
    let mut off = turned.find(|&turned| !is_line(turned)).expect("its edge");
    while off - on > 1e-12 {
        let middle = 0.5 * (on + off);
        if is_line(middle) {
            on = middle;
        } else {
            off = middle;
        }
    }
    for fov in [0.02, 0.002, 0.0005] {
        let (width, height) = (96, 54);
        let red = red(on, fov, (width, height));
        let most = red.iter().fold(0.0, |most: f64, &red| most.max(red));
        assert!(most > 0.1);
        // The length of each row that the line covers, in pixels, tells where its edge crosses the row.
        let lengths: Vec<f64> = red
            .chunks_exact(width as usize)
            .map(|row| row.iter().sum::<f64>() / most)
            .collect();
        let inner: Vec<(usize, f64)> = lengths
            .into_iter()
            .enumerate()
            .filter(|(_, length)| *length > 2.0 && *length < f64::from(width) - 2.0)
            .collect();
        assert!(
            inner.len() > 10,
            "{fov}: the edge crosses {} rows",
            inner.len()
        );
        let ((first, from), (last, to)) = (inner[0], inner[inner.len() - 1]);
        for &(row, length) in &inner {
            let share = (row - first) as f64 / (last - first) as f64;
            let off = length - (from + share * (to - from));
            assert!(off.abs() < 0.02, "{fov}: row {row} is {off} pixels off");
        }
    }
}
