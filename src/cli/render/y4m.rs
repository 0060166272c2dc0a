//! YUV4MPEG2 films.
//!
//! The header says the size, the frame rate, square pixels, and how pixels are coded. Films have 8 bits a sample,
//! 4:2:0, limited range: black is Y = 16 and white Y = 235, with U = V = 128 where there is no colour. The chroma
//! samples lie at the left of two pixels and between two rows (`C420mpeg2`), where MPEG-2 and H.264 put them unless
//! told otherwise. R, G and B become Y, U and V by the matrix of BT.709; the format has no tag for that. A mask's
//! linear coverage is its luma. Grey films have full range and no chroma (`Cmono`, `XCOLORRANGE=FULL`).

use super::yuv::{self, BLACK, NO_COLOUR};
use crate::render::Pixels;
use crate::scene::ImageSize;
use crate::scene::animation::Rate;

/// What stands before each frame.
pub(super) const MARK: &[u8] = b"FRAME\n";

/// The header of a film in colour or of masks.
pub(super) fn header(size: ImageSize, rate: Rate) -> String {
    with_coding(size, rate, "C420mpeg2 XCOLORRANGE=LIMITED")
}

/// The header of a grey film of full range.
pub(super) fn grey_header(size: ImageSize, rate: Rate) -> String {
    with_coding(size, rate, "Cmono XCOLORRANGE=FULL")
}

fn with_coding(ImageSize { width, height }: ImageSize, rate: Rate, coding: &str) -> String {
    format!("YUV4MPEG2 W{width} H{height} F{rate} Ip A1:1 {coding}\n")
}

/// Writes a frame of even width and height, with its mark, over `frame`. Layers and wide samples have no form here: the
/// frame is black.
pub(super) fn encode(pixels: Pixels<'_>, size: ImageSize, frame: &mut Vec<u8>) {
    let (width, height) = (size.width as usize, size.height as usize);
    // All bytes are written below: a frame of the same size is not cleared first.
    frame.resize(MARK.len() + width * height * 3 / 2, 0);
    frame[..MARK.len()].copy_from_slice(MARK);
    let (luma, chroma) = frame[MARK.len()..].split_at_mut(width * height);
    match pixels {
        Pixels::Grey8(pixels) => {
            for (luma, &grey) in luma.iter_mut().zip(pixels) {
                *luma = luma_of_grey(grey);
            }
            chroma.fill(NO_COLOUR);
        }
        Pixels::Rgb8(pixels) => yuv::convert(pixels, width, luma, chroma),
        Pixels::Grey16(_) | Pixels::Rgb16(_) | Pixels::Planes(_) => {
            luma.fill(BLACK);
            chroma.fill(NO_COLOUR);
        }
    }
}

/// 16 + 219 grey/255, to the nearest. The division is exact for what 16 bits hold, and fits vectors.
fn luma_of_grey(grey: u8) -> u8 {
    let scaled = u16::from(grey) * 219 + 128;
    BLACK + ((scaled + (scaled >> 8)) >> 8) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: ImageSize = ImageSize {
        width: 4,
        height: 2,
    };

    fn encoded(pixels: Pixels<'_>) -> Vec<u8> {
        let mut frame = vec![7; 100];
        encode(pixels, SIZE, &mut frame);
        assert!(frame.starts_with(b"FRAME\n"));
        frame.split_off(6)
    }

    #[test]
    fn greys_are_the_nearest_codes_and_neutral_as_masks_and_as_colour() {
        for grey in 0..=255_u8 {
            let luma = (16.0 + 219.0 * f64::from(grey) / 255.0).round() as u8;
            let expected = [[luma; 8].as_slice(), &[128; 4]].concat();
            assert_eq!(encoded(Pixels::Grey8(&[grey; 8])), expected);
            assert_eq!(encoded(Pixels::Rgb8(&[grey; 24])), expected);
        }
        assert_eq!((luma_of_grey(0), luma_of_grey(255)), (16, 235));
    }

    /// Against the formula of BT.709 in floating point, for every 7th value of each primary.
    #[test]
    fn colours_are_the_nearest_codes() {
        let levels = || (0..=255_u8).step_by(7).chain([255]);
        let colours =
            levels().flat_map(|r| levels().flat_map(move |g| levels().map(move |b| [r, g, b])));
        for colour in colours {
            let [r, g, b] = colour.map(|value| f64::from(value) / 255.0);
            let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
            let exact = [
                16.0 + 219.0 * y,
                128.0 + 224.0 * (b - y) / 1.8556,
                128.0 + 224.0 * (r - y) / 1.5748,
            ];
            let frame = encoded(Pixels::Rgb8(&[colour; 8].concat()));
            for (code, exact) in [frame[0], frame[8], frame[10]].into_iter().zip(exact) {
                // Half a code, and the weights' rounding: 3/2 · 255 · 2⁻¹⁶.
                assert!((f64::from(code) - exact).abs() <= 0.506, "{colour:?}");
            }
        }
    }

    #[test]
    fn chroma_lies_at_the_left_of_two_pixels_and_between_two_rows() {
        // A blue column: half of the sample on it, a quarter of the next, nothing of the one before.
        let weight = |blue_column: usize, sample: usize| {
            let mut pixels = [0; 24];
            for row in 0..2 {
                pixels[(row * 4 + blue_column) * 3 + 2] = 255;
            }
            encoded(Pixels::Rgb8(&pixels))[8 + sample] - 128
        };
        assert_eq!([0, 1, 2, 3].map(|column| weight(column, 0)), [84, 28, 0, 0]);
        assert_eq!(
            [0, 1, 2, 3].map(|column| weight(column, 1)),
            [0, 28, 56, 28]
        );
    }
}
