//! R, G and B as luma and chroma: the matrix of BT.709, limited range, 4:2:0.
//!
//! A chroma sample lies at the left of two pixels and between two rows. It is a quarter of the column to its left, half
//! of its own, and a quarter of the one to its right, each the mean of two rows. The first column is its own left
//! neighbour.
//!
//! Codes are the nearest to sums of products with weights of 16 fractional bits. A pixel is held as a word with red in
//! its lowest byte and green and blue above it; its highest byte is arbitrary. Two channels of a word, 16 bits apart,
//! are the operands of one instruction that multiplies pairs and adds them.

use wide::{i16x8, i32x4, u8x16};

/// The value of black, and of no colour.
pub(super) const BLACK: u8 = 16;
pub(super) const NO_COLOUR: u8 = 128;

/// The columns that are converted together. With fewer, the bookkeeping costs. With more, fewer blocks are all black.
const COLUMNS: usize = 128;

/// Red and blue of a pixel, or sums of them, in the lower and the upper half of a word.
const RED_AND_BLUE: u32 = 0x00ff_00ff;

/// How a code is computed: (weights · colour + offset) >> shift.
struct Matrix {
    red_and_blue: i16x8,
    green_and_offset: i16x8,
    shift: i32,
}

impl Matrix {
    /// Creates the matrix of some weights. The offset is `unit` times what stands above each green.
    fn new([red, green, blue]: [i16; 3], unit: i16, shift: i32) -> Self {
        let pairs = |low, high| i16x8::new([low, high, low, high, low, high, low, high]);
        Self {
            red_and_blue: pairs(red, blue),
            green_and_offset: pairs(green, unit),
            shift,
        }
    }

    /// Computes the codes of 16 colours.
    #[inline(always)]
    fn codes(&self, red_and_blue: [u32; 16], green_and_offset: [u32; 16]) -> [u8; 16] {
        let red_and_blue: [i16x8; 4] = bytemuck::cast(red_and_blue);
        let green_and_offset: [i16x8; 4] = bytemuck::cast(green_and_offset);
        let four = |i: usize| -> i32x4 {
            let sum = red_and_blue[i].dot(self.red_and_blue)
                + green_and_offset[i].dot(self.green_and_offset);
            sum >> self.shift
        };
        let eight = |i| i16x8::from_i32x8_saturate(bytemuck::cast([four(i), four(i + 1)]));
        u8x16::narrow_i16x8(eight(0), eight(2)).to_array()
    }
}

/// What stands above green, doubled, for luma: times 2¹³ it is 16 + 1/2, the half for the nearest code.
const LUMA_OFFSET: u32 = 132 << 16;

/// What stands above eight times green for chroma: times 2¹⁴ it is 128 + 1/2, eightfold.
const CHROMA_OFFSET: u32 = 4112 << 16;

/// Converts a picture of even width and height into luma, and into both kinds of chroma.
pub(super) fn convert(rgb: &[u8], width: usize, luma: &mut [u8], chroma: &mut [u8]) {
    // Luma's weights of red, green and blue (ITU-R BT.709-6, 3.2) times 219/255; half of green's, which is doubled.
    let luma_matrix = Matrix::new([11966, 20127, 4064], 1 << 13, 16);
    // The weights of (B − Y)/1.8556 and (R − Y)/1.5748, times 224/255. Their sums are 0: grey has U = V = 128 exactly.
    let blue_matrix = Matrix::new([-6596, -22188, 28784], 1 << 14, 19);
    let red_matrix = Matrix::new([28784, -26145, -2639], 1 << 14, 19);

    let (blue, red) = chroma.split_at_mut(chroma.len() / 2);
    let pairs_of_rows = rgb
        .chunks_exact(6 * width)
        .zip(luma.chunks_exact_mut(2 * width))
        .zip(blue.chunks_exact_mut(width / 2))
        .zip(red.chunks_exact_mut(width / 2));
    let (mut top, mut bottom) = ([0; COLUMNS], [0; COLUMNS]);
    let (mut red_and_blue, mut green) = (Sums::BLACK, Sums::BLACK);
    for (((rgb, luma), blue), red) in pairs_of_rows {
        let (top_rgb, bottom_rgb) = rgb.split_at(3 * width);
        let (top_luma, bottom_luma) = luma.split_at_mut(width);
        let blocks = top_rgb
            .chunks(3 * COLUMNS)
            .zip(bottom_rgb.chunks(3 * COLUMNS))
            .zip(top_luma.chunks_mut(COLUMNS))
            .zip(bottom_luma.chunks_mut(COLUMNS))
            .zip(blue.chunks_mut(COLUMNS / 2))
            .zip(red.chunks_mut(COLUMNS / 2));
        // What lies at the left of the first block is not part of it.
        red_and_blue.columns[COLUMNS] = 0;
        green.columns[COLUMNS] = 0;
        for (place, (((((top_rgb, bottom_rgb), top_luma), bottom_luma), blue), red)) in
            blocks.enumerate()
        {
            let left_is_black = red_and_blue.last() == 0 && green.last() == 0;
            if left_is_black && is_black(top_rgb) && is_black(bottom_rgb) {
                top_luma.fill(BLACK);
                bottom_luma.fill(BLACK);
                blue.fill(NO_COLOUR);
                red.fill(NO_COLOUR);
                continue;
            }
            for (pixels, rgb, luma) in [
                (&mut top, top_rgb, top_luma),
                (&mut bottom, bottom_rgb, bottom_luma),
            ] {
                load(rgb, pixels);
                let pixels = pixels.as_chunks().0;
                fill(
                    luma,
                    #[inline(always)]
                    |i| {
                        let double_green = |pixel: u32| pixel >> 7 & 0x1fe | LUMA_OFFSET;
                        let red_and_blue = pixels[i].map(|pixel: u32| pixel & RED_AND_BLUE);
                        luma_matrix.codes(red_and_blue, pixels[i].map(double_green))
                    },
                );
            }
            let is_first = place == 0;
            red_and_blue.update(&top, &bottom, is_first, |pixel| pixel & RED_AND_BLUE);
            green.update(&top, &bottom, is_first, |pixel| pixel >> 8 & 0xff);
            let (red_and_blue, green) = (red_and_blue.eightfold(0), green.eightfold(CHROMA_OFFSET));
            let (red_and_blue, green) = (red_and_blue.as_chunks().0, green.as_chunks().0);
            fill(blue, |i| blue_matrix.codes(red_and_blue[i], green[i]));
            fill(red, |i| red_matrix.codes(red_and_blue[i], green[i]));
        }
    }
}

fn is_black(rgb: &[u8]) -> bool {
    // Without an end at the first other byte, which vectors could not find.
    rgb.iter().fold(0, |all, byte| all | byte) == 0
}

/// Loads pixels as words; those after the last stay as they are.
#[inline(always)]
fn load(rgb: &[u8], pixels: &mut [u32; COLUMNS]) {
    for (pixel, four) in pixels.iter_mut().zip(rgb.windows(4).step_by(3)) {
        *pixel = u32::from_le_bytes([four[0], four[1], four[2], four[3]]);
    }
    // No fourth byte follows the last pixel.
    if let Some(&[red, green, blue]) = rgb.last_chunk() {
        pixels[rgb.len() / 3 - 1] = u32::from_le_bytes([red, green, blue, 0]);
    }
}

/// Fills `codes` with the 16 of each place.
#[inline(always)]
fn fill(codes: &mut [u8], of_place: impl Fn(usize) -> [u8; 16]) {
    let (whole, rest) = codes.as_chunks_mut();
    let places = whole.len();
    for (place, codes) in whole.iter_mut().enumerate() {
        *codes = of_place(place);
    }
    if !rest.is_empty() {
        rest.copy_from_slice(&of_place(places)[..rest.len()]);
    }
}

/// Sums of two rows, column by column, of one channel or of two that are 16 bits apart.
struct Sums {
    /// The column at the left, and those of the block.
    columns: [u32; COLUMNS + 1],
}

impl Sums {
    const BLACK: Self = Self {
        columns: [0; COLUMNS + 1],
    };

    /// Goes on to the next block of two rows, or to the first.
    #[inline(always)]
    fn update(
        &mut self,
        top: &[u32; COLUMNS],
        bottom: &[u32; COLUMNS],
        is_first: bool,
        channels: impl Fn(u32) -> u32,
    ) {
        let left = self.last();
        for ((sum, &top), &bottom) in self.columns[1..].iter_mut().zip(top).zip(bottom) {
            *sum = channels(top) + channels(bottom);
        }
        self.columns[0] = if is_first { self.columns[1] } else { left };
    }

    fn last(&self) -> u32 {
        self.columns[COLUMNS]
    }

    /// Computes eight times the mean around every other column, and adds `offset`.
    #[inline(always)]
    fn eightfold(&self, offset: u32) -> [u32; COLUMNS / 2] {
        let mut sums = [0; COLUMNS / 2];
        for (i, sum) in sums.iter_mut().enumerate() {
            let [left, own, right] = [0, 1, 2].map(|column| self.columns[2 * i + column]);
            *sum = left + 2 * own + right + offset;
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    /// The code of a colour: `offset` and the weighted sum, with so many fractional bits; to the nearest.
    fn code(weights: [i32; 3], colour: [i32; 3], offset: i32, fraction: u32) -> u8 {
        let products = weights.into_iter().zip(colour);
        let sum: i32 = products.map(|(weight, value)| weight * value).sum();
        (offset + ((sum + (1 << (fraction - 1))) >> fraction)) as u8
    }

    /// Luma and chroma, sample by sample.
    fn expected(rgb: &[u8], width: usize) -> (Vec<u8>, Vec<u8>) {
        let pixels = rgb.as_chunks::<3>().0;
        let luma = |pixel: &[u8; 3]| code([11966, 40254, 4064], pixel.map(i32::from), 16, 16);
        let mut chroma = Vec::new();
        for weights in [[-6596, -22188, 28784], [28784, -26145, -2639]] {
            for rows in pixels.chunks(2 * width) {
                let sum = |column: usize, channel: usize| {
                    let value = |pixel: usize| i32::from(rows[pixel][channel]);
                    value(column) + value(width + column)
                };
                for own in (0..width).step_by(2) {
                    let eightfold = [0, 1, 2].map(|channel| {
                        let left = own.saturating_sub(1);
                        sum(left, channel) + 2 * sum(own, channel) + sum(own + 1, channel)
                    });
                    chroma.push(code(weights, eightfold, 128, 19));
                }
            }
        }
        (pixels.iter().map(luma).collect(), chroma)
    }

    /// Frames whose rows have runs of black and of random or extreme colours, of any length.
    fn frames() -> impl Strategy<Value = (usize, Vec<u8>)> {
        let colour = prop_oneof![
            any::<[u8; 3]>(),
            prop::sample::select(vec![
                [255, 0, 0],
                [0, 255, 0],
                [0, 0, 255],
                [255; 3],
                [0; 3]
            ]),
        ];
        let run = (0..300_usize, any::<bool>());
        let sides = (1..300_usize, 1..4_usize);
        (sides, vec(run, 1..20), vec(colour, 97)).prop_map(|((width, height), runs, colours)| {
            let (width, height) = (2 * width, 2 * height);
            let runs = runs
                .iter()
                .cycle()
                .flat_map(|&(length, is_black)| std::iter::repeat_n(is_black, length + 1));
            let pixels = colours.iter().cycle().zip(runs);
            let pixels = pixels.map(|(colour, is_black)| if is_black { [0; 3] } else { *colour });
            (width, pixels.take(width * height).flatten().collect())
        })
    }

    proptest! {
        #[test]
        fn any_frame_has_the_codes_of_the_formula((width, rgb) in frames()) {
            let (luma, chroma) = expected(&rgb, width);
            let mut codes = vec![7; luma.len() + chroma.len()];
            let (own_luma, own_chroma) = codes.split_at_mut(luma.len());
            convert(&rgb, width, own_luma, own_chroma);
            prop_assert!(own_luma == luma);
            prop_assert!(own_chroma == chroma);
        }
    }
}
