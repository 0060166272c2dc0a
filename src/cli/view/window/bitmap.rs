//! A window's pixels.

/// A picture of 0x00RRGGBB, row by row from the top.
pub(super) struct Bitmap<'a> {
    pixels: &'a mut [u32],
    width: usize,
    height: usize,
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Area {
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Area {
    /// Whether a point is in it.
    pub(super) fn contains(&self, (x, y): (f64, f64)) -> bool {
        let within = |value: f64, from: usize, length: usize| {
            (from as f64..(from + length) as f64).contains(&value)
        };
        within(x, self.left, self.width) && within(y, self.top, self.height)
    }
}

/// Returns a colour of three bytes.
pub(super) fn colour([red, green, blue]: [u8; 3]) -> u32 {
    u32::from(red) << 16 | u32::from(green) << 8 | u32::from(blue)
}

impl<'a> Bitmap<'a> {
    /// The picture in these pixels, `width` a row; what is left of the last row is not a part of it.
    pub(super) fn new(pixels: &'a mut [u32], width: usize) -> Self {
        let height = pixels.len().checked_div(width).unwrap_or_default();
        Self {
            pixels,
            width,
            height,
        }
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    /// All of it.
    pub(super) fn whole(&self) -> Area {
        Area {
            left: 0,
            top: 0,
            width: self.width,
            height: self.height,
        }
    }

    /// The part of a row within an area.
    fn part(&mut self, area: Area, row: usize) -> &mut [u32] {
        let right = (area.left + area.width).min(self.width);
        let left = area.left.min(right);
        let start = row * self.width;
        &mut self.pixels[start + left..start + right]
    }

    fn rows(&self, area: Area) -> std::ops::Range<usize> {
        area.top.min(self.height)..(area.top + area.height).min(self.height)
    }

    /// Fills an area with a colour.
    pub(super) fn fill(&mut self, area: Area, colour: u32) {
        for row in self.rows(area) {
            self.part(area, row).fill(colour);
        }
    }

    /// Fills an area with columns of colours: `colour` takes a column's place in it, 0 to 1.
    pub(super) fn fill_columns(&mut self, area: Area, colour: impl Fn(f64) -> u32) {
        for row in self.rows(area) {
            for (i, pixel) in self.part(area, row).iter_mut().enumerate() {
                *pixel = colour(i as f64 / (area.width - 1).max(1) as f64);
            }
        }
    }

    /// Copies a picture of the area's size into it.
    pub(super) fn copy(&mut self, area: Area, picture: &[u32]) {
        for (row, source) in self.rows(area).zip(picture.chunks(area.width.max(1))) {
            let part = self.part(area, row);
            let width = part.len().min(source.len());
            part[..width].copy_from_slice(&source[..width]);
        }
    }

    /// Darkens an area to a quarter, so that writing on it can be read.
    pub(super) fn dim(&mut self, area: Area) {
        for row in self.rows(area) {
            for pixel in self.part(area, row) {
                *pixel = *pixel >> 2 & 0x003f_3f3f;
            }
        }
    }

    /// Lays a colour over a pixel, which it covers to `share` of 255. Pixels outside the picture are left out.
    pub(super) fn blend(&mut self, (x, y): (usize, usize), colour: u32, share: u8) {
        if x >= self.width || y >= self.height {
            return;
        }
        let below = &mut self.pixels[y * self.width + x];
        let share = u32::from(share);
        let channel = |shift: u32| {
            let mixed = (colour >> shift & 255) * share + (*below >> shift & 255) * (255 - share);
            ((mixed + 127) / 255) << shift
        };
        *below = channel(16) | channel(8) | channel(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_outside_the_picture_is_left_out() {
        let mut pixels = vec![0x00ff_8040; 6];
        let mut bitmap = Bitmap::new(&mut pixels, 3);
        let area = Area {
            left: 2,
            top: 1,
            width: 9,
            height: 9,
        };
        bitmap.dim(area);
        bitmap.blend((3, 0), 0, 255);
        bitmap.blend((0, 2), 0, 255);
        bitmap.blend((0, 0), 0x0010_2030, 255);
        bitmap.blend((1, 0), 0x0010_2030, 0);
        bitmap.fill(Area { left: 5, ..area }, 7);
        bitmap.copy(Area { width: 1, ..area }, &[0x003f_2010, 8, 9]);
        let same = 0x00ff_8040;
        assert_eq!(pixels, [0x0010_2030, same, same, same, same, 0x003f_2010]);
    }
}
