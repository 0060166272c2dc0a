//! Writing on pictures, in Go Mono (its licence is in the file `Go-Mono-LICENSE`).

use std::collections::HashMap;

use ab_glyph::{Font as _, FontRef, PxScale, ScaleFont as _};

use super::bitmap::Bitmap;

static GO_MONO: &[u8] = include_bytes!("Go-Mono.ttf");

/// A font at one size, with the glyphs that have been written.
pub(super) struct Typeface {
    /// `None` if the font cannot be read: then nothing is written.
    font: Option<FontRef<'static>>,
    scale: PxScale,
    glyphs: HashMap<char, Glyph>,
}

/// The coverage of a glyph's pixels.
struct Glyph {
    left: i32,
    top: i32,
    width: usize,
    coverage: Vec<u8>,
}

impl Typeface {
    /// The font with lines of `pixels`.
    pub(super) fn new(pixels: f32) -> Self {
        Self {
            font: FontRef::try_from_slice(GO_MONO).ok(),
            scale: PxScale::from(pixels),
            glyphs: HashMap::new(),
        }
    }

    /// The distance from one line to the next, in pixels.
    pub(super) fn line_height(&self) -> usize {
        (self.scale.y * 1.25).ceil() as usize
    }

    /// The width of a character, the same for all of them, in pixels.
    pub(super) fn advance(&self) -> usize {
        let font = self.font.as_ref();
        let advance = font.map_or(0.0, |font| {
            let font = font.as_scaled(self.scale);
            font.h_advance(font.glyph_id('0'))
        });
        advance.ceil() as usize
    }

    /// The width of a line, in pixels.
    pub(super) fn width(&self, line: &str) -> usize {
        line.chars().count() * self.advance()
    }

    /// Writes a line whose upper left corner is given.
    pub(super) fn write(&mut self, bitmap: &mut Bitmap<'_>, (x, y): (usize, usize), line: &str) {
        const WHITE: u32 = 0x00ff_ffff;
        let Some(font) = &self.font else {
            return;
        };
        let scaled = font.as_scaled(self.scale);
        let baseline = y as i32 + scaled.ascent().ceil() as i32;
        let advance = self.advance();
        for (place, character) in line.chars().enumerate() {
            let glyph = self
                .glyphs
                .entry(character)
                .or_insert_with(|| Glyph::draw(font, self.scale, character));
            if glyph.width == 0 {
                continue;
            }
            let left = (x + place * advance) as i32 + glyph.left;
            for (row, coverage) in glyph.coverage.chunks(glyph.width).enumerate() {
                for (column, &share) in coverage.iter().enumerate() {
                    let place = (left + column as i32, baseline + glyph.top + row as i32);
                    if let (Ok(x), Ok(y)) = (place.0.try_into(), place.1.try_into()) {
                        bitmap.blend((x, y), WHITE, share);
                    }
                }
            }
        }
    }
}

impl Glyph {
    fn draw(font: &FontRef<'_>, scale: PxScale, character: char) -> Self {
        let glyph = font.glyph_id(character).with_scale(scale);
        let Some(outlined) = font.outline_glyph(glyph) else {
            // A space.
            return Self {
                left: 0,
                top: 0,
                width: 0,
                coverage: Vec::new(),
            };
        };
        let bounds = outlined.px_bounds();
        let (width, height) = (bounds.width() as usize, bounds.height() as usize);
        let mut coverage = vec![0; width * height];
        outlined.draw(|x, y, share| {
            let place = y as usize * width + x as usize;
            if let Some(pixel) = coverage.get_mut(place) {
                *pixel = (share.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
            }
        });
        Self {
            left: bounds.min.x as i32,
            top: bounds.min.y as i32,
            width,
            coverage,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_are_told_apart_and_stay_within_their_width() {
        let mut typeface = Typeface::new(16.0);
        let (width, height) = (typeface.width("M"), typeface.line_height());
        let mut seen = Vec::new();
        for character in "0123456789abcdefghijklmnopqrstuvwxyzABCXYZ.,:;°×·−−=()[]/%′".chars()
        {
            let mut pixels = vec![0; 3 * width * height];
            let mut bitmap = Bitmap::new(&mut pixels, 3 * width);
            typeface.write(&mut bitmap, (width, 0), &character.to_string());
            assert!(
                pixels.iter().any(|&pixel| pixel > 0x0080_8080),
                "{character}"
            );
            for row in pixels.chunks(3 * width) {
                assert!(
                    row[..width - 1].iter().all(|&pixel| pixel == 0),
                    "{character}"
                );
                assert!(
                    row[2 * width + 1..].iter().all(|&pixel| pixel == 0),
                    "{character}"
                );
            }
            seen.push(pixels);
        }
        seen.sort();
        seen.dedup();
        // One character is twice in the list.
        assert_eq!(seen.len(), 58);
    }
}
