//! A frame from isoradial curves: two comparisons a pixel and order.

use rayon::prelude::*;

use crate::isoradial::{Isoradials, Sight};
use crate::scene::{Scene, View};

/// White: the disk.
pub const WHITE: u8 = 255;

/// What an edge may be off by, in pixels, where nothing else is asked for.
pub const TOLERANCE: f64 = 1e-3;

/// What the curves of `scene` are to be drawn for.
pub fn sight(scene: &Scene, view: &View) -> Sight {
    // A pixel spans the least angle where the picture plane is farthest from its centre: cos² there.
    let (x, y) = (view.x_at(0.0), view.y_at(0.0));
    let pitch = (view.y_at(0.0) - view.y_at(1.0)).abs();
    Sight {
        u0: view.u0(),
        slope_scale: view.slope_scale(),
        u_inner: 1.0 / scene.disk().inner,
        u_outer: 1.0 / scene.disk().outer,
        pixel_angle: pitch / (1.0 + x * x + y * y),
        tolerance: TOLERANCE,
    }
}

/// The frame's pixels, row by row from the top, on all threads of the current rayon pool.
pub fn render(view: &View, curves: &Isoradials) -> Vec<u8> {
    let width = view.width() as usize;
    let mut pixels = vec![0; width * view.height() as usize];
    // With n or its opposite for the disk's normal the plane is the same; of the two the one away from the camera has N ≥ 0.
    let n_p = view.n_p().abs();
    let n_a = if view.n_p() > 0.0 {
        -view.n_a()
    } else {
        view.n_a()
    };
    let (z, ta, tb) = (view.z(), view.ta(), view.tb());
    pixels
        .par_chunks_exact_mut(width)
        .enumerate()
        .for_each(|(j, row)| {
            let y = view.y_at(j as f64 + 0.5);
            for (i, pixel) in row.iter_mut().enumerate() {
                let x = view.x_at(i as f64 + 0.5);
                let (z, ta, tb) = (z.at(x, y), ta.at(x, y), tb.at(x, y));
                let s = (ta * ta + tb * tb).sqrt();
                if s > 0.0 && curves.meets(z, s, n_p * s, n_a * ta) {
                    *pixel = WHITE;
                }
            }
        });
    pixels
}
