//! Draws six frames of the animation `plunge` side by side, and saves them as a PNG file:
//! `cargo run --release --example strip -- strip.png`.

use std::env;
use std::error::Error;

use darkness::scene::Animation;
use darkness::table::Spec;
use darkness::{Renderer, Table};
use image::{RgbImage, imageops};

const FRAMES: [i64; 6] = [1, 90, 150, 175, 200, 220];
const WIDTH: u32 = 160;
const HEIGHT: u32 = 90;

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args()
        .nth(1)
        .ok_or("expected the name of a PNG file")?;
    strip()?.save(path)?;
    Ok(())
}

/// Renders the frames, from left to right.
pub(crate) fn strip() -> Result<RgbImage, Box<dyn Error>> {
    let table = Table::generate(&Spec::standard())?;
    let plunge = Animation::load("plunge")?.with_size(WIDTH, HEIGHT)?;
    let mut renderer = Renderer::new(&table);
    let mut strip = RgbImage::new(WIDTH * FRAMES.len() as u32, HEIGHT);
    for (left, number) in (0..).step_by(WIDTH as usize).zip(FRAMES) {
        let frame = renderer.render_rgb(&plunge.frame(number)?)?;
        imageops::replace(&mut strip, &frame, left, 0);
    }
    Ok(strip)
}
