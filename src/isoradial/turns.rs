//! The orbit angles of a quarter turn's nodes.

/// The angles of one quarter turn's nodes beyond its start, for each number of cells: the same for every order and
/// both edges.
#[derive(Debug)]
pub(super) struct Turns {
    x: (f64, f64),
    /// For the fewest cells, twice as many, and so on.
    levels: Vec<Vec<f64>>,
}

impl Turns {
    /// Between two places on the axis. Those closer than a share of 1e-6 (a camera on the disk's axis meets its plane
    /// at one angle) are taken that far apart: nodes need a distance.
    pub(super) fn new(x: (f64, f64)) -> Self {
        const CLOSEST: f64 = 1e-6;
        let middle = (0.5 * (x.0 + x.1)).clamp(CLOSEST, 1.0 - CLOSEST);
        Self {
            x: (x.0.min(middle - CLOSEST), x.1.max(middle + CLOSEST)),
            levels: Vec::new(),
        }
    }

    /// The places.
    pub(super) fn x(&self) -> (f64, f64) {
        self.x
    }

    /// The angles of the nodes of so many cells: the fewest that was ever asked for, or doublings of it.
    pub(super) fn nodes(&mut self, cells: usize) -> &[f64] {
        let fewest = self.levels.first().map_or(cells, |level| level.len() - 1);
        let index = (cells / fewest).trailing_zeros() as usize;
        while self.levels.len() <= index {
            let next = self.levels.last().map_or_else(
                || (0..=cells).map(|i| self.at(i, cells)).collect(),
                |last| {
                    let cells = 2 * (last.len() - 1);
                    (0..=cells)
                        .map(|i| {
                            if i % 2 == 0 {
                                last[i / 2]
                            } else {
                                self.at(i, cells)
                            }
                        })
                        .collect()
                },
            );
            self.levels.push(next);
        }
        &self.levels[index]
    }

    /// `tan(φ − start) = x/(1 − x)`.
    fn at(&self, i: usize, cells: usize) -> f64 {
        let x = super::x_at(self.x, i as f64 / cells as f64);
        libm::atan2(x, 1.0 - x)
    }
}
