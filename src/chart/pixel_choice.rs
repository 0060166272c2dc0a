//! Which pixels of a picture are measured: those that a slow method has time for, spread evenly.

use crate::scene::View;

/// Returns rows spread evenly over the picture: all of them, or as many as have at most `most` pixels in total, but at
/// least one.
pub(super) fn rows(view: &View, most: u64) -> Vec<u32> {
    let height = u64::from(view.height());
    let count = (most / u64::from(view.width())).clamp(1, height);
    let row = |k| ((2 * k + 1) * height / (2 * count)) as u32;
    (0..count).map(row).collect()
}

/// Returns those of `rows`, evenly spread, that have at most `budget` pixels in total, but at least one.
pub(super) fn affordable<'a, T>(rows: &'a [T], view: &View, budget: u64) -> Vec<&'a T> {
    let count = (budget / u64::from(view.width())).max(1) as usize;
    let stride = rows.len().div_ceil(count).max(1);
    rows.iter().skip(stride / 2).step_by(stride).collect()
}

/// Returns `count` pixels spread evenly over the picture, the same on every machine. They follow the additive sequence
/// with steps 1/g and 1/g², where g³ = g + 1.
pub(super) fn sample(view: &View, count: u32) -> Vec<(u32, u32)> {
    let place = |k: u32, step: f64, side: u32| {
        let x = 0.5 + f64::from(k) * step;
        (((x - x.floor()) * f64::from(side)) as u32).min(side - 1)
    };
    (0..count)
        .map(|k| {
            (
                place(k, 0.754_877_666_246_692_7, view.width()),
                place(k, 0.569_840_290_998_053_2, view.height()),
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn a_sample_is_spread_over_the_picture() {
        let scene = Scene::builtin("classic").unwrap();
        let view = View::new(&scene);
        let pixels = sample(&view, 256);
        let left = pixels.iter().filter(|(i, _)| *i < view.width() / 2);
        let upper = pixels.iter().filter(|(_, j)| *j < view.height() / 2);
        assert!((120..=136).contains(&left.count()) && (120..=136).contains(&upper.count()));
    }
}
