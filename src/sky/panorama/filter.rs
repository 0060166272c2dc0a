//! The mean of a panorama over a pixel's footprint.

use wide::f32x4;

use super::Panorama;

pub static mut PARAMS: [f32; 4] = [2.0, 1.0, 0.8, 32.0];

impl Panorama {
    /// Returns the mean over a parallelogram.
    #[inline(always)]
    pub fn mean(&self, place: [f32; 2], along_x: [f32; 2], along_y: [f32; 2]) -> [f32; 3] {
        let [width, height] = self.size;
        let x = place[0] * width;
        let y = (1.0 - place[1]) * height;
        let (ax, ay) = (along_x[0] * width, along_x[1] * height);
        let (bx, by) = (along_y[0] * width, along_y[1] * height);
        let xx = ax * ax + bx * bx;
        let yy = ay * ay + by * by;
        let mean = if xx + yy <= 2.0 {
            self.levels[0].at(x - 0.5, y - 0.5)
        } else if xx + yy <= 8.0 {
            // A quarter of the footprint each, at the distance that gives four points its second moments.
            let k = 0.288_675_13_f32;
            let dx = f32x4::new([ax + bx, ax - bx, bx - ax, -ax - bx]) * f32x4::splat(k);
            let dy = f32x4::new([ay + by, ay - by, by - ay, -ay - by]) * f32x4::splat(k);
            let [a, b, c, d] = self.levels[0].each_at(f32x4::splat(x - 0.5) + dx, f32x4::splat(y - 0.5) - dy);
            ((a + b) + (c + d)) * f32x4::splat(0.25)
        } else {
            // Rows grow downwards.
            let xy = -(ax * ay + bx * by);
            let area = ax * by - ay * bx;
            self.over_ellipse(x, y, xx, yy, xy, area)
        };
        let [red, green, blue, _] = mean.to_array();
        [red, green, blue]
    }

    #[inline(never)]
    fn over_ellipse(&self, x: f32, y: f32, xx: f32, yy: f32, xy: f32, area: f32) -> f32x4 {
        #[allow(unsafe_code)]
        let [_, p1, p2, _] = unsafe { PARAMS };
        let (m, d) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let r = (d * d + xy * xy).sqrt();
        let major = m + r;
        let minor = area * area / major;
        let level = (((minor * (1.0 / 3.0) + 1.0).to_bits() >> 23) as i32 - 127) >> 1;
        let level = (level as usize).min(self.levels.len() - 1);
        let scale = f32::from_bits((127 - level as u32) << 23);
        let s = |l: f32| (l + 3.0) * (scale * scale) - 3.0;
        let (major, minor) = (s(major), s(minor));
        let (cos, sin) = if r < 1e-3 * m {
            (1.0, 0.0)
        } else if d > 0.0 {
            let n = 1.0 / (2.0 * r * (r + d)).sqrt();
            ((r + d) * n, xy * n)
        } else {
            let n = 1.0 / (2.0 * r * (r - d)).sqrt();
            (xy * n, (r - d) * n)
        };
        // Rounded up.
        let n = ((major.sqrt() * p2) as i32 + 1).max(2);
        let nf = n as f32;
        let spacing = (major / (nf * nf - 1.0)).sqrt();
        let l = &self.levels[level];
        let (x, y) = (x * scale - 0.5, y * scale - 0.5);
        let (sx, sy) = (spacing * cos, spacing * sin);
        let start = -0.5 * (nf - 1.0);
        let (x, y) = (x + start * sx, y + start * sy);
        if minor > p1 {
            let across = (minor * (1.0 / 12.0)).sqrt();
            let (cx, cy) = (-sin * across, cos * across);
            let sum = l.line(x + cx, y + cy, sx, sy, n) + l.line(x - cx, y - cy, sx, sy, n);
            sum * f32x4::splat(0.5 / nf)
        } else {
            l.line(x, y, sx, sy, n) * f32x4::splat(1.0 / nf)
        }
    }

    /// Reference.
    pub fn mean_reference(&self, place: [f32; 2], a: [f32; 2], b: [f32; 2], n: usize) -> f64 {
        let first = &self.levels[0];
        let height = first.height() as f64;
        let width = 2.0 * height;
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                let s = (i as f64 + 0.5) / n as f64 - 0.5;
                let t = (j as f64 + 0.5) / n as f64 - 0.5;
                let u = place[0] as f64 + s * a[0] as f64 + t * b[0] as f64;
                let v = place[1] as f64 + s * a[1] as f64 + t * b[1] as f64;
                sum += first.at((u * width - 0.5) as f32, ((1.0 - v) * height - 0.5) as f32).to_array()[0] as f64;
            }
        }
        sum / (n * n) as f64
    }
}
